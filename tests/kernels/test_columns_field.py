"""Field under columns of any width: that of uniform cells, every load and extent, properties of any edges."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contactstudy import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels import displacement, stress
from contactstudy.kernels.columns_field import columns_field, smooth_columns_field
from contactstudy.kernels.field import half_space_field
from contactstudy.kernels.fine_cells import FineCells
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch import STRESS_CORNERS

LENGTH, POISSON = 2.0, 0.3
EXTENTS = {
    "none": (-np.inf, np.inf),
    "first": (0.0, np.inf),
    "last": (-np.inf, LENGTH),
    "both": (0.0, LENGTH),
}
X, Z = np.array([0.0, 0.3, 1.0, LENGTH]), np.array([0.05, 0.5])


def stresses_of(load: Load) -> Influence:
    return Influence.of(STRESS_CORNERS[load], POISSON, load, stress.UNDER_PRESSURE)


def displacements_of(load: Load, extent: tuple[float, float]) -> Influence:
    return displacement.displacement_influence(load, POISSON, extent[1] - extent[0], 20.0)


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
def test_field_of_uniform_cells(load: Load, extent: str) -> None:
    grid = Grid((0.0, LENGTH), (-1.0, 1.0), 20, 16)
    cells = np.random.default_rng(0).random(grid.shape)
    cells[:, :3] = 0
    # Displacements of a row without end are differences of large numbers.
    for influence, allowed in ((stresses_of(load), 2e-7), (displacements_of(load, EXTENTS[extent]), 3e-6)):
        for y in (grid.y, np.array([0.1, 0.33])):
            expected = half_space_field(cells, influence, grid, X, y, Z, extent=EXTENTS[extent])
            found = columns_field(cells, influence, grid, X, y, Z, extent=EXTENTS[extent])
            assert found.shape == expected.shape
            assert np.abs(found - expected).max() < allowed * np.abs(expected).max()


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
def test_a_body_elsewhere_has_the_same_field(load: Load, extent: str) -> None:
    fields = []
    for place in (0.0, 8.0):
        grid = Grid.from_edges(place + np.array([0.0, 0.2, 0.7, 1.1, 1.6, LENGTH]), (-1.0, 1.0), 6)
        ends = (EXTENTS[extent][0] + place, EXTENTS[extent][1] + place)
        cells = np.random.default_rng(2).random(grid.shape)
        fields.append(columns_field(cells, stresses_of(load), grid, place + X, np.array([0.1]), Z, extent=ends))
    assert np.abs(fields[1] - fields[0]).max() < 1e-9 * np.abs(fields[0]).max()


GRADED = np.array([0, 1, 2, 3, 5, 7, 10, 14, 17, 18, 19, 20])
"""Edges that are kept of twenty uniform cells."""


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
def test_field_of_the_same_load_on_finer_uniform_cells(load: Load, extent: str) -> None:
    uniform = Grid((0.0, LENGTH), (-1.0, 1.0), 20, 16)
    graded = Grid.from_edges(uniform.x_edges[GRADED], (-1.0, 1.0), 16)
    cells = np.random.default_rng(1).random(graded.shape)
    spread = np.repeat(cells, np.diff(GRADED), axis=0)
    influence, y = stresses_of(load), np.array([-0.4, 0.0, 0.1, 0.33, 0.9])
    expected = half_space_field(spread, influence, uniform, X, y, Z, extent=EXTENTS[extent])
    found = columns_field(cells, influence, graded, X, y, Z, extent=EXTENTS[extent])
    assert np.abs(found - expected).max() < 2e-7 * np.abs(expected).max()


@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("extent", EXTENTS)
@pytest.mark.parametrize("column", [7, 10])
def test_a_column_loaded_alone_keeps_its_place_wherever_its_field_is_asked_for(
    load: Load, extent: str, column: int
) -> None:
    # Columns are split so that each point lies in the middle of one, which moved the force beside a step of the load.
    graded = Grid.from_edges(np.linspace(0.0, LENGTH, 21)[GRADED], (-1.0, 1.0), 16)
    cells = np.zeros(graded.shape)
    cells[column] = np.sqrt(np.maximum(1 - (graded.y / 0.6) ** 2, 0))
    fine = FineCells(cells, graded, EXTENTS[extent], load.sign_x)
    uniform = Grid((0.0, LENGTH), (float(fine.y_edges[0]), float(fine.y_edges[-1])), 20, 9 * fine.cells.shape[1])
    smooth = fine.along_y(cells[:, fine.first : fine.first + fine.cells.shape[1]]).means(
        np.linspace(*uniform.y_range, uniform.cells_y + 1)
    )
    spread = np.repeat(smooth, np.diff(GRADED), axis=0)
    influence, x, y = stresses_of(load), np.linspace(0.05, 1.95, 21), np.array([0.0, 0.3])
    for z in (np.array([0.15]), np.array([0.4])):
        expected = half_space_field(spread, influence, uniform, x, y, z, extent=EXTENTS[extent])
        found = smooth_columns_field(cells, influence, graded, x, y, z, extent=EXTENTS[extent])
        assert np.abs(found - expected).max() < 1e-3 * np.abs(expected).max()


@pytest.mark.parametrize("extent", EXTENTS)
def test_a_smooth_load_on_wide_columns_is_seen_as_smooth(extent: str) -> None:
    """In thirds of columns 0.4 wide; as steps it would be 9 % off."""
    scale = 1e-3
    graded = Grid.from_edges(scale * np.linspace(0.0, LENGTH, 21)[GRADED], (-scale, scale), 16)
    across = np.sqrt(np.maximum(1 - (graded.y / (0.6 * scale)) ** 2, 0))
    cells = np.exp(-((graded.x[:, None] / scale - 1.3) ** 2) / 0.2) * across
    ends = (scale * EXTENTS[extent][0], scale * EXTENTS[extent][1])
    fine = FineCells(cells, graded, ends)
    y_range = (float(fine.y_edges[0]), float(fine.y_edges[-1]))
    uniform = Grid((0.0, scale * LENGTH), y_range, 100, 9 * fine.cells.shape[1])
    along_x = fine.columns([uniform.x_edges])
    spread = fine.along_y(along_x).means(np.linspace(*y_range, uniform.cells_y + 1))
    influence, x, y = stresses_of(Load.NORMAL), scale * np.linspace(0.1, 1.9, 13), np.array([0.0, 0.3 * scale])
    for z in (np.array([0.05 * scale]), np.array([0.3 * scale])):
        expected = half_space_field(spread, influence, uniform, x, y, z, extent=ends)
        found = smooth_columns_field(cells, influence, graded, x, y, z, extent=ends)
        assert np.abs(found - expected).max() < 0.02 * np.abs(expected).max()


@pytest.mark.parametrize(
    ("column", "extent", "image", "expected"),
    [
        (3, "none", 1, [0.3, 0.5]),
        (3, "last", 1, [0.3, 0.5, 3.5, 3.7]),
        (10, "both", 1, [-1.9, 1.9, 2.1]),
        (10, "both", -1, [-2.0, -1.9, 1.9, 2.0, 2.1]),
    ],
)
def test_steps_of_a_load(column: int, extent: str, image: int, expected: list[float]) -> None:
    graded = Grid.from_edges(np.linspace(0.0, LENGTH, 21)[GRADED], (-1.0, 1.0), 16)
    cells = np.zeros(graded.shape)
    cells[column] = np.sqrt(np.maximum(1 - (graded.y / 0.6) ** 2, 0))
    steps = FineCells(1e-3 * cells, graded, EXTENTS[extent], image).steps
    assert np.unique(steps.round(9)).tolist() == pytest.approx(expected)


@pytest.mark.parametrize("load", Load)
def test_depths_that_are_seen_together_are_those_seen_alone(load: Load) -> None:
    # What columns far away do is interpolated over the depth; at a single depth it is not.
    edges = np.concatenate([np.linspace(0.0, 2.0, 9), np.geomspace(2.5, 60.0, 24)])
    graded = Grid.from_edges(edges, (-1.0, 1.0), 16)
    cells = np.exp(-graded.x[:, None] / 20) * np.sqrt(np.maximum(1 - (graded.y / 0.8) ** 2, 0))
    influence, y, z = stresses_of(load), np.array([-0.2, 0.3]), np.linspace(0.0, 6.0, 25)
    x, extent = np.array([0.0, 0.7, 9.0, 40.0, 60.0]), (0.0, 60.0)
    together = smooth_columns_field(cells, influence, graded, x, y, z, extent=extent)
    for number in (0, 1, 8, 24):
        alone = smooth_columns_field(cells, influence, graded, x, y, z[number : number + 1], extent=extent)
        # Nearer to the top than the others see it, columns are split into more.
        assert np.abs(together[..., number] - alone[..., 0]).max() < 2e-4 * np.abs(together).max()


@pytest.mark.parametrize("load", Load)
def test_far_away_the_field_is_that_of_a_point_load(load: Load) -> None:
    graded = Grid.from_edges([0.0, 0.2, 0.6, 1.0], (-1.0, 1.0), 16)
    cells = np.ones((3, 1)) * np.sqrt(np.maximum(1 - (graded.y / 0.8) ** 2, 0))
    point = Grid.from_edges([0.45, 0.55], (-0.05, 0.05), 1)
    force = float((cells * graded.widths[:, None]).sum() * graded.dy)
    influence, x, y, z = stresses_of(load), np.array([-60.0, 50.0, 70.0]), np.array([0.0, 3.0]), np.array([1.0, 40.0])
    found = smooth_columns_field(cells, influence, graded, x, y, z, extent=EXTENTS["none"])
    expected = columns_field(np.full((1, 1), force / 0.01), influence, point, x, y, z, extent=EXTENTS["none"])
    assert np.abs(found - expected).max() < 5e-4 * np.abs(expected).max()


def test_splitting_columns_that_are_all_narrow_adds_nothing() -> None:
    grid = Grid((0.0, 1.0), (-1.0, 1.0), 10, 16)
    cells = np.ones((10, 1)) * np.sqrt(np.maximum(1 - (grid.y / 0.8) ** 2, 0))
    x, extent = np.array([0.1, 0.53]), EXTENTS["none"]
    deep = smooth_columns_field(
        cells, stresses_of(Load.NORMAL), grid, x, X[:1], np.array([2.0]), extent=extent, added=True
    )
    assert not deep.any()


def test_nothing_loaded_leaves_nothing() -> None:
    grid = Grid.from_edges([0.0, 0.5, 2.0], (-1.0, 1.0), 4)
    field = columns_field(np.zeros(grid.shape), stresses_of(Load.NORMAL), grid, X, grid.y, Z, extent=EXTENTS["both"])
    assert field.shape == (6, X.size, grid.y.size, Z.size)
    assert not field.any()


@st.composite
def graded_loads(draw: st.DrawFn) -> tuple[Grid, FloatArray]:
    """Columns of any widths, and a load on them."""
    ratios = draw(st.lists(st.floats(0.3, 3.0), min_size=1, max_size=10))
    edges = np.append(0.0, np.cumsum(np.cumprod([1.0, *ratios])))
    grid = Grid.from_edges(LENGTH * edges / edges[-1], (-1.0, 1.0), 6)
    return grid, np.random.default_rng(draw(st.integers(0, 1000))).random(grid.shape)


@settings(max_examples=20)
@given(loaded=graded_loads(), load=st.sampled_from(list(Load)), extent=st.sampled_from(["none", "both"]))
def test_mirrored_load_makes_the_mirrored_field(loaded: tuple[Grid, FloatArray], load: Load, extent: str) -> None:
    grid, cells = loaded
    backwards = Grid.from_edges(LENGTH - grid.x_edges[::-1], (-1.0, 1.0), 6)
    influence, y = stresses_of(load), np.array([-0.4, 0.1])
    there = columns_field(cells, influence, grid, X, y, Z, extent=EXTENTS[extent])
    back = columns_field(cells[::-1], influence, backwards, LENGTH - X[::-1], y, Z, extent=EXTENTS[extent])
    sign = np.array(influence.sign_along_x)[:, None, None, None]
    assert np.abs(there - sign * back[:, ::-1]).max() < 1e-8 * np.abs(there).max()


@settings(max_examples=5)
@given(loaded=graded_loads())
def test_normal_stress_on_a_plane_carries_the_whole_load(loaded: tuple[Grid, FloatArray]) -> None:
    grid, cells = loaded
    depth, reach, points = 0.6, 40.0, 81
    # Points that crowd where the load is: y = sinh(s).
    s = np.linspace(-1.0, 1.0, points) * np.arcsinh(reach / depth)
    wide, steps = depth * np.sinh(s), depth * np.cosh(s) * (s[1] - s[0])
    field = columns_field(
        cells, stresses_of(Load.NORMAL), grid, 1.0 + wide, wide, np.array([depth]), extent=EXTENTS["none"]
    )[2, :, :, 0]
    carried = -float(steps @ field @ steps)
    total = float((cells * grid.widths[:, None]).sum() * grid.dy)
    assert carried == pytest.approx(total, rel=2e-3)
