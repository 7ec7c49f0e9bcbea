"""Basic reference rating life of a roller bearing from its laminae: the slice model, the half-space, free ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import describe
from contactstudy.bearing.laminae import LIFE_POWER, lamina_loads
from contactstudy.bodies.models import HalfSpace
from contactstudy.case.case import Case
from contactstudy.case.magnitudes import warn_of_values
from contactstudy.case.motion import Sliding
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.solution import solve

MODELS = ("slices", "slices with riser", "half-space", "free ends")  # Models of the pressure of a lamina
RACEWAYS = ("inner", "outer")

TURNING_POWER = 4.0  # Power of the mean for the turning raceway; for the other raceway LIFE_POWER
# Factor lambda nu of ISO 281's dynamic ratings for radial roller bearings, second-hand: an allowance for edge stress,
# which the lamina model contains
RATING_REDUCTION = 0.83


def roller_ratings(dynamic_rating: float, rollers: int, gamma: float, *, rows: int = 1) -> tuple[float, float]:
    """Dynamic load ratings of one roller on the inner and on the outer raceway of a radial roller bearing.

    Parameters
    ----------
    dynamic_rating : float
        Basic dynamic radial load rating ``C_r`` of ISO 281, from the catalogue, N.
    rollers : int
        Number Z of rollers in a row.
    gamma : float
        Roller diameter over pitch diameter, for a contact angle of 0.
    rows : int
        Number of rows.

    Returns
    -------
    tuple of float
        ``Q_ci`` and ``Q_ce``, N.

    Raises
    ------
    InvalidInputError
        If a value is out of range.

    Warns
    -----
    MagnitudeWarning
        If the rating lies outside its usual range.

    Notes
    -----
    ``Q_c = C_r / (0.83 c Z rows**(7/9)) (1 + r**(+-9/2))**(2/9)`` with c = 0.378 inside and 0.364 outside, and
    ``r = 1.038 ((1 - gamma) / (1 + gamma))**(143/108)``: equations 47 to 49 of ISO/TS 16281, second-hand.

    Examples
    --------
    >>> [round(rating) for rating in roller_ratings(50e3, rollers=14, gamma=0.2)]
    [11640, 19921]
    """
    rating = checks.positive("dynamic_rating", dynamic_rating, "N")
    count, rows = checks.count("rollers", rollers), checks.count("rows", rows)
    diameter_ratio = checks.positive("gamma", gamma)
    if diameter_ratio >= 1:
        raise InvalidInputError("gamma", diameter_ratio, "below 1, roller diameter over pitch diameter")
    warn_of_values(dynamic_rating=rating)
    ratio = 1.038 * ((1 - diameter_ratio) / (1 + diameter_ratio)) ** (143 / 108)
    mean_rating = rating / (RATING_REDUCTION * count * rows ** (7 / 9))
    inner = mean_rating / 0.378 * (1 + ratio**LIFE_POWER) ** (1 / LIFE_POWER)
    outer = mean_rating / 0.364 * (1 + ratio**-LIFE_POWER) ** (1 / LIFE_POWER)
    return inner, outer


def reference_life(
    inner: Case | Sequence[Case],
    outer: Case | Sequence[Case],
    ratings: tuple[float, float],
    *,
    rollers: int | None = None,
    turning: str = "inner",
    laminae: int = 30,
    accuracy: float = 0.01,
) -> xr.Dataset:
    """Compute the basic reference rating life of a roller bearing by four models of its contacts, side by side.

    Parameters
    ----------
    inner, outer : Case or sequence of Case
        Loaded rollers on either raceway, with load and tilt; a single Case represents all rollers. The radius of its
        roller is that relative to the raceway: ``D (1 - gamma) / 2`` inside, ``D (1 + gamma) / 2``
        outside.
    ratings : tuple of float
        Dynamic load ratings ``Q_ci`` and ``Q_ce`` of a roller, N, see :func:`roller_ratings`.
    rollers : int, optional
        Number of rollers, including unloaded rollers, with a sequence. Default: the length of the sequence.
    turning : {"inner", "outer"}
        Raceway that turns against the load.
    laminae, accuracy
        As for :func:`lamina_factors` and :func:`contactstudy.solve`.

    Returns
    -------
    Dataset
        Along `model`: `reference_life` (revolutions that 9 of 10 bearings survive), and along `raceway`
        `raceway_life`. The models are "slices" (no edge factor), "slices with riser" (the standard's approximation),
        "half-space" (body and roller as half-spaces, under the same load and moment), and "free ends" (the Case).
        Along `raceway`, `roller` and `slice` the factors ``f_i[j, k]`` and ``f_e[j, k]``, `stress_riser`, and the
        dynamic equivalent load per lamina, `lamina_equivalent_load` (N). Each has its ``_error`` from the stated errors
        of the pressures; it is NaN for both models of slices, whose error is unknown.

    Raises
    ------
    InvalidInputError
        If a case is no Case, the raceways have different numbers of rollers, or an argument is out of range.

    Notes
    -----
    ``L = (sum over k of (q_kci / q_kei)**(-9/2) + (q_kce / q_kee)**(-9/2))**(-8/9)`` in millions, where ``q_kc = Q_c
    n**(-7/9)`` rates one of n laminae and ``q_ke = (1/Z sum over j of (f[j, k] q[j, k])**s)**(1/s)`` is its dynamic
    equivalent load, s = 4 on the raceway that turns against the load and 9/2 on the other: equations 56, 57 and 61 to
    65 of ISO/TS 16281, second-hand; they agree with Lundberg and Palmgren's theory. A singular pressure has life 0.
    The model excludes contamination, lubrication and a reliability other than 0.9.

    Examples
    --------
    >>> from contactstudy import FiniteLengthSpace, Material, Roller, profiles
    >>> body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.5e-3, profile=profiles.Lundberg(0.2e-6))
    >>> case = Case(body=body, roller=roller, load=80.0)
    >>> life = reference_life(case, case, ratings=(800.0, 800.0), accuracy=0.05).reference_life
    >>> bool(life.sel(model="free ends") > life.sel(model="half-space"))
    True
    """
    cases = {
        name: [argument] if isinstance(argument, Case) else argument
        for name, argument in zip(RACEWAYS, (inner, outer), strict=True)
    }
    for name, argument in cases.items():
        if not (isinstance(argument, Sequence) and argument and all(isinstance(case, Case) for case in argument)):
            raise InvalidInputError(name, argument, "a Case, or a sequence of a Case per loaded roller")
    if len(cases["inner"]) != len(cases["outer"]):
        raise InvalidInputError("outer", len(cases["outer"]), f"as many rollers as inside, {len(cases['inner'])}")
    loaded_count = len(cases["inner"])
    roller_count = loaded_count if rollers is None else checks.count("rollers", rollers, minimum=loaded_count)
    if isinstance(inner, Case):
        roller_count = 1  # equal rollers: the mean does not depend on their number
    checks.known_name("turning", turning, RACEWAYS)
    checked_ratings = checks.coordinates("ratings", ratings, "N")
    if checked_ratings.size != len(RACEWAYS) or (checked_ratings <= 0).any():
        raise InvalidInputError("ratings", checked_ratings.tolist(), "two positive numbers, Q_ci and Q_ce (N)")
    # Arrays (model, raceway, roller, lamina).
    rollers_loads = [[_solve_roller_loads(case, laminae, accuracy) for case in cases[name]] for name in RACEWAYS]
    loads, errors, common_errors, risers, riser_errors = np.array(rollers_loads).transpose(2, 3, 0, 1, 4)
    lamina_count = loads.shape[-1]
    powers = np.array([TURNING_POWER if name == turning else LIFE_POWER for name in RACEWAYS])[:, None]
    rating = checked_ratings[:, None] * lamina_count ** (-7 / 9)

    def equivalent_loads(roller_loads: FloatArray) -> FloatArray:
        """Equivalent loads (model, raceway, lamina) of the rollers."""
        power = powers[:, None]
        return np.asarray(((roller_loads**power).sum(axis=2) / roller_count) ** (1 / powers))

    mean_loads, upper_loads = equivalent_loads(loads), equivalent_loads(loads + errors)
    risks = [((equivalent_loads(q) / rating) ** LIFE_POWER).sum(axis=-1) for q in (loads, loads + common_errors)]
    raceway_lives, lower_raceway_lives = (1e6 * risk ** (-8 / 9) for risk in risks)
    lives, lower_lives = (1e6 * risk.sum(axis=-1) ** (-8 / 9) for risk in risks)
    is_infinite = np.isinf(mean_loads)
    load_errors = np.where(is_infinite, np.inf, upper_loads - np.where(is_infinite, 0.0, mean_loads))
    # The models of slices neglect the ends; their error is not estimated.
    comment = {"comment": "from the stated errors of the pressures; NaN for the models of slices"}
    variables: dict[str, tuple[object, ...]] = {}
    for name, dims, values, error in (
        ("reference_life", ("model",), lives, lives - lower_lives),
        ("raceway_life", ("model", "raceway"), raceway_lives, raceway_lives - lower_raceway_lives),
        ("lamina_equivalent_load", ("model", "raceway", "slice"), mean_loads, load_errors),
        ("stress_riser", ("model", "raceway", "roller", "slice"), risers, riser_errors),
    ):
        variables |= {name: (dims, values), f"{name}_error": (dims, error, comment)}
    result = xr.Dataset(
        variables,
        coords={
            "model": list(MODELS),
            "raceway": list(RACEWAYS),
            "roller": np.arange(1, loaded_count + 1),
            "slice": np.arange(1, lamina_count + 1),
        },
        attrs={"turning": turning, "laminae": lamina_count},
    )
    return describe(result, "basic reference rating life from laminae")


def _solve_roller_loads(case: Case, laminae: int, accuracy: float) -> FloatArray:
    """Solve for loads of laminae, N, their errors and common errors, factors and errors: (quantity, model, lamina)."""
    # Uncoupled friction does not change the pressure.
    case = case if case.coupled else replace(case, friction=0.0, motion=Sliding())
    exact_result = solve(case, stresses=False, accuracy=accuracy)
    # The models have equal moments; their tilts differ by the compliance of the bodies.
    position = float(exact_result["load_position"]) if case.tilt else case.load_position
    body, roller = HalfSpace(material=case.body.material), replace(case.roller, ends="none")
    start = case.roller_start
    infinite = replace(case, body=body, roller=roller, end_distance=start, tilt=0.0, load_position=position)
    half_space = solve(infinite, stresses=False, accuracy=accuracy)
    tables, common_errors = zip(
        *(lamina_loads(result, model, laminae) for model, result in ((infinite, half_space), (case, exact_result))),
        strict=True,
    )
    width, slices = tables[1]["width"].values, tables[1]["load_per_length"].values
    riser, no_errors = tables[1]["edge_factor"].values, [np.full_like(slices, np.nan)] * 2
    return np.array(
        [
            width
            * np.array([slices, slices * riser, *(factors["hertz_load_per_length"].values for factors in tables)]),
            width * np.array([*no_errors, *(factors["hertz_load_per_length_error"].values for factors in tables)]),
            width * np.array([*no_errors, *common_errors]),
            [np.ones_like(slices), riser, *(factors["stress_riser"].values for factors in tables)],
            [*no_errors, *(factors["stress_riser_error"].values for factors in tables)],
        ]
    )
