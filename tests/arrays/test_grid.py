"""Grids of graded cells: properties of the cells, and positions in error messages."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import Grid, InvalidInputError
from contactstudy.arrays.grid import MAX_WIDTH_RATIO, growing_edges, interpolate_columns
from contactstudy.checks import FloatArray

Y_RANGE = (-1.0, 1.0)

RATIOS = st.lists(st.floats(0.3, 3.3), min_size=1, max_size=30)


def compute_edges(ratios: list[float]) -> list[float]:
    return np.append(0.0, np.cumsum(np.cumprod([1.0, *ratios]))).tolist()


@given(ratios=RATIOS)
def test_cells_tile_range(ratios: list[float]) -> None:
    edges = np.array(compute_edges(ratios))
    grid = Grid.from_edges(edges, Y_RANGE, 4)
    assert np.allclose(grid.x_edges, edges, rtol=1e-12)
    assert grid.x_edges[0] == grid.x_range[0]
    assert grid.x_edges[-1] == grid.x_range[1]
    assert grid.shape == (edges.size - 1, 4)
    assert np.all((grid.x > grid.x_edges[:-1]) & (grid.x < grid.x_edges[1:]))
    assert np.allclose(grid.x - 0.5 * grid.widths, grid.x_edges[:-1], atol=1e-12 * edges[-1])
    assert float(grid.weights.sum()) == pytest.approx(grid.cells_x)
    assert float((grid.weights * np.ones(grid.shape)).sum()) * grid.cell_area == pytest.approx(2 * edges[-1])


@given(ratios=RATIOS)
def test_grids_of_equal_edges_are_equal(ratios: list[float]) -> None:
    edges = compute_edges(ratios)
    grid, equal_grid = (Grid.from_edges(edges, Y_RANGE, 4) for _ in range(2))
    assert grid == equal_grid
    assert hash(grid) == hash(equal_grid)
    shifted_edges = [*edges[:-1], edges[-1] * 1.01]
    assert Grid.from_edges(shifted_edges, Y_RANGE, 4) != grid


@given(ratios=RATIOS)
def test_coarsened_grid_keeps_alternate_edges(ratios: list[float]) -> None:
    """Coarsened cells may differ by more than the limit of given cells."""
    grid = Grid.from_edges(compute_edges(ratios), Y_RANGE, 4)
    coarse_grid = grid.coarsened()
    assert coarse_grid.cells_y == 2
    assert coarse_grid.x_range == grid.x_range
    if not grid.uniform:
        assert set(coarse_grid.x_edges[:-1].tolist()) == set(grid.x_edges[:-1:2].tolist())
        assert float(coarse_grid.widths.sum()) == pytest.approx(float(grid.widths.sum()))


def test_equal_widths_make_a_uniform_grid() -> None:
    grid = Grid.from_edges(np.linspace(0.0, 3.0, 7), Y_RANGE, 4)
    assert grid.uniform
    assert grid == Grid(x_range=(0.0, 3.0), y_range=Y_RANGE, cells_x=6, cells_y=4)
    assert np.array_equal(grid.weights, np.ones((6, 1)))


def test_growth_limit_tolerates_rounding() -> None:
    edges = np.append(0.0, np.cumsum(1.3e-6 * MAX_WIDTH_RATIO ** np.arange(8)))
    assert Grid.from_edges(0.1 + edges, Y_RANGE, 4).cells_x == 8


@pytest.mark.parametrize(
    ("edges", "message"),
    [
        ([0.0, 1.0, 1.0, 2.0], r"x_edges = '1, 1 m': must be increasing"),
        ([0.0, 1.0, 0.5, 2.0], r"x_edges = '1, 0.5 m': must be increasing"),
        ([0.0, 1.0, 1.0 + 1e-15, 2.0], r"must be increasing"),
        ([0.0, 1.0, 2.0, 7.0], r"cells of 1 and 5 m next to x = 2 m.*factor of 4"),
        ([0.0, 5.0, 6.0, 7.0], r"cells of 5 and 1 m next to x = 5 m"),
        ([0.0], r"at least two edges"),
        ([0.0, np.nan, 1.0], r"x_edges"),
        ([0.0, np.inf], r"x_edges"),
        ([[0.0, 1.0], [2.0, 3.0]], r"x_edges"),
        ("wide", r"x_edges"),
    ],
)
def test_invalid_edges_raise(edges: object, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        Grid.from_edges(edges, Y_RANGE, 4)


@pytest.mark.parametrize(("y_range", "cells_y"), [((1.0, -1.0), 4), ((0.0, np.inf), 4), ((-1.0, 1.0), 0)])
def test_cells_along_y_are_checked(y_range: tuple[float, float], cells_y: int) -> None:
    with pytest.raises(InvalidInputError):
        Grid.from_edges([0.0, 1.0, 3.0], y_range, cells_y)


@given(distance=st.floats(1e-3, 1e4), width=st.floats(1e-3, 10.0))
def test_growing_edges_cover_distance(distance: float, width: float) -> None:
    edges = growing_edges(distance, width)
    assert edges[-1] == pytest.approx(distance)
    widths = np.diff(np.append(0.0, edges))
    assert np.all(widths > 0)
    assert widths[0] <= width * (1 + 1e-9)
    if edges.size > 1:
        assert np.all(widths[1:] / widths[:-1] < MAX_WIDTH_RATIO)


def test_growing_edges_end_at_zero_and_infinite_distance() -> None:
    assert growing_edges(0.0, 1.0).size == 0
    assert growing_edges(np.inf, 0.5).tolist() == [0.5]


@pytest.mark.parametrize("positions", [np.linspace(-1.0, 8.0, 46), np.array([0.0, 1.0, 3.0, 7.0])])
def test_column_interpolation_is_linear(positions: FloatArray) -> None:
    centres = np.array([0.0, 1.0, 3.0, 7.0])
    cell_values = np.random.default_rng(0).standard_normal((4, 3))
    expected = np.stack([np.interp(positions, centres, row_values) for row_values in cell_values.T], axis=1)
    assert interpolate_columns(cell_values, centres, positions) == pytest.approx(expected, abs=1e-12)
    assert interpolate_columns(cell_values[:1], centres[:1], positions) == pytest.approx(
        np.repeat(cell_values[:1], positions.size, 0)
    )
