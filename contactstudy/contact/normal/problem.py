"""Unilateral contact under prescribed resultants or a prescribed approach, with or without coupled friction.

The conjugate gradients follow I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206, with a preconditioner (J. Zhao,
E. A. H. Vollebregt, C. W. Oosterlee, Math. Comput. Sci. 9 (2015) 375), an update of the gap along the search direction
while the contact area does not change, and a safeguard against cells that enter at once and overshoot. The initial
guess is a solution on coarser cells.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from contactstudy.arrays.grid import Grid, interpolate_columns
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.kernels.load import Load

Operator = Callable[[FloatArray], FloatArray]

ENTRY_OVERLAP = 0.1  # least overlap of a cell that enters the contact, over the tolerated violation. Speed.
MIN_ENTRY_PRESSURE = 1e-12  # least pressure of a cell that enters the contact, over the largest pressure. Speed.
MIN_LINEAR_FACTOR = 0.1  # least value of the linear factor in `restore`, over its constant: positive. Speed.
ADDED_PRESSURE = 0.1  # over the largest pressure: added to all cells if one side of the load has none. Speed.
MAX_EXPONENT = 1e4  # largest slope of the exponential factor in `restore`. Speed.


@dataclass(frozen=True, eq=False)
class Resultants:
    """Prescribed resultants of the pressure, each conjugate to a rigid motion of the shape."""

    total: float | None  # sum over the cells, Pa, conjugate to the approach; None if the gap contains the approach
    lever: FloatArray | None = None
    """(x, 1): arm of each cell about the point where the load is to act, over the largest arm: the sum of arm times
    pressure is zero, and the shape tilts about that point."""

    @property
    def motions(self) -> list[FloatArray]:
        """Rigid motions that are free: arrays that broadcast to (x, y)."""
        if self.total is None:
            return []
        return [np.ones((1, 1))] if self.lever is None else [np.ones((1, 1)), self.lever]

    def restore(self, pressure: FloatArray) -> FloatArray:
        """Scale the pressure to the prescribed resultants, by a factor that is linear or exponential in the arm."""
        if self.total is None:
            return pressure
        if self.lever is None:
            return np.asarray(pressure * (self.total / pressure.sum()))
        axial_sums = pressure.sum(axis=1)
        arm = self.lever[:, 0]
        sums = [float((axial_sums * arm**power).sum()) for power in (0, 1, 2)]
        # One column of cells lacks a second moment: the factor restores the sum only.
        if sums[0] * sums[2] - sums[1] ** 2 <= 1e-9 * sums[0] * sums[2]:
            return np.asarray(pressure * (self.total / sums[0]))
        constant, slope = np.linalg.solve([sums[:2], sums[1:]], [self.total, 0.0])
        factor = constant + slope * self.lever
        if factor.min() < MIN_LINEAR_FACTOR * constant:
            factor = self._exponential_factor(axial_sums, arm)
        return np.asarray(pressure * factor)

    def _exponential_factor(self, axial_sums: FloatArray, arm: FloatArray) -> FloatArray:
        """Positive factor ``C exp(s arm)`` for both resultants; without pressure on both sides, for the sum alone."""
        assert self.total is not None
        is_loaded = axial_sums > 0
        axial_sums, lever = axial_sums[is_loaded], arm[is_loaded]
        slope = 0.0
        if lever.min() < 0 < lever.max():

            def moment(slope: float) -> float:
                scaled_sums = axial_sums * np.exp(slope * lever - (slope * lever).max())
                return float((scaled_sums * lever).sum() / scaled_sums.sum())

            bound = 1.0
            while bound < MAX_EXPONENT and moment(-bound) * moment(bound) > 0:
                bound *= 2
            if moment(-bound) * moment(bound) <= 0:
                from scipy.optimize import brentq

                slope = float(brentq(moment, -bound, bound, xtol=1e-15, rtol=1e-14))
        factor = np.exp(slope * arm - (slope * lever).max())
        return np.asarray((factor * (self.total / float((axial_sums * factor[is_loaded]).sum())))[:, None])

    def position_error(self, pressure: FloatArray) -> float:
        """Distance of the pressure's resultant from its prescribed position, over the largest arm."""
        return 0.0 if self.lever is None else abs(float((pressure * self.lever).sum() / pressure.sum()))


@dataclass(frozen=True, kw_only=True)
class ContactIterate:
    """Result of the iteration."""

    pressure: FloatArray  # (x, y): pressure, Pa, with the prescribed resultants
    motion: tuple[float, ...]  # the free rigid motions: approach, metres, and tilt about the point of application
    applications: int  # number of applications of the operator
    converged: bool  # whether the tolerance was reached


def solve_complementarity(
    operator: Operator,
    preconditioner: Operator,
    gap: FloatArray,
    resultants: Resultants,
    start: FloatArray,
    *,
    tolerance: float,
    max_iterations: int,
) -> ContactIterate:
    """Solve for a pressure ``p >= 0`` with ``g = gap + operator(p) - motion >= 0``, ``p g = 0`` and the resultants."""
    iteration = _IterationState(operator, preconditioner, gap, resultants, start)
    converged = False
    for _ in range(max_iterations):
        opening = iteration.compute_opening()
        residual = np.where(iteration.contact, opening, 0.0)
        violation = np.where(iteration.contact, np.abs(residual), np.maximum(-opening, 0.0)).max()
        scale = np.ptp(iteration.displacement)
        step, response, curvature = iteration.search_step(residual)
        trial = iteration.pressure - step * iteration.direction
        change = abs(step) * float(np.abs(iteration.direction).sum() / iteration.pressure.sum())
        is_entering = ~iteration.contact & (opening < -ENTRY_OVERLAP * tolerance * scale)
        if (trial < 0).any() or is_entering.any():
            iteration.change_area(trial, is_entering, opening, step, response)
        else:
            iteration.pressure, iteration.area_changed = trial, False
            iteration.displacement = iteration.displacement - step * response
            converges = violation <= tolerance * scale and change <= tolerance
            if converges and resultants.position_error(iteration.pressure) <= tolerance:
                converged = True
                break
        if curvature <= 0:
            break
    pressure = resultants.restore(iteration.pressure)
    motion = tuple(float(component) for component in iteration.motion)
    return ContactIterate(pressure=pressure, motion=motion, applications=iteration.applications, converged=converged)


class _IterationState:
    """State of the iteration in `solve_complementarity`."""

    def __init__(
        self, operator: Operator, preconditioner: Operator, gap: FloatArray, resultants: Resultants, start: FloatArray
    ) -> None:
        self._operator, self._preconditioner = operator, preconditioner
        self._gap, self._can_touch = gap, np.isfinite(gap)
        self._resultants, self._motions = resultants, resultants.motions
        self.applications = 0
        self.pressure = resultants.restore(self._balance_sides(start))
        self.displacement = self._apply(self.pressure)
        if resultants.total is None:
            self._scale_guess()
        self.contact = self.pressure > 0
        self.area_changed = True
        self.motion: FloatArray = np.zeros(len(self._motions))
        self.direction: FloatArray = np.zeros_like(self.pressure)
        self._residual: FloatArray = np.zeros_like(self.pressure)
        self._energy_slope = 0.0
        self._weights: list[FloatArray] = []
        self._gram: FloatArray = np.zeros((len(self._motions), len(self._motions)))

    def _apply(self, pressure: FloatArray) -> FloatArray:
        self.applications += 1
        return self._operator(pressure)

    def _scale_guess(self) -> None:
        """Scale the guess so that the work of the prescribed approach equals the work of the displacement."""
        gap = self._gap
        work = -float((self.pressure * np.where(self._can_touch, gap, 0.0)).sum())
        if work <= 0:  # the guess lies outside the shape's overlap
            self.pressure = np.where(gap < 0, 1.0, 0.0)
            self.displacement, work = self._apply(self.pressure), -float(gap[gap < 0].sum())
        factor = work / float((self.pressure * self.displacement).sum())
        self.pressure, self.displacement = factor * self.pressure, factor * self.displacement

    def _balance_sides(self, pressure: FloatArray) -> FloatArray:
        """Add a little pressure to every cell if all pressure lies on one side of the load's position."""
        lever = self._resultants.lever
        if lever is None:
            return pressure
        arms = lever[pressure.any(axis=1)]
        if arms.min() < 0 < arms.max():
            return pressure
        return pressure + np.where(self._can_touch, ADDED_PRESSURE * pressure.max(), 0.0)

    def compute_opening(self) -> FloatArray:
        """Compute the gap after the rigid motion for which the descent keeps the prescribed resultants."""
        motions = self._motions
        if self.area_changed:
            self._weights = [
                np.where(self.contact, self._preconditioner(np.where(self.contact, mode, 0.0)), 0.0) for mode in motions
            ]
            self._gram = np.array([[float((weight * mode).sum()) for mode in motions] for weight in self._weights])
        height = np.where(self._can_touch, self._gap + self.displacement, np.inf)
        contact_height = np.where(self.contact, height, 0.0)
        if motions:
            weighted_heights = [float((weight * contact_height).sum()) for weight in self._weights]
            if len(motions) == 1:
                self.motion = np.asarray(np.array(weighted_heights) / self._gram[0])
            else:  # least squares, for a contact of one column of cells cannot tilt
                self.motion = np.asarray(np.linalg.lstsq(self._gram, weighted_heights, rcond=None)[0])
        terms = (component * mode for component, mode in zip(self.motion, motions, strict=True))
        return np.asarray(height - sum(terms, np.zeros((1, 1))))

    def search_step(self, residual: FloatArray) -> tuple[float, FloatArray, float]:
        """Update the search direction; return the step, the displacement under the direction and the curvature."""
        descent = np.where(self.contact, self._preconditioner(residual), 0.0)
        if self.area_changed or self._energy_slope == 0.0:
            direction = descent
        else:
            # Polak and Ribiere's form tolerates a preconditioner that is slightly unsymmetric on the contact.
            beta = float(((residual - self._residual) * descent).sum()) / self._energy_slope
            direction = descent + beta * self.direction
        self._energy_slope, self._residual = float((residual * descent).sum()), residual
        self.direction = np.where(self.contact, direction, 0.0)
        displacement = self._apply(self.direction)
        curvature = float((self.direction * displacement).sum())
        step = float((residual * self.direction).sum()) / curvature if curvature > 0 else 0.0
        return step, displacement, curvature

    def change_area(
        self, trial: FloatArray, is_entering: BoolArray, opening: FloatArray, step: float, response: FloatArray
    ) -> None:
        """Remove cells with negative pressure from the contact, and add cells that overlap."""
        trial[trial < 0] = 0.0
        if is_entering.any():
            # As in Polonsky and Keer, the pressure of an entering cell is a step along its overlap.
            scaled_opening = self._preconditioner(np.where(is_entering, opening, 0.0))
            trial[is_entering] = np.maximum(-scaled_opening[is_entering], MIN_ENTRY_PRESSURE * trial.max())
        trial = self._resultants.restore(self._balance_sides(trial))
        displacement = self._apply(trial)
        fraction = 1.0
        # Only entering cells may overshoot; cells leave the contact finitely often.
        if is_entering.any():
            fraction = _descent_fraction(trial - self.pressure, displacement - self.displacement, opening)
        if fraction > 0:
            if fraction < 1.0:
                trial = self.pressure + fraction * (trial - self.pressure)
                displacement = self.displacement + fraction * (displacement - self.displacement)
            self.pressure, self.displacement = trial, displacement
        else:
            self._step_to_border(step, response)
        self.contact = self.pressure > 0
        self.area_changed = True

    def _step_to_border(self, step: float, response: FloatArray) -> None:
        """Step along the search direction until the first cell leaves the contact; the resultants do not change."""
        pressure_change = -step * self.direction
        is_falling = self.contact & (pressure_change < 0)
        steps_to_zero = self.pressure[is_falling] / -pressure_change[is_falling]
        fraction = min(1.0, float(steps_to_zero.min(initial=1.0)))
        pressure = self.pressure + fraction * pressure_change
        pressure[is_falling] = np.where(steps_to_zero <= fraction, 0.0, np.maximum(pressure[is_falling], 0.0))
        self.pressure, self.displacement = pressure, self.displacement - fraction * step * response


def _descent_fraction(pressure_change: FloatArray, displacement_change: FloatArray, opening: FloatArray) -> float:
    """Fraction of a pressure change to apply: 1, or the minimum of the energy if the whole change raises the energy."""
    slope = -float((pressure_change * np.where(np.isfinite(opening), opening, 0.0)).sum())
    curvature = float((pressure_change * displacement_change).sum())
    if slope <= 0:
        return 0.0
    return slope / curvature if slope < 0.5 * curvature else 1.0


MAX_COUPLED_ROUNDS = 60  # largest number of rounds of a coupled contact. Speed.
ROUND_ACCURACY = 0.03  # tolerance of a round over the change in the preceding round. Speed.
FIRST_ROUND_TOLERANCE = 1e-2  # tolerance of the first coupled round. Speed.
NESTED_CELLS = 4096  # least number of cells of a contact that is first solved on coarser cells. Speed.
COARSE_TOLERANCE = 1e-3  # tolerance of a solution that serves as a guess. Speed.
GUESSED_CONTACT, GUESSED_DEPTH = 0.4, 1e-3  # fraction of cells in an initial guess, depth over the gap's range. Speed.
OPENING_POWER = 2 / 3  # power of the opening that is linear in the distance from a contact's edge. Speed.


class ContactOperator(Protocol):
    """Surface operator of one body or of a pair."""

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cell centres under `loads` (Pa)."""
        ...

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure for a normal displacement `gap`."""
        ...

    @property
    def coarse(self) -> ContactOperator:
        """Approximate operator on cells of twice the size."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactProblem:
    """A checked contact to solve."""

    grid: Grid
    gap: FloatArray  # (x, y): initial gap less a prescribed approach, metres; infinite outside the shape
    resultants: Resultants  # prescribed resultants of the pressure
    tolerance: float  # tolerance of the iteration
    friction: float = 0.0  # coefficient of the traction along +y
    max_iterations: int = 500  # bound on the iterations

    def rigid_height(self, motion: tuple[float, ...]) -> FloatArray:
        """Height of the shape after its rigid `motion`, metres: broadcasts to (x, y)."""
        heights = (component * height for component, height in zip(motion, self.resultants.motions, strict=True))
        return sum(heights, np.zeros((1, 1)))

    def coarsen(self) -> ContactProblem:
        """Return the contact on cells of twice the size."""
        grid = self.grid.coarsened()
        gaps = self.gap.reshape(grid.cells_x, 2, grid.cells_y, 2)
        can_touch = np.isfinite(gaps)
        areas = can_touch * self.grid.weights.reshape(-1, 2, 1, 1)
        total = areas.sum(axis=(1, 3))
        mean = (np.where(can_touch, gaps, 0.0) * areas).sum(axis=(1, 3)) / np.where(total > 0, total, 1.0)
        lever = self.resultants.lever
        if lever is not None:
            weights = self.grid.weights.reshape(-1, 2)
            lever = ((weights * lever.reshape(-1, 2)).sum(axis=1) / weights.sum(axis=1))[:, None]
        resultants = Resultants(None if self.resultants.total is None else self.resultants.total / 4, lever)
        return replace(
            self, grid=grid, gap=np.where(total > 0, mean, np.inf), resultants=resultants, tolerance=COARSE_TOLERANCE
        )


def _initial_guess(operator: ContactOperator, problem: ContactProblem) -> FloatArray:
    """Return a guess of the pressure: the solution on coarser cells, or, on few cells, a function of the gap."""
    gap = problem.gap
    can_touch = np.isfinite(gap)
    if gap.size >= NESTED_CELLS and not any(cells % 2 for cells in problem.grid.shape):
        coarse = problem.coarsen()
        squared_pressure = _continue_square(operator.coarse, coarse, solve_normal(operator.coarse, coarse))
        fine_square = interpolate_columns(halve_cells(squared_pressure.T, 0).T, coarse.grid.x, problem.grid.x)
        guess = np.sqrt(np.maximum(np.where(can_touch, fine_square, 0.0), 0.0))
    else:
        heights = _remove_mean_slope(problem)
        touchable_heights = heights[can_touch]
        level = 0.0
        if problem.resultants.total is not None:
            level = np.quantile(touchable_heights, GUESSED_CONTACT) + GUESSED_DEPTH * np.ptp(touchable_heights)
        guess = np.sqrt(np.maximum(level - np.where(can_touch, heights, np.inf), 0.0))
    return np.asarray(guess if guess.any() else can_touch.astype(np.float64))


def _remove_mean_slope(problem: ContactProblem) -> FloatArray:
    """Gap less its mean slope along the axis, where the shape is free to tilt."""
    lever = problem.resultants.lever
    if lever is None:
        return problem.gap
    is_under_shape = np.isfinite(problem.gap).any(axis=1)
    lowest, arm = problem.gap[is_under_shape].min(axis=1), lever[is_under_shape, 0]
    slope = np.polynomial.polynomial.polyfit(arm, lowest, 1)[1] if arm.size > 1 else 0.0
    return problem.gap - slope * lever


def _continue_square(operator: ContactOperator, problem: ContactProblem, iterate: ContactIterate) -> FloatArray:
    """Squared pressure, continued smoothly below zero outside the contact."""
    # Near an edge the squared pressure and the opening to the power 2/3 are linear in the distance from the edge
    # (Johnson, Contact Mechanics, section 5.1): their zero on finer cells locates the edge within a cell.
    from scipy.ndimage import binary_dilation

    squared = iterate.pressure**2
    contact = squared > 0
    height = np.where(np.isfinite(problem.gap), problem.gap, 0.0) + operator({Load.NORMAL: iterate.pressure})
    positive_opening = np.where(
        contact | np.isinf(problem.gap), 0.0, np.maximum(height - problem.rigid_height(iterate.motion), 0.0)
    )
    opening = positive_opening**OPENING_POWER
    is_inner_edge = contact & binary_dilation(~contact)
    is_outer_edge = (opening > 0) & binary_dilation(contact)
    if not is_inner_edge.any() or not is_outer_edge.any():
        return np.asarray(squared)
    return np.asarray(squared - opening * (np.median(squared[is_inner_edge]) / np.median(opening[is_outer_edge])))


def cell_means(values: FloatArray) -> FloatArray:
    """Means (x, y) over cells of twice the size."""
    rows, columns = values.shape
    return np.asarray(values.reshape(rows // 2, 2, columns // 2, 2).mean(axis=(1, 3)))


def halve_cells(values: FloatArray, axis: int) -> FloatArray:
    """Values on cells of half the size along an axis, linear between the centres."""
    rows = np.moveaxis(values, axis, 0)
    padded = np.concatenate([rows[:1], rows, rows[-1:]])
    halves = np.stack([0.75 * rows + 0.25 * padded[:-2], 0.75 * rows + 0.25 * padded[2:]], axis=1)
    return np.ascontiguousarray(np.moveaxis(halves.reshape(-1, *rows.shape[1:]), 0, axis))


def solve_normal(operator: ContactOperator, problem: ContactProblem, start: FloatArray | None = None) -> ContactIterate:
    """Solve a contact without the displacement from friction."""
    # The unknowns are pressures times the weights of the cells: their scalar product with displacements is a work.
    weights = problem.grid.weights
    guess = _initial_guess(operator, problem) if start is None else start
    iterate = solve_complementarity(
        lambda forces: operator({Load.NORMAL: forces / weights}),
        lambda gap: weights * operator.precondition(gap),
        problem.gap,
        problem.resultants,
        weights * guess,
        tolerance=problem.tolerance,
        max_iterations=problem.max_iterations,
    )
    return replace(iterate, pressure=iterate.pressure / weights)


def solve_problem(
    operator: ContactOperator, problem: ContactProblem, start: FloatArray | None = None
) -> ContactIterate:
    """Solve a contact; with coupled friction the traction of each round changes the gap of the next round."""
    if not problem.friction:
        return solve_normal(operator, problem, start)
    # The rounds contract like ``f (1 - 2 nu) / (2 (1 - nu))``; each is solved only as far as the last change requires.
    tolerance = max(problem.tolerance, FIRST_ROUND_TOLERANCE)
    iterate = solve_normal(operator, replace(problem, tolerance=tolerance))
    if not iterate.converged:
        return iterate
    scale = float(np.ptp(operator({Load.NORMAL: iterate.pressure})))
    applications = iterate.applications + 1
    displacement: FloatArray = np.zeros_like(iterate.pressure)
    change = FIRST_ROUND_TOLERANCE
    for _ in range(MAX_COUPLED_ROUNDS):
        previous_pressure, previous_displacement = iterate.pressure, displacement
        displacement = operator({Load.ALONG_Y: problem.friction * previous_pressure})
        applications += 1
        # Difference of the displacements under the last two tractions.
        displacement_change = float(np.ptp((displacement - previous_displacement)[previous_pressure > 0])) / scale
        if max(tolerance, change) <= problem.tolerance and displacement_change <= 0.5 * problem.tolerance:
            return replace(iterate, pressure=previous_pressure, applications=applications, converged=True)
        tolerance = max(0.5 * problem.tolerance, ROUND_ACCURACY * change)
        next_problem = replace(problem, gap=problem.gap + displacement, tolerance=tolerance)
        iterate = solve_normal(operator, next_problem, previous_pressure)
        applications += iterate.applications
        if not iterate.converged:
            break
        weights, pressure = problem.grid.weights, iterate.pressure
        change = float((weights * np.abs(pressure - previous_pressure)).sum() / (weights * pressure).sum())
    return replace(iterate, applications=applications, converged=False)
