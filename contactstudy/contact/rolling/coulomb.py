"""Coulomb's law of friction on the cells of a contact, by a semi-smooth Newton method.

The unknowns are the tractions ``q`` (two components on each cell) where cells stick and, where they slip along ``n``,
the part ``a`` of ``q = g n + a n'`` across ``n``. With bound ``g``, rigid slip ``w`` and compliance ``B``:

    stick:  w - B q = 0,        slip:  n' (w - B q) - (s n / g) a = 0.

Rigid slips with prescribed resultants are further unknowns.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from contactstudy.checks import BoolArray, FloatArray

Operator = Callable[[FloatArray], FloatArray]

GUESS_TOLERANCE = 1e-6  # distance from the bound, over the bound, within which a cell of a guess slips. Speed.
MIN_FRACTION = 0.1  # fraction of a Newton step below which the step is not halved again. Speed.
ENERGY_ROUNDING = 1e-12  # relative rise of the energy that is rounding. Rounding.
MAX_DIRECT_STEPS = 40  # Newton steps without convergence after which resultants are raised by steps. Speed.
MIN_CONTINUATION_STEP = 1e-3  # least step of the resultants over the prescribed resultants. Speed.


@dataclass(frozen=True, eq=False, kw_only=True)
class CoulombProblem:
    """Coulomb's law on the cells of a contact."""

    apply_compliance: Operator  # ``B``: slip (2, cell) that tractions (2, cell) relieve
    inverse: Operator  # approximate inverse of ``B``
    bound: FloatArray  # (cell): largest traction, Pa; positive
    rigid: FloatArray  # (2, cell): prescribed slip of rigid surfaces
    modes: FloatArray  # (mode, 2, cell): rigid slips of unknown amplitude
    resultant_weights: FloatArray  # (mode, 2, cell): weights of the tractions in the resultant of each mode
    resultants: FloatArray  # (mode): prescribed resultants
    relative_areas: FloatArray  # (cell): areas over their mean, weights that make the linear systems symmetric
    tolerance: float = 1e-6  # violation, over the largest bound and rigid slip, at which the iteration stops
    max_steps: int = 40  # bound on the Newton steps
    symmetric: bool = False  # whether B is symmetric, so that the tractions minimise an energy

    def slip(self, traction: FloatArray, amplitudes: FloatArray) -> FloatArray:
        """Slip (2, cell) under tractions."""
        return self.rigid_slip(amplitudes) - self.apply_compliance(traction)

    def energy(self, traction: FloatArray, slip: FloatArray, amplitudes: FloatArray) -> float:
        """Energy ``q B q / 2 - w q`` of tractions under a shift, to a factor; least under the law (43)."""
        return -0.5 * float((self.relative_areas * traction * (self.rigid_slip(amplitudes) + slip)).sum())

    def rigid_slip(self, amplitudes: FloatArray) -> FloatArray:
        """Slip (2, cell) of rigid surfaces."""
        return np.asarray(self.rigid + np.tensordot(amplitudes, self.modes, axes=1))

    def slip_scale(self, amplitudes: FloatArray) -> float:
        """Largest rigid slip, the scale of violations."""
        return max(float(np.hypot(*self.rigid_slip(amplitudes)).max(initial=0.0)), np.finfo(float).tiny)


@dataclass(frozen=True, kw_only=True, eq=False)
class CoulombSolution:
    """Tractions under Coulomb's law."""

    traction: FloatArray  # (2, cell): tractions, Pa, and slip
    slip: FloatArray
    sticks: BoolArray  # (cell): sticking cells
    amplitudes: FloatArray  # (mode): amplitudes of the unknown rigid slips
    steps: int  # Newton steps
    converged: bool  # whether the tolerance was reached


class Guess(NamedTuple):
    """Start of the iteration: tractions (2, cell), the bound where cells slip, and amplitudes (mode) of rigid slips."""

    traction: FloatArray
    amplitudes: FloatArray


def law_violation(
    traction: FloatArray, slip: FloatArray, bound: FloatArray, sticks: BoolArray, scale: float
) -> tuple[float, float]:
    """Violations of law (43): of the bound, over the largest bound, and of the slip, over `scale`."""
    # A sticking cell violates the law by its slip, a slipping cell by the slip across and against its traction.
    size = np.hypot(*traction)
    max_bound = float(bound.max(initial=0.0))
    excess = float(np.maximum(size - bound, 0.0).max(initial=0.0)) / max_bound if max_bound else 0.0  # eq. (43)
    direction = traction / np.where(size > 0, size, 1.0)
    parallel = (slip * direction).sum(axis=0)
    across = slip[0] * direction[1] - slip[1] * direction[0]
    violation = np.where(sticks, np.hypot(*slip), np.hypot(across, np.minimum(parallel, 0.0)))
    return excess, float(violation.max(initial=0.0)) / scale


def solve_with_continuation(problem: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
    """Solve Coulomb's law; where Newton's method does not converge, raise prescribed resultants step by step."""
    # Near full sliding few cells stick. Resultants between two admissible resultants are admissible: every step has a
    # solution.
    if not len(problem.modes) or problem.max_steps <= MAX_DIRECT_STEPS:
        return solve_coulomb(problem, start)
    solution = solve_coulomb(replace(problem, max_steps=MAX_DIRECT_STEPS), start)
    if solution.converged:
        return solution
    no_modes = problem.modes[:0]
    unconstrained = replace(problem, modes=no_modes, resultant_weights=no_modes, resultants=problem.resultants[:0])
    without_modes = solve_coulomb(unconstrained)
    steps = solution.steps + without_modes.steps
    resultants = (problem.resultant_weights * without_modes.traction).sum(axis=(1, 2))
    guess, load_fraction, step = Guess(without_modes.traction, np.zeros(len(problem.modes))), 0.0, 0.5
    while load_fraction < 1 and step > MIN_CONTINUATION_STEP and steps < problem.max_steps:
        trial_fraction = min(1.0, load_fraction + step)
        trial_resultants = (1 - trial_fraction) * resultants + trial_fraction * problem.resultants
        solution = solve_coulomb(replace(problem, resultants=trial_resultants, max_steps=MAX_DIRECT_STEPS), guess)
        steps += solution.steps
        if solution.converged:
            load_fraction, step, guess = trial_fraction, 2 * step, Guess(solution.traction, solution.amplitudes)
        else:
            step *= 0.5
    return replace(solution, steps=steps, converged=solution.converged and load_fraction == 1)


def solve_coulomb(problem: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
    """Solve Coulomb's law by a semi-smooth Newton method."""
    bound = problem.bound
    traction = np.zeros_like(problem.rigid)
    sticks = np.ones(bound.size, bool)
    amplitudes = np.zeros(len(problem.modes))
    slip = problem.rigid.copy()
    if start is not None:
        size, amplitudes = np.hypot(*start.traction), start.amplitudes
        sticks = size < (1 - GUESS_TOLERANCE) * bound
        traction = start.traction * np.where(sticks, 1.0, bound / np.where(size > 0, size, 1.0))
        slip = problem.slip(traction, amplitudes)
    steps, converged, accuracy, violation = 0, False, 0.1, np.inf
    visited, change_fraction, diagonal = {sticks.tobytes()}, 1.0, _diagonal(problem)
    while steps < problem.max_steps and not converged:
        steps += 1
        active_set, rigid_slip = sticks, problem.rigid_slip(amplitudes)
        target, amplitudes = _newton_step(
            problem, traction, slip, sticks, amplitudes, diagonal=diagonal, accuracy=accuracy
        )
        slip = slip - rigid_slip + problem.rigid_slip(amplitudes)
        traction, slip, begins_slip = _search_step(problem, traction, slip, sticks, target, amplitudes)
        begins_slip = _select_first(begins_slip, change_fraction)
        begins_stick = _select_first(~sticks & ((slip * traction).sum(axis=0) < 0), change_fraction)
        sticks = (sticks & ~begins_slip) | begins_stick
        scale = problem.slip_scale(amplitudes)
        missing = np.abs((problem.resultant_weights * traction).sum(axis=(1, 2)) - problem.resultants)
        largest = np.abs(problem.resultant_weights).sum(axis=1) @ bound if len(problem.modes) else np.ones(0)
        previous_violation = violation
        violation = max(
            *law_violation(traction, slip, bound, sticks, scale), float((missing / largest).max(initial=0.0))
        )
        converged = violation <= problem.tolerance
        unchanged = np.array_equal(sticks, active_set)
        # The linear systems are solved more accurately where the last step did not reduce the violation. Speed.
        accuracy = 1e-2 if unchanged or violation > 0.8 * previous_violation else 0.1
        if not unchanged:
            # A repeated active set halves the share of cells that may change at once, in the limit to one (Murty).
            change_fraction = 0.5 * change_fraction if sticks.tobytes() in visited else min(1.0, 2 * change_fraction)
            visited.add(sticks.tobytes())
    return CoulombSolution(
        traction=traction, slip=slip, sticks=sticks, amplitudes=amplitudes, steps=steps, converged=converged
    )


def _search_step(
    problem: CoulombProblem,
    traction: FloatArray,
    slip: FloatArray,
    sticks: BoolArray,
    target: FloatArray,
    amplitudes: FloatArray,
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Step to Newton's tractions within the bound; return tractions, slip and the cells that begin to slip."""
    # Under a shift the law (43) minimises an energy: without its decrease active sets may cycle. Rolling has no energy.
    energy, fraction = problem.energy(traction, slip, amplitudes), 1.0
    while True:
        trial = traction + fraction * (target - traction)
        size = np.hypot(*trial)
        begins_slip = sticks & (size > problem.bound)
        trial = trial * np.where(~sticks | begins_slip, problem.bound / np.where(size > 0, size, 1.0), 1.0)
        trial_slip = problem.slip(trial, amplitudes)
        trial_energy = problem.energy(trial, trial_slip, amplitudes)
        if not problem.symmetric or trial_energy <= energy + ENERGY_ROUNDING * abs(energy) or fraction < MIN_FRACTION:
            return trial, trial_slip, begins_slip
        fraction *= 0.5


def _select_first(cells: BoolArray, fraction: float) -> BoolArray:
    """Select the first cells of a set: a fraction of their number, at least one."""
    if fraction == 1:
        return cells
    indices = np.flatnonzero(cells)
    first = np.zeros_like(cells)
    first[indices[: max(1, int(fraction * indices.size))]] = True
    return first


def _unknown_basis(direction: FloatArray, sticks: BoolArray) -> Any:
    """Sparse matrix from the unknowns to the components of the tractions; `direction` is that of the slip."""
    # Unknowns are both components of a sticking cell's traction, and a slipping cell's component across the slip.
    from scipy.sparse import csr_array

    first = np.where(sticks, np.array([[1.0], [0.0]]), np.stack([-direction[1], direction[0]]))
    cells, sticking = np.arange(sticks.size), np.flatnonzero(sticks)
    rows = np.concatenate([cells, cells.size + cells, cells.size + sticking])
    columns = np.concatenate([cells, cells, cells.size + np.arange(sticking.size)])
    return csr_array((np.append(first, np.ones(sticking.size)), (rows, columns)))


def _newton_step(
    problem: CoulombProblem,
    traction: FloatArray,
    slip: FloatArray,
    sticks: BoolArray,
    amplitudes: FloatArray,
    *,
    diagonal: FloatArray,
    accuracy: float,
) -> tuple[FloatArray, FloatArray]:
    """Tractions and amplitudes of the rigid slips that reduce the residual by the factor `accuracy`."""
    from scipy.sparse.linalg import LinearOperator, gmres

    size, root = np.hypot(*traction), np.sqrt(problem.relative_areas)
    direction = np.where(sticks, 0.0, traction / np.where(size > 0, size, 1.0))
    basis = _unknown_basis(direction, sticks)
    transposed = basis.T.tocsr()

    def tractions_of(unknowns: FloatArray) -> FloatArray:
        return np.asarray((basis @ unknowns).reshape(2, -1) / root)

    def components_of(slip: FloatArray) -> FloatArray:
        return np.asarray(transposed @ (root * slip).ravel())

    parallel = np.maximum((slip * direction).sum(axis=0), 0.0)
    turning = np.append(np.where(sticks, 0.0, parallel / problem.bound), np.zeros(int(sticks.sum())))
    # Spin (1/m) and moment (N m) are scaled to the units of slip, so that one residual contains all unknowns.
    count, shape = turning.size, (len(problem.modes), turning.size)
    sizes = np.hypot(problem.modes[:, 0], problem.modes[:, 1]).max(axis=1, initial=np.finfo(float).tiny)
    modes = np.array([components_of(mode) for mode in problem.modes]).reshape(shape) / sizes[:, None]
    weights = np.array([components_of(work / problem.relative_areas) for work in problem.resultant_weights])
    weights = weights.reshape(shape)
    unit = (np.abs(weights).sum(axis=1) + np.finfo(float).tiny) / float(diagonal.mean())
    weights = weights / unit[:, None]
    diagonal = np.append(diagonal, diagonal[sticks])
    damping = np.sqrt(diagonal / (diagonal + turning))

    def invert(slip: FloatArray) -> FloatArray:
        return np.asarray(damping * components_of(problem.inverse(tractions_of(damping * slip))))

    inverse_modes = np.array([invert(mode) for mode in modes]).reshape(modes.shape)
    schur = weights @ inverse_modes.T

    def multiply(unknowns: FloatArray) -> FloatArray:
        tractions, rigid = unknowns[:count], unknowns[count:]
        slip = components_of(problem.apply_compliance(tractions_of(tractions))) + turning * tractions
        return np.concatenate([slip - rigid @ modes, weights @ tractions])

    def precondition(residual: FloatArray) -> FloatArray:
        tractions = invert(residual[:count])
        if not len(modes):
            return tractions
        rigid = np.linalg.lstsq(schur, residual[count:] - weights @ tractions, rcond=None)[0]
        return np.concatenate([tractions + rigid @ inverse_modes, rigid])

    resultant_errors = (problem.resultants - (problem.resultant_weights * traction).sum(axis=(1, 2))) / unit
    residual = np.concatenate([components_of(slip), resultant_errors])
    # With the preconditioner on the right the residual is the system's. 60 directions, 5 restarts. Speed.
    operator = LinearOperator((residual.size,) * 2, lambda vector: multiply(precondition(vector)), dtype=float)
    change = precondition(gmres(operator, residual, rtol=accuracy, atol=0.0, restart=60, maxiter=5)[0])
    return traction + tractions_of(change[:count]), amplitudes + change[count:] / sizes


def _diagonal(problem: CoulombProblem) -> FloatArray:
    """Slip that a traction relieves in its cell, per traction: array (cell), one value for each width of cells."""
    diagonal = np.empty_like(problem.bound)
    for area in np.unique(problem.relative_areas):
        cells = problem.relative_areas == area
        unit = np.zeros_like(problem.rigid)
        largest = int(np.where(cells, problem.bound, 0.0).argmax())
        unit[1, largest] = 1.0
        diagonal[cells] = abs(1.0 / problem.inverse(unit)[1, largest])
    return diagonal
