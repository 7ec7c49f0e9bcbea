"""Fields under columns of any width: against uniform cells, split columns, additivity, distant columns."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contactstudy import Grid
from contactstudy.arrays.grid import Points
from contactstudy.cache import ArrayKey
from contactstudy.checks import FloatArray
from contactstudy.kernels.column_fields import (
    LateralAxis,
    _split_around,
    _SplitRange,
    columns_field,
    common_step,
    split_columns,
)
from contactstudy.kernels.corner_sums import Layer
from contactstudy.kernels.field import displacement_influence, half_space_field, stress_influence
from contactstudy.kernels.fine_cells import FineCells, add_images, resolved_columns
from contactstudy.kernels.images import Influence
from contactstudy.kernels.load import Load

LENGTH, POISSON = 2.0, 0.3
EXTENTS = {"none": (-np.inf, np.inf), "first": (0.0, np.inf), "last": (-np.inf, LENGTH), "both": (0.0, LENGTH)}
X, Z = np.array([0.0, 0.3, 1.0, LENGTH]), np.array([0.05, 0.5])


def compute_stresses(load: Load) -> Influence:
    return stress_influence(load, POISSON)


def compute_displacements(load: Load, extent: tuple[float, float]) -> Influence:
    return displacement_influence(load, POISSON, extent[1] - extent[0], 20.0)


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
def test_columns_reproduce_field_of_uniform_cells(load: Load, extent: str) -> None:
    grid = Grid(x_range=(0.0, LENGTH), y_range=(-1.0, 1.0), cells_x=20, cells_y=16)
    cells = np.random.default_rng(0).random(grid.shape)
    cells[:, :3] = 0
    # Displacements of an infinite row of images are differences of large numbers.
    for influence, tolerance in ((compute_stresses(load), 2e-7), (compute_displacements(load, EXTENTS[extent]), 3e-6)):
        for y in (grid.y, np.array([0.1, 0.33])):
            expected = half_space_field(cells, influence, grid, Points(X, y, Z), extent=EXTENTS[extent])
            computed = columns_field(cells, None, influence, grid, Points(X, y, Z), extent=EXTENTS[extent])
            assert computed.shape == expected.shape
            assert np.abs(computed - expected).max() < tolerance * np.abs(expected).max()


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
def test_shifted_body_has_equal_field(load: Load, extent: str) -> None:
    fields = []
    for position in (0.0, 8.0):
        grid = Grid.from_edges(position + np.array([0.0, 0.2, 0.7, 1.1, 1.6, LENGTH]), (-1.0, 1.0), 6)
        ends = (EXTENTS[extent][0] + position, EXTENTS[extent][1] + position)
        cells = np.random.default_rng(2).random(grid.shape)
        fields.append(
            columns_field(
                cells, None, compute_stresses(load), grid, Points(position + X, np.array([0.1]), Z), extent=ends
            )
        )
    assert np.abs(fields[1] - fields[0]).max() < 1e-9 * np.abs(fields[0]).max()


GRADED_INDICES = np.array([0, 1, 2, 3, 5, 7, 10, 14, 17, 18, 19, 20])
"""Indices of the edges of twenty uniform cells that are edges of the graded cells."""


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
def test_columns_match_finer_uniform_cells(load: Load, extent: str) -> None:
    uniform_grid = Grid(x_range=(0.0, LENGTH), y_range=(-1.0, 1.0), cells_x=20, cells_y=16)
    graded_grid = Grid.from_edges(uniform_grid.x_edges[GRADED_INDICES], (-1.0, 1.0), 16)
    cells = np.random.default_rng(1).random(graded_grid.shape)
    uniform_load = np.repeat(cells, np.diff(GRADED_INDICES), axis=0)
    influence, y = compute_stresses(load), np.array([-0.4, 0.0, 0.1, 0.33, 0.9])
    expected = half_space_field(uniform_load, influence, uniform_grid, Points(X, y, Z), extent=EXTENTS[extent])
    computed = columns_field(cells, None, influence, graded_grid, Points(X, y, Z), extent=EXTENTS[extent])
    # The field of the columns is interpolated along y at the larger depth.
    assert np.abs(computed - expected).max() < 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
@pytest.mark.parametrize("column", [7, 10])
def test_single_loaded_column_keeps_position(load: Load, extent: str, column: int) -> None:
    # Columns are split so that each point lies at the centre of a column; the load keeps its position.
    graded_grid = Grid.from_edges(np.linspace(0.0, LENGTH, 21)[GRADED_INDICES], (-1.0, 1.0), 16)
    cells = np.zeros(graded_grid.shape)
    cells[column] = np.sqrt(np.maximum(1 - (graded_grid.y / 0.6) ** 2, 0))
    fine_load = FineCells(load=cells, shape=cells, grid=graded_grid, extent=EXTENTS[extent], image_sign=load.sign_x)
    uniform_grid = Grid(
        x_range=(0.0, LENGTH),
        y_range=(float(fine_load.y_edges[0]), float(fine_load.y_edges[-1])),
        cells_x=20,
        cells_y=9 * fine_load.cell_loads.shape[1],
    )
    smooth_load = fine_load.shape_along_y(fine_load.cell_loads, fine_load.cell_loads)
    means = (
        np.diff(smooth_load.integral(np.linspace(*uniform_grid.y_range, uniform_grid.cells_y + 1)), axis=1)
        / uniform_grid.dy
    )
    uniform_load = np.repeat(means, np.diff(GRADED_INDICES), axis=0)
    influence, x, y = compute_stresses(load), np.linspace(0.05, 1.95, 21), np.array([0.0, 0.3])
    for z in (np.array([0.15]), np.array([0.4])):
        expected = half_space_field(uniform_load, influence, uniform_grid, Points(x, y, z), extent=EXTENTS[extent])
        computed = columns_field(cells, cells, influence, graded_grid, Points(x, y, z), extent=EXTENTS[extent])
        assert np.abs(computed - expected).max() < 1e-3 * np.abs(expected).max()


@pytest.mark.parametrize("extent", EXTENTS)
def test_wide_columns_represent_smooth_load(extent: str) -> None:
    """The fine columns are thirds of columns 0.4 wide; steps of the load would cause an error of 9 %."""
    scale = 1e-3
    graded_grid = Grid.from_edges(scale * np.linspace(0.0, LENGTH, 21)[GRADED_INDICES], (-scale, scale), 16)
    lateral_profile = np.sqrt(np.maximum(1 - (graded_grid.y / (0.6 * scale)) ** 2, 0))
    cells = np.exp(-((graded_grid.x[:, None] / scale - 1.3) ** 2) / 0.2) * lateral_profile
    ends = (scale * EXTENTS[extent][0], scale * EXTENTS[extent][1])
    fine_load = FineCells(load=cells, shape=cells, grid=graded_grid, extent=ends)
    y_range = (float(fine_load.y_edges[0]), float(fine_load.y_edges[-1]))
    uniform_grid = Grid(
        x_range=(0.0, scale * LENGTH), y_range=y_range, cells_x=100, cells_y=9 * fine_load.cell_loads.shape[1]
    )
    column_loads = fine_load.column_means([uniform_grid.x_edges])
    integral = fine_load.shape_along_y(column_loads, column_loads).integral(
        np.linspace(*y_range, uniform_grid.cells_y + 1)
    )
    uniform_load = np.diff(integral, axis=1) / uniform_grid.dy
    influence, x, y = compute_stresses(Load.NORMAL), scale * np.linspace(0.1, 1.9, 13), np.array([0.0, 0.3 * scale])
    for z in (np.array([0.05 * scale]), np.array([0.3 * scale])):
        expected = half_space_field(uniform_load, influence, uniform_grid, Points(x, y, z), extent=ends)
        computed = columns_field(cells, cells, influence, graded_grid, Points(x, y, z), extent=ends)
        assert np.abs(computed - expected).max() < 0.02 * np.abs(expected).max()


@pytest.mark.parametrize(
    ("column", "extent", "image_sign", "expected"),
    [
        (3, "none", 1, [0.3, 0.5]),
        (3, "last", 1, [0.3, 0.5, 3.5, 3.7]),
        (10, "both", 1, [-1.9, 1.9, 2.1]),
        (10, "both", -1, [-2.0, -1.9, 1.9, 2.0, 2.1]),
    ],
)
def test_step_edges_of_load(column: int, extent: str, image_sign: int, expected: list[float]) -> None:
    graded_grid = Grid.from_edges(np.linspace(0.0, LENGTH, 21)[GRADED_INDICES], (-1.0, 1.0), 16)
    cells = np.zeros(graded_grid.shape)
    cells[column] = np.sqrt(np.maximum(1 - (graded_grid.y / 0.6) ** 2, 0))
    steps = FineCells(
        load=1e-3 * cells, shape=1e-3 * cells, grid=graded_grid, extent=EXTENTS[extent], image_sign=image_sign
    ).step_edges
    assert np.unique(steps.round(9)).tolist() == pytest.approx(expected)


@pytest.mark.parametrize("load", Load)
def test_joint_depths_equal_separate_depths(load: Load) -> None:
    # The field of distant columns is interpolated over the depth; a single depth has no interpolation.
    edges = np.concatenate([np.linspace(0.0, 2.0, 9), np.geomspace(2.5, 60.0, 24)])
    graded_grid = Grid.from_edges(edges, (-1.0, 1.0), 16)
    cells = np.exp(-graded_grid.x[:, None] / 20) * np.sqrt(np.maximum(1 - (graded_grid.y / 0.8) ** 2, 0))
    influence, y, z = compute_stresses(load), np.array([-0.2, 0.3]), np.linspace(0.0, 6.0, 25)
    x, extent = np.array([0.0, 0.7, 9.0, 40.0, 60.0]), (0.0, 60.0)
    joint_field = columns_field(cells, cells, influence, graded_grid, Points(x, y, z), extent=extent)
    for depth_index in (0, 1, 8, 24):
        depth_field = columns_field(
            cells, cells, influence, graded_grid, Points(x, y, z[depth_index : depth_index + 1]), extent=extent
        )
        # At a single small depth, columns near a point are split further than for all depths together.
        assert np.abs(joint_field[..., depth_index] - depth_field[..., 0]).max() < 2e-4 * np.abs(joint_field).max()


@pytest.mark.parametrize("load", Load)
def test_distant_field_equals_point_load(load: Load) -> None:
    graded_grid = Grid.from_edges([0.0, 0.2, 0.6, 1.0], (-1.0, 1.0), 16)
    cells = np.ones((3, 1)) * np.sqrt(np.maximum(1 - (graded_grid.y / 0.8) ** 2, 0))
    point = Grid.from_edges([0.45, 0.55], (-0.05, 0.05), 1)
    force = float((cells * graded_grid.widths[:, None]).sum() * graded_grid.dy)
    influence, x, y, z = (
        compute_stresses(load),
        np.array([-60.0, 50.0, 70.0]),
        np.array([0.0, 3.0]),
        np.array([1.0, 40.0]),
    )
    computed = columns_field(cells, cells, influence, graded_grid, Points(x, y, z), extent=EXTENTS["none"])
    expected = columns_field(
        np.full((1, 1), force / 0.01), None, influence, point, Points(x, y, z), extent=EXTENTS["none"]
    )
    assert np.abs(computed - expected).max() < 5e-4 * np.abs(expected).max()


def test_zero_load_has_zero_field() -> None:
    grid = Grid.from_edges([0.0, 0.5, 2.0], (-1.0, 1.0), 4)
    field = half_space_field(
        np.zeros(grid.shape), compute_stresses(Load.NORMAL), grid, Points(X, grid.y, Z), extent=EXTENTS["both"]
    )
    assert field.shape == (6, X.size, grid.y.size, Z.size)
    assert not field.any()


@st.composite
def draw_graded_loads(draw: st.DrawFn) -> tuple[Grid, FloatArray]:
    """Columns of any widths, and a load on them."""
    ratios = draw(st.lists(st.floats(0.3, 3.0), min_size=1, max_size=10))
    edges = np.append(0.0, np.cumsum(np.cumprod([1.0, *ratios])))
    grid = Grid.from_edges(LENGTH * edges / edges[-1], (-1.0, 1.0), 6)
    return grid, np.random.default_rng(draw(st.integers(0, 1000))).random(grid.shape)


@settings(max_examples=10)
@given(grid_and_load=draw_graded_loads(), load=st.sampled_from(list(Load)), extent=st.sampled_from(["none", "both"]))
def test_mirrored_load_has_mirrored_field(grid_and_load: tuple[Grid, FloatArray], load: Load, extent: str) -> None:
    grid, cells = grid_and_load
    backwards = Grid.from_edges(LENGTH - grid.x_edges[::-1], (-1.0, 1.0), 6)
    influence, y = compute_stresses(load), np.array([-0.4, 0.1])
    field_of_cells = columns_field(cells, None, influence, grid, Points(X, y, Z), extent=EXTENTS[extent])
    mirrored_field = columns_field(
        cells[::-1], None, influence, backwards, Points(LENGTH - X[::-1], y, Z), extent=EXTENTS[extent]
    )
    sign = np.array(influence.sign_along_x)[:, None, None, None]
    assert np.abs(field_of_cells - sign * mirrored_field[:, ::-1]).max() < 1e-8 * np.abs(field_of_cells).max()


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
@pytest.mark.parametrize("is_shaped", [True, False])
def test_symmetric_load_equals_sum_of_halves(load: Load, extent: str, *, is_shaped: bool) -> None:
    """Positions of a symmetric load are evaluated in one half; some of them lie on edges of its columns."""
    first_half = np.array([0.0, 0.1, 0.25, 0.5, 0.85])
    grid = Grid.from_edges(np.append(first_half, LENGTH - first_half[::-1]), (-1.0, 1.0), 8)
    shape = np.sqrt(np.maximum(1 - (grid.y / 0.9) ** 2 - 0.3 * (grid.x[:, None] - 0.5 * LENGTH) ** 2, 0.0))
    half_load = shape * (1 + grid.y) * (grid.x < 0.5 * LENGTH)[:, None]
    half_load[grid.cells_x // 2] *= 0.5
    x, y = np.array([0.0, 0.02, 0.25, 0.3, 0.5 * LENGTH, LENGTH - 0.3, 1.75, 1.9, LENGTH]), np.array([-0.4, 0.1])
    for influence in (compute_stresses(load), compute_displacements(load, EXTENTS[extent])):
        first_field, second_field, sum_field = (
            columns_field(cells, shape if is_shaped else None, influence, grid, Points(x, y, Z), extent=EXTENTS[extent])
            for cells in (half_load, half_load[::-1], half_load + half_load[::-1])
        )
        assert np.abs(first_field + second_field - sum_field).max() < 1e-11 * np.abs(first_field).max()


@settings(max_examples=2)
@given(grid_and_load=draw_graded_loads())
def test_normal_stress_integrates_to_load(grid_and_load: tuple[Grid, FloatArray]) -> None:
    grid, cells = grid_and_load
    depth, half_range, points = 0.6, 40.0, 41
    # The points are dense near the load: y = sinh(s).
    positions = np.linspace(-1.0, 1.0, points) * np.arcsinh(half_range / depth)
    distances, steps = depth * np.sinh(positions), depth * np.cosh(positions) * (positions[1] - positions[0])
    field = columns_field(
        cells,
        None,
        compute_stresses(Load.NORMAL),
        grid,
        Points(1.0 + distances, distances, np.array([depth])),
        extent=EXTENTS["none"],
    )[2, :, :, 0]
    work = -float(steps @ field @ steps)
    total_load = float((cells * grid.widths[:, None]).sum() * grid.dy)
    assert work == pytest.approx(total_load, rel=2e-3)


EDGES = np.array([0.0, 0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 2.4, 2.7, 2.9, 3.0])
UNIT, PRESSURE = 2.0**-17, 2.0**37
OFFSETS = (0.0, 1e-12, 0.02, 0.05, 0.07, 0.3, 0.4, 0.75, 1.5, 1.7, 2.2, 2.95, 3.0)


def make_fine_cells(
    offset: float = 0.0, unit: float = 1.0, *, ends: int = 2, image_sign: int = 1, steps: bool = False
) -> FineCells:
    """A load on both ends of a body, with optional steps between columns."""
    grid = Grid.between(unit * (EDGES + offset), (-unit, unit), 8)
    x, y = grid.x[:, None] / unit - offset, grid.y / unit
    cells = np.sqrt(np.maximum(1 - (y / 0.9) ** 2, 0.0)) * (1 + 0.4 * np.sin(2 * x))
    if steps:
        cells = np.where((x > 0.6) & (x < 2.4), cells, 0.0)
    extent = (unit * offset if ends else -np.inf, unit * (offset + 3.0) if ends == 2 else np.inf)
    load = (PRESSURE if unit < 1 else 1.0) * cells
    return FineCells(load=load, shape=load, grid=grid, extent=extent, image_sign=image_sign)


def split_around(x: float, fine_cells: FineCells, narrow_distance: float = 0.0) -> _SplitRange:
    return _split_around(x, fine_cells, narrow_distance)


@pytest.mark.parametrize("x", OFFSETS)
@pytest.mark.parametrize("narrow_distance", [0.0, 0.15, 5.0])
@pytest.mark.parametrize("steps", [False, True])
def test_results_scale_with_unit_and_position(x: float, narrow_distance: float, *, steps: bool) -> None:
    for ends in (0, 1, 2):
        plain_cells = make_fine_cells(ends=ends, steps=steps)
        baseline = split_around(x, plain_cells, narrow_distance)
        for position, unit in ((0.0, UNIT), (8.0, 1.0), (-32.0, 1.0)):
            cells = make_fine_cells(position, unit, ends=ends, steps=steps)
            scaled_parts = split_around(unit * (x + position), cells, unit * narrow_distance)
            if x == 1e-12 and position:  # equal to 0 within rounding at this position
                continue
            assert (scaled_parts.start, scaled_parts.stop) == (baseline.start, baseline.stop)
            assert scaled_parts.inserted_edges / unit - position == pytest.approx(baseline.inserted_edges, abs=1e-9)
            factor = PRESSURE if unit < 1 else 1.0
            assert scaled_parts.moment_loads(cells) / factor == pytest.approx(
                baseline.moment_loads(plain_cells), abs=1e-9
            )
            for half_range in (0.0, 0.3137, 1.0731, 9.0):
                column_range = scaled_parts.range_within(cells.edges, unit * (x + position), unit * half_range)
                assert column_range == baseline.range_within(plain_cells.edges, x, half_range)


@pytest.mark.parametrize("x", OFFSETS)
@pytest.mark.parametrize("image_sign", [1, -1])
def test_inserted_columns_preserve_force(x: float, image_sign: int) -> None:
    cells = make_fine_cells(image_sign=image_sign)
    split_range = split_around(x, cells)
    forces = add_images(cells.far_load, image_sign, cells.extent) * np.diff(cells.edges)[:, None]
    inserted_loads = cells.column_means([split_range.inserted_edges]) + split_range.moment_loads(cells)
    inserted_force = (inserted_loads * np.diff(split_range.inserted_edges)[:, None]).sum(axis=0)
    outside = forces.sum(axis=0) - forces[split_range.start : split_range.stop].sum(axis=0)
    assert inserted_force + outside == pytest.approx(forces.sum(axis=0), abs=1e-9)
    assert split_range.inserted_edges[0] == cells.edges[split_range.start]
    assert split_range.inserted_edges[-1] == cells.edges[split_range.stop]
    assert (np.diff(split_range.inserted_edges) > 0).all()


@pytest.mark.parametrize("x", [0.02, 0.07, 0.3, 0.4, 0.75, 1.5, 1.7, 2.2, 2.95])
def test_narrow_columns_surround_point(x: float) -> None:
    """The columns are a quarter as wide as the column of the point, on an edge as the narrower neighbour."""
    cells = make_fine_cells()
    edges = split_around(x, cells).inserted_edges
    column = int(np.searchsorted(edges, x)) - 1
    assert 0.5 * (edges[column] + edges[column + 1]) == pytest.approx(x)
    widths = np.diff(edges)
    assert widths[column - 1] == pytest.approx(widths[column])
    assert widths[column + 1] == pytest.approx(widths[column])
    fine_edges = cells.x_edges
    is_adjacent = np.flatnonzero((fine_edges[:-1] <= x + 1e-12) & (fine_edges[1:] >= x - 1e-12))
    assert widths[column] == pytest.approx(0.25 * np.diff(fine_edges)[is_adjacent].min())
    low, high = resolved_columns(cells.edges, x)
    assert np.isin(edges[[0, -1]], cells.edges[[max(low - 1, 0), min(high + 1, cells.edges.size - 1)]]).all()
    distant_edges = fine_edges[
        (fine_edges > cells.edges[low])
        & (fine_edges < cells.edges[high])
        & (np.abs(fine_edges - x) > 2.1 * widths[column])
    ]
    assert np.isin(distant_edges, edges).all()


def test_inserted_columns_stop_at_load_step() -> None:
    cells = make_fine_cells(steps=True)
    (step,) = cells.step_edges[np.abs(cells.step_edges - 0.6) < 1e-9]
    for distance in (0.001, 0.004, 0.01):
        for x in (step - distance, step + distance):
            edges = split_around(float(x), cells).inserted_edges
            column = int(np.searchsorted(edges, x)) - 1
            assert 0.5 * (edges[column] + edges[column + 1]) == pytest.approx(x)
            assert not edges[column - 1] < step - 1e-12 < step + 1e-12 < edges[column + 2]
    edges = split_around(float(step), cells).inserted_edges  # on the step itself by the least width
    assert np.diff(edges).min() == pytest.approx(1e-3 * 0.1, rel=0.5)


@pytest.mark.parametrize("narrow_distance", [0.0, 0.02])
def test_rounding_before_edge_equals_edge(narrow_distance: float) -> None:
    """Points on both sides of an edge have equal columns, also at the outermost split column next to narrow columns."""
    edges = np.concatenate([[0.0, 1.0], np.linspace(2.0, 2.1, 11)])
    grid = Grid.between(edges, (-1.0, 1.0), 4)
    cells = FineCells(load=PRESSURE * np.ones(grid.shape), shape=PRESSURE * np.ones(grid.shape), grid=grid)
    edges_at_edge = split_around(2.0, cells, narrow_distance).inserted_edges
    for direction in (-np.inf, np.inf):
        adjacent = split_around(float(np.nextafter(2.0, direction)), cells, narrow_distance).inserted_edges
        assert np.diff(adjacent).min() == pytest.approx(np.diff(edges_at_edge).min(), rel=0.6)


def test_point_on_end_adds_no_column() -> None:
    """A point on an end has no column: the mirrored load continues smoothly or changes its sign."""
    for position in (0.0, 8.0):
        for end in (position, position + 3.0):
            assert np.abs(split_around(end, make_fine_cells(position)).inserted_edges - end).min() < 1e-12
        adjacent = split_around(position + 1e-3, make_fine_cells(position)).inserted_edges
        column = int(np.searchsorted(adjacent, position + 1e-3)) - 1
        assert 0.5 * (adjacent[column] + adjacent[column + 1]) == pytest.approx(position + 1e-3)


def test_range_contains_near_and_replaced_columns() -> None:
    edges = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 7.0])
    empty_range = _SplitRange(edges[:1], 2, 2)
    assert empty_range.range_within(edges, 3.0, 0.0) == (2, 3)
    assert empty_range.range_within(edges, 3.0, 1.5) == (1, 4)
    assert empty_range.range_within(edges, -3.0, 1.0) == (0, 2)
    assert empty_range.range_within(edges, 9.0, 2.5) == (2, 5)
    assert _SplitRange(edges[:3], 0, 2).range_within(edges, 4.5, 0.1) == (0, 4)
    assert _SplitRange(edges[3:], 3, 5).range_within(edges, 0.5, 0.1) == (0, 5)


@pytest.mark.parametrize("parts", range(1, 9))
def test_common_step_divides_distances(parts: int) -> None:
    y = np.array([0.0, 0.1 * parts, 0.1 * parts + 0.1 * (parts + 1)])
    assert common_step(y) == (pytest.approx(0.1) if parts <= 6 else None)
    assert common_step(y[:1]) is None


def make_layers(y: FloatArray, parts: int | None) -> list[Layer]:
    grid = Grid(x_range=(0.0, 1.0), y_range=(-0.75, 1.25), cells_x=4, cells_y=8)
    along_y, depth_indices = LateralAxis(grid, y, 1, 6), np.array([1])
    z = np.array([0.1, 0.2])
    return (
        along_y.uniform_layers(z, depth_indices)
        if parts is None
        else along_y.shaped_layers(z, depth_indices, fine=bool(parts))
    )


def test_positions_with_common_step_share_cells() -> None:
    layers = make_layers(np.array([-0.1, 0.0, 0.3]), 5)
    assert len(layers) == 1
    (layer,) = layers
    assert layer.edges is not None
    for y in (-0.1, 0.0, 0.3):
        cell_position = (y - layer.edges[0]) / np.diff(layer.edges)[0]
        assert cell_position == pytest.approx(np.floor(cell_position) + 0.5)
    # The cells are at most a fifth of a cell wide, an odd part of the step of 0.1.
    assert np.diff(layer.edges)[0] == pytest.approx(0.1 / 3)
    assert len(make_layers(np.array([-0.1, 0.0, 0.1 * np.pi]), 5)) == 3
    assert len(make_layers(np.array([-0.1, 0.0, 0.3]), None)) == 3
    assert len(make_layers(np.array([-0.25, 0.0, 0.5]), 5)) == 1
    assert len(make_layers(np.array([0.0, 0.003, 0.999]), 5)) == 3
    assert len(make_layers(np.linspace(-0.7, 1.1, 601), 5)) == 1
    assert make_layers(np.array([0.0]), 5)[0].edges is not None


@pytest.mark.parametrize("x", [0.002, 0.005, 0.01, 2.99, 2.995, 2.998])
def test_inserted_columns_stay_in_replaced_range(x: float) -> None:
    """No narrow columns lie outside the outermost edges of a load without images."""
    cells = make_fine_cells(ends=0)
    split_range = split_around(x, cells)
    assert (split_range.inserted_edges[0], split_range.inserted_edges[-1]) == (
        cells.edges[split_range.start],
        cells.edges[split_range.stop],
    )
    assert (np.diff(split_range.inserted_edges) > 0).all()


@pytest.mark.parametrize("uniform_grid", [True, False])
def test_columns_do_not_depend_on_the_unit(*, uniform_grid: bool) -> None:
    computed = []
    for unit in (1.0, UNIT):
        cells = make_fine_cells(unit=unit)
        x, y, z = np.array([0.3, 1.3, 2.9]), np.array([-0.1, 0.0, 0.3]), np.linspace(0.01, 6.0, 30)
        axes, load = (ArrayKey(unit * x), ArrayKey(unit * y), ArrayKey(unit * z)), ArrayKey(cells.load)
        computed.append(split_columns(load, None if uniform_grid else load, cells.grid, cells.extent, 1, axes))
    baseline, scaled_parts = computed
    assert len({tuple(part.depth_indices.size for part in columns.groups) for columns in computed}) == 1
    for jumps_of_parts, scaled_jumps_of_parts in zip(baseline.jumps, scaled_parts.jumps, strict=True):
        for part, jumps, scaled_jumps in zip(baseline.groups, jumps_of_parts, scaled_jumps_of_parts, strict=True):
            assert [column_jumps.edges.size for column_jumps in jumps] == [
                column_jumps.edges.size for column_jumps in scaled_jumps
            ]
            for column_jumps, scaled_column_jumps in () if part.radius else zip(jumps, scaled_jumps, strict=True):
                assert scaled_column_jumps.edges / UNIT == pytest.approx(column_jumps.edges, abs=1e-9)
