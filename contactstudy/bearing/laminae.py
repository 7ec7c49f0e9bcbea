"""Laminae of a roller after ISO/TS 16281: slice model, edge factors from solved pressures, reference rating life."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import cell_edges, dimension_along, single_case
from contactstudy.analysis.provenance import solved_case
from contactstudy.analysis.roller_slices import SIDES, Columns, power_means, pressure_errors
from contactstudy.arrays.peaks import section_maxima
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, describe, require, require_in_si
from contactstudy.bodies import hertz
from contactstudy.bodies.models import HalfSpace
from contactstudy.case.case import Case, small_tilt
from contactstudy.case.magnitudes import warn_of_values
from contactstudy.case.motion import Sliding
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import check_drop, local_radius
from contactstudy.solution import solve

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
        `half_width` (m), `deflection` (m), `edge_factor`; the scalars `normal_load` (N), `approach` (m). No errors.

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
    # At `max_depth` beyond the smallest height a single slice carries the whole load.
    min_height, max_depth = float(height.min()), 0.5 * (load / stiffness) ** (1 / POWER)
    max_approach = min_height + 1.001 * max_depth

    def load_excess(approach: float) -> float:
        return float(stiffness * np.sum((2 * np.maximum(approach - height, 0.0)) ** POWER) / load - 1)

    approach = float(brentq(load_excess, min_height, max_approach, xtol=1e-15 * max_depth, rtol=1e-14, maxiter=200))
    deflection = np.maximum(approach - height, 0.0)
    load_per_length = stiffness * (2 * deflection) ** POWER * slices / length
    middle_distance = np.abs(2 * np.arange(1, slices + 1) - slices - 1) / (2 * slices - 2)
    with np.errstate(divide="ignore"):
        edge_factor = 1 - 0.01 / np.log(1.985 * middle_distance)  # 1 in the middle
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
        "approach": ((), approach, attributes | {"long_name": "approach of the undeformed bodies at mid-length"}),
    }
    result = xr.Dataset(variables, coords={"x": x}, attrs={"slices": slices, "tilt": tilt})
    return describe(result, "slice model of ISO/TS 16281")


# Power of the load in a lamina's risk of fatigue: life exponent 4 of a line contact times Weibull's slope 9/8
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
    model_load = slice_result["load_per_length"].values
    with np.errstate(divide="ignore", invalid="ignore"):
        riser = np.where(model_load > 0, load / model_load, np.nan)
        riser_error = np.where(model_load > 0, error / model_load, np.nan)
    model_attributes = {"comment": MODEL_COMMENT}
    error_attributes = {"comment": "from the stated errors of the pressure and the distance of its columns"}
    if np.isnan(error).any():
        error_attributes = {ERROR_KIND: NOT_ESTIMATED}
    values: dict[str, tuple[object, ...]] = {
        "position": ("slice", 0.5 * (edges[1:] + edges[:-1])),
        "width": ("slice", np.full(count, (stop - start) / count)),
        "load_per_length": ("slice", model_load, model_attributes),
        "hertz_load_per_length": ("slice", load),
        "hertz_load_per_length_error": ("slice", error, error_attributes),
        "stress_riser": ("slice", riser),
        "stress_riser_error": ("slice", riser_error, error_attributes),
        "edge_factor": ("slice", slice_result["edge_factor"].values, model_attributes),
    }
    factors = xr.Dataset(values, coords={"slice": np.arange(1, count + 1)})
    return describe(factors, "stress riser of every lamina from solved pressures"), common_error


def _hertz_loads(result: xr.Dataset, case: Case, edges: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Hertz load per length of each lamina's solved pressure, its error, and the error without discretisation error."""
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
    half_count, overlaps = load.size // 2, columns.overlaps(edges)
    halves = (slice(load.size - half_count), slice(half_count, None))
    is_singular = [bool(np.isinf(float(result.get(f"peak_pressure_{side}", 0.0)))) for side in SIDES]
    errors = np.zeros((2, load.size))
    for row, half, singular, relative_error in zip(errors, halves, is_singular, pressure_errors(result), strict=True):
        max_load = load[half] if singular else line_loads[overlaps[half].any(axis=0)].max()
        # The load is proportional to the square of the pressure.
        row[half] = 2 * relative_error * np.sqrt(load[half] * max_load)
    common_error = errors.max(axis=0)
    error = common_error + discretisation_error
    singular_ends = np.flatnonzero(is_singular) * (load.size - 1)
    for values in (load, error, common_error):
        values[singular_ends] = np.inf
    return load, error, common_error


MODELS = ("slices", "slices with riser", "half-space", "free ends")  # Models of the pressure of a lamina
RACEWAYS = ("inner", "outer")

TURNING_POWER = 4.0  # Power of the mean for the turning raceway; for the other raceway LIFE_POWER
# Factor lambda nu of ISO 281's dynamic ratings for radial roller bearings (from secondary sources): allowance for edge
# stress, which the lamina model contains
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
        Loaded rollers on either raceway, with load and tilt; a single Case represents all rollers. The roller has its
        radius relative to the raceway: ``D (1 - gamma) / 2`` inside, ``D (1 + gamma) / 2`` outside.
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
    roller_tables = [[_solve_roller_loads(case, laminae, accuracy) for case in cases[name]] for name in RACEWAYS]
    loads, errors, common_errors, risers, riser_errors = np.array(roller_tables).transpose(2, 3, 0, 1, 4)
    lamina_count = loads.shape[-1]
    powers = np.array([TURNING_POWER if name == turning else LIFE_POWER for name in RACEWAYS])[:, None]
    lamina_ratings = checked_ratings[:, None] * lamina_count ** (-7 / 9)

    def equivalent_loads(roller_loads: FloatArray) -> FloatArray:
        """Equivalent loads (model, raceway, lamina) of the rollers."""
        power = powers[:, None]
        return np.asarray(((roller_loads**power).sum(axis=2) / roller_count) ** (1 / powers))

    mean_loads, upper_loads = equivalent_loads(loads), equivalent_loads(loads + errors)
    load_bounds = (loads, loads + common_errors)
    risks = [((equivalent_loads(bound) / lamina_ratings) ** LIFE_POWER).sum(axis=-1) for bound in load_bounds]
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
    load_position = float(exact_result["load_position"]) if case.tilt else case.load_position
    body, roller = HalfSpace(material=case.body.material), replace(case.roller, ends="none")
    start = case.roller_start
    half_space_case = replace(case, body=body, roller=roller, end_distance=start, tilt=0.0, load_position=load_position)
    half_space_result = solve(half_space_case, stresses=False, accuracy=accuracy)
    solved_models = ((half_space_case, half_space_result), (case, exact_result))
    solved_loads = (lamina_loads(result, model, laminae) for model, result in solved_models)
    tables, common_errors = zip(*solved_loads, strict=True)
    width, model_loads = tables[1]["width"].values, tables[1]["load_per_length"].values
    riser, unknown_errors = tables[1]["edge_factor"].values, [np.full_like(model_loads, np.nan)] * 2
    hertz_loads = [factors["hertz_load_per_length"].values for factors in tables]
    return np.array(
        [
            width * np.array([model_loads, model_loads * riser, *hertz_loads]),
            width * np.array([*unknown_errors, *(factors["hertz_load_per_length_error"].values for factors in tables)]),
            width * np.array([*unknown_errors, *common_errors]),
            [np.ones_like(model_loads), riser, *(factors["stress_riser"].values for factors in tables)],
            [*unknown_errors, *(factors["stress_riser_error"].values for factors in tables)],
        ]
    )
