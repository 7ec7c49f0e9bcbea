"""Implicit steps of wear of second order, and the contact of a profile that wears within a step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contactstudy.cache import ArrayKey
from contactstudy.case.case import Case
from contactstudy.case.motion import Rolling
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.conjugate_gradients import ContactIterate
from contactstudy.contact.normal.contact import Settings, Shape, check_window, contact_operator
from contactstudy.contact.normal.prescribed import RigidMotion
from contactstudy.contact.normal.problem import ContactOperator, ContactProblem, solve_coupled, solve_normal
from contactstudy.contact.rolling.frictional_contact import FrictionRequest, frictional_contact
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread


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

            def solve(motion: RigidMotion, guess: FloatArray | None) -> ContactIterate:
                problem = ContactProblem(
                    grid,
                    shape.gap.values + depth[:, None] - motion.height(grid.x),
                    shape.prescribed.resultants(grid),
                    shape.coupled_friction,
                    *self.settings,
                )
                if shape.coupled_friction:
                    return solve_coupled(operator, problem)
                return solve_normal(operator, problem, start if guess is None else guess)

            solution = shape.referred(solve, self.settings.tolerance).iterate
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
        request = FrictionRequest(motion=case.motion, friction=friction[:, None], middle=middle, coupled=False)
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

    def first_step(self, state: State) -> float:
        """Return a step that wears off little wherever the pressure is."""
        case, grid = self.contact.case, self.contact.shape.grid
        load = grid.dy * state.pressure.sum(axis=1)
        sinking = case.hertz_half_width**2 / (2 * case.roller.radius)
        fastest = float((self.rate * state.slip * load).max())
        # Largest worn depth of the first step over the depth ``a**2 / (2 R)`` of the contact
        return 1e-3 * sinking / fastest if fastest > 0 else np.inf

    def states(self, state: State, until: float, step: float) -> Iterator[tuple[State, float]]:
        """Go on to a distance; after each step give its state and the length of the next."""
        # Length over the first one below which a step is taken in spite of its error, which is stated
        least = 1e-6 * min(step, until - state.distance)
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
