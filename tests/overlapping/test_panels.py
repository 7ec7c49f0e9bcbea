"""Graded positions along x: what is interpolated from them."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.overlapping.panels import graded_interpolation


@pytest.mark.parametrize("finite", [True, False])
def test_polynomials_are_interpolated_exactly_whatever_the_positions(finite: bool) -> None:
    """In the middle rounding decides whether a position lies in the last panel or behind it."""
    rng = np.random.default_rng(0)
    for length in rng.uniform(1e-3, 1e3, 20):
        x = np.sort(np.concatenate([length * rng.random(200), [0.0, 0.5 * length, length]]))
        found = graded_interpolation(x, length if finite else np.inf, 8)
        assert found is not None
        positions, matrix = found
        for power in (0, 1, 5):
            assert matrix @ (positions / length) ** power == pytest.approx((x / length) ** power, abs=1e-9)


def test_few_positions_and_those_on_the_ends_are_left_alone() -> None:
    assert graded_interpolation(np.linspace(0.0, 1.0, 11), 1.0, 8) is None
    assert graded_interpolation(np.array([0.0, 1.0]), 1.0, 8) is None
    positions, matrix = graded_interpolation(np.linspace(0.0, 1.0, 401), 1.0, 8) or (np.empty(0), np.empty(0))
    assert matrix[[0, -1], -2:].tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert positions[-2:].tolist() == [0.0, 1.0]
