"""Fields under uniform and graded cells: aligned and single positions, linearity, symmetry, refinement depth."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.arrays.grid import Points
from contactstudy.checks import FloatArray
from contactstudy.kernels import field
from contactstudy.kernels.column_fields import LateralAxis
from contactstudy.kernels.convolution import centred_field
from contactstudy.kernels.field import displacement_influence, half_space_field, half_space_influence, stress_influence
from contactstudy.kernels.fine_cells import MAX_REFINED_DEPTH
from contactstudy.kernels.load import Load

EDGES = {"uniform": np.linspace(0.0, 4.0, 41), "graded": np.cumsum([0.0, *np.geomspace(0.04, 0.4, 23)])}
INFLUENCE = stress_influence(Load.NORMAL, 0.3)
Z_STEPS = np.array([0.0, 0.5, 3.0, 15.0])


def test_unaligned_positions_equal_single_positions() -> None:
    grid = Grid(x_range=(0.0, 8.0), y_range=(-2.0, 2.0), cells_x=80, cells_y=16)
    load = (1 - (grid.y / 2.0) ** 2) * np.ones(grid.shape)
    x, z = np.sort(np.random.default_rng(0).uniform(0.0, 8.0, 25)), np.array([0.05, 0.5])
    joint_field, *single_fields = (
        half_space_field(load, INFLUENCE, grid, Points(points_x, grid.y[::4], z), extent=(0.0, 8.0))
        for points_x in (x, *x[:, None])
    )
    # Merged far columns cause the difference.
    np.testing.assert_allclose(
        joint_field, np.concatenate(single_fields, axis=1), rtol=0, atol=1e-5 * np.abs(joint_field).max()
    )


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("is_shaped", [False, True])
@pytest.mark.parametrize("kind", ["uniform", pytest.param("graded", marks=pytest.mark.slow)])
def test_interpolated_lateral_positions_equal_single_positions(kind: str, load: Load, *, is_shaped: bool) -> None:
    """Loads uniform in each cell have steps of the whole pressure at the edges."""
    grid = Grid.between(EDGES[kind] * 4.0 / EDGES[kind][-1], (-1.2, 1.2), 24)
    rng, influence = np.random.default_rng(3), stress_influence(load, 0.3)
    cell_loads = make_decreasing_pressure(grid) if is_shaped else rng.integers(0, 2, grid.shape).astype(np.float64)
    x, y = np.array([0.0, 0.013, 1.7, 3.6]), np.append(np.sort(rng.uniform(-1.5, 1.5, 16)), 30.0)
    z = grid.dy * np.array([0.0, 0.3, 1.0, 2.5, 7.9, 8.0, 30.0])
    compared_points = slice(0, None, 4)
    joint_field, *single_fields = (
        half_space_field(
            cell_loads,
            influence,
            grid,
            Points(x, positions, z),
            extent=(0.0, 4.0),
            shape=cell_loads if is_shaped else None,
        )
        for positions in (y, *y[compared_points, None])
    )
    assert LateralAxis(grid, y, 0, 24).offset_count == y.size
    np.testing.assert_allclose(
        joint_field[:, :, compared_points], np.concatenate(single_fields, axis=2), rtol=0, atol=1e-6
    )


def make_decreasing_pressure(grid: Grid, half_length: float = 1.7) -> FloatArray:
    """Pressure that decreases to zero inside its last cells along y, and within a finite half-length along x."""
    axial_profile = ((grid.x[:, None] - 2.0) / half_length) ** 8
    return np.asarray(np.sqrt(np.maximum(1 - (grid.y / 0.93) ** 2 - axial_profile, 0.0)))


@pytest.mark.parametrize(
    ("kind", "has_ends", "is_shaped", "is_aligned"),
    [
        *((kind, False, is_shaped, is_shaped) for kind in EDGES for is_shaped in (True, False)),
        *((kind, True, is_shaped, not is_shaped) for kind in EDGES for is_shaped in (True, False)),
    ],
)
def test_field_is_linear_in_the_load(kind: str, *, has_ends: bool, is_shaped: bool, is_aligned: bool) -> None:
    extent = (0.0, 4.0) if has_ends else (-np.inf, np.inf)
    edges = EDGES[kind] * 4.0 / EDGES[kind][-1]
    grid = Grid.between(edges, (-1.2, 1.2), 24)
    shape = make_decreasing_pressure(grid) if is_shaped else None
    rng = np.random.default_rng(2)
    first_load, second_load = (
        make_decreasing_pressure(grid) * rng.random(grid.shape),
        rng.random(grid.shape) * (np.abs(grid.y) < 0.5),
    )
    x, y = (grid.x[::6], grid.y[::4]) if is_aligned else (np.array([0.01, 1.3, 3.77]), np.array([-0.9, 0.033]))
    z = np.array([0.0, 0.05, 0.3, 1.5])
    first_field, second_field, sum_field = (
        half_space_field(load, INFLUENCE, grid, Points(x, y, z), extent=extent, shape=shape)
        for load in (first_load, second_load, first_load + 2 * second_load)
    )
    # The sums over images amplify rounding.
    assert np.abs(first_field + 2 * second_field - sum_field).max() < (1e-10 if np.isfinite(extent).all() else 1e-12)


@pytest.mark.parametrize("kind", EDGES)
@pytest.mark.parametrize("has_ends", [True, False])
def test_load_on_whole_columns_adds_to_load_on_split_columns(kind: str, *, has_ends: bool) -> None:
    extent = (0.0, 4.0) if has_ends else (-np.inf, np.inf)
    grid = Grid.between(EDGES[kind] * 4.0 / EDGES[kind][-1], (-1.2, 1.2), 24)
    uniform_load = make_decreasing_pressure(grid, np.inf)
    varying_load = uniform_load * np.random.default_rng(2).random(grid.shape)
    points = Points(grid.x[::6] if kind == "uniform" else np.array([0.01, 1.3, 3.77]), grid.y[::4], grid.dy * Z_STEPS)
    uniform_field, varying_field, sum_field = (
        half_space_field(load, INFLUENCE, grid, points, extent=extent, shape=uniform_load)
        for load in (uniform_load, varying_load, uniform_load + varying_load)
    )
    assert np.abs(uniform_field + varying_field - sum_field).max() < (1e-10 if has_ends else 1e-12)


@pytest.mark.parametrize("kind", EDGES)
@pytest.mark.parametrize("is_aligned", [True, False])
def test_field_is_continuous_at_refinement_depth(kind: str, *, is_aligned: bool) -> None:
    edges = EDGES[kind] * 4.0 / EDGES[kind][-1]
    grid = Grid.between(edges, (-1.2, 1.2), 24)
    load = make_decreasing_pressure(grid)
    x, y = (grid.x[::6], grid.y[::4]) if is_aligned else (np.array([0.01, 1.3, 3.77]), np.array([-0.9, 0.033]))
    for cell_size in (grid.dy, grid.dx):
        z = MAX_REFINED_DEPTH * cell_size * np.array([1 - 1e-9, 1 + 1e-9])
        upper_field, lower_field = np.moveaxis(
            half_space_field(load, INFLUENCE, grid, Points(x, y, z), extent=(0.0, 4.0), shape=load), 3, 0
        )
        assert np.abs(upper_field - lower_field).max() < 1e-5


GRID = Grid(x_range=(0.0, 2.0), y_range=(-1.0, 1.0), cells_x=20, cells_y=16)
Z = np.array([0.0, 0.05, 0.4])


def compute_stresses(load: np.ndarray, x: np.ndarray, y: np.ndarray, extent: tuple[float, float]) -> np.ndarray:
    """Stresses under steps of a load in each direction."""
    influences = [stress_influence(direction, 0.3) for direction in Load]
    return np.stack(
        [half_space_field(load, direction, GRID, Points(x, y, Z), extent=extent) for direction in influences]
    )


def compute_displacements(load: np.ndarray, x: np.ndarray, y: np.ndarray, extent: tuple[float, float]) -> np.ndarray:
    """Displacements under steps of a load in each direction."""
    length = extent[1] - extent[0]
    fields = []
    for direction in Load:
        influence = displacement_influence(direction, 0.3, length, 20.0)
        fields.append(half_space_field(load, influence, GRID, Points(x, y, Z), extent=extent))
    return np.stack(fields)


@pytest.fixture
def load() -> np.ndarray:
    load = np.random.default_rng(0).random(GRID.shape)
    load[:, :3] = 0.0
    return load


@pytest.mark.parametrize("compute", [compute_stresses, compute_displacements])
@pytest.mark.parametrize(
    ("extent", "cells_x"),
    [
        ((-np.inf, np.inf), range(-3, 25)),
        ((-np.inf, np.inf), range(-7, 2)),
        ((0.0, np.inf), range(25)),
        ((0.0, np.inf), range(30)),
        ((0.0, 2.0), range(20)),
    ],
)
@pytest.mark.parametrize("cells_y", [range(-2, 20), range(-7, 3)])
def test_symmetric_load_has_equal_field(
    monkeypatch, compute, load: np.ndarray, extent: tuple[float, float], cells_x: range, cells_y: range
):
    x, y = GRID.x[0] + GRID.dx * np.array(cells_x), GRID.y[0] + GRID.dy * np.array(cells_y)
    calls = []
    original_centred_field = centred_field
    monkeypatch.setattr(field, "centred_field", lambda *a, **k: calls.append(1) or original_centred_field(*a, **k))
    symmetric_field = compute(load, x, y, extent)
    # A position at another offset along y excludes the use of symmetry.
    general_field = compute(load, x, np.append(y, y[0] + 0.3 * GRID.dy), extent)[:, :, :, :-1]
    # Mirrored tractions along x use the general convolution.
    assert len(calls) == (3 if np.isinf(extent[0]) else 2)
    # The interpolation of the images depends on the span along y.
    tolerance = 1e-13 if np.isinf(extent[1]) else 2e-8
    np.testing.assert_allclose(symmetric_field, general_field, atol=tolerance * np.abs(general_field).max())


@pytest.mark.parametrize("load", [Load.NORMAL, Load.ALONG_Y])
@pytest.mark.parametrize("cells_x", [20, 21])
@pytest.mark.parametrize("rows", [slice(None), [1, 4, 12], [17]])
@pytest.mark.parametrize("mirrored_factor", [1.0, 1 + 1e-6, -1.0])
def test_symmetric_load_equals_sum_of_halves(
    load: Load, cells_x: int, rows: slice | list[int], mirrored_factor: float
) -> None:
    """The spectrum of each half has no zero, unlike the spectrum of the symmetric load."""
    grid = Grid(x_range=(0.0, 2.0), y_range=(-1.0, 1.0), cells_x=cells_x, cells_y=16)
    half_load = np.random.default_rng(0).random(grid.shape)
    half_load[(cells_x + 1) // 2 :] = 0.0
    x = np.atleast_1d(grid.x[rows])
    influence = stress_influence(load, 0.3)
    loads = (half_load, mirrored_factor * half_load[::-1], half_load + mirrored_factor * half_load[::-1])
    first_field, second_field, sum_field = (
        half_space_field(cells, influence, grid, Points(x, grid.y, Z), extent=(0.0, 2.0)) for cells in loads
    )
    np.testing.assert_allclose(sum_field, first_field + second_field, atol=1e-13 * np.abs(first_field).max())


@pytest.mark.parametrize("unit", [1e-20, 1e20])
def test_asymmetric_load_stays_asymmetric_in_any_unit(load: np.ndarray, unit: float) -> None:
    """The field is proportional to the load in any unit."""
    computed, baseline = (compute_stresses(points_x, GRID.x, GRID.y, (0.0, 2.0)) for points_x in (unit * load, load))
    np.testing.assert_allclose(computed / unit, baseline, atol=1e-12 * np.abs(baseline).max())


def test_cached_kernels_depend_on_material_and_quantity(load: np.ndarray):
    y, extent = GRID.y, (0.0, 2.0)
    first_stresses = compute_stresses(load, GRID.x, y, extent)
    field_of_other_material = half_space_field(
        load, stress_influence(Load.NORMAL, 0.1), GRID, Points(GRID.x, y, Z), extent=extent
    )
    assert np.abs(field_of_other_material - first_stresses[0]).max() > 1e-2
    compute_displacements(load, GRID.x, y, extent)
    np.testing.assert_array_equal(compute_stresses(load, GRID.x, y, extent), first_stresses)


@pytest.mark.parametrize("extent", [(-np.inf, np.inf), (0.0, np.inf), (0.0, 2.0)])
@pytest.mark.parametrize("loaded_cells", [(5, slice(None)), (slice(None), 5), (slice(None), slice(None)), (5, 5)])
@pytest.mark.parametrize("has_all_positions", [False, True])
def test_convolution_includes_all_cell_pairs(
    extent: tuple[float, float], loaded_cells: tuple, has_all_positions: bool
) -> None:
    """The periods include the farthest cells for components that are odd in y.

    A contact one cell wide has a transform of at least one point.
    """
    load = np.zeros(GRID.shape)
    load[loaded_cells] = 1.0
    x, y = (
        (GRID.x, GRID.y)
        if has_all_positions
        else (np.atleast_1d(GRID.x[loaded_cells[0]]), np.atleast_1d(GRID.y[loaded_cells[1]]))
    )
    # Pairs of positions at two offsets exclude the use of symmetry.
    pairs_of_positions = [(positions[:, None] + 0.013 * np.arange(2)).ravel() for positions in (x, y)]
    unaligned_field = compute_stresses(load, *pairs_of_positions, extent)[:, :, ::2, ::2]
    np.testing.assert_allclose(compute_stresses(load, x, y, extent), unaligned_field, atol=1e-8)


@pytest.mark.parametrize("load", list(Load))
@pytest.mark.parametrize("extent", [(-np.inf, np.inf), (0.0, np.inf), (-np.inf, 3.0), (0.0, 3.0)])
def test_influences_sum_to_field(extent: tuple[float, float], load: Load) -> None:
    grid = Grid.from_edges([0.0, 0.1, 0.25, 0.5, 1.0, 1.6, 2.2, 2.7, 3.0], (-1.0, 1.0), 10)
    cells = np.random.default_rng(1).random(grid.shape)
    points = Points(np.array([0.4, 1.3, 2.9]), np.array([0.05]), np.array([0.7, 2.0]))
    for influence in (displacement_influence(load, 0.3, extent[1] - extent[0], 30.0), stress_influence(load, 0.3)):
        field = half_space_field(cells, influence, grid, points, extent=extent)[:, :, 0]
        influence_of_cells = half_space_influence(influence, grid, points._replace(y=points.y - grid.y), extent=extent)
        summed_field = np.einsum("cxiyz,iy->cxz", influence_of_cells, cells)
        np.testing.assert_allclose(summed_field, field, atol=1e-6 * np.abs(field).max())
