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

from contactstudy.checks import BoolArray, FloatArray

Operator = Callable[[FloatArray], FloatArray]

OVERLAP = 0.1  # part of the tolerated violation from which on an overlapping cell enters the contact. Speed.
LEAST_ENTRY = 1e-12  # least pressure, over the largest, of a cell that enters the contact: it has to be in it. Speed.

LEAST_RESTORED = 0.1  # least of a linear factor that restores the moment, over its mean: its sign stays. Speed.
ADDED = 0.1  # pressure, over the largest, added everywhere if none lies on one side of the load. Speed.
STEEPEST = 1e4  # largest slope of the exponential factor that restores the moment instead. Speed.


@dataclass(frozen=True, eq=False)
class Resultants:
    """Prescribed resultants of the pressure; the rigid motions are conjugate to them."""

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

    def restored(self, pressure: FloatArray) -> FloatArray:
        """Return the pressure times a factor that gives it the resultants: linear in the arm, or exponential."""
        if self.total is None:
            return pressure
        if self.lever is None:
            return np.asarray(pressure * (self.total / pressure.sum()))
        line = pressure.sum(axis=1)
        arm = self.lever[:, 0]
        sums = [float((line * arm**power).sum()) for power in (0, 1, 2)]
        # One column of cells lacks a second moment: the factor restores the sum only.
        if sums[0] * sums[2] - sums[1] ** 2 <= 1e-9 * sums[0] * sums[2]:
            return np.asarray(pressure * (self.total / sums[0]))
        constant, slope = np.linalg.solve([sums[:2], sums[1:]], [self.total, 0.0])
        factor = constant + slope * self.lever
        if factor.min() < LEAST_RESTORED * constant:
            factor = self._exponential(line, arm)
        return np.asarray(pressure * factor)

    def _exponential(self, line: FloatArray, arm: FloatArray) -> FloatArray:
        """Factor ``C exp(s arm)``, positive whatever the moment; without pressure on both sides, only the sum's."""
        assert self.total is not None
        loaded = line > 0
        line, lever = line[loaded], arm[loaded]
        slope = 0.0
        if lever.min() < 0 < lever.max():

            def moment(slope: float) -> float:
                weighted = line * np.exp(slope * lever - (slope * lever).max())
                return float((weighted * lever).sum() / weighted.sum())

            reach = 1.0
            while reach < STEEPEST and moment(-reach) * moment(reach) > 0:
                reach *= 2
            if moment(-reach) * moment(reach) <= 0:
                from scipy.optimize import brentq

                slope = float(brentq(moment, -reach, reach, xtol=1e-15, rtol=1e-14))
        factor = np.exp(slope * arm - (slope * lever).max())
        return np.asarray((factor * (self.total / float((line * factor[loaded]).sum())))[:, None])

    def off_position(self, pressure: FloatArray) -> float:
        """Distance of the pressure's resultant from where it is to act, over the largest arm."""
        return 0.0 if self.lever is None else abs(float((pressure * self.lever).sum() / pressure.sum()))


@dataclass(frozen=True, kw_only=True)
class ContactIterate:
    """Where the iteration ended."""

    pressure: FloatArray  # (x, y): pressure, Pa, with the prescribed resultants
    motion: tuple[float, ...]  # the free rigid motions: approach, metres, and tilt about the point of application
    applications: int  # applications of the operator
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
    """Pressure ``p >= 0``, gap ``g = gap + operator(p) - motion >= 0``, ``p g = 0``, and prescribed resultants."""
    state = _State(operator, preconditioner, gap, resultants, start)
    converged = False
    for _ in range(max_iterations):
        opening = state.opening()
        residual = np.where(state.contact, opening, 0.0)
        violation = np.where(state.contact, np.abs(residual), np.maximum(-opening, 0.0)).max()
        scale = np.ptp(state.sunk)
        step, displacement, curvature = state.search(residual)
        moved = state.pressure - step * state.direction
        change = abs(step) * float(np.abs(state.direction).sum() / state.pressure.sum())
        closed = ~state.contact & (opening < -OVERLAP * tolerance * scale)
        if (moved < 0).any() or closed.any():
            state.change_area(moved, closed, opening, step, displacement)
        else:
            state.pressure, state.sunk, state.fresh = moved, state.sunk - step * displacement, False
            converges = violation <= tolerance * scale and change <= tolerance
            if converges and resultants.off_position(state.pressure) <= tolerance:
                converged = True
                break
        if curvature <= 0:
            break
    pressure = resultants.restored(state.pressure)
    motion = tuple(float(amount) for amount in state.motion)
    return ContactIterate(pressure=pressure, motion=motion, applications=state.applications, converged=converged)


class _State:
    """Where the iteration stands."""

    def __init__(
        self, operator: Operator, preconditioner: Operator, gap: FloatArray, resultants: Resultants, start: FloatArray
    ) -> None:
        self._operator, self._preconditioner = operator, preconditioner
        self._gap, self._possible = gap, np.isfinite(gap)
        self._resultants, self._motions = resultants, resultants.motions
        self.applications = 0
        self.pressure = resultants.restored(self._balance_sides(start))
        self.sunk = self._apply(self.pressure)
        if resultants.total is None:
            self._scale_guess()
        self.contact = self.pressure > 0
        self.fresh = True
        self.motion: FloatArray = np.zeros(len(self._motions))
        self.direction: FloatArray = np.zeros_like(self.pressure)
        self._residual: FloatArray = np.zeros_like(self.pressure)
        self._slope = 0.0
        self._weights: list[FloatArray] = []
        self._gram: FloatArray = np.zeros((len(self._motions), len(self._motions)))

    def _apply(self, pressure: FloatArray) -> FloatArray:
        self.applications += 1
        return self._operator(pressure)

    def _scale_guess(self) -> None:
        """Scale the guess: the work of the prescribed approach equals the work of the displacement."""
        gap = self._gap
        work = -float((self.pressure * np.where(self._possible, gap, 0.0)).sum())
        if work <= 0:  # a guess that lies where the shape does not reach
            self.pressure = np.where(gap < 0, 1.0, 0.0)
            self.sunk, work = self._apply(self.pressure), -float(gap[gap < 0].sum())
        factor = work / float((self.pressure * self.sunk).sum())
        self.pressure, self.sunk = factor * self.pressure, factor * self.sunk

    def _balance_sides(self, pressure: FloatArray) -> FloatArray:
        """Add a little pressure everywhere if all of it lies on one side of where the load acts."""
        lever = self._resultants.lever
        if lever is None:
            return pressure
        arms = lever[pressure.any(axis=1)]
        if arms.min() < 0 < arms.max():
            return pressure
        return pressure + np.where(self._possible, ADDED * pressure.max(), 0.0)

    def opening(self) -> FloatArray:
        """Gap after the rigid motion that leaves the descent without resultants: the prescribed ones stay."""
        motions = self._motions
        if self.fresh:
            self._weights = [
                np.where(self.contact, self._preconditioner(np.where(self.contact, mode, 0.0)), 0.0) for mode in motions
            ]
            self._gram = np.array([[float((weight * mode).sum()) for mode in motions] for weight in self._weights])
        height = np.where(self._possible, self._gap + self.sunk, np.inf)
        inside = np.where(self.contact, height, 0.0)
        if motions:
            works = [float((weight * inside).sum()) for weight in self._weights]
            if len(motions) == 1:
                self.motion = np.asarray(np.array(works) / self._gram[0])
            else:  # least squares, for a contact of one column of cells cannot tilt
                self.motion = np.asarray(np.linalg.lstsq(self._gram, works, rcond=None)[0])
        level = sum((amount * mode for amount, mode in zip(self.motion, motions, strict=True)), np.zeros((1, 1)))
        return np.asarray(height - level)

    def search(self, residual: FloatArray) -> tuple[float, FloatArray, float]:
        """Turn the direction; return the step, the displacement under the direction and the curvature."""
        descent = np.where(self.contact, self._preconditioner(residual), 0.0)
        if self.fresh or self._slope == 0.0:
            direction = descent
        else:
            # Polak and Ribiere's form forgives that the preconditioner is not exactly symmetric on the contact.
            turn = float(((residual - self._residual) * descent).sum()) / self._slope
            direction = descent + turn * self.direction
        self._slope, self._residual = float((residual * descent).sum()), residual
        self.direction = np.where(self.contact, direction, 0.0)
        displacement = self._apply(self.direction)
        curvature = float((self.direction * displacement).sum())
        step = float((residual * self.direction).sum()) / curvature if curvature > 0 else 0.0
        return step, displacement, curvature

    def change_area(
        self, moved: FloatArray, closed: BoolArray, opening: FloatArray, step: float, displacement: FloatArray
    ) -> None:
        """Take cells out of the contact whose pressure has become negative, and cells that overlap into it."""
        moved[moved < 0] = 0.0
        if closed.any():
            # As in Polonsky and Keer: overlapping points enter with the step along the gap itself.
            scaled = self._preconditioner(np.where(closed, opening, 0.0))
            moved[closed] = np.maximum(-scaled[closed], LEAST_ENTRY * moved.max())
        moved = self._resultants.restored(self._balance_sides(moved))
        sunk = self._apply(moved)
        part = 1.0
        # Cells leave the contact finitely often; cells that enter may overshoot.
        if closed.any():
            part = _descent_fraction(moved - self.pressure, sunk - self.sunk, opening)
        if part > 0:
            self.pressure = moved if part == 1.0 else self.pressure + part * (moved - self.pressure)
            self.sunk = sunk if part == 1.0 else self.sunk + part * (sunk - self.sunk)
        else:
            self._step_to_border(step, displacement)
        self.contact = self.pressure > 0
        self.fresh = True

    def _step_to_border(self, step: float, displacement: FloatArray) -> None:
        """Follow the direction until the first cell leaves the contact: that keeps the resultants and descends."""
        change = -step * self.direction
        falling = self.contact & (change < 0)
        reach = self.pressure[falling] / -change[falling]
        part = min(1.0, float(reach.min(initial=1.0)))
        pressure = self.pressure + part * change
        pressure[falling] = np.where(reach <= part, 0.0, np.maximum(pressure[falling], 0.0))
        self.pressure, self.sunk = pressure, self.sunk - part * step * displacement


def _descent_fraction(change: FloatArray, sinking: FloatArray, opening: FloatArray) -> float:
    """Part of a change of the pressure to take: all, unless the energy increases; then the parabola's minimum."""
    slope = -float((change * np.where(np.isfinite(opening), opening, 0.0)).sum())
    curvature = float((change * sinking).sum())
    if slope <= 0:
        return 0.0
    return slope / curvature if slope < 0.5 * curvature else 1.0
