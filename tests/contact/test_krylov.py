"""Minimal residuals against a direct solution."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.contact.krylov import minimal_residual


@pytest.mark.parametrize("directions", [4, 30])
def test_a_system_is_solved_with_and_without_restarts(directions: int) -> None:
    random = np.random.default_rng(1)
    matrix = np.eye(20) + 0.1 * random.standard_normal((20, 20))
    rough, asked = np.diag(1 / np.diag(matrix)), random.standard_normal(20)
    found = minimal_residual(matrix.__matmul__, rough.__matmul__, asked, 1e-9, directions=directions, restarts=40)
    assert np.linalg.norm(asked - matrix @ found) <= 1.1e-9 * np.linalg.norm(asked)
    assert found == pytest.approx(np.linalg.solve(matrix, asked), abs=1e-7)


def test_no_residual_asks_for_no_change() -> None:
    assert not minimal_residual(np.copy, np.copy, np.zeros(3), 0.1, directions=3, restarts=2).any()


def test_the_accuracy_is_what_is_left_and_no_more_work_is_done() -> None:
    values = np.linspace(1.0, 2.0, 50)
    calls: list[int] = []

    def matrix(vector: np.ndarray) -> np.ndarray:
        calls.append(1)
        return np.asarray(values * vector)

    found = minimal_residual(matrix, np.copy, np.ones(50), 0.1, directions=50, restarts=5)
    left = np.linalg.norm(1 - values * found) / np.sqrt(50)
    assert 0.01 < left <= 0.1
    assert len(calls) <= 3


@pytest.mark.parametrize("scale", [1e-20, 1.0, 1e20])
def test_the_unit_of_the_matrix_does_not_count(scale: float) -> None:
    random = np.random.default_rng(1)
    matrix, asked = scale * (np.eye(20) + 0.1 * random.standard_normal((20, 20))), random.standard_normal(20)
    found = minimal_residual(matrix.__matmul__, np.copy, asked, 1e-9, directions=30, restarts=2)
    assert np.linalg.norm(asked - matrix @ found) <= 1.1e-9 * np.linalg.norm(asked)


def test_directions_and_restarts_bound_the_work() -> None:
    """The residual is computed anew between two restarts only."""
    values, calls = np.linspace(1.0, 100.0, 50), []

    def matrix(vector: np.ndarray) -> np.ndarray:
        calls.append(1)
        return np.asarray(values * vector)

    minimal_residual(matrix, np.copy, np.ones(50), 1e-12, directions=3, restarts=4)
    assert len(calls) == 3 * 4 + 3
