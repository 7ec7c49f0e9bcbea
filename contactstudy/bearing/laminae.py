"""Laminae of a roller: the slice model after ISO/TS 16281, and edge factors from solved pressures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import cell_edges, dimension_along, single_case
from contactstudy.analysis.provenance import solved_case
from contactstudy.analysis.slices import SIDES, Columns, power_means, pressure_errors
from contactstudy.arrays.peaks import section_maxima
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, describe, require, require_in_si
from contactstudy.bodies import hertz
from contactstudy.case.case import Case, small_tilt
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import check_drop, local_radius

SPRING_CONSTANT = 35948e6  # The standard's spring constant 35948 N / mm**2, in N / m**2
# Contact modulus (Pa) of the standard's constant: steel on steel, 207 GPa and 0.3
STEEL_MODULUS = 0.5 * 207e9 / (1 - 0.3**2)
POWER = 10 / 9

MODEL_COMMENT = "of independent slices"  # Comment of every variable of the model


def slice_model(case: Case, *, slices: int = 30, tilt: float | None = None, edge_riser: bool = False) -> xr.Dataset:
    """Load and pressure along a roller by the slice model of ISO/TS 16281.

    Each of the ``n`` slices of a contact of length ``L`` carries ``c_s (E* / E*_steel) (2 d_k)**(10/9)`` with
    ``c_s = 35948 L**(8/9) / n`` (N, mm) and its deflection ``d_k = max(d + tilt x_k - drop(x_k), 0)``. The approach
    ``d`` follows from the load. The pressure is that of the Hertz line contact of the slice's load per length.

    Parameters
    ----------
    case : Case
        The model uses only the body's contact modulus. An overhanging roller has slices over the body only.
    slices : int
        Number ``n`` of slices; at least 30 in the standard.
    tilt : float, optional
        Angle of the roller's axis about its mid-length, radians; positive presses the end at larger `x` deeper.
        Default: the case's.
    edge_riser : bool
        Whether the pressure contains the standard's approximate stress riser: the load of slice ``k`` times
        ``1 - 0.01 / ln(1.985 |2 k - n - 1| / (2 n - 2))``, 2.33 at the ends and 1 in the middle. Its range:
        the standard's profiles (`IsoCylindrical`, `IsoTapered`), medium loads and tilts below 4 minutes of arc,
        1.2 mrad; not rollers without a profile. `contactstudy.bearing.lamina_factors` computes it exactly.

    Returns
    -------
    Dataset
        Along `x` (middle of each slice, metres from end I of the body): `load_per_length` (N/m), `pressure` (Pa),
        `half_width` (m), `deflection` (m), `edge_factor`; and the scalars `normal_load` (N) and `approach` (m). Their
        errors are not estimated.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind or out of range, or the case prescribes the load's position.

    Notes
    -----
    The standard's deflection belongs to a roller between two raceways; one contact has half the deflection. The
    standard applies the riser to the loads of the life only. Formulas and range are second-hand, from public programs.

    References
    ----------
    ISO/TS 16281:2008, equations 35, 38 to 44 and 60.

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
    from scipy.optimize import brentq

    checks.instance("case", case, Case, "a Case")
    slices = checks.count("slices", slices, minimum=2)
    if case.load_position is not None:
        raise InvalidInputError("case.load_position", case.load_position, "None: the slice model takes a tilt")
    tilt = small_tilt(case.tilt if tilt is None else tilt)
    checks.instance("edge_riser", edge_riser, bool, "True or False")
    start, _ = case.contact_range
    length, roller = case.contact_length, case.roller
    x = start + length * (np.arange(slices) + 0.5) / slices
    x_from_middle = x - case.roller_middle
    height = check_drop(roller.profile, x_from_middle, roller.length) - np.tan(tilt) * x_from_middle
    stiffness = SPRING_CONSTANT * length ** (8 / 9) / slices * (case.modulus / STEEL_MODULUS)
    load = case.normal_load
    # `bound`: approach beyond the smallest height at which a single slice carries the whole load
    min_height, max_depth = float(height.min()), 0.5 * (load / stiffness) ** (1 / POWER)
    max_approach = min_height + 1.001 * max_depth

    def excess(approach: float) -> float:
        return float(stiffness * np.sum((2 * np.maximum(approach - height, 0.0)) ** POWER) / load - 1)

    approach = float(brentq(excess, min_height, max_approach, xtol=1e-15 * max_depth, rtol=1e-14, maxiter=200))
    deflection = np.maximum(approach - height, 0.0)
    load_per_length = stiffness * (2 * deflection) ** POWER * slices / length
    from_middle = np.abs(2 * np.arange(1, slices + 1) - slices - 1) / (2 * slices - 2)
    with np.errstate(divide="ignore"):
        edge_factor = 1 - 0.01 / np.log(1.985 * from_middle)  # 1 in the middle
    radius = local_radius(roller.profile, x_from_middle, roller.length, roller.radius)
    line_load = load_per_length * edge_factor if edge_riser else load_per_length
    pressure = np.sqrt(line_load * case.modulus / (np.pi * radius))
    riser_comment = ", with stress riser" if edge_riser else ""
    attributes = {"comment": MODEL_COMMENT, ERROR_KIND: NOT_ESTIMATED}
    variables: dict[str, tuple[object, ...]] = {
        "load_per_length": ("x", load_per_length, attributes),
        "pressure": ("x", pressure, attributes | {"comment": f"peak of each slice{riser_comment}; {MODEL_COMMENT}"}),
        "half_width": ("x", 2 * pressure * radius / case.modulus, attributes),
        "deflection": ("x", deflection, attributes),
        "edge_factor": ("x", edge_factor, attributes),
        "normal_load": ((), load),
        "approach": ((), approach, attributes | {"reference": "undeformed bodies, at mid-length"}),
    }
    result = xr.Dataset(variables, coords={"x": x}, attrs={"slices": slices, "tilt": tilt})
    return describe(result, "slice model of ISO/TS 16281")


# Power with which a lamina's risk of fatigue grows with load: the life exponent 4 of a line contact times the slope
# 9/8 of Weibull's distribution
LIFE_POWER = 9 / 2


def lamina_factors(result: xr.Dataset, *, laminae: int = 30) -> xr.Dataset:
    """Factors on the loads of the lamina model, whose Hertz pressures then equal the pressures of a solved contact.

    Parameters
    ----------
    result : Dataset
        Result of :func:`contactstudy.solve` for the roller on the inner or the outer raceway.
    laminae : int
        Number of laminae; at least 30 in the standard.

    Returns
    -------
    Dataset
        Along `slice`: `position` (m, middle, from end I of the body), `width` (m); `load_per_length` (N/m) of the
        lamina model under the same load and tilt; `hertz_load_per_length` (N/m), with the solved pressure in line
        contact; `stress_riser`, the latter over the former: ``f_i[k]`` inside, ``f_e[k]`` outside; the errors
        of these two, from the stated errors of the pressures and the distance of the columns; and `edge_factor`, the
        standard's approximation. The error of the lamina model is not estimated.

    Raises
    ------
    InvalidInputError
        If the result lacks its case, or `laminae` is not a whole number above 1.

    Notes
    -----
    Within a lamina the pressure varies. Its load is the mean that gives the same life,
    ``(mean of (pi p**2 R / E*)**(9/2))**(2/9)`` with the largest pressure p of each cross-section, so the life does not
    depend on the number of laminae. At a sharp end, where the pressure is singular, the outermost factor is
    infinite. The factor is NaN where the lamina model has no load; `hertz_load_per_length` is finite (equations
    58 and 59 of ISO/TS 16281, second-hand).

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, profiles, solve
    >>> body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.5e-3, profile=profiles.Lundberg(0.2e-6))
    >>> factors = lamina_factors(solve(Case(body=body, roller=roller, max_pressure=1.5e9), stresses=False))
    >>> factors.edge_factor[:2].values.round(2).tolist()
    [2.33, 1.13]
    >>> bool(factors.stress_riser[0] < 1 < factors.stress_riser[1])  # between free ends the ends carry less
    True
    """
    require(result, "tilt", argument="result")
    result = require_in_si(result, "pressure", argument="result")
    solution = single_case(result)
    return lamina_loads(solution, solved_case(solution), laminae)[0]


def lamina_loads(solution: xr.Dataset, case: Case, laminae: int) -> tuple[xr.Dataset, FloatArray]:
    """Factors as in :func:`lamina_factors`, and the error of the loads, N/m, from the stated errors of the pressure."""
    count = checks.count("laminae", laminae, minimum=2)
    slice_result = slice_model(replace(case, load_position=None, tilt=float(solution["tilt"])), slices=count)
    start, stop = case.contact_range
    edges = np.linspace(start, stop, count + 1)
    load, error, common_error = _hertz_loads(solution, case, edges)
    sliced_load = slice_result["load_per_length"].values
    with np.errstate(divide="ignore", invalid="ignore"):
        riser = np.where(sliced_load > 0, load / sliced_load, np.nan)
        riser_error = np.where(sliced_load > 0, error / sliced_load, np.nan)
    model_attributes = {"comment": MODEL_COMMENT}
    error_attributes = {"comment": "from the stated errors of the pressure and the distance of its columns"}
    if np.isnan(error).any():
        error_attributes = {ERROR_KIND: NOT_ESTIMATED}
    values: dict[str, tuple[object, ...]] = {
        "position": ("slice", 0.5 * (edges[1:] + edges[:-1])),
        "width": ("slice", np.full(count, (stop - start) / count)),
        "load_per_length": ("slice", sliced_load, model_attributes),
        "hertz_load_per_length": ("slice", load),
        "hertz_load_per_length_error": ("slice", error, error_attributes),
        "stress_riser": ("slice", riser),
        "stress_riser_error": ("slice", riser_error, error_attributes),
        "edge_factor": ("slice", slice_result["edge_factor"].values, model_attributes),
    }
    labelled = xr.Dataset(values, coords={"slice": np.arange(1, count + 1)})
    return describe(labelled, "stress riser of every lamina from solved pressures"), common_error


def _hertz_loads(result: xr.Dataset, case: Case, edges: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Hertz load per length of each lamina's solved pressure, its error, and the error without that of columns."""
    pressure = result["pressure"].transpose(dimension_along(result["pressure"], "x"), ...)
    x = dimension_along(pressure, "x")
    position, max_pressure = result[x].values, section_maxima(pressure.values)
    roller, half_length = case.roller, 0.5 * case.roller.length
    x_from_middle = np.clip(position - case.roller_middle, -half_length, half_length)
    radius = local_radius(roller.profile, x_from_middle, roller.length, roller.radius)
    line_loads = hertz.line_load(1.0, 1.0, case.modulus) * max_pressure**2 * radius
    columns = Columns(np.stack(cell_edges(pressure, "x"), axis=-1), position, line_loads)
    load, discretisation_error = power_means(columns, edges, LIFE_POWER)
    # Errors that follow from the stated errors of the largest pressure in either half
    half_count, weights = load.size // 2, columns.overlaps(edges)
    halves = (slice(load.size - half_count), slice(half_count, None))
    is_singular = [bool(np.isinf(float(result.get(f"peak_pressure_{side}", 0.0)))) for side in SIDES]
    errors = np.zeros((2, load.size))
    for row, half, singular, relative_error in zip(errors, halves, is_singular, pressure_errors(result), strict=True):
        max_load = load[half] if singular else line_loads[weights[half].any(axis=0)].max()
        # The load is proportional to the square of the pressure.
        row[half] = 2 * relative_error * np.sqrt(load[half] * max_load)
    common_error = errors.max(axis=0)
    error = common_error + discretisation_error
    singular_ends = np.flatnonzero(is_singular) * (load.size - 1)
    for values in (load, error, common_error):
        values[singular_ends] = np.inf
    return load, error, common_error
