"""Where Newton's method does not meet prescribed forces at once, they are raised step by step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy.contact import continuation
from contactstudy.contact.continuation import solve_continued
from contactstudy.contact.coulomb import CoulombProblem, CoulombSolution, Guess, solve_coulomb
from tests.contact.test_coulomb import holds, problem


def test_forces_are_raised_where_the_first_try_fails(monkeypatch: pytest.MonkeyPatch) -> None:
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
    monkeypatch.setattr(continuation, "solve_coulomb", fails_far_away)
    near = replace(asked, max_steps=500)
    original = continuation.Guess

    def noted(traction: np.ndarray, amplitudes: np.ndarray) -> Guess:
        reached.append(whole[-1] if len(whole) > 1 else 0.0)
        return original(traction, amplitudes)

    monkeypatch.setattr(continuation, "Guess", noted)
    found = solve_continued(near)
    assert found.converged
    assert whole[0] == whole[-1] == pytest.approx(1.0)
    assert len(whole) >= 5
    holds(asked, found)
    assert found.traction.sum(axis=1) == pytest.approx(asked.resultants, abs=1e-6 * bound.sum())


def test_what_cannot_be_reached_says_so() -> None:
    bound = np.ones(6)
    asked = problem(np.zeros((2, 6)), bound, forces=np.array([0.0, 6.5]))
    assert not solve_continued(replace(asked, max_steps=200)).converged
