"""Graded positions along x and the interpolation between them."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.overlapping.quadrature import cell_moments, graded_interpolation, graded_positions


@pytest.mark.parametrize("is_finite", [True, False])
def test_interpolation_is_exact_for_polynomials(is_finite: bool) -> None:
    """Rounding determines whether the position at mid-length lies in the last panel or beyond it."""
    rng = np.random.default_rng(0)
    for length in rng.uniform(1e-3, 1e3, 20):
        x = np.sort(np.concatenate([length * rng.random(200), [0.0, 0.5 * length, length]]))
        computed = graded_interpolation(x, length if is_finite else np.inf)
        assert computed is not None
        positions, matrix = computed
        for power in (0, 1, 5):
            assert matrix @ (positions / length) ** power == pytest.approx((x / length) ** power, abs=1e-9)


def test_few_positions_are_not_interpolated() -> None:
    assert graded_interpolation(np.linspace(0.0, 1.0, 11), 1.0) is None
    assert graded_interpolation(np.array([0.0, 1.0]), 1.0) is None
    positions, matrix = graded_interpolation(np.linspace(0.0, 1.0, 401), 1.0) or (np.empty(0), np.empty(0))
    assert matrix[[0, -1], -2:].tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert positions[-2:].tolist() == [0.0, 1.0]


@pytest.mark.parametrize("unit", [2.0**-17, 1.0, 2.0**17])
def test_cell_moments_are_exact_for_polynomials(unit: float) -> None:
    """The moments are exact up to the degree of a panel; cells outside the panels do not contribute."""
    rng = np.random.default_rng(0)
    edges, positions = graded_positions(4.0 * unit, 0.1 * unit)
    assert edges[0] == 0.0
    assert edges[-1] == pytest.approx(4.0 * unit)
    assert edges[1] == pytest.approx(0.0625 * unit)
    assert edges[2:] / edges[1:-1] == pytest.approx(2.0)
    for _ in range(5):
        cells = np.sort(rng.uniform(-0.5, 4.5, 12))
        moments = cell_moments(edges, positions, unit * cells) / unit
        clipped_edges = np.clip(cells, 0.0, 4.0)
        for power in range(8):
            expected = np.diff(clipped_edges ** (power + 1)) / (power + 1)
            assert (positions / unit) ** power @ moments == pytest.approx(expected, abs=1e-9 * 4.0**power)


@pytest.mark.parametrize("length", [3.0, np.inf])
@pytest.mark.parametrize("unit", [2.0**-17, 1.0])
def test_interpolation_is_symmetric_in_any_unit(length: float, unit: float) -> None:
    x = np.sort(np.append(np.random.default_rng(0).uniform(0.0, 3.0, 600), [0.0, 3.0]))
    computed = graded_interpolation(unit * x, unit * length)
    assert computed is not None
    positions, matrix = computed
    assert positions.size < x.size

    def evaluate_steep_function(positions_at: np.ndarray) -> np.ndarray:
        return np.asarray(1 / (positions_at + 0.02) + (1 / (3.02 - positions_at) if np.isfinite(length) else 0.0))

    assert matrix @ evaluate_steep_function(positions / unit) == pytest.approx(evaluate_steep_function(x), rel=1e-4)
    assert np.isin(unit * x[[0]], positions).all()
    if np.isfinite(length):
        assert np.isin(unit * x[[-1]], positions).all()
        assert positions.max() <= unit * 3.0
    # The interpolation never has more positions than the original.
    for count in range(2, 160):
        nodes = np.linspace(0.0, 3.0, count)
        scaled_interpolation = graded_interpolation(unit * nodes, unit * length)
        assert scaled_interpolation is None or scaled_interpolation[0].size < count
