"""Wear of a roller's profile over the distance that it slides or rolls, by implicit steps of second order."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import check_solved_for, with_provenance
from contactstudy.arrays.cells import cell_coordinates, labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, numbers_in_si, require
from contactstudy.cache import ArrayKey
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.magnitudes import warn_doubtful
from contactstudy.case.motion import Rolling, Shift, Sliding
from contactstudy.case.roller import onto_ends
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.conjugate_gradients import ContactIterate
from contactstudy.contact.normal.contact import Settings, Shape, check_window, contact_operator
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad, RigidMotion
from contactstudy.contact.normal.problem import ContactOperator, ContactProblem, solve_coupled, solve_normal
from contactstudy.contact.refinement.refined_contact import refine_contact
from contactstudy.contact.rolling.frictional_contact import frictional_contact
from contactstudy.contact.rolling.tractions import FrictionRequest
from contactstudy.errors import ConvergenceWarning, InvalidInputError
from contactstudy.kernels.load import Load
from contactstudy.profiles.base import checked_drop
from contactstudy.threads import one_blas_thread
from contactstudy.wear.profile import SAME_ROLLER


@dataclass(frozen=True, eq=False)
class WearingOperator:
    """Displacement under a pressure, and the wear of the profile by it within a step."""

    elastic: ContactOperator
    compliance: FloatArray  # (x, 1), worn depth per load per length, m2/N
    step: float  # cell size along y, m

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cell centres under `loads` (Pa): only the pressure wears."""
        displaced = self.elastic(loads)
        if Load.NORMAL not in loads:
            return displaced
        return np.asarray(displaced + self.compliance * (self.step * loads[Load.NORMAL].sum(axis=1, keepdims=True)))

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self.elastic.precondition(gap)

    @property
    def coarse(self) -> ContactOperator:
        """The bodies' operator on cells of twice the size: a first guess without wear."""
        return self.elastic.coarse


class Pressed(NamedTuple):
    """A pressure (x, y), its load per length (x), and whether the iteration converged."""

    pressure: FloatArray
    line_load: FloatArray
    converged: bool


@dataclass(frozen=True, eq=False)
class WornContact:
    """The contact of a case on given cells, its profile worn by some depth."""

    case: Case
    shape: Shape  # unworn
    settings: Settings

    def pressed(self, depth: FloatArray, compliance: FloatArray, start: FloatArray | None) -> Pressed:
        """Press the roller on while it wears: `compliance` (x) is further depth per load per length, m2/N."""
        shape, grid = self.shape, self.shape.grid
        with one_blas_thread():
            operator = WearingOperator(contact_operator(shape), compliance[:, None], grid.dy)  # eq. (604)

            def solve(motion: RigidMotion, guess: FloatArray | None, tolerance: float) -> ContactIterate:
                problem = ContactProblem(
                    grid=grid,
                    gap=shape.gap.values + depth[:, None] - motion.height(grid.x),
                    resultants=shape.prescribed.resultants(grid),
                    friction=shape.coupled_friction,
                    tolerance=tolerance,
                    max_iterations=self.settings.max_iterations,
                )
                if shape.coupled_friction:
                    return solve_coupled(operator, problem)
                return solve_normal(operator, problem, start if guess is None else guess)

            solution = shape.solve_relative_to_reference(solve, self.settings.tolerance).iterate
        check_window(shape.body, solution.pressure)
        return Pressed(solution.pressure, grid.dy * solution.pressure.sum(axis=1), solution.converged)

    def slip(self, depth: FloatArray, law: str) -> FloatArray:
        """Factor (x) from load per length to wear: slip per distance, or frictional work, weighted by the pressure."""
        case, grid = self.case, self.shape.grid
        friction = np.broadcast_to(case.friction_on(grid.x), (grid.cells_x, 1))[:, 0]
        if not isinstance(case.motion, Rolling):
            return np.ones(grid.cells_x) if law == "slip" else np.abs(friction)
        middle = case.roller_middle
        shape = self.shape._replace(gap=ArrayKey(self.shape.gap.values + depth[:, None]))
        request = FrictionRequest(motion=case.motion, friction=friction[:, None], reference_x=middle, coupled=False)
        rolling = frictional_contact(shape, self.settings, request)
        rolling.warn_unless_converged()
        slip, traction = rolling.tractions.slip, rolling.tractions.traction
        pressure = rolling.contact.pressure
        if law == "slip":
            worn = pressure * np.hypot(slip[0], slip[1])
        else:
            worn = np.maximum(traction[0] * slip[0] + traction[1] * slip[1], 0.0)
        load = pressure.sum(axis=1)
        return np.asarray(np.divide(worn.sum(axis=1), load, out=np.zeros_like(load), where=load > 0))


# Length of either implicit stage over the length of the step: the scheme damps the stiffest wear fully (R. Alexander,
# SIAM Journal on Numerical Analysis 14 (1977) 1006, theorem 5)
STAGE = 1 - np.sqrt(0.5)
SAFETY, LARGEST_GROWTH, LARGEST_CUT = 0.85, 4.0, 0.2  # Factor on the next step, and its bounds


class State(NamedTuple):
    """Where the wear stands."""

    distance: float  # m
    depth: FloatArray  # (x), m
    pressure: FloatArray  # (x, y), Pa
    slip: FloatArray  # (x), load per length to wear
    error: float = 0.0  # of the depth, summed over the steps, m
    worn: float = 0.0  # law's volume over the circumference, trapezoids, m2
    converged: bool = True


@dataclass(frozen=True, eq=False)
class Stepper:
    """Takes steps."""

    contact: WornContact
    rate: float  # m2/N per metre, per slip
    law: str  # slip or work
    tolerance: float  # error of the depth per step over the largest depth

    def initial(self, distance: float, depth: FloatArray, error: float) -> State:
        """Return the state of a worn depth, which is known within an error."""
        pressed = self.contact.pressed(depth, np.zeros_like(depth), None)
        slip = self.contact.slip(depth, self.law)
        return State(distance, depth, pressed.pressure, slip, error, converged=pressed.converged)

    def states(self, state: State, until: float, step: float) -> Iterator[tuple[State, float]]:
        """Go on to a distance; after each step give its state and the length of the next."""
        least = 1e-6 * min(step, until - state.distance)  # Shorter steps are taken in spite of their error, stated
        while state.distance < until:
            remaining = until - state.distance
            length = min(step, remaining)
            if remaining < 1.5 * length:
                length = remaining
            begin = state._replace(converged=True)
            single = self._stepped(begin, length)
            halved = self._stepped(self._stepped(begin, 0.5 * length), 0.5 * length)
            # Two halves of a scheme of second order err by a quarter of a single step.
            error = float(np.abs(halved.depth - single.depth).max()) / 3
            allowed = self.tolerance * float(halved.depth.max())
            growth = SAFETY * (allowed / error) ** (1 / 3) if error > 0 else LARGEST_GROWTH
            factor = min(max(growth, LARGEST_CUT), LARGEST_GROWTH)
            solved = halved.converged and single.converged
            if (error > allowed or not solved) and length > least:
                step = (factor if solved else LARGEST_CUT) * length
                continue
            reached = until if length == remaining else state.distance + length
            worn = state.worn + 0.5 * length * (self._area_per_distance(state) + self._area_per_distance(halved))
            converged = state.converged and halved.converged
            state = halved._replace(distance=reached, error=state.error + error, worn=worn, converged=converged)
            step = max(step, factor * length)
            yield state, step

    def _area_per_distance(self, state: State) -> float:
        """Area worn off a section along the axis by the law, per distance."""
        grid = self.contact.shape.grid
        return self.rate * grid.dy * float((grid.widths * state.slip) @ state.pressure.sum(axis=1))  # eq. (603)

    def _stepped(self, state: State, length: float) -> State:
        """One step, or a predictor and a corrector if the slip depends on the depth."""
        stepped = self._staged(state, length, state.slip, state.slip)
        slip = self.contact.slip(stepped.depth, self.law)
        if np.array_equal(slip, state.slip):
            return stepped
        between = state.slip + STAGE * (slip - state.slip)
        return self._staged(state, length, between, slip)

    def _staged(self, state: State, length: float, first: FloatArray, last: FloatArray) -> State:
        """Two implicit stages; the second is the result."""
        early, late = self.rate * length * first, self.rate * length * last
        half = self.contact.pressed(state.depth, STAGE * early, state.pressure)
        partial = state.depth + (1 - STAGE) * early * half.line_load
        full = self.contact.pressed(partial, STAGE * late, half.pressure)
        depth = partial + STAGE * late * full.line_load
        converged = state.converged and half.converged and full.converged
        return State(state.distance + length, depth, full.pressure, last, converged=converged)


LAWS = ("slip", "work")  # Laws: wear proportional to pressure times slip, or to frictional work
DEEPEST = 0.01  # Bound on the mean worn depth over the roller's radius: the radius counts as unchanged
TOLERANCES = (1e-5, 0.1)  # Tolerances that the contact is solved well enough for, and that mean something


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
    """Wear the profile of a roller by Archard's law, in steps that its own estimate of the error allows.

    The roller turns, so its wear is uniform along the circumference and depends on x alone; the body does not wear.

    Parameters
    ----------
    case : Case
        The case, with its unworn profile; in full sliding or in rolling.
    coefficient : float
        Worn volume k per load and distance slid (``law="slip"``), or per frictional work (``law="work"``), 1/Pa.
    distance : float or sequence of float
        How far the contact slides, or in rolling rolls, metres; the states after every step are returned, or those at
        the increasing distances of a sequence only.
    law : str
        "slip": the volume is ``k p |slip|`` per area and distance, in full sliding ``k p``; "work": ``k`` times the
        frictional work.
    circumference : float, optional
        Length along y of the surface over which the wear is spread, metres; default: the roller's, ``2 pi R``.
    grid : Grid, optional
        Cells. Default: in full sliding the columns that settle the unworn contact, else the cells of `choose_grid`.
    after : Dataset, optional
        Result of this function from whose last state to go on, of the same roller and body.
    tolerance : float
        Error of the worn depth that one step may make, over the largest depth: from 1e-5 to 0.1.
    max_steps : int
        Bound on the steps.

    Returns
    -------
    Dataset
        Along `distance`, beginning with the state before the first step: `wear_depth` and `profile_drop` of the worn
        profile (distance, x), metres, `line_load` (distance, x), N/m, `pressure` (distance, x, y), `worn_volume`, m3,
        `wear_error`, the estimated error of the depth by the steps over the largest depth (the error of the cells is
        not contained), and `next_step`, metres. In all, `volume_error`: the volume over the volume of the law, minus
        one. See `worn_profile` for the profile itself.

    Raises
    ------
    InvalidInputError
        If an argument is out of range, the motion is a shift, nothing rubs, `after` is of another roller or body, or
        so much would be worn off that the radius changes.
    WindowError
        If the contact grows beyond the cells.

    Warns
    -----
    ConvergenceWarning
        If `max_steps` did not suffice, or a contact did not converge. The result ends with the last step.

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
    began = time.perf_counter()
    checks.instance("case", case, Case, "a Case")
    warn_doubtful(case)
    checks.known_name("law", law, LAWS)
    if isinstance(case.motion, Shift):
        raise InvalidInputError("case.motion", case.motion, "Sliding() or Rolling(...): a shift has no distance")
    if case.coupled and not isinstance(case.motion, Sliding):
        raise InvalidInputError("case.coupled", True, "False in rolling: its tractions are solved after the pressure")
    rate = checks.positive("coefficient", coefficient, "1/Pa")
    around = 2 * np.pi * case.roller.radius if circumference is None else circumference
    around = checks.positive("circumference", around, "metres")
    tolerance = checks.positive("tolerance", tolerance)
    if not TOLERANCES[0] <= tolerance <= TOLERANCES[1]:
        raise InvalidInputError("tolerance", tolerance, f"from {TOLERANCES[0]:g} to {TOLERANCES[1]:g}")
    max_steps = checks.count("max_steps", max_steps)
    distance_before, depth, cells, step, error = (
        (0.0, None, _cells(case, grid), None, 0.0) if after is None else _state_of(after, case, grid)
    )
    all_steps = np.ndim(distance) == 0
    stops = checks.coordinates("distance", numbers_in_si("distance", distance, "m"))
    if (np.diff(stops) <= 0).any():
        raise InvalidInputError("distance", stops.tolist(), "increasing (metres)")
    if stops[0] < distance_before or stops[-1] <= distance_before:
        raise InvalidInputError("distance", stops.tolist(), f"beyond {distance_before:g} m, where the wear begins")
    gap = case.gap(cells)
    prescribed = PrescribedLoad(case.normal_load, case.load_position).check(gap, cells)
    shape = Shape(case.body, cells, ArrayKey(gap), prescribed, case.counterbody, coupled_friction=case.coupled_friction)
    # Bound on the iterations of one contact: in large steps the contact area changes often
    contact = WornContact(case, shape, Settings(max_iterations=2000))
    stepper = Stepper(contact, rate / around, law, tolerance)
    first = stepper.initial(distance_before, np.zeros(cells.cells_x) if depth is None else depth, error)
    if not first.slip.any():
        raise InvalidInputError("case", f"friction = {case.friction}", "one in which something rubs")
    until = float(stops[-1])
    mean = stepper.rate * float(first.slip.max()) * case.normal_load / case.contact_length * until
    if mean > DEEPEST * case.roller.radius:
        raise InvalidInputError(
            "distance",
            until,
            f"such that the mean worn depth, {mean:.3g} m, is at most {DEEPEST:g} of the roller's radius, "
            f"{case.roller.radius:g} m",
            "coefficient is in 1/Pa, distances in metres",
        )
    if step is None:
        # Largest worn depth of the first step over the depth ``a**2 / (2 R)`` of the contact
        sinking = case.hertz_half_width**2 / (2 * case.roller.radius)
        fastest = float((stepper.rate * first.slip * (cells.dy * first.pressure.sum(axis=1))).max())
        step = 1e-3 * sinking / fastest if fastest > 0 else np.inf
    states, steps = [first], [step]
    for state, ahead in _limited(stepper, first, stops, steps[0], max_steps):
        if all_steps or state.distance in stops:
            states.append(state)
            steps.append(ahead)
    settings = {"coefficient": rate, "law": law, "circumference": float(around), "tolerance": tolerance}
    worn = _labelled(case, stepper, states, steps, around)
    return with_provenance(worn, case, settings, {"wear": time.perf_counter() - began})


def _cells(case: Case, grid: Grid | None) -> Grid:
    """Cells to wear on."""
    if grid is not None:
        checks.instance("grid", grid, Grid, "a Grid")
        return grid
    if not isinstance(case.motion, Sliding):
        return choose_grid(case)
    refined = refine_contact(case, 0.01, 1e-6).contact.shape.grid
    low, high = refined.y_range
    # Width of the window over that which the unworn contact needs: load moves along the axis as the ends wear
    count = 2 * int(np.ceil(0.5 * 1.4 * refined.cells_y))
    wider = count / refined.cells_y
    return Grid.between(refined.x_edges, (wider * low, wider * high), count)


def _state_of(after: xr.Dataset, case: Case, grid: Grid | None) -> tuple[float, FloatArray, Grid, float, float]:
    """Distance, depth, cells, next step and error of the depth of the last state of a result."""
    require(after, "wear_depth", "wear_error", "pressure", "next_step", argument="after")
    check_solved_for(after, case, "after", only=SAME_ROLLER)
    if grid is not None:
        raise InvalidInputError("grid", grid, "None with after, which has cells")
    last = after.isel(distance=-1) if "distance" in after.dims else after
    cells = labelled_cells("after.pressure", last["pressure"], extent=case.body.extent)[1]
    depth = last["wear_depth"].values.astype(np.float64)
    error = float(last["wear_error"]) * float(depth.max())
    return float(last["distance"]), depth, cells, float(last["next_step"]), error


def _limited(
    stepper: Stepper, state: State, stops: FloatArray, step: float, max_steps: int
) -> Iterator[tuple[State, float]]:
    """Go to one distance after the other, in a number of steps at most."""
    steps = 0
    for stop in stops[stops > state.distance]:
        for reached, ahead in stepper.states(state, float(stop), step):
            steps += 1
            state, step = reached, ahead
            yield state, step
            if steps >= max_steps and state.distance < stops[-1]:
                warnings.warn(
                    f"the wear stopped after max_steps = {max_steps} at {state.distance:g} m of {stops[-1]:g} m; go on "
                    "with after=, or raise max_steps or tolerance",
                    ConvergenceWarning,
                    stacklevel=2,
                )
                return
        if not state.converged:
            warnings.warn(
                "a contact of a wear step did not converge; take a smaller tolerance or other cells",
                ConvergenceWarning,
                stacklevel=2,
            )


def _labelled(case: Case, stepper: Stepper, states: list[State], steps: list[float], around: float) -> xr.Dataset:
    """Label the states."""
    grid = stepper.contact.shape.grid
    distances = np.array([state.distance for state in states])
    depths = np.array([state.depth for state in states])
    pressures = np.array([state.pressure for state in states])
    from_middle, half = grid.x - case.roller_middle, 0.5 * case.roller.length
    if grid.uniform:
        from_middle = onto_ends(from_middle, half, grid.dx)
    under = np.abs(from_middle) <= half
    drop = np.full(grid.cells_x, np.nan)
    drop[under] = checked_drop(case.roller.profile, from_middle[under], case.roller.length)
    volumes = around * depths @ grid.widths
    due = around * np.array([state.worn for state in states])
    gained, due = volumes - volumes[0], due - due[0]
    positive = due > 0
    scale = np.maximum(depths.max(axis=1), np.finfo(np.float64).tiny)
    coords = {"distance": distances, "x": grid.x, "y": grid.y} | cell_coordinates(grid)
    result = xr.Dataset(
        {
            "wear_depth": (("distance", "x"), depths),
            "profile_drop": (("distance", "x"), drop + depths),
            "line_load": (("distance", "x"), grid.dy * pressures.sum(axis=2)),
            "pressure": (("distance", "x", "y"), pressures),
            "worn_volume": ("distance", volumes),
            "wear_error": ("distance", np.array([state.error for state in states]) / scale),
            "next_step": ("distance", np.array(steps)),
            "volume_error": float(np.abs(gained[positive] / due[positive] - 1).max(initial=0.0)),
            "converged": states[-1].converged,
            "hertz_half_width": case.hertz_half_width,
            "hertz_max_pressure": case.hertz_max_pressure,
        },
        coords=coords,
    )
    motion = "slid" if isinstance(case.motion, Sliding) else "rolled"
    result["distance"].attrs = {"units": "m", "long_name": f"distance {motion}"}
    return describe(result, "wear of a roller's profile")
