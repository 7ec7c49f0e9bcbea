"""The slice model of ISO/TS 16281: what bearing calculations use instead of a contact solution.

The roller is cut into slices that do not know of each other; each is a non-linear spring. Quick, and blind for what
happens at ends: a comparison for the contact solver, not a substitute.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import UNBOUNDED, describe
from contactstudy.case.case import Case, small_tilt
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import checked_drop, local_radius

SPRING = 35948e6
"""The standard's spring constant 35948 N / mm**2 in N / m**2; the powers of its lengths add up to 2."""

STEEL = 0.5 * 207e9 / (1 - 0.3**2)
"""Contact modulus (Pa) that the standard's constant stands for: steel on steel, 207 GPa and 0.3."""

EXPONENT = 10 / 9

OF_MODEL = f"of slices that do not know of each other, {UNBOUNDED}"
"""What every number of the model says of itself."""


def slice_model(case: Case, *, slices: int = 30, tilt: float | None = None, edge_riser: bool = False) -> xr.Dataset:
    """Load and pressure along a roller by the slice model of ISO/TS 16281.

    Each of the ``n`` slices of a contact of length ``L`` carries ``c_s (E* / E*_steel) (2 d_k)**(10/9)`` with
    ``c_s = 35948 L**(8/9) / n`` (N, mm) and its own deflection ``d_k = max(d + tilt x_k - drop(x_k), 0)``. The approach
    ``d`` follows from the load. The pressure is that of the Hertz line contact of the slice's load per length.

    Parameters
    ----------
    case : Case
        Body, roller and load. Only the body's contact modulus counts: the model knows no free ends. Where the roller
        overhangs only the part over the body is cut.
    slices : int
        Number ``n`` of slices; the standard asks for at least 30.
    tilt : float, optional
        Angle of the roller's axis about its mid-length, radians; positive presses the end at larger `x` deeper.
        Default: the case's.
    edge_riser : bool
        Whether the pressure contains the standard's approximate stress riser: the load of slice ``k`` times
        ``1 - 0.01 / ln(1.985 |2 k - n - 1| / (2 n - 2))``, 2.33 at the ends and 1 in the middle. It is said to hold
        for the standard's own profiles (`IsoCylindrical`, `IsoTapered`), medium loads and tilts below 4 minutes of arc,
        1.2 mrad; not for rollers without a profile. `contactstudy.bearing.lamina_factors` has it from solved contacts.

    Returns
    -------
    Dataset
        Along `x` (middle of each slice, metres from end I of the body): `load_per_length` (N/m), `pressure` (Pa),
        `half_width` (m), `deflection` (m), `edge_factor`; and the scalars `normal_load` (N) and `approach` (m). A
        `comment` says of what the model makes that no error is known.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind or out of range, or the case prescribes where the load acts.

    Notes
    -----
    The standard's deflection is that of a roller between two raceways and its profile counts twice; here there is one
    contact, so the deflection is half of that and the profile counts once. Its constant holds for steel; Palmgren's
    relation behind it depends on the load over the contact modulus, so that the constant is proportional to the
    modulus. The riser is applied by the standard to the loads from which it calculates the life; it does not enter
    the equilibrium. The standard's text was not available: formulas and their range are what public programs quote.

    References
    ----------
    ISO/TS 16281:2008, Rolling bearings - Methods for calculating the modified reference rating life for universally
    loaded bearings, equations 35, 38 to 44 and 60.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material, Roller
    >>> roller = Roller(radius=5e-3, length=10e-3)
    >>> case = Case(body=HalfSpace(material=Material(210e9, 0.3)), roller=roller, load=1000.0)
    >>> result = slice_model(case, tilt=1e-3)
    >>> round(float(result.load_per_length.mean()) / 1e3, 6)
    100.0
    >>> bool(result.pressure[-1] > result.pressure[0])
    True
    """
    checks.instance("case", case, Case, "a Case")
    slices = checks.count("slices", slices, least=2)
    if case.load_position is not None:
        raise InvalidInputError("case.load_position", case.load_position, "None: the slice model takes a tilt")
    tilt = small_tilt(case.tilt if tilt is None else tilt)
    checks.instance("edge_riser", edge_riser, bool, "True or False")
    start, _ = case.contact_range
    length, roller = case.contact_length, case.roller
    x = start + length * (np.arange(slices) + 0.5) / slices
    from_middle = x - case.roller_middle
    height = checked_drop(roller.profile, from_middle, roller.length) - np.tan(tilt) * from_middle
    stiffness = SPRING * length ** (8 / 9) / slices * (case.modulus / STEEL)
    approach, deflection = _equilibrium(height, stiffness, case.normal_load)
    load_per_length = stiffness * (2 * deflection) ** EXPONENT * slices / length
    factor = _edge_factor(slices)
    radius = local_radius(roller.profile, from_middle, roller.length, roller.radius)
    carried = load_per_length * factor if edge_riser else load_per_length
    pressure = np.sqrt(carried * case.modulus / (np.pi * radius))
    fields = {
        "load_per_length": load_per_length,
        "pressure": pressure,
        "half_width": 2 * pressure * radius / case.modulus,
        "deflection": deflection,
        "edge_factor": factor,
    }
    result = xr.Dataset(
        {name: ("x", values) for name, values in fields.items()}
        | {"normal_load": case.normal_load, "approach": approach},
        coords={"x": x},
        attrs={"slices": slices, "tilt": tilt},
    )
    for name in ("load_per_length", "half_width", "deflection", "edge_factor", "approach"):
        result[name].attrs["comment"] = OF_MODEL
    risen = ", with stress riser" if edge_riser else ""
    result["pressure"].attrs["comment"] = f"peak of each slice{risen}; {OF_MODEL}"
    result["approach"].attrs["reference"] = "undeformed bodies, at mid-length"
    return describe(result, "slice model of ISO/TS 16281")


def _equilibrium(height: FloatArray, stiffness: float, load: float) -> tuple[float, FloatArray]:
    """Approach and deflections for which springs of a `stiffness`, at different heights, carry the load."""
    from scipy.optimize import brentq

    def deflection(approach: float) -> FloatArray:
        return np.asarray(np.maximum(approach - height, 0.0))

    def excess(approach: float) -> float:
        return float(stiffness * np.sum((2 * deflection(approach)) ** EXPONENT)) / load - 1

    lowest = float(height.min())
    alone = 0.5 * (load / stiffness) ** (1 / EXPONENT)  # one slice carries all: the most that can be needed
    approach = float(brentq(excess, lowest, lowest + 1.001 * alone, xtol=1e-15 * alone, rtol=1e-14, maxiter=200))
    return approach, deflection(approach)


def _edge_factor(slices: int) -> FloatArray:
    """Stress riser of every slice; 1 in the middle."""
    number = np.arange(1, slices + 1)
    with np.errstate(divide="ignore"):
        return np.asarray(1 - 0.01 / np.log(1.985 * np.abs(2 * number - slices - 1) / (2 * slices - 2)))
