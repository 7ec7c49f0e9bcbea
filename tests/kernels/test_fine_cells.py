"""Finer cells under a load: force, moments and images of the load, at any position of the body and in any unit."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.arrays.grid import Points
from contactstudy.checks import FloatArray
from contactstudy.kernels.field import half_space_field, stress_influence
from contactstudy.kernels.fine_cells import (
    MAX_REFINED_DEPTH,
    MIN_RESOLVED_WIDTH,
    PARTS_X,
    PARTS_Y,
    FineCells,
    add_images,
    coarsen,
    resolved_columns,
)
from contactstudy.kernels.load import Load
from contactstudy.kernels.smooth_load import SmoothLoad

EDGES = np.array([0.0, 0.2, 0.5, 0.9, 1.5, 2.3, 2.9, 3.3, 3.6, 3.8])
UNIFORM_EDGES = np.linspace(0.0, 3.8, 10)
LENGTH, PRESSURE = 2.0**-17, 2.0**37
"""Units of length and pressure: powers of two have no rounding errors."""


def make_inclined_pressure(x: FloatArray, y: FloatArray) -> FloatArray:
    """Inclined pressure of a contact that reaches the first end of the body and not the second end."""
    position = 1 - (y / 0.8) ** 2 - np.maximum((x[:, None] - 1.5) / 1.6, 0.0) ** 2
    return np.asarray(np.sqrt(np.maximum(position, 0.0)) * (1 + 0.3 * x[:, None]))


def make_fine_cells(
    *,
    edges: FloatArray = EDGES,
    offset: float = 0.0,
    unit: float = 1.0,
    pressure: float = 1.0,
    image_sign: int = 1,
    ends: int = 2,
) -> FineCells:
    """A load on a body with a number of ends."""
    grid = Grid.between(unit * (edges + offset), (-1.2 * unit, 1.2 * unit), 12)
    cell_loads = pressure * make_inclined_pressure(grid.x / unit - offset, grid.y / unit)
    extent = (unit * offset if ends else -np.inf, unit * (offset + 3.8) if ends == 2 else np.inf)
    return FineCells(load=cell_loads, shape=cell_loads, grid=grid, extent=extent, image_sign=image_sign)


@pytest.mark.parametrize(
    ("ends", "image_sign", "edges"),
    [
        (0, 1, UNIFORM_EDGES),
        (1, -1, UNIFORM_EDGES),
        (2, 1, UNIFORM_EDGES),
        (0, -1, EDGES),
        (1, 1, EDGES),
        (2, -1, EDGES),
    ],
)
def test_results_scale_with_unit_and_position(ends: int, image_sign: int, edges: FloatArray) -> None:
    baseline = make_fine_cells(edges=edges, image_sign=image_sign, ends=ends)
    for position, unit, pressure in ((0.0, LENGTH, PRESSURE), (16.0, 1.0, 1.0), (-32.0, 1.0, 1.0)):
        scaled_cells = make_fine_cells(
            edges=edges, image_sign=image_sign, ends=ends, offset=position, unit=unit, pressure=pressure
        )
        for name in ("x_edges", "edges", "step_edges"):
            assert getattr(scaled_cells, name) / unit - position == pytest.approx(getattr(baseline, name), abs=1e-9), (
                name
            )
        for computed, expected in (
            (scaled_cells.far_load, baseline.far_load),
            (scaled_cells.cell_loads, baseline.cell_loads),
        ):
            assert computed / pressure == pytest.approx(expected, abs=1e-9)
        z = np.array([0.0, 0.1, 0.5, 1.19, 1.21, 2.5, 2.6, 4.0])
        assert scaled_cells.is_refined_along_y(unit * z).tolist() == baseline.is_refined_along_y(z).tolist()
        finer_loads = [
            [
                cells.end_load(),
                cells.fine_load(0.03 * size),
                *([cells.coarse_load(fine_x=False)] if edges is UNIFORM_EDGES else []),
            ]
            for cells, size in ((scaled_cells, unit), (baseline, 1.0))
        ]
        for (computed, grid), (expected, baseline_grid) in zip(*finer_loads, strict=True):
            assert computed / pressure == pytest.approx(expected, abs=1e-9)
            assert grid.x_edges / unit - position == pytest.approx(baseline_grid.x_edges, abs=1e-9)
            assert np.array(grid.y_range) / unit == pytest.approx(baseline_grid.y_range)


@pytest.mark.parametrize("edges", [EDGES, UNIFORM_EDGES], ids=["graded", "uniform"])
def test_refinement_ends_at_maximum_depth(edges: FloatArray) -> None:
    cells = make_fine_cells(edges=edges)
    assert cells.is_refined_along_y(cells.grid.dy * MAX_REFINED_DEPTH * np.array([0.0, 0.99, 1.01, 3.0])).tolist() == [
        True,
        True,
        False,
        False,
    ]
    depths = cells.grid.dx * MAX_REFINED_DEPTH * np.array([0.99, 1.01])
    assert cells.is_refined_along_x(depths).tolist() == [True, False]
    assert cells.x_edges.size == 3 * PARTS_X * cells.grid.cells_x + 1  # with images


@pytest.mark.parametrize("edges", [EDGES, UNIFORM_EDGES], ids=["graded", "uniform"])
def test_constant_load_has_whole_columns(edges: FloatArray) -> None:
    grid = make_fine_cells(edges=edges).grid
    shape = np.where(np.abs(grid.y) < 0.7, 1.0, 0.0) * np.ones(grid.shape)
    varying_load = shape * np.linspace(0.5, 1.0, grid.cells_x)[:, None]
    cells, varying_cells = (FineCells(load=load, shape=shape, grid=grid) for load in (0.3 * shape, varying_load))
    assert np.array_equal(cells.x_edges, grid.x_edges)
    assert cells.is_refined_along_x(np.array([0.0, 100.0 * grid.dx])).all()
    assert varying_cells.x_edges.size == PARTS_X * grid.cells_x + 1


@pytest.mark.parametrize("image_sign", [1, -1])
def test_images_contain_mirrored_load(image_sign: int) -> None:
    """The means over columns between any edges include the images."""
    cells = make_fine_cells(image_sign=image_sign)
    edges_near_first_end = np.array([0.1, 0.3, 0.35, 0.8])
    expected = cells.column_means([edges_near_first_end])
    assert cells.column_means([-edges_near_first_end[::-1]])[::-1] == pytest.approx(image_sign * expected)
    edges_near_second_end = np.array([3.0, 3.1, 3.5, 3.75])
    assert cells.column_means([7.6 - edges_near_second_end[::-1]])[::-1] == pytest.approx(
        image_sign * cells.column_means([edges_near_second_end])
    )
    # The column over an end contains the load and its image by half.
    assert cells.column_means([np.array([-0.2, 0.0, 0.2])]) == pytest.approx(
        np.stack([image_sign * cells.cell_loads[0], cells.cell_loads[0]])
    )
    assert cells.column_means([edges_near_first_end, edges_near_second_end]) == pytest.approx(
        np.vstack([expected, cells.column_means([edges_near_second_end])])
    )


@pytest.mark.parametrize("ends", [0, 1, 2])
def test_far_load_keeps_force_and_moment(ends: int) -> None:
    """The far load has force and moment of the smooth load with its images."""
    cells = make_fine_cells(ends=ends)
    smooth_load = SmoothLoad.of(cells.cell_loads.T, cells.grid.x_edges).shape_loads(cells.cell_loads.T)
    forces = add_images(cells.far_load, 1, cells.extent) * np.diff(cells.edges)[:, None]
    centres = 0.5 * (cells.edges[1:] + cells.edges[:-1])
    image_count = 1 + (ends > 0) + (ends > 1)
    column_forces = (cells.cell_loads * cells.grid.widths[:, None]).sum(axis=0)
    assert forces.sum(axis=0) == pytest.approx(image_count * column_forces)
    if not ends:
        column_moments = smooth_load.moments + cells.grid.x * smooth_load.cell_means * cells.grid.widths
        assert (forces * centres[:, None]).sum(axis=0) == pytest.approx(column_moments.sum(axis=1))
    elif ends == 1:  # about the end the moments of load and image cancel
        assert (forces * centres[:, None]).sum(axis=0) == pytest.approx(np.zeros(column_forces.size), abs=1e-9)


@pytest.mark.parametrize("offset", [0.0, 0.03, -0.03, 0.07, -0.1, 0.1])
def test_fine_cells_centre_points_and_keep_force(offset: float) -> None:
    fine_cells = make_fine_cells(edges=UNIFORM_EDGES, ends=1)
    cells, grid = fine_cells.fine_load(offset)
    step = fine_cells.grid.dy / PARTS_Y
    assert grid.dy == pytest.approx(step)
    position = (fine_cells.grid.y + offset - grid.y_range[0]) / step - 0.5
    assert position == pytest.approx(np.round(position), abs=1e-9)
    assert grid.y_range[0] <= fine_cells.y_edges[0] + 1e-12
    assert grid.y_range[1] >= fine_cells.y_edges[-1] - 1e-12
    assert grid.cells_y - PARTS_Y * fine_cells.count == (abs(offset) in (0.03, 0.07, 0.1))
    force = cells.sum(axis=1) * step * grid.widths
    expected = fine_cells.cell_loads.sum(axis=1) * fine_cells.grid.dy * fine_cells.grid.widths
    assert force.sum() == pytest.approx(expected.sum())
    cell_forces = force.reshape(fine_cells.grid.cells_x, -1).sum(axis=1)
    assert cell_forces == pytest.approx(expected, rel=0.05, abs=0.02 * expected.max())
    moment = (cells.T * grid.widths).sum(axis=1) @ grid.y * step
    assert moment == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("min_width", [0.0, 0.3, 1.0])
def test_resolved_columns_are_wide_over_distance(min_width: float) -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        edges = 5.0 + np.cumsum(np.cumprod(rng.uniform(0.4, 2.5, 12)))
        x = float(rng.uniform(edges[0], edges[-1]))
        widths, distance = np.diff(edges), np.abs(0.5 * (edges[1:] + edges[:-1]) - x)
        low, high = resolved_columns(edges, x, min_width)
        first_column = last_column = int(distance.argmin())
        while first_column > 0 and widths[first_column - 1] > MIN_RESOLVED_WIDTH * distance[first_column - 1]:
            first_column -= 1
        while (
            last_column + 1 < widths.size and widths[last_column + 1] > MIN_RESOLVED_WIDTH * distance[last_column + 1]
        ):
            last_column += 1
        resolved = [index for index in range(first_column, last_column + 1) if widths[index] > min_width]
        assert (low, high) == ((resolved[0], resolved[-1] + 1) if resolved else (low, low))


@pytest.mark.parametrize("parts", [PARTS_X, PARTS_Y])
def test_coarse_cells_keep_six_moments(parts: int) -> None:
    fine_loads = np.random.default_rng(0).random((4 * parts, 2))
    loads = coarsen(fine_loads, parts)

    def compute_moments(values: FloatArray, edges: FloatArray) -> FloatArray:
        powers = [np.diff(edges ** (order + 1)) / (order + 1) for order in range(7)]
        return np.asarray(powers @ values)

    expected = compute_moments(fine_loads, np.linspace(0.0, 4.0, 4 * parts + 1))
    assert compute_moments(loads, np.arange(-3.0, 8.0)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("ends", "image_sign"), [(0, 1), (1, -1), (2, 1)])
def test_distribution_is_linear_in_the_load(ends: int, image_sign: int) -> None:
    """Loads of one shape add up, also outside the shape; half of the load has half of the values, bit for bit."""
    fine_cells = make_fine_cells(edges=UNIFORM_EDGES, ends=ends, image_sign=image_sign)
    rng = np.random.default_rng(1)
    first_load, second_load = (
        rng.random(fine_cells.grid.shape),
        rng.random(fine_cells.grid.shape) * (fine_cells.load > 0),
    )

    def evaluate_loads(load: FloatArray) -> list[FloatArray]:
        cells = FineCells(
            load=load, shape=fine_cells.shape, grid=fine_cells.grid, extent=fine_cells.extent, image_sign=image_sign
        )
        columns = cells.column_means([np.linspace(0.1, 3.7, 30)])
        complete = cells.coarse_load(fine_x=False)[0]
        return [cells.fine_load(0.03)[0], complete, cells.end_load()[0], columns]

    # The cells along y contain load and shape.
    second_load[:, [0, -1]] = first_load[:, [0, -1]] = 1.0
    for first_values, second_values, sum_values in zip(
        evaluate_loads(first_load),
        evaluate_loads(second_load),
        evaluate_loads(first_load + 2 * second_load),
        strict=True,
    ):
        assert sum_values == pytest.approx(first_values + 2 * second_values, abs=1e-12)
    for first_values, half_values in zip(
        evaluate_loads(fine_cells.load), evaluate_loads(0.5 * fine_cells.load), strict=True
    ):
        assert np.array_equal(first_values, 2 * half_values)


@pytest.mark.parametrize("crown", [0.0, 0.04])
@pytest.mark.parametrize("edges", [EDGES, UNIFORM_EDGES], ids=["graded", "uniform"])
def test_tractions_on_the_top_keep_their_bound(edges: FloatArray, crown: float) -> None:
    """The traction is at most the pressure, at any ratios of the cells and any position, also under a flat pressure."""
    grid = Grid.between(edges, (-1.2, 1.2), 20)
    mid_x = 0.5 * (edges[0] + edges[-1])
    pressure = np.sqrt(np.maximum(1 - crown * (grid.x[:, None] - mid_x) ** 2 - grid.y**2, 0.0))
    rng = np.random.default_rng(0)
    bent_ratio = np.clip(np.abs(grid.y - 0.3) * 2 + 0.1 * grid.x[:, None], 0.0, 1.0)
    x = np.concatenate([grid.x, (edges[:-1, None] + np.diff(edges)[:, None] * [0.1, 0.3, 0.9]).ravel()])
    for ratio, angle in (
        (rng.random(grid.shape) ** 0.2, rng.uniform(0.0, 7.0, grid.shape)),
        (bent_ratio, 0.5 * grid.x[:, None]),
    ):
        loads = {
            Load.NORMAL: pressure,
            Load.ALONG_X: pressure * ratio * np.cos(angle),
            Load.ALONG_Y: pressure * ratio * np.sin(angle),
        }
        for positions in (grid.x, np.sort(x)):
            points = Points(positions, np.linspace(-0.95, 0.95, 61), np.zeros(1))
            top_stresses = {
                load: half_space_field(
                    values, stress_influence(load, 0.3), grid, points, extent=(-np.inf, np.inf), shape=pressure
                )
                for load, values in loads.items()
            }
            normal = -top_stresses[Load.NORMAL][2]
            traction = np.hypot(top_stresses[Load.ALONG_X][4], top_stresses[Load.ALONG_Y][5])
            is_off_border = normal > 0.05 * normal.max()
            assert (traction / normal)[is_off_border].max() < 1.0005


@pytest.mark.parametrize("offset", [0.0, 0.03])
def test_fine_cells_extend_to_load_border(offset: float) -> None:
    """The fine cells include the last cells of the grid along y."""
    grid = Grid.between(UNIFORM_EDGES, (-1.2, 1.2), 12)
    cells = make_inclined_pressure(grid.x, 0.6 * grid.y)
    assert cells[:, [0, -1]].any()
    computed, fine_cells = FineCells(load=cells, shape=cells, grid=grid).fine_load(offset)
    assert computed.sum() * fine_cells.cell_area == pytest.approx(cells.sum() * grid.cell_area)
