"""Continuation in steps of the prescribed forces, for problems where Newton's method fails from zero."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy.contact.rolling import coulomb
from contactstudy.contact.rolling.coulomb import (
    CoulombProblem,
    CoulombSolution,
    Guess,
    solve_coulomb,
    solve_with_continuation,
)
from tests.contact.rolling.test_coulomb import check_law, make_problem


def test_failed_newton_raises_forces_stepwise(monkeypatch: pytest.MonkeyPatch) -> None:
    bound = np.random.default_rng(5).uniform(0.2, 1.0, 30)
    request = make_problem(np.zeros((2, 30)), bound, forces=0.9 * bound.sum() * np.array([0.6, 0.8]), skew=0.5)
    force_fractions: list[float] = []

    def solve_small_steps(trial_problem: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
        computed = solve_coulomb(trial_problem, start)
        if not len(trial_problem.modes):
            return computed
        force_fractions.append(float(np.hypot(*trial_problem.resultants) / np.hypot(*request.resultants)))
        return replace(
            computed,
            converged=computed.converged and (start is not None) and force_fractions[-1] - reached_fractions[-1] < 0.3,
        )

    reached_fractions = [0.0]
    monkeypatch.setattr(coulomb, "solve_coulomb", solve_small_steps)
    request_of_many_steps = replace(request, max_steps=500)
    create_guess = coulomb.Guess

    def record_guess(traction: np.ndarray, amplitudes: np.ndarray) -> Guess:
        reached_fractions.append(force_fractions[-1] if len(force_fractions) > 1 else 0.0)
        return create_guess(traction, amplitudes)

    monkeypatch.setattr(coulomb, "Guess", record_guess)
    computed = solve_with_continuation(request_of_many_steps)
    assert computed.converged
    assert force_fractions[0] == force_fractions[-1] == pytest.approx(1.0)
    assert len(force_fractions) >= 5
    check_law(request, computed)
    assert computed.traction.sum(axis=1) == pytest.approx(request.resultants, abs=1e-6 * bound.sum())


def test_unreachable_forces_do_not_converge() -> None:
    bound = np.ones(6)
    request = make_problem(np.zeros((2, 6)), bound, forces=np.array([0.0, 6.5]))
    assert not solve_with_continuation(replace(request, max_steps=200)).converged


def test_continuation_steps_are_linear_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """The resultants change linearly from those of zero unknown slip to the prescribed ones, in adaptive steps."""
    bound = np.random.default_rng(5).uniform(0.2, 1.0, 12)
    rng = np.random.default_rng(6)
    requested_forces = 0.5 * bound.sum() * np.array([0.6, 0.8])
    request = replace(make_problem(rng.standard_normal((2, 12)), bound, forces=requested_forces), max_steps=500)
    fractions: list[float] = []
    step_counts: list[int] = []
    step_fails = [True, True, False, False, True, True, True, False, False]
    first_resultants = np.zeros(2)

    def record_and_solve(trial_problem: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
        nonlocal first_resultants
        steps = int(rng.integers(1, 5))
        step_counts.append(steps)
        computed = solve_coulomb(trial_problem, start)
        if not len(trial_problem.modes):
            first_resultants = computed.traction.sum(axis=1)
            return replace(computed, steps=steps)
        if len(step_counts) > 1:
            fraction = (
                (trial_problem.resultants - first_resultants)
                @ (requested_forces - first_resultants)
                / ((requested_forces - first_resultants) @ (requested_forces - first_resultants))
            )
            assert trial_problem.resultants == pytest.approx(
                first_resultants + fraction * (requested_forces - first_resultants)
            )
            fractions.append(float(fraction))
        step_failed = step_fails.pop(0) if step_fails else False
        return replace(computed, steps=steps, converged=not step_failed)

    monkeypatch.setattr(coulomb, "solve_coulomb", record_and_solve)
    computed = solve_with_continuation(request)
    assert computed.converged
    assert fractions == pytest.approx([0.5, 0.25, 0.75, 1.0, 1.0, 1.0, 0.875, 1.0])
    assert computed.steps == sum(step_counts)
