"""Problem of one contact, first guess from coarser cells, and solution with or without coupled friction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.conjugate_gradients import ContactIterate, Resultants, solve_complementarity
from contactstudy.kernels.load import Load

MAX_COUPLED_ROUNDS = 60  # largest number of rounds of a coupled contact. Speed.
ROUND_ACCURACY = 0.03  # tolerance of a round over the change in the preceding round. Speed.
FIRST_ROUND_TOLERANCE = 1e-2  # tolerance of the first coupled round. Speed.
NESTED_CELLS = 4096  # cells from which on the contact is first solved on coarser ones. Speed.
COARSE_TOLERANCE = 1e-3  # tolerance of a solution that serves as a guess. Speed.
GUESSED_CONTACT, GUESSED_DEPTH = 0.4, 1e-3  # part of the cells in a first guess, and depth over the gap's range. Speed.
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
    gap: FloatArray  # (x, y): initial gap less a prescribed approach, metres; infinite where nothing can touch
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
        cells = self.gap.reshape(grid.cells_x, 2, grid.cells_y, 2)
        possible = np.isfinite(cells)
        areas = possible * self.grid.weights.reshape(-1, 2, 1, 1)
        total = areas.sum(axis=(1, 3))
        mean = (np.where(possible, cells, 0.0) * areas).sum(axis=(1, 3)) / np.where(total > 0, total, 1.0)
        lever = self.resultants.lever
        if lever is not None:
            weights = self.grid.weights.reshape(-1, 2)
            lever = ((weights * lever.reshape(-1, 2)).sum(axis=1) / weights.sum(axis=1))[:, None]
        resultants = Resultants(None if self.resultants.total is None else self.resultants.total / 4, lever)
        return replace(
            self, grid=grid, gap=np.where(total > 0, mean, np.inf), resultants=resultants, tolerance=COARSE_TOLERANCE
        )


def _initial_guess(operator: ContactOperator, problem: ContactProblem) -> FloatArray:
    """First guess of the pressure: the solution on coarser cells, or, on few cells, a pressure that follows the gap."""
    gap = problem.gap
    possible = np.isfinite(gap)
    if gap.size >= NESTED_CELLS and not any(cells % 2 for cells in problem.grid.shape):
        coarse = problem.coarsen()
        squared = _continue_square(operator.coarse, coarse, solve_normal(operator.coarse, coarse))
        fine_square = interpolate_columns(halve_cells(squared.T, 0).T, coarse.grid.x, problem.grid.x)
        guess = np.sqrt(np.maximum(np.where(possible, fine_square, 0.0), 0.0))
    else:
        heights = _remove_mean_slope(problem)
        heights_in_reach = heights[possible]
        sinks = problem.resultants.total is not None
        level = (
            np.quantile(heights_in_reach, GUESSED_CONTACT) + GUESSED_DEPTH * np.ptp(heights_in_reach) if sinks else 0.0
        )
        guess = np.sqrt(np.maximum(level - np.where(possible, heights, np.inf), 0.0))
    return np.asarray(guess if guess.any() else possible.astype(np.float64))


def _remove_mean_slope(problem: ContactProblem) -> FloatArray:
    """Gap less its mean slope along the axis, where the shape is free to tilt."""
    lever = problem.resultants.lever
    if lever is None:
        return problem.gap
    under_shape = np.isfinite(problem.gap).any(axis=1)
    lowest, arm = problem.gap[under_shape].min(axis=1), lever[under_shape, 0]
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
    opened = np.where(
        contact | np.isinf(problem.gap), 0.0, np.maximum(height - problem.rigid_height(iterate.motion), 0.0)
    )
    opening = opened**OPENING_POWER
    inner = contact & binary_dilation(~contact)
    outer = (opening > 0) & binary_dilation(contact)
    if not inner.any() or not outer.any():
        return np.asarray(squared)
    return np.asarray(squared - opening * (np.median(squared[inner]) / np.median(opening[outer])))


def cell_means(values: FloatArray) -> FloatArray:
    """Means (x, y) over cells of twice the size."""
    rows, columns = values.shape
    return np.asarray(values.reshape(rows // 2, 2, columns // 2, 2).mean(axis=(1, 3)))


def halve_cells(values: FloatArray, axis: int) -> FloatArray:
    """Values on cells of half the size along an axis, linear between the centres."""
    centre = np.moveaxis(values, axis, 0)
    padded = np.concatenate([centre[:1], centre, centre[-1:]])
    halves = np.stack([0.75 * centre + 0.25 * padded[:-2], 0.75 * centre + 0.25 * padded[2:]], axis=1)
    return np.ascontiguousarray(np.moveaxis(halves.reshape(-1, *centre.shape[1:]), 0, axis))


def interpolate_columns(values: FloatArray, centres: FloatArray, x: FloatArray) -> FloatArray:
    """Values (x, y) at other positions along x, linear between the centres and constant beyond the outermost ones."""
    if centres.size == 1:
        return np.repeat(values, x.size, axis=0)
    right = np.clip(np.searchsorted(centres, x), 1, centres.size - 1)
    fraction = np.clip((x - centres[right - 1]) / (centres[right] - centres[right - 1]), 0.0, 1.0)[:, None]
    return np.asarray((1 - fraction) * values[right - 1] + fraction * values[right])


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


def solve_coupled(operator: ContactOperator, problem: ContactProblem) -> ContactIterate:
    """Solve a contact with the displacement from friction: the traction of one round changes the gap of the next."""
    # The rounds contract like ``f (1 - 2 nu) / (2 (1 - nu))``; each is solved only as far as the last change requires.
    tolerance = max(problem.tolerance, FIRST_ROUND_TOLERANCE)
    iterate = solve_normal(operator, replace(problem, tolerance=tolerance))
    if not iterate.converged:
        return iterate
    scale = float(np.ptp(operator({Load.NORMAL: iterate.pressure})))
    applications = iterate.applications + 1
    bending: FloatArray = np.zeros_like(iterate.pressure)
    change = FIRST_ROUND_TOLERANCE
    for _ in range(MAX_COUPLED_ROUNDS):
        previous, previous_bending = iterate.pressure, bending
        bending = operator({Load.ALONG_Y: problem.friction * previous})
        applications += 1
        # Difference of the displacements under the last two tractions.
        bending_change = float(np.ptp((bending - previous_bending)[previous > 0])) / scale
        if max(tolerance, change) <= problem.tolerance and bending_change <= 0.5 * problem.tolerance:
            return replace(iterate, pressure=previous, applications=applications, converged=True)
        tolerance = max(0.5 * problem.tolerance, ROUND_ACCURACY * change)
        iterate = solve_normal(operator, replace(problem, gap=problem.gap + bending, tolerance=tolerance), previous)
        applications += iterate.applications
        if not iterate.converged:
            break
        weights = problem.grid.weights
        change = float((weights * np.abs(iterate.pressure - previous)).sum() / (weights * iterate.pressure).sum())
    return replace(iterate, applications=applications, converged=False)
