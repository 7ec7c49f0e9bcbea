"""Coulomb's law of friction on the cells of a contact: which of them stick, and the tractions on all.

With the tractions ``q`` (two components on each cell), the bound ``g = f p`` and the slip ``s = w - B q`` the law
reads: ``|q| <= g`` everywhere; where ``|q| < g`` there is no slip; where there is slip, ``q`` is ``g`` times its
direction. ``w`` is the slip of rigid surfaces and ``B`` what tractions take from it. It is solved by a semi-smooth
Newton method: for a guess of the cells that slip and of their directions ``n`` the unknowns are ``q`` where they stick
and, where they slip, the part ``a`` of ``q = g n + a n'`` across, with which the slip has to turn:

    stick:  w - B q = 0,        slip:  n' (w - B q) - (s n / g) a = 0,

a linear system with the matrix ``T' B T + D`` and ``D >= 0``. A cell then slips if its traction exceeds the bound, and
sticks if it would slip against its traction. Rigid slips whose resultant is prescribed are unknowns beside ``q``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.coulomb_law import CoulombProblem, CoulombSolution, Operator, law_violation
from contactstudy.contact.krylov import minimal_residual
from contactstudy.contact.projected import balanced_tractions

ROUGHLY, CAREFULLY, FALLS = 0.1, 1e-2, 0.8
"""Part of its residual that a linear system leaves; the part where the last step did not make the violation fall by a
factor, and where all cells stayed what they were; that factor. Speed."""

GUESSED = 1e-6
"""Part of the bound by which the traction of a cell that slips in a guess may miss it. Speed."""

DIRECTIONS = 60
"""Directions that the linear solver keeps. Speed."""

ASTRAY = 15
"""Steps of Newton's method after which it has lost its way, and begins again from a descent. Speed."""

RESTARTS = 5
"""Restarts after which a linear system is left as it is. Speed."""


@dataclass
class _Count:
    """Applications of an operator so far."""

    operator: Operator
    number: int = field(default=0)

    def __call__(self, values: FloatArray) -> FloatArray:
        self.number += 1
        return self.operator(values)


class Guess(NamedTuple):
    """What an iteration begins from.

    Attributes
    ----------
    traction : array (2, cell)
        Tractions; those on their bound slip.
    amplitudes : array (mode)
        Amplitudes of the unknown rigid slips.
    """

    traction: FloatArray
    amplitudes: FloatArray


def solve_coulomb(problem: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
    """Solve for tractions, slip and the unknown rigid slips.

    Parameters
    ----------
    problem : CoulombProblem
        What is asked for.
    start : Guess, optional
        What to begin from. Default: all cells stick.
    """
    relief = _Count(problem.relief)
    counted = CoulombProblem(**{**vars(problem), "relief": relief})
    bound = problem.bound
    traction = np.zeros_like(problem.rigid)
    sticks = np.ones(bound.size, bool)
    amplitudes = np.zeros(len(problem.modes))
    slip = problem.rigid.copy()
    if start is not None:
        size, amplitudes = np.hypot(*start.traction), start.amplitudes
        sticks = size < (1 - GUESSED) * bound
        traction = start.traction * np.where(sticks, 1.0, bound / np.where(size > 0, size, 1.0))
        slip = counted.slip(traction, amplitudes)
    steps, converged, accuracy, violation = 0, False, ROUGHLY, np.inf
    seen, share, typical = {sticks.tobytes()}, 1.0, _typical(problem)
    while steps < problem.max_steps and not converged:
        steps += 1
        step = _Step(counted, traction, slip, sticks, typical)
        guess, amplitudes = step.solve(traction, slip, amplitudes, accuracy)
        traction, before = guess, sticks
        size = np.hypot(*traction)
        slipping = ~sticks
        exceeds = size > bound
        begins = exceeds & sticks
        if len(problem.modes):
            begins = _foremost(begins, size / bound, sticks)
        begins = _some(begins, share)
        # Where a cell slips its traction has grown across; where it stuck and exceeds the bound it begins to slip.
        traction = traction * np.where(slipping | begins, bound / np.where(size > 0, size, 1.0), 1.0)
        slip = counted.slip(traction, amplitudes)
        along = (slip * traction).sum(axis=0)
        ends = slipping & (along < 0)
        ends = _some(ends, share)
        sticks = (sticks & ~begins) | ends
        scale = _scale(counted, amplitudes)
        missed = np.abs((problem.works * traction).sum(axis=(1, 2)) - problem.resultants)
        whole = np.abs(problem.works).sum(axis=1) @ bound if len(problem.works) else np.ones(0)
        last, violated = violation, law_violation(traction, slip, bound, sticks, scale)
        violation = max(*violated, float((missed / whole).max(initial=0.0)))
        converged = violation <= problem.tolerance
        stayed = np.array_equal(sticks, before)
        accuracy = CAREFULLY if stayed or violation > FALLS * last else ROUGHLY
        if not stayed:
            # Cells that go round in circles do not if fewer of them change at once (in the end one by one: Murty).
            again = sticks.tobytes() in seen
            share = 0.5 * share if again else min(1.0, 2 * share)
            seen.add(sticks.tobytes())
        if problem.symmetric and steps % ASTRAY == 0 and not converged:
            traction, amplitudes = balanced_tractions(
                relief,
                counted.rigid_slip,
                problem.works,
                problem.resultants,
                _within(bound, traction),
                amplitudes,
                scale,
                bound,
                problem.shares,
            )
            slip, share = counted.slip(traction, amplitudes), 1.0
            sticks, seen = np.hypot(*traction) < (1 - GUESSED) * bound, set()
    return CoulombSolution(traction, slip, sticks, amplitudes, steps, relief.number, converged)


def _within(bound: FloatArray, traction: FloatArray) -> FloatArray:
    """Tractions put back onto their bound where they exceed it."""
    size = np.hypot(*traction)
    return np.asarray(traction * np.where(size > bound, bound / np.where(size > 0, size, 1.0), 1.0))


def _some(cells: BoolArray, share: float) -> BoolArray:
    """Only a share of some cells, the first of them, and one at least."""
    if share == 1:
        return cells
    numbers = np.flatnonzero(cells)
    some = np.zeros_like(cells)
    some[numbers[: max(1, int(share * numbers.size))]] = True
    return some


def _foremost(exceeds: BoolArray, excess: FloatArray, sticks: BoolArray) -> BoolArray:
    """Half of the cells that stick at most, those farthest above their bound.

    Were all to begin at once, the rigid slip that makes a prescribed resultant would hardly have a value. The last
    cell may: where another rigid slip is prescribed, all cells may have to slip.
    """
    most = (int(sticks.sum()) + 1) // 2
    if exceeds.sum() <= most:
        return exceeds
    least = np.partition(excess[exceeds], -most)[-most]
    return np.asarray(exceeds & (excess >= least))


def _scale(problem: CoulombProblem, amplitudes: FloatArray) -> float:
    """Size of the rigid slip, to which violations are related."""
    return max(float(np.hypot(*problem.rigid_slip(amplitudes)).max(initial=0.0)), np.finfo(float).tiny)


class _Step:
    """One linear system of Newton's method."""

    def __init__(
        self,
        problem: CoulombProblem,
        traction: FloatArray,
        slip: FloatArray,
        sticks: BoolArray,
        typical: FloatArray,
    ) -> None:
        self._problem, self._sticks, self._typical = problem, sticks, typical
        self._root = np.sqrt(problem.shares)
        size = np.hypot(*traction)
        self._direction = np.where(sticks, 0.0, traction / np.where(size > 0, size, 1.0))
        across = np.stack([-self._direction[1], self._direction[0]])
        # Unknowns: both components where cells stick, else the component across.
        self._first = np.where(sticks, np.array([[1.0], [0.0]]), across)
        self._second = np.where(sticks, np.array([[0.0], [1.0]]), 0.0)[:, sticks]
        along = np.maximum((slip * self._direction).sum(axis=0), 0.0)
        self._turning = np.where(sticks, 0.0, along / problem.bound)

    def _spread(self, unknowns: FloatArray) -> FloatArray:
        """Tractions (2, cell) of the unknowns, without the given part."""
        cells = self._sticks.size
        traction = self._first * unknowns[:cells]
        traction[:, self._sticks] += self._second * unknowns[cells:]
        return np.asarray(traction / self._root)

    def _gathered(self, slip: FloatArray) -> FloatArray:
        """Parts of a slip (2, cell) that the unknowns work on."""
        slip = self._root * slip
        first = (self._first * slip).sum(axis=0)
        second = (self._second * slip[:, self._sticks]).sum(axis=0)
        return np.concatenate([first, second])

    def solve(
        self, traction: FloatArray, slip: FloatArray, amplitudes: FloatArray, accuracy: float
    ) -> tuple[FloatArray, FloatArray]:
        """Tractions and amplitudes of the rigid slips; what the present ones leave is taken away to an accuracy."""
        problem = self._problem
        turning = np.concatenate([self._turning, np.zeros(int(self._sticks.sum()))])
        count, shape = turning.size, (len(problem.modes), turning.size)
        # A spin counts per metre and its moment in N m: as slip, and as the slip that tractions of their size take
        # away, one residual means something for all.
        sizes = np.hypot(problem.modes[:, 0], problem.modes[:, 1]).max(axis=1, initial=np.finfo(float).tiny)
        modes = np.array([self._gathered(mode) for mode in problem.modes]).reshape(shape) / sizes[:, None]
        works = np.array([self._gathered(work / problem.shares) for work in problem.works]).reshape(shape)
        unit = (np.abs(works).sum(axis=1) + np.finfo(float).tiny) / float(self._typical.mean())
        works = works / unit[:, None]
        typical = np.concatenate([self._typical, self._typical[self._sticks]])
        damped = np.sqrt(typical / (typical + turning))

        def matrix(unknowns: FloatArray) -> FloatArray:
            moved = self._gathered(problem.relief(self._spread(unknowns))) + turning * unknowns
            return np.asarray(moved)

        def inverse(slip: FloatArray) -> FloatArray:
            return np.asarray(damped * self._gathered(problem.inverse(self._spread(damped * slip))))

        lifted = np.array([inverse(mode) for mode in modes]).reshape(modes.shape)
        schur = works @ lifted.T

        def whole(unknowns: FloatArray) -> FloatArray:
            own, free = unknowns[:count], unknowns[count:]
            return np.concatenate([matrix(own) - free @ modes, works @ own])

        def precondition(residual: FloatArray) -> FloatArray:
            own = inverse(residual[:count])
            if not len(modes):
                return own
            free = np.linalg.lstsq(schur, residual[count:] - works @ own, rcond=None)[0]
            return np.concatenate([own + free @ lifted, free])

        # Cells that slip carry their bound and nothing across it, so the slip is all that is left.
        owed = (problem.resultants - (problem.works * traction).sum(axis=(1, 2))) / unit
        change = minimal_residual(
            whole,
            precondition,
            np.concatenate([self._gathered(slip), owed]),
            accuracy,
            directions=DIRECTIONS,
            restarts=RESTARTS,
        )
        return traction + self._spread(change[:count]), amplitudes + change[count:] / sizes


def _typical(problem: CoulombProblem) -> FloatArray:
    """Slip that a traction on its own takes away, per traction, of cells of each width: array (cell)."""
    found = np.empty_like(problem.bound)
    for share in np.unique(problem.shares):
        alike = problem.shares == share
        one = np.zeros_like(problem.rigid)
        most = int(np.where(alike, problem.bound, 0.0).argmax())
        one[1, most] = 1.0
        found[alike] = abs(1.0 / problem.inverse(one)[1, most])
    return found
