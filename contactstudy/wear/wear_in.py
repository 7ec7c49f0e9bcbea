"""Wear of a roller's profile over the distance that it slides or rolls, by implicit steps of second order."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import check_solved_for, with_provenance
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import cell_coordinates, describe, in_si, labelled_cells, require
from contactstudy.cache import ArrayKey
from contactstudy.case.case import Case
from contactstudy.case.gridding import create_widening_grids, solve_in_first_window
from contactstudy.case.magnitudes import warn_of_magnitudes
from contactstudy.case.motion import Rolling, Shift, Sliding
from contactstudy.case.roller import snap_to_ends
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Settings, Shape, check_window, contact_operator, iterate_contact
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.contact.normal.problem import ContactIterate, ContactOperator
from contactstudy.contact.refinement.refined_contact import contact_shape, refine_contact
from contactstudy.contact.rolling.frictional_contact import frictional_contact
from contactstudy.contact.rolling.tractions import FrictionRequest
from contactstudy.errors import ConvergenceWarning, InvalidInputError
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread
from contactstudy.wear.profile import WORN_ATTRIBUTES


@dataclass(frozen=True, eq=False)
class WearingOperator:
    """Operator that adds the wear within a step to the displacement under a pressure."""

    elastic: ContactOperator
    compliance: FloatArray  # (x, 1), worn depth per load per length, m2/N
    step: float  # cell size along y, m

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement and wear (m) at the cell centres under `loads` (Pa); only the pressure wears."""
        displacement = self.elastic(loads)
        if Load.NORMAL not in loads:
            return displacement
        return np.asarray(displacement + self.compliance * (self.step * loads[Load.NORMAL].sum(axis=1, keepdims=True)))

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Return approximately the pressure that displaces the cells by `gap`."""
        return self.elastic.precondition(gap)

    @property
    def coarse(self) -> ContactOperator:
        """Operator without wear on cells of twice the size, for a first guess."""
        return self.elastic.coarse


# Length of either implicit stage over the length of the step, which damps the stiffest wear fully (R. Alexander,
# SIAM Journal on Numerical Analysis 14 (1977) 1006, theorem 5)
STAGE_FRACTION = 1 - np.sqrt(0.5)
STEP_SAFETY, MAX_GROWTH, MIN_GROWTH = 0.85, 4.0, 0.2  # Factor on the next step, and its bounds


class Wear(NamedTuple):
    """State of the wear integration: depth, pressure, slip, worn area."""

    distance: float  # m
    depth: FloatArray  # (x), m
    pressure: FloatArray  # (x, y), Pa
    slip: FloatArray  # (x), factor from load per length to wear
    error: float = 0.0  # of the depth, summed over the steps, m
    worn_area: float = 0.0  # volume by the law over the circumference, integrated by trapezoids, m2
    next_step: float = np.inf  # length of the next step, m
    converged: bool = True


class StartState(NamedTuple):
    """Cells and worn profile before the first step."""

    grids: Iterable[Grid]  # the first that contains the contact is used
    distance: float = 0.0  # m
    depth: FloatArray | None = None  # (x), m; None: not worn
    error: float = 0.0  # of the depth, m
    step: float | None = None  # length of the first step, m; None: from the rate of wear


@dataclass(frozen=True, kw_only=True, eq=False)
class WearIntegrator:
    """Integrates the wear of a contact on given cells over the sliding distance."""

    case: Case
    shape: Shape  # unworn
    settings: Settings
    rate: float  # depth per load per length, distance and slip, m2/N per metre
    law: str  # slip or work
    tolerance: float  # error of the depth per step over the largest depth

    def solve_contact(self, depth: FloatArray, compliance: FloatArray, start: FloatArray | None) -> ContactIterate:
        """Solve the contact with wear: `compliance` (x) is the further depth per load per length, m2/N."""
        shape = self.shape._replace(gap=ArrayKey(self.shape.gap.values + depth[:, None]))
        with one_blas_thread():
            operator = WearingOperator(contact_operator(shape), compliance[:, None], shape.grid.dy)  # eq. (604)
            solution, _ = iterate_contact(shape, operator, self.settings, start)
        check_window(shape.body, solution.pressure)
        return solution

    def compute_slip(self, depth: FloatArray) -> FloatArray:
        """Wear (x) per load per length, over `rate`: slip per distance, or frictional work, pressure-weighted."""
        case, grid = self.case, self.shape.grid
        friction = np.broadcast_to(case.friction_on(grid.x), (grid.cells_x, 1))[:, 0]
        if not isinstance(case.motion, Rolling):
            return np.ones(grid.cells_x) if self.law == "slip" else np.abs(friction)
        mid_length = case.roller_middle
        shape = self.shape._replace(gap=ArrayKey(self.shape.gap.values + depth[:, None]))
        request = FrictionRequest(motion=case.motion, friction=friction[:, None], reference_x=mid_length, coupled=False)
        rolling = frictional_contact(shape, self.settings, request)
        rolling.warn_unless_converged()
        slip, traction = rolling.tractions.slip, rolling.tractions.traction
        pressure = rolling.contact.pressure
        if self.law == "slip":
            wear_rate = pressure * np.hypot(slip[0], slip[1])
        else:
            wear_rate = np.maximum(traction[0] * slip[0] + traction[1] * slip[1], 0.0)
        load = pressure.sum(axis=1)
        return np.asarray(np.divide(wear_rate.sum(axis=1), load, out=np.zeros_like(load), where=load > 0))

    def initial_state(self, distance: float, depth: FloatArray, error: float) -> Wear:
        """Return the state of a worn depth with an error."""
        contact = self.solve_contact(depth, np.zeros_like(depth), None)
        slip = self.compute_slip(depth)
        return Wear(distance, depth, contact.pressure, slip, error, converged=contact.converged)

    def integrate(self, state: Wear, stop: float) -> Iterator[Wear]:
        """Integrate to a distance; yield the state after each step."""
        step = state.next_step
        min_length = 1e-6 * min(step, stop - state.distance)  # A shorter step is accepted with any error
        while state.distance < stop:
            remaining = stop - state.distance
            length = min(step, remaining)
            if remaining < 1.5 * length:
                length = remaining
            start = state._replace(converged=True)
            full_step = self._take_step(start, length)
            half_steps = self._take_step(self._take_step(start, 0.5 * length), 0.5 * length)
            # Two half steps of a scheme of second order have a quarter of the error of one step.
            error = float(np.abs(half_steps.depth - full_step.depth).max()) / 3
            allowed_error = self.tolerance * float(half_steps.depth.max())
            growth = STEP_SAFETY * (allowed_error / error) ** (1 / 3) if error > 0 else MAX_GROWTH
            factor = min(max(growth, MIN_GROWTH), MAX_GROWTH)
            all_converged = half_steps.converged and full_step.converged
            if (error > allowed_error or not all_converged) and length > min_length:
                step = (factor if all_converged else MIN_GROWTH) * length
                continue
            distance = stop if length == remaining else state.distance + length
            area = state.worn_area + 0.5 * length * (self._worn_area_rate(state) + self._worn_area_rate(half_steps))
            step = max(step, factor * length)
            error, converged = state.error + error, state.converged and half_steps.converged
            state = half_steps._replace(
                distance=distance, error=error, worn_area=area, next_step=step, converged=converged
            )
            yield state

    def _worn_area_rate(self, state: Wear) -> float:
        """Area (x, depth) that the law removes from the profile, per distance."""
        grid = self.shape.grid
        return self.rate * grid.dy * float((grid.widths * state.slip) @ state.pressure.sum(axis=1))  # eq. (603)

    def _line_load(self, contact: ContactIterate) -> FloatArray:
        """Load per length (x), N/m."""
        return np.asarray(self.shape.grid.dy * contact.pressure.sum(axis=1))

    def _take_step(self, state: Wear, length: float) -> Wear:
        """Take one step, or a predictor and a corrector if the slip depends on the depth."""
        predicted = self._solve_stages(state, length, state.slip, state.slip)
        last_slip = self.compute_slip(predicted.depth)
        if np.array_equal(last_slip, state.slip):
            return predicted
        first_slip = state.slip + STAGE_FRACTION * (last_slip - state.slip)
        return self._solve_stages(state, length, first_slip, last_slip)

    def _solve_stages(self, state: Wear, length: float, first_slip: FloatArray, last_slip: FloatArray) -> Wear:
        """Solve two implicit stages and return the second."""
        first_increment, second_increment = self.rate * length * first_slip, self.rate * length * last_slip
        first_stage = self.solve_contact(state.depth, STAGE_FRACTION * first_increment, state.pressure)
        middle_depth = state.depth + (1 - STAGE_FRACTION) * first_increment * self._line_load(first_stage)
        second_stage = self.solve_contact(middle_depth, STAGE_FRACTION * second_increment, first_stage.pressure)
        depth = middle_depth + STAGE_FRACTION * second_increment * self._line_load(second_stage)
        converged = state.converged and first_stage.converged and second_stage.converged
        return Wear(state.distance + length, depth, second_stage.pressure, last_slip, converged=converged)


WEAR_LAWS = ("slip", "work")  # Laws: wear proportional to pressure times slip, or to frictional work
MAX_DEPTH = 0.01  # Bound on the mean worn depth over the roller's radius: the wear leaves the radius unchanged
TOLERANCE_RANGE = (1e-5, 0.1)  # Range of the tolerance; the contact is solved more accurately


def wear_in(
    case: Case,
    coefficient: float,
    *,
    distance: float | Sequence[float] | FloatArray,
    law: str = "slip",
    circumference: float | None = None,
    grid: Grid | None = None,
    after: xr.Dataset | None = None,
    tolerance: float = 0.01,
    max_steps: int = 200,
) -> xr.Dataset:
    """Wear the profile of a roller by Archard's law, in steps that an estimate of their error limits.

    The roller turns, so its wear is uniform along the circumference and depends on x alone; the body does not wear.

    Parameters
    ----------
    case : Case
        The case, with its unworn profile; in full sliding or in rolling.
    coefficient : float
        Worn volume k per load and distance slid (``law="slip"``), or per frictional work (``law="work"``), 1/Pa.
    distance : float or sequence of float
        Distance of sliding, or in rolling of rolling, metres. The result contains the states after every step, or
        only the states at the increasing distances of a sequence.
    law : str
        "slip": volume ``k p |slip|`` per area and distance, in full sliding ``k p``; "work": ``k`` times friction work.
    circumference : float, optional
        Length along y of the surface over which the wear is spread, metres; default: the roller's, ``2 pi R``.
    grid : Grid, optional
        Cells. Default: in full sliding the columns refined for the unworn contact, else the cells
        of `choose_grid` in the first window that contains the contact.
    after : Dataset, optional
        Result of this function for the same roller and body; its last state is the start.
    tolerance : float
        Allowed error of the worn depth by one step, over the largest depth: from 1e-5 to 0.1.
    max_steps : int
        Bound on the steps.

    Returns
    -------
    Dataset
        Along `distance`, beginning with the state before the first step: `wear_depth` and `profile_drop` of the worn
        profile (distance, x), metres, `line_load` (distance, x), N/m, `pressure` (distance, x, y), `worn_volume`, m3,
        `wear_error`, the estimated error of the depth by the steps over the largest depth (the error of the cells is
        not contained), and `next_step`, metres. `volume_error` is the worn volume over the volume of the law, minus
        one. See `worn_profile` for the profile.

    Raises
    ------
    InvalidInputError
        If an argument is out of range, the motion is a shift, the case has no friction or slip, `after` is of another
        roller or body, or the wear would change the radius.
    WindowError
        If the contact grows beyond the cells.

    Warns
    -----
    ConvergenceWarning
        If `max_steps` did not suffice, or a contact did not converge. The result ends at the last step.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, choose_grid
    >>> body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.4e-3), max_pressure=1.5e9)
    >>> cells = choose_grid(case, cells_x=3, cells_y=8)
    >>> worn = wear_in(case, 1e-17, distance=[0.0, 5e3, 1e5], grid=cells)
    >>> load = worn.line_load.where(worn.line_load > 0)
    >>> (load.max("x") / load.min("x")).values.round(2).tolist()
    [2.28, 1.37, 1.0]
    """
    start_time = time.perf_counter()
    checks.instance("case", case, Case, "a Case")
    warn_of_magnitudes(case)
    checks.known_name("law", law, WEAR_LAWS)
    if isinstance(case.motion, Shift):
        raise InvalidInputError("case.motion", case.motion, "Sliding() or Rolling(...): a shift has no distance")
    if case.coupled and not isinstance(case.motion, Sliding):
        raise InvalidInputError("case.coupled", True, "False in rolling: its tractions are solved after the pressure")
    rate = checks.positive("coefficient", coefficient, "1/Pa")
    length = 2 * np.pi * case.roller.radius if circumference is None else circumference
    length = checks.positive("circumference", length, "metres")
    tolerance = checks.positive("tolerance", tolerance)
    if not TOLERANCE_RANGE[0] <= tolerance <= TOLERANCE_RANGE[1]:
        raise InvalidInputError("tolerance", tolerance, f"from {TOLERANCE_RANGE[0]:g} to {TOLERANCE_RANGE[1]:g}")
    max_steps = checks.count("max_steps", max_steps)
    origin = StartState(_choose_grids(case, grid)) if after is None else _read_last_state(after, case, grid)
    all_steps = np.ndim(distance) == 0
    stops = checks.increasing("distance", in_si("distance", distance, "m"), "metres")
    if stops[0] < origin.distance or stops[-1] <= origin.distance:
        raise InvalidInputError("distance", stops.tolist(), f"beyond {origin.distance:g} m, where the wear begins")

    def create_integrator(cells: Grid) -> tuple[WearIntegrator, Wear]:
        integrator = WearIntegrator(
            case=case,
            shape=contact_shape(case, cells, PrescribedLoad(case.normal_load, case.load_position)),
            settings=Settings(max_iterations=2000),  # per contact: long steps change its area in many iterations
            rate=rate / length,
            law=law,
            tolerance=tolerance,
        )
        first_depth = np.zeros(cells.cells_x) if origin.depth is None else origin.depth
        return integrator, integrator.initial_state(origin.distance, first_depth, origin.error)

    integrator, start = solve_in_first_window(origin.grids, create_integrator)
    if not start.slip.any():
        raise InvalidInputError("case", f"friction = {case.friction}", "a case with friction and slip")
    last_stop = float(stops[-1])
    mean_depth = integrator.rate * float(start.slip.max()) * case.normal_load / case.contact_length * last_stop
    if mean_depth > MAX_DEPTH * case.roller.radius:
        limit = f"at most {MAX_DEPTH:g} of the roller's radius, {case.roller.radius:g} m"
        allowed = f"such that the mean worn depth, {mean_depth:.3g} m, is {limit}"
        raise InvalidInputError("distance", last_stop, allowed, "coefficient is in 1/Pa, distances in metres")
    step = origin.step
    if step is None:
        # The first step wears 1e-3 of the depth ``a**2 / (2 R)`` of the contact.
        contact_depth = case.hertz_half_width**2 / (2 * case.roller.radius)
        max_rate = float((integrator.rate * start.slip * (integrator.shape.grid.dy * start.pressure.sum(axis=1))).max())
        step = 1e-3 * contact_depth / max_rate if max_rate > 0 else np.inf
    states = [start._replace(next_step=step)]
    for state in _integrate_to_stops(integrator, states[0], stops, max_steps):
        if all_steps or state.distance in stops:
            states.append(state)
    inputs = {"coefficient": rate, "law": law, "circumference": float(length), "tolerance": tolerance}
    worn = _label_states(integrator, states, length)
    return with_provenance(worn, case, inputs, {"wear": time.perf_counter() - start_time})


def _choose_grids(case: Case, grid: Grid | None) -> Iterable[Grid]:
    """Choose the cells, in rolling with windows of increasing widths."""
    if grid is not None:
        checks.instance("grid", grid, Grid, "a Grid")
        return (grid,)
    if not isinstance(case.motion, Sliding):
        return create_widening_grids(case)
    refined_grid = refine_contact(case, 0.01, 1e-6).contact.shape.grid
    low, high = refined_grid.y_range
    # The load moves along the axis as the ends wear: the window is 1.4 times the window of the unworn contact.
    cells_y = 2 * int(np.ceil(0.5 * 1.4 * refined_grid.cells_y))
    width_factor = cells_y / refined_grid.cells_y
    return (Grid.between(refined_grid.x_edges, (width_factor * low, width_factor * high), cells_y),)


def _read_last_state(after: xr.Dataset, case: Case, grid: Grid | None) -> StartState:
    """Start from the last state of a result."""
    require(after, "wear_depth", "wear_error", "pressure", "next_step", argument="after")
    check_solved_for(after, case, "after", compared_names=WORN_ATTRIBUTES)
    if grid is not None:
        raise InvalidInputError("grid", grid, "None with after, which has cells")
    last_state = after.isel(distance=-1) if "distance" in after.dims else after
    cells = labelled_cells("after.pressure", last_state["pressure"], extent=case.body.extent)[1]
    depth = last_state["wear_depth"].values.astype(np.float64)
    error = float(last_state["wear_error"]) * float(depth.max())
    return StartState((cells,), float(last_state["distance"]), depth, error, step=float(last_state["next_step"]))


def _integrate_to_stops(integrator: WearIntegrator, state: Wear, stops: FloatArray, max_steps: int) -> Iterator[Wear]:
    """Integrate to one distance after the other, in at most `max_steps` steps."""
    step_count = 0
    for stop in stops[stops > state.distance]:
        for next_state in integrator.integrate(state, float(stop)):
            step_count += 1
            state = next_state
            yield state
            if step_count >= max_steps and state.distance < stops[-1]:
                message = f"the wear stopped after max_steps = {max_steps} at {state.distance:g} m of {stops[-1]:g} m"
                hint = "go on with after=, or raise max_steps or tolerance"
                warnings.warn(f"{message}; {hint}", ConvergenceWarning, stacklevel=2)
                return
        if not state.converged:
            message = "a contact of a wear step did not converge; take a smaller tolerance or other cells"
            warnings.warn(message, ConvergenceWarning, stacklevel=2)


def _label_states(integrator: WearIntegrator, states: list[Wear], length: float) -> xr.Dataset:
    """Return the states as a Dataset."""
    case, grid = integrator.case, integrator.shape.grid
    columns = {name: np.array(values) for name, values in zip(Wear._fields, zip(*states, strict=True), strict=True)}
    depths, pressures = columns["depth"], columns["pressure"]
    x, half_length = grid.x - case.roller_middle, 0.5 * case.roller.length
    if grid.uniform:
        x = snap_to_ends(x, half_length, grid.dx)
    drop = np.where(np.abs(x) <= half_length, case.roller.clearance(x, np.zeros(1))[:, 0], np.nan)
    volumes = length * depths @ grid.widths
    law_volumes = length * columns["worn_area"]
    volume_gain, law_volumes = volumes - volumes[0], law_volumes - law_volumes[0]
    has_wear = law_volumes > 0
    scale = np.maximum(depths.max(axis=1), np.finfo(np.float64).tiny)
    coords = {"distance": columns["distance"], "x": grid.x, "y": grid.y} | cell_coordinates(grid)
    result = xr.Dataset(
        {
            "wear_depth": (("distance", "x"), depths),
            "profile_drop": (("distance", "x"), drop + depths),
            "line_load": (("distance", "x"), grid.dy * pressures.sum(axis=2)),
            "pressure": (("distance", "x", "y"), pressures),
            "worn_volume": ("distance", volumes),
            "wear_error": ("distance", columns["error"] / scale),
            "next_step": ("distance", columns["next_step"]),
            "volume_error": float(np.abs(volume_gain[has_wear] / law_volumes[has_wear] - 1).max(initial=0.0)),
            "converged": states[-1].converged,
            "hertz_half_width": case.hertz_half_width,
            "hertz_max_pressure": case.hertz_max_pressure,
        },
        coords=coords,
    )
    motion = "slid" if isinstance(case.motion, Sliding) else "rolled"
    result["distance"].attrs = {"units": "m", "long_name": f"distance {motion}"}
    return describe(result, "wear of a roller's profile")
