"""Contact of a case on columns that are refined until peak and end pressures are accurate, with stick and slip.

The tractions are solved on the columns of the normal contact: on half of its cells along y, on all, and on twice as
many until forces and creepages change by less than the accuracy. The last change estimates their error, at most of
first order in the cell size; the errors of the columns and of the leading edge of unlike bodies are added.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass, replace

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, without_error
from contactstudy.bodies import hertz
from contactstudy.bodies.material import dundurs_parameter
from contactstudy.bodies.models import Body, BodyWithFreeEnds
from contactstudy.cache import ArrayKey, cached
from contactstudy.case.case import MAX_HALF_WIDTH, MIN_HALF_WIDTH, Case
from contactstudy.case.gridding import WINDOWS, graded_grid, solve_in_first_window
from contactstudy.case.motion import RESULTANTS, Rolling, Shift, Sliding
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Contact, Settings, Shape, check_window, contact_of, contact_operator
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.contact.normal.problem import ContactProblem, solve_normal
from contactstudy.contact.refinement.laws import EndLaw, corner_law, elastic_exponent
from contactstudy.contact.refinement.refinement import (
    VALUE_TOLERANCE,
    AxialShape,
    ColumnPressure,
    RefinedColumns,
    refine_coarsely,
    refine_columns,
    replace_pressure,
)
from contactstudy.contact.rolling.frictional_contact import AMPLITUDE_NAMES, FrictionalContact, frictional_contact
from contactstudy.contact.rolling.tractions import FrictionRequest
from contactstudy.kernels.load import Load
from contactstudy.profiles.base import as_shape
from contactstudy.threads import one_blas_thread

WINDOW_FACTOR, WINDOW_FACTOR_COUPLED, WINDOW_FACTOR_ROLLING = 1.1, 1.4, 1.5
"""Least window over the extent of the contact along y: in full sliding, with coupled friction, with stick and slip.
Tractions with stick and slip are also solved on half of the cells and depend on two cells ahead. Speed."""

WINDOW_STEP = 2 ** (1 / 6)  # ratio of consecutive windows, so that similar cases share end kernels. Speed.
SMALL_SLOPE = 0.1  # slope of a corner up to which strains are small. Physics.
CELLS_Y, COARSE_CELLS_Y = (32, 64, 128, 256), 16  # along y: allowed numbers, number of the coarse contact. Accuracy.

MAX_CORNER_JUMP = 0.2
"""Jump of the slope of measured points times E*, over the peak, above which the peak is unbounded. Accuracy: the
pressure at the corner grows by 3 % with each halving of its width."""

DATA_ERROR = 1.5  # error over the difference of two interpolations of measured points. Accuracy.

PEAK_ERROR_FACTOR, ACCURACY_FRACTION_Y = 0.7, 0.25
"""Relative increase of the peak between cells along y, times the squared number of cells across the contact; and the
share of the accuracy for this increase. Accuracy."""


@dataclass(frozen=True, eq=False)
class RefinedContact:
    """A contact on refined columns, and their values and errors."""

    contact: Contact
    refined: RefinedColumns


def refine_contact(case: Case, accuracy: float, tolerance: float) -> RefinedContact:
    """Contact of a case, on columns that are refined to an accuracy of peak and end pressures."""
    if not isinstance(case.motion, Sliding):
        # The columns do not depend on creepages or shifts.
        case = replace(case, friction=0.0, motion=Rolling())
    refine = _cached_contact if _is_immutable(case) else _refine_contact
    return refine(case if case.coupled else replace(case, friction=0.0), accuracy, tolerance)


def _is_immutable(value: object) -> bool:
    """Whether a case, or a field of a case, cannot change: users' profiles may be mutable."""
    if is_dataclass(value):
        frozen = bool(getattr(type(value), "__dataclass_params__").frozen)  # noqa: B009 - unknown to mypy
        return frozen and all(_is_immutable(getattr(value, field.name)) for field in fields(value))
    if isinstance(value, tuple):
        return all(_is_immutable(item) for item in value)
    return value is None or isinstance(value, (str, int, float, np.number, np.bool_))


def _refine_contact(case: Case, accuracy: float, tolerance: float) -> RefinedContact:
    """Refine in the narrowest window that contains the contact."""
    return solve_in_first_window(
        WINDOWS, lambda window: _refine_in_window(case, window * case.hertz_half_width, accuracy, tolerance)
    )


_cached_contact = cached("refined contacts")(_refine_contact)


def _refine_in_window(case: Case, half_window: float, accuracy: float, tolerance: float) -> RefinedContact:
    """Contact in a window that a coarse contact determines."""
    shape = _axial_shape(case)
    with one_blas_thread():
        # The half-width depends only weakly on the end correction, which is the expensive part.
        coarse_solver = _ColumnSolver(replace(case, body=_mirror_body_ends(case.body)), half_window, COARSE_CELLS_Y)
        coarse = refine_coarsely(coarse_solver, shape)
        rows = np.flatnonzero(coarse.pressure.any(axis=0))
        coarse_grid = coarse_solver.shape(coarse.edges).grid
        extent = float(np.abs(coarse_grid.y[rows]).max()) + 0.5 * coarse_grid.dy
        # Coupled friction moves the contact along y.
        factor = WINDOW_FACTOR_COUPLED if case.coupled else WINDOW_FACTOR
        if not isinstance(case.motion, Sliding):
            factor = WINDOW_FACTOR_ROLLING
        min_window = factor * extent / case.hertz_half_width
        window = float(case.hertz_half_width * WINDOW_STEP ** np.ceil(np.log(min_window) / np.log(WINDOW_STEP)))
        peak_cells = coarse.pressure[int(coarse.pressure.max(axis=1).argmax())] > 0
        cells_y = _choose_cells_y(float(peak_cells.sum()) * coarse_grid.dy / (2 * window), accuracy)
        solver = _ColumnSolver(case, window, cells_y)
        # The splittings of the outermost columns determine the law of an end: begin with few columns.
        refined = refine_columns(solver, shape, accuracy, None if coarse.singular else coarse.edges)
        refined = _add_data_error(solver, refined, shape)
    fine_shape = solver.shape(refined.edges)
    guess = ArrayKey(_pad_to_grid(refined.pressure, fine_shape.grid, refined.edges))
    contact = contact_of(fine_shape, Settings(tolerance), guess)
    refined_contact = RefinedContact(contact, refined)
    if fine_shape.coupled_friction or contact.motions.total.tilt:
        return replace_contact(refined_contact, contact, case)
    return refined_contact


def _convex_corners(case: Case) -> list[tuple[float, float]]:
    """Convex corners of a profile given by a formula: position and jump of the slope."""
    if as_shape(case.roller.profile).second_interpolation() is not None:
        return []
    return [(x, jump) for x, jump in zip(*(values.tolist() for values in case.slope_jumps), strict=True) if jump > 0]


def _add_data_error(solver: _ColumnSolver, refined: RefinedColumns, shape: AxialShape) -> RefinedColumns:
    """Add the error due to measured points: the change under a second interpolation, infinite at unresolved corners."""
    case = solver.case
    other_profile = as_shape(case.roller.profile).second_interpolation()
    if other_profile is None:
        return refined
    solver = replace(solver, case=replace(case, roller=replace(case.roller, profile=other_profile)))
    new = replace_pressure(refined, solver(refined.edges, refined.pressure, VALUE_TOLERANCE).pressure, shape).values
    errors = {
        name: [
            error + DATA_ERROR * (abs(value - new_value) if np.isfinite(value) else 0.0)
            for error, value, new_value in zip(errors, refined.values[name], new[name], strict=True)
        ]
        for name, errors in refined.errors.items()
    }
    for x, jump in zip(*case.slope_jumps, strict=True):
        column = int(np.clip(np.searchsorted(refined.edges, x) - 1, 0, refined.edges.size - 2))
        end = int(x > 0.5 * (shape.start + shape.stop))
        peak = refined.values["peak_pressure"][end]
        if jump * case.modulus > MAX_CORNER_JUMP * peak and refined.pressure[column].any():
            errors["peak_pressure"][end] = np.inf
    return replace(refined, errors=errors)


def _choose_cells_y(fraction: float, accuracy: float) -> int:
    """Least number of cells along y that resolve a peak, where the contact covers a `fraction` of the window."""
    min_cells = np.sqrt(PEAK_ERROR_FACTOR / (ACCURACY_FRACTION_Y * accuracy)) / fraction
    return next((cells for cells in CELLS_Y if cells >= min_cells), CELLS_Y[-1])


def refined_values(case: Case, refined_contact: RefinedContact) -> xr.Dataset:
    """Label the values and their errors; a singular end has the values of its law instead of a pressure."""
    refined = refined_contact.refined
    laws = [corner_law(corner, case.modulus, refined.edges, refined.pressure) for corner in _convex_corners(case)]
    corner = max(filter(None, laws), key=lambda law: law.intensity, default=None)  # None at corners without contact
    values = {"peak_pressure": refined.peak, "peak_pressure_error": refined.peak_error}
    dy = refined_contact.contact.shape.grid.dy
    for end, suffix in enumerate(("first", "last")):
        for name, end_values in refined.values.items():
            factor = dy if name == "end_load" else 1.0
            values[f"{name}_{suffix}"] = factor * end_values[end]
            values[f"{name}_{suffix}_error"] = factor * refined.errors[name][end]
        values |= _law_values(refined.laws[end], f"_{suffix}")
    sharper_law = max((law for law in refined.laws if law), key=lambda law: np.nan_to_num(law.intensity), default=None)
    values |= _law_values(sharper_law)
    if corner is not None:
        values |= {f"corner_{name}": value for name, value in vars(corner).items()}
    result = xr.Dataset(values)
    if corner is not None and corner.slope > SMALL_SLOPE:
        result["corner_intensity"].attrs["comment"] = f"a slope above {SMALL_SLOPE} is beyond small strains"
    if any(law and law.fitted for law in refined.laws):
        result = without_error(result, *(str(name) for name in result if str(name).startswith("end_exponent")))
    for key, intensity in result.items():
        if str(key).startswith("end_intensity"):
            exponent = float(result[str(key).replace("intensity", "exponent").removesuffix("_error")])
            intensity.attrs["units"] = f"Pa m{exponent:.3g}"
    if not refined.accurate:
        result["peak_pressure_error"].attrs["comment"] = "above the accuracy: the largest number of columns was reached"
    return describe(result)


def _law_values(law: EndLaw | None, end: str = "") -> dict[str, float]:
    """Exponent and intensity of a law by name in results; `end` is the suffix of the names, "" for the sharper end."""
    if law is None:
        return {}
    intensity = f"end_intensity{end}"
    return {f"end_exponent{end}": law.exponent, intensity: law.intensity, f"{intensity}_error": law.intensity_error}


def contact_shape(
    case: Case, grid: Grid, prescribed: PrescribedLoad | None = None, gap: FloatArray | None = None
) -> Shape:
    """Contact problem of a case on cells; `prescribed` and `gap` default to the values of the case."""
    gap = case.gap(grid) if gap is None else gap
    if prescribed is None and case.approach is not None:
        prescribed = PrescribedLoad(approach=case.approach)
    prescribed = (prescribed or PrescribedLoad(case.normal_load, case.load_position)).check(gap, grid)
    return Shape(case.body, grid, ArrayKey(gap), prescribed, case.counterbody, coupled_friction=case.coupled_friction)


def replace_contact(refined_contact: RefinedContact, contact: Contact, case: Case) -> RefinedContact:
    """Refined contact with another pressure on the same columns, from friction or finer cells along y."""
    refined = refined_contact.refined
    pressure = contact.pressure[_roller_columns(contact.shape.grid, refined.edges)]
    return RefinedContact(contact, replace_pressure(refined, pressure, _axial_shape(case)))


@dataclass(frozen=True)
class _ColumnSolver:
    """Solver of a case on columns: the `solve` of `refine_columns`."""

    case: Case
    half_window: float
    cells_y: int

    def shape(self, edges: FloatArray) -> Shape:
        """Contact problem on cells with columns under the roller between `edges`."""
        window = (-self.half_window, self.half_window)
        return contact_shape(self.case, graded_grid(self.case, edges, window, self.cells_y))

    def __call__(self, edges: FloatArray, first_guess: FloatArray | None, tolerance: float) -> ColumnPressure:
        """Solve without coupled friction, which changes the pressure by a few percent but not the columns."""
        shape = self.shape(edges)._replace(coupled_friction=0.0)
        grid, gap = shape.grid, shape.gap.values
        columns = _roller_columns(grid, edges)
        guess = _pad_to_grid(first_guess, grid, edges) if first_guess is not None and first_guess.any() else None
        resultants = shape.prescribed.resultants(grid)
        problem = ContactProblem(grid=grid, gap=gap, resultants=resultants, tolerance=tolerance)
        operator = contact_operator(shape)
        iterate = solve_normal(operator, problem, guess)
        check_window(shape.body, iterate.pressure)

        def compute_opening() -> FloatArray:
            opening = gap + operator({Load.NORMAL: iterate.pressure}) - problem.rigid_height(iterate.motion)
            return np.asarray(opening[columns].min(axis=1))

        return ColumnPressure(iterate.pressure[columns], compute_opening)


def _roller_columns(grid: Grid, edges: FloatArray) -> slice:
    """Columns of a grid under the roller, between `edges`."""
    first_column = int(np.abs(grid.x_edges - edges[0]).argmin())
    return slice(first_column, first_column + edges.size - 1)


def _pad_to_grid(pressure: FloatArray, grid: Grid, edges: FloatArray) -> FloatArray:
    """Pressure (column, y) between `edges` on all cells of a grid."""
    padded = np.zeros(grid.shape)
    padded[_roller_columns(grid, edges)] = pressure
    return padded


def _end_exponent(case: Case, distance: float, rounding: float) -> float:
    """Exponent of the pressure at a roller's end, at a distance inside the body's end; NaN without a theory."""
    body, roller = case.body, case.roller.body
    body_compliance = 1 / body.material.plane_strain_modulus
    roller_compliance = 0.0 if roller is None else 1 / roller.material.plane_strain_modulus
    roller_has_ends = isinstance(roller, BodyWithFreeEnds)
    if distance > rounding:
        return elastic_exponent(roller_compliance if roller_has_ends else 0.0, body_compliance)
    # The body's edge is loaded if the roller overhangs, or is a half-space.
    is_loaded = roller_compliance > 0 and (distance < -rounding or not roller_has_ends)
    has_law = is_loaded and getattr(body, "model", "") == "exact"
    return elastic_exponent(body_compliance, roller_compliance) if has_law else np.nan


def _axial_shape(case: Case) -> AxialShape:
    """Axial shape of a case."""
    start, stop = case.contact_range
    body, half_width = case.body, case.hertz_half_width
    low, high = body.extent
    rounding = 1e-9 * (stop - start)
    distances = case.roller_start - low, high - (case.roller_start + case.roller.length)
    face_lengths = [distance if distance > rounding else 0.0 for distance in distances]
    # Different factors on the images in body and roller make the pressure fade at a common end.
    has_fading_end = (
        isinstance(body, BodyWithFreeEnds) and body.model == "mirror-factor" and case.roller.body is not None
    )
    return AxialShape(
        start=start,
        stop=stop,
        half_width=half_width,
        depth=half_width**2 / (2 * case.roller.radius),
        height=case.gap_on_axis,
        face_beyond=(face_lengths[0], face_lengths[1]),
        exponents=(_end_exponent(case, distances[0], rounding), _end_exponent(case, distances[1], rounding)),
        corners=tuple(x for x, _ in _convex_corners(case)),
        nodes=case.nodes,
        has_fading_end=has_fading_end,
    )


LOAD_POWER, LOAD_POWER_RANGE = 1.2, (1.0, 2.0)
"""Exponent of the load as a power of the depth from first touch: initial guess, and bounds. The exponent is
10/9 of a line contact, 3/2 of a point contact. Speed."""

MAX_EXCESS_DEPTH, MAX_MISSING_DEPTH, MAX_CORRECTIONS = 0.05, 0.005, 12
"""Fractions of the prescribed depth by which a contact may be too deep or too shallow to reuse its columns and window,
and the largest number of corrections of the load. Speed."""

LOAD_EXCESS = 1.02  # factor on a corrected load, because a shallower contact's window is too narrow. Speed.
COARSE_ACCURACY, COARSE_TOLERANCE = 0.1, 1e-4  # accuracy and tolerance of contacts that determine a load. Speed.
WINDOW_FACTOR_COARSE = 1.5  # factor on the window for half as many cells along y. Speed.
SLICES, SLICE_WIDTH = 200, 0.3  # slices for the initial load: number, half-width over the overlap's. Speed.


def contact_at_approach(case: Case, accuracy: float, tolerance: float) -> RefinedContact:
    """Contact of a case that prescribes its approach, on columns that are refined to an accuracy."""
    assert case.approach is not None
    coarse = search_load(_mirror_case_ends(case), case.approach, _slice_load(case), COARSE_ACCURACY, COARSE_TOLERANCE)
    return search_load(case, case.approach, coarse.contact.carried_load, accuracy, tolerance)


def search_load(case: Case, approach: float, load: float, accuracy: float, tolerance: float) -> RefinedContact:
    """Contact of a case at an approach, from an initial guess of its load."""
    power, previous_load, previous_depth = LOAD_POWER, 0.0, 0.0
    for _ in range(MAX_CORRECTIONS):
        loaded_case = replace(case, load=load, max_pressure=None, approach=None)
        refined = refine_contact(loaded_case, accuracy, tolerance)
        shape = refined.contact.shape
        first_touch = float(shape.gap.values.min())
        depth, prescribed_depth = refined.contact.approach - first_touch, approach - first_touch
        if 1 - MAX_MISSING_DEPTH <= depth / prescribed_depth <= 1 + MAX_EXCESS_DEPTH:
            break
        if 0 < previous_depth != depth:
            power = float(np.clip(np.log(load / previous_load) / np.log(depth / previous_depth), *LOAD_POWER_RANGE))
        previous_load, previous_depth = load, depth
        load *= LOAD_EXCESS * (prescribed_depth / depth) ** power
    prescribed = PrescribedLoad(approach=approach).check(shape.gap.values, shape.grid)
    contact = contact_of(shape._replace(prescribed=prescribed), Settings(tolerance))
    return replace_contact(refined, contact, replace(loaded_case, load=contact.carried_load))


def approach_load_error(case: Case, refined_contact: RefinedContact) -> float:
    """Error of the load at a prescribed approach, N: changes on coarser columns and fewer cells, with mirrored ends."""
    refined, grid = refined_contact.refined, refined_contact.contact.shape.grid
    case = _mirror_case_ends(case)
    window = WINDOW_FACTOR_COARSE * grid.y_range[0], WINDOW_FACTOR_COARSE * grid.y_range[1]
    rows = int(WINDOW_FACTOR_COARSE * grid.cells_y)

    def solve(edges: FloatArray, cells_y: int, prescribed: PrescribedLoad | None) -> Contact:
        shape = contact_shape(case, graded_grid(case, edges, window, cells_y), prescribed)
        return contact_of(shape._replace(coupled_friction=0.0), Settings(COARSE_TOLERANCE))

    fine = solve(refined.edges, rows, None)
    fine_approach = PrescribedLoad(approach=fine.approach)
    coarser_contacts = solve(refined.first_edges, rows, fine_approach), solve(refined.edges, rows // 2, fine_approach)
    return sum(abs(contact.carried_load - fine.carried_load) for contact in coarser_contacts)


def _mirror_body_ends(body: Body) -> Body:
    """Body with the mirror model of its ends instead of the exact model."""
    return replace(body, model="mirror") if isinstance(body, BodyWithFreeEnds) and body.model == "exact" else body


def _mirror_case_ends(case: Case) -> Case:
    """Case with the mirror model of its ends."""
    return replace(case, body=_mirror_body_ends(case.body), roller=replace(case.roller, ends="none"))


def _slice_load(case: Case) -> float:
    """Load of independent slices whose widths are a fraction of the undeformed overlap, N."""
    assert case.approach is not None
    start, stop = case.contact_range
    x = np.linspace(start, stop, SLICES + 1)
    depth = np.maximum(case.approach - case.gap_on_axis(x), 0.0)
    radius, modulus = case.roller.radius, case.modulus
    half_width = np.minimum(SLICE_WIDTH * np.sqrt(2 * radius * depth), MAX_HALF_WIDTH * radius)
    per_length = np.pi * modulus * half_width**2 / (4 * radius)  # Johnson, Contact Mechanics (1985), 4.43
    load = float(per_length.mean()) * (stop - start)
    min_load = hertz.line_load(MIN_HALF_WIDTH * modulus, radius, modulus) * (stop - start)
    return max(load, min_load)


COLUMN_ERROR_FACTOR = 0.5
"""Error of the columns, over the least error of the pressure; relative to full sliding's force and moment, and to work
and creepages themselves. Accuracy: without this error one in ten of the stated errors was too small."""

EDGE_ERROR_FACTOR = 1.0
"""Error of the leading edge in rolling, times the cells across, over Dundurs' beta and a value's scale. Accuracy."""

MAX_COARSE_STEPS = 60
"""Bound on the Newton steps on half of the cells along y, whose tractions are a guess. Speed: in a few shifts the
active sets cycle on these cells, and converge on finer cells."""


def refine_tractions(
    case: Case, normal_contact: RefinedContact, accuracy: float
) -> tuple[FrictionalContact, RefinedContact, xr.Dataset]:
    """Tractions of a case on the columns of its normal contact, the contact that they change, and their errors."""
    motion, cells_y = case.motion, normal_contact.contact.shape.grid.cells_y
    assert isinstance(motion, Shift | Rolling)
    prescribed_names = {
        RESULTANTS[mode] if mode in motion.modes else name for mode, name in AMPLITUDE_NAMES[type(motion)].items()
    }
    previous_contact = _solve_on_cells(case, normal_contact, cells_y // 2, None)
    # FASTSIM's error is due to its model: its strips do not become accurate on finer cells.
    max_rows = cells_y if isinstance(motion, Rolling) and motion.model == "fastsim" else CELLS_Y[-1]
    while True:
        contact = _solve_on_cells(case, normal_contact, cells_y, previous_contact)
        scales = {name: scale for name, scale in _scales(case, contact).items() if name not in prescribed_names}
        values, previous_values = _monitored_values(contact), _monitored_values(previous_contact)
        changes = {name: abs(values[name] - previous_values[name]) for name in scales}
        is_accurate = all(changes[name] <= accuracy * scale for name, scale in scales.items())
        if is_accurate or cells_y >= max_rows:
            break
        cells_y, previous_contact = 2 * cells_y, contact
    column_error, edge_error = COLUMN_ERROR_FACTOR * normal_contact.refined.least_error, 0.0
    if isinstance(motion, Rolling):
        cells_across = float((contact.contact.pressure > 0).sum(axis=1).max())
        edge_error = EDGE_ERROR_FACTOR * abs(dundurs_parameter(case.body.material, case.roller.material)) / cells_across
    errors = xr.Dataset()
    for name, scale in scales.items():
        # A force or a moment may be a small difference of large terms; work and rigid motions are not.
        size = scale if name in RESULTANTS.values() else min(scale, abs(values[name]))
        errors[f"{name}_error"] = changes[name] + column_error * size + edge_error * scale
        if not is_accurate:
            errors[f"{name}_error"].attrs["comment"] = (
                "above the accuracy: the largest number of cells along y was reached"
            )
    errors["friction_work_error"].attrs["units"] = "J/m" if isinstance(motion, Rolling) else "J"
    return contact, replace_contact(normal_contact, contact.contact, case), describe(errors)


def _solve_on_cells(
    case: Case, normal_contact: RefinedContact, cells_y: int, coarse_contact: FrictionalContact | None
) -> FrictionalContact:
    """Contact on refined columns with `cells_y` cells along y; the guess `coarse_contact` has half as many."""
    assert isinstance(case.motion, Shift | Rolling)
    contact = normal_contact.contact
    grid = contact.shape.grid
    if cells_y != grid.cells_y:
        grid = Grid.between(grid.x_edges, grid.y_range, cells_y)
    request = FrictionRequest(
        motion=case.motion,
        friction=case.friction_on(grid.x),
        reference_x=case.roller_middle,
        coupled=case.coupled,
        coarse=None if coarse_contact is None else coarse_contact.tractions,
        max_steps=MAX_COARSE_STEPS if coarse_contact is None else None,
    )
    return frictional_contact(contact_shape(case, grid, contact.shape.prescribed), contact.settings, request)


def _monitored_values(contact: FrictionalContact) -> dict[str, float]:
    """Values whose changes end the refinement, by name in results."""
    tractions = contact.tractions
    return {**tractions.resultants, "friction_work": tractions.work, **contact.rigid_motions}


def _scales(case: Case, contact: FrictionalContact) -> dict[str, float]:
    """Scale of the accuracy of each value, by name in results."""
    # Forces and moment have the scale of full sliding. Creepages have ``f a / R`` (Johnson, Contact Mechanics (1985),
    # 8.45) and shifts ``f a**2 / R``, or their own size if larger.
    pressure, grid = contact.contact.pressure, contact.contact.shape.grid
    loads = case.friction_on(grid.x) * pressure * grid.weights * grid.cell_area
    arms = np.hypot((grid.x - case.roller_middle)[:, None], grid.y)
    slip = float(np.max(case.friction_on(grid.x))) * case.hertz_half_width / case.roller.radius
    force, moment = float(loads.sum()), float((loads * arms).sum())
    sliding = {"x": slip, "y": slip, "spin": slip * force / moment if moment else 0.0}
    if not isinstance(case.motion, Rolling):
        sliding = {name: size * case.hertz_half_width for name, size in sliding.items()}
    slips = {name: max(abs(amplitude), sliding[name]) for name, amplitude in contact.tractions.amplitudes.items()}
    max_slip = max(abs(slips["x"]), abs(slips["y"]), slips.get("spin", 0.0) * moment / force if force else 0.0)
    scales = {"force_x": force, "force_y": force, "moment_z": moment, "friction_work": force * max_slip}
    return scales | dict(zip(contact.rigid_motions, slips.values(), strict=True))
