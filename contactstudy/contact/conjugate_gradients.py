"""Unilateral contact by preconditioned conjugate gradients, under prescribed resultants or a prescribed approach.

The scheme of I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206, with two changes that save most of its iterations:
the descent direction is preconditioned by the inverse of the operator's spectrum, restricted to the contact (J. Zhao,
E. A. H. Vollebregt, C. W. Oosterlee, Math. Comput. Sci. 9 (2015) 375, use the like for Hertz' problem), and the gap is
updated along the search direction while the contact area stays as it is. And one that keeps it from going astray after
a bad guess: cells that enter the contact all at once may press too hard, so of a change of the area that would raise
the energy only the part is taken that lowers it most.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray

Operator = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class Resultants:
    """What is prescribed of the pressure; the rigid motions conjugate to it follow.

    Attributes
    ----------
    total : float or None
        Sum over the cells, Pa, conjugate to the approach; None if the approach is prescribed (as part of the gap).
    lever : array (x, 1), optional
        Arm of each cell about the point where the load is to act, metres: the sum of arm times pressure is zero, and
        the shape tilts about that point.
    """

    total: float | None
    lever: FloatArray | None = None

    @property
    def motions(self) -> list[FloatArray]:
        """Rigid motions that are free: arrays that broadcast to (x, y)."""
        if self.total is None:
            return []
        return [np.ones((1, 1))] if self.lever is None else [np.ones((1, 1)), self.lever]

    def restored(self, pressure: FloatArray) -> FloatArray:
        """Return the pressure times the factor, linear in the arm, that gives it the resultants."""
        if self.total is None:
            return pressure
        if self.lever is None:
            return np.asarray(pressure * (self.total / pressure.sum()))
        line = pressure.sum(axis=1)
        arm = self.lever[:, 0]
        sums = [float((line * arm**power).sum()) for power in (0, 1, 2)]
        # One column of cells has no second moment: then only its sum can be restored.
        if sums[0] * sums[2] - sums[1] ** 2 <= 1e-9 * sums[0] * sums[2]:
            return np.asarray(pressure * (self.total / sums[0]))
        constant, slope = np.linalg.solve([sums[:2], sums[1:]], [self.total, 0.0])
        return np.asarray(pressure * np.maximum(constant + slope * self.lever, 0.1 * constant))


@dataclass(frozen=True)
class ContactIterate:
    """Where the iteration ended.

    Attributes
    ----------
    pressure : array (x, y)
        Pressure, Pa, with the prescribed resultants.
    motion : tuple of float
        The free rigid motions: approach, metres, and tilt about the point of application.
    applications : int
        Applications of the operator.
    converged : bool
        Whether the tolerance was reached.
    """

    pressure: FloatArray
    motion: tuple[float, ...]
    applications: int
    converged: bool


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
    """Pressure ``p >= 0`` with gap ``g = gap + operator(p) - motion >= 0``, ``p g = 0`` and the prescribed resultants.

    Parameters
    ----------
    operator, preconditioner : callable
        Symmetric positive operators on arrays (x, y): displacement from pressure, and roughly its inverse.
    gap : array (x, y)
        Initial gap, metres; infinite where contact is impossible.
    resultants : Resultants
        What the pressure has to sum up to, and so which rigid motions are free.
    start : array (x, y)
        First guess of the pressure; not negative, zero where the gap is infinite, not zero everywhere.
    tolerance : float
        Bound on the largest violation of the gap conditions over the displacement's variation, and on the last
        change of the pressure over its sum.
    max_iterations : int
        Bound on the iterations.

    Returns
    -------
    ContactIterate
    """
    possible = np.isfinite(gap)
    pressure = resultants.restored(start)
    applications = 1
    sunk = operator(pressure)
    if resultants.total is None:
        # The best multiple of the guess: the one that the prescribed approach does as much work on as the displacement.
        work = -float((pressure * np.where(possible, gap, 0.0)).sum())
        if work <= 0:  # a guess that lies where the shape does not reach
            pressure = np.where(gap < 0, 1.0, 0.0)
            sunk, work = operator(pressure), -float(gap[gap < 0].sum())
            applications += 1
        factor = work / float((pressure * sunk).sum())
        pressure, sunk = factor * pressure, factor * sunk
    motions = resultants.motions
    direction = np.zeros_like(pressure)
    previous = np.zeros_like(pressure)
    slope = 0.0
    contact = pressure > 0
    weights: list[FloatArray] = []
    gram = np.zeros((len(motions), len(motions)))
    motion: FloatArray = np.zeros(len(motions))
    converged, fresh = False, True
    for _ in range(max_iterations):
        if fresh:
            weights = [np.where(contact, preconditioner(np.where(contact, each, 0.0)), 0.0) for each in motions]
            gram = np.array([[float((weight * each).sum()) for each in motions] for weight in weights])
        height = np.where(possible, gap + sunk, np.inf)
        inside = np.where(contact, height, 0.0)
        # Weighted so, the descent has no resultants: the prescribed ones stay as they are.
        if motions:
            works = [float((weight * inside).sum()) for weight in weights]
            # Least squares, for a contact of one column of cells cannot tilt.
            motion = np.asarray(np.array(works) / gram[0] if len(motions) == 1 else np.linalg.lstsq(gram, works)[0])
        level = sum((amount * each for amount, each in zip(motion, motions, strict=True)), np.zeros((1, 1)))
        opening = height - level
        residual = np.where(contact, opening, 0.0)
        violation = np.where(contact, np.abs(residual), np.maximum(-opening, 0.0)).max()
        scale = np.ptp(sunk)
        descent = np.where(contact, preconditioner(residual), 0.0)
        new_slope = float((residual * descent).sum())
        if fresh or slope == 0.0:
            direction = descent
        else:
            # Polak and Ribiere's form forgives that the preconditioner is not exactly symmetric on the contact.
            direction = descent + float(((residual - previous) * descent).sum()) / slope * direction
        slope, previous = new_slope, residual
        direction = np.where(contact, direction, 0.0)
        along = operator(direction)
        applications += 1
        curvature = float((direction * along).sum())
        step = float((residual * direction).sum()) / curvature if curvature > 0 else 0.0
        moved = pressure - step * direction
        closed = ~contact & (opening < -0.1 * tolerance * scale)
        clipped = moved < 0
        change = abs(step) * float(np.abs(direction).sum() / pressure.sum())
        fresh = bool(clipped.any() or closed.any())
        if fresh:
            moved[clipped] = 0.0
            if closed.any():
                # As in Polonsky and Keer: overlapping points enter with the step along the gap itself.
                scaled = preconditioner(np.where(closed, opening, 0.0))
                moved[closed] = np.maximum(-scaled[closed], 1e-12 * moved.max())
            moved = resultants.restored(moved)
            settled = operator(moved)
            applications += 1
            # Cells that only leave the contact cannot do so for ever; those that enter may overshoot.
            part = _part_that_descends(moved - pressure, settled - sunk, opening) if closed.any() else 1.0
            pressure = moved if part == 1.0 else pressure + part * (moved - pressure)
            sunk = settled if part == 1.0 else sunk + part * (settled - sunk)
            contact = pressure > 0
        else:
            pressure = moved
            sunk = sunk - step * along
        if not fresh and violation <= tolerance * scale and change <= tolerance:
            converged = True
            break
        if curvature <= 0:
            break
    pressure = resultants.restored(pressure)
    return ContactIterate(pressure, tuple(float(amount) for amount in motion), applications, converged)


def _part_that_descends(change: FloatArray, sinking: FloatArray, opening: FloatArray) -> float:
    """Part of a change of the pressure to take: all, unless it raises the energy; then what lowers it most.

    Between two pressures that are nowhere negative and have the prescribed resultants, all have both properties, and
    the energy between them is a parabola.
    """
    slope = -float((change * np.where(np.isfinite(opening), opening, 0.0)).sum())
    curvature = float((change * sinking).sum())
    return slope / curvature if 0 < slope < 0.5 * curvature else 1.0
