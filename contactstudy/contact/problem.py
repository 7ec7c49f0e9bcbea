"""One contact to solve: its first guess from coarser cells, and its solution with or without coupled friction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy import ndimage

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.contact.conjugate_gradients import ContactIterate, Resultants, solve_complementarity

COUPLED_ROUNDS = 60
# The first rounds of a coupled contact are solved roughly, later ones to this part of what the last one changed.
ROUND_ACCURACY = 0.03
ROUGH_TOLERANCE = 1e-2
# From this many cells on, the contact is first solved on coarser ones, to a tolerance that serves as a guess.
NESTED_CELLS = 4096
COARSE_TOLERANCE = 1e-3


class ContactOperator(Protocol):
    """What the contact needs of one body or of two."""

    def __call__(self, pressure: FloatArray, traction: FloatArray | None = None) -> FloatArray:
        """Displacement (m) of the cell centres."""
        ...

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        ...

    @property
    def coarse(self) -> ContactOperator:
        """The operator on cells of twice the size, roughly."""
        ...


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """A contact to solve, checked.

    Attributes
    ----------
    grid : Grid
        Cells.
    gap : array (x, y)
        Initial gap, metres, less the approach if that is prescribed; infinite where there is nothing to touch.
    resultants : Resultants
        What the pressure has to sum up to.
    friction : float
        Coefficient of the traction along +y.
    tolerance : float
        Tolerance of the iteration.
    max_iterations : int
        Bound on the iterations.
    """

    grid: Grid
    gap: FloatArray
    resultants: Resultants
    friction: float
    tolerance: float
    max_iterations: int

    def level(self, motion: tuple[float, ...]) -> FloatArray:
        """Height of the shape after its rigid `motion`, metres: broadcasts to (x, y)."""
        level = np.zeros((1, 1))
        for amount, each in zip(motion, self.resultants.motions, strict=True):
            level = level + amount * each
        return level

    def coarser(self) -> ContactProblem:
        """Return the same contact on cells of twice the size."""
        grid = self.grid.coarsened()
        cells = self.gap.reshape(grid.cells_x, 2, grid.cells_y, 2)
        possible = np.isfinite(cells)
        count = possible.sum(axis=(1, 3))
        mean = np.where(possible, cells, 0.0).sum(axis=(1, 3)) / np.maximum(count, 1)
        total, lever = self.resultants.total, self.resultants.lever
        coarse = Resultants(
            None if total is None else total / 4, None if lever is None else 0.5 * (lever[::2] + lever[1::2])
        )
        return replace(
            self, grid=grid, gap=np.where(count > 0, mean, np.inf), resultants=coarse, tolerance=COARSE_TOLERANCE
        )


def _first_guess(operator: ContactOperator, problem: ContactProblem) -> FloatArray:
    """Pressure to begin with: the solution on coarser cells, or, on few cells, one that follows the gap."""
    gap = problem.gap
    possible = np.isfinite(gap)
    if gap.size >= NESTED_CELLS and problem.grid.cells_x % 2 == 0 and problem.grid.cells_y % 2 == 0:
        coarse = problem.coarser()
        squared = _continued_square(operator.coarse, coarse, solve_normal(operator.coarse, coarse))
        guess = np.sqrt(np.maximum(np.where(possible, _refined(_refined(squared).T).T, 0.0), 0.0))
    else:
        level = (
            0.0 if problem.resultants.total is None else np.quantile(gap[possible], 0.4) + 1e-3 * np.ptp(gap[possible])
        )
        guess = np.sqrt(np.maximum(level - np.where(possible, gap, np.inf), 0.0))
    return np.asarray(guess if guess.any() else possible.astype(np.float64))


def _continued_square(operator: ContactOperator, problem: ContactProblem, found: ContactIterate) -> FloatArray:
    """Squared pressure, and outside the contact what continues it smoothly below zero.

    Close to an edge the squared pressure and the opening to the power 2/3 are both linear in the distance from it
    (Johnson, Contact Mechanics, section 5.1), so the one continues the other but for a factor. Interpolated to finer
    cells its zero puts the edge within a cell.
    """
    squared = found.pressure**2
    contact = squared > 0
    height = np.where(np.isfinite(problem.gap), problem.gap, 0.0) + operator(found.pressure)
    opening = np.where(contact | np.isinf(problem.gap), 0.0, np.maximum(height - problem.level(found.motion), 0.0)) ** (
        2 / 3
    )
    inner = contact & ndimage.binary_dilation(~contact)
    outer = (opening > 0) & ndimage.binary_dilation(contact)
    if not inner.any() or not outer.any():
        return np.asarray(squared)
    return np.asarray(squared - opening * (np.median(squared[inner]) / np.median(opening[outer])))


def _refined(values: FloatArray) -> FloatArray:
    """Values on cells of half the size along the first axis, by linear interpolation between the centres."""
    before, after = np.vstack([values[:1], values[:-1]]), np.vstack([values[1:], values[-1:]])
    halves = np.stack([0.75 * values + 0.25 * before, 0.75 * values + 0.25 * after], axis=1)
    return halves.reshape(-1, values.shape[1])


def solve_normal(operator: ContactOperator, problem: ContactProblem, start: FloatArray | None = None) -> ContactIterate:
    """Contact without the displacement from friction."""
    return solve_complementarity(
        operator,
        operator.precondition,
        problem.gap,
        problem.resultants,
        _first_guess(operator, problem) if start is None else start,
        tolerance=problem.tolerance,
        max_iterations=problem.max_iterations,
    )


def solve_coupled(operator: ContactOperator, problem: ContactProblem) -> ContactIterate:
    """Contact with the displacement from friction: the traction of one round shapes the gap of the next.

    The rounds contract like ``f (1 - 2 nu) / (2 (1 - nu))``, so a few are enough; each is solved no further than the
    last one's change makes worth while.
    """
    tolerance = max(problem.tolerance, ROUGH_TOLERANCE)
    iterate = solve_normal(operator, replace(problem, tolerance=tolerance))
    scale = float(np.ptp(operator(iterate.pressure)))
    applications = iterate.applications + 1
    bent: FloatArray = np.zeros_like(iterate.pressure)
    change = ROUGH_TOLERANCE
    for _ in range(COUPLED_ROUNDS):
        previous, bent_before = iterate.pressure, bent
        bent = operator(np.zeros_like(previous), problem.friction * previous)
        applications += 1
        # What the friction of this pressure bends the surface otherwise than that of the last one.
        unsettled = float(np.ptp((bent - bent_before)[previous > 0])) / scale
        if max(tolerance, change) <= problem.tolerance and unsettled <= 0.5 * problem.tolerance:
            return ContactIterate(previous, iterate.motion, applications, True)
        tolerance = max(0.5 * problem.tolerance, ROUND_ACCURACY * change)
        iterate = solve_normal(operator, replace(problem, gap=problem.gap + bent, tolerance=tolerance), previous)
        applications += iterate.applications
        if not iterate.converged:
            break
        change = float(np.abs(iterate.pressure - previous).sum() / iterate.pressure.sum())
    return ContactIterate(iterate.pressure, iterate.motion, applications, False)
