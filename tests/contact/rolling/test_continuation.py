"""Where Newton's method does not meet prescribed forces at once, they are raised step by step."""

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
from tests.contact.rolling.test_coulomb import holds, problem


def test_failed_newton_raises_forces_stepwise(monkeypatch: pytest.MonkeyPatch) -> None:
    bound = np.random.default_rng(5).uniform(0.2, 1.0, 30)
    asked = problem(np.zeros((2, 30)), bound, forces=0.9 * bound.sum() * np.array([0.6, 0.8]), skew=0.5)
    whole: list[float] = []

    def fails_far_away(each: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
        found = solve_coulomb(each, start)
        if not len(each.modes):
            return found
        whole.append(float(np.hypot(*each.resultants) / np.hypot(*asked.resultants)))
        return replace(found, converged=found.converged and (start is not None) and whole[-1] - reached[-1] < 0.3)

    reached = [0.0]
    monkeypatch.setattr(coulomb, "solve_coulomb", fails_far_away)
    near = replace(asked, max_steps=500)
    original = coulomb.Guess

    def noted(traction: np.ndarray, amplitudes: np.ndarray) -> Guess:
        reached.append(whole[-1] if len(whole) > 1 else 0.0)
        return original(traction, amplitudes)

    monkeypatch.setattr(coulomb, "Guess", noted)
    found = solve_with_continuation(near)
    assert found.converged
    assert whole[0] == whole[-1] == pytest.approx(1.0)
    assert len(whole) >= 5
    holds(asked, found)
    assert found.traction.sum(axis=1) == pytest.approx(asked.resultants, abs=1e-6 * bound.sum())


def test_unreachable_forces_do_not_converge() -> None:
    bound = np.ones(6)
    asked = problem(np.zeros((2, 6)), bound, forces=np.array([0.0, 6.5]))
    assert not solve_with_continuation(replace(asked, max_steps=200)).converged


def test_continuation_steps_are_linear_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the resultants without unknown slips to the prescribed ones: longer steps after success, else shorter."""
    bound = np.random.default_rng(5).uniform(0.2, 1.0, 12)
    random = np.random.default_rng(6)
    wanted = 0.5 * bound.sum() * np.array([0.6, 0.8])
    asked = replace(problem(random.standard_normal((2, 12)), bound, forces=wanted), max_steps=500)
    parts: list[float] = []
    counts: list[int] = []
    fails = [True, True, False, False, True, True, True, False, False]
    first = np.zeros(2)

    def told(each: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
        nonlocal first
        steps = int(random.integers(1, 5))
        counts.append(steps)
        found = solve_coulomb(each, start)
        if not len(each.modes):
            first = found.traction.sum(axis=1)
            return replace(found, steps=steps)
        if len(counts) > 1:
            along = (each.resultants - first) @ (wanted - first) / ((wanted - first) @ (wanted - first))
            assert each.resultants == pytest.approx(first + along * (wanted - first))
            parts.append(float(along))
        failed = fails.pop(0) if fails else False
        return replace(found, steps=steps, converged=not failed)

    monkeypatch.setattr(coulomb, "solve_coulomb", told)
    found = solve_with_continuation(asked)
    assert found.converged
    assert parts == pytest.approx([0.5, 0.25, 0.75, 1.0, 1.0, 1.0, 0.875, 1.0])
    assert found.steps == sum(counts)
