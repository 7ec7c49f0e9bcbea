"""Stresses, displacements and equivalent loads of a pressure on graded cells, against uniform cells."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from contactstudy import (
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    Material,
    QuarterSpace,
    displacement_field,
    equivalent_loads,
    stress_field,
    surface_displacement,
)
from contactstudy.bodies.models import Body, BodyWithFreeEnds
from contactstudy.checks import FloatArray
from contactstudy.fields.loads import sliding
from contactstudy.fields.stress import end_traction_residual

STEEL = Material(210e9, 0.3)
LENGTH, FRICTION = 1e-3, 0.3
Y_RANGE = (-1.6e-4, 1.6e-4)
EDGE_INDICES = [0, 1, 2, 3, 5, 7, 10, 14, 18, 22, 26, 29, 31, 33, 35, 36, 37, 38, 39, 40]
"""Indices of the edges of forty uniform cells that are edges of the graded cells."""
UNIFORM_GRID = Grid(x_range=(0.0, LENGTH), y_range=Y_RANGE, cells_x=40, cells_y=20)
GRADED_GRID = Grid.from_edges(UNIFORM_GRID.x_edges[EDGE_INDICES], Y_RANGE, 20)
X, Y, Z = [0.0, 1e-5, 3.3e-4, LENGTH], [0.0, 5e-5], [2e-5, 1e-4]

BODIES: dict[str, Body] = {
    "half": HalfSpace(material=STEEL),
    "quarter": QuarterSpace(material=STEEL),
    "finite": FiniteLengthSpace(length=LENGTH, material=STEEL),
    "mirror": FiniteLengthSpace(length=LENGTH, material=STEEL, model="mirror"),
    "mirror-factor": FiniteLengthSpace(length=LENGTH, material=STEEL, model="mirror-factor"),
    "single-mirror": FiniteLengthSpace(length=LENGTH, material=STEEL, model="single-mirror"),
}


def label_cells(cells: FloatArray, grid: Grid) -> xr.DataArray:
    return xr.DataArray(cells, coords={"x": grid.x, "y": grid.y, "x_width": ("x", grid.widths)}, dims=("x", "y"))


@pytest.fixture(scope="module")
def loads() -> tuple[xr.DataArray, xr.DataArray]:
    """The same pressure on graded and on uniform cells."""
    cell_loads = 1e9 * np.random.default_rng(0).random(GRADED_GRID.shape)
    cell_loads[:, :5] = 0
    return label_cells(cell_loads, GRADED_GRID), label_cells(
        np.repeat(cell_loads, np.diff(EDGE_INDICES), axis=0), UNIFORM_GRID
    )


@pytest.fixture(scope="module")
def smooth_loads() -> tuple[xr.DataArray, xr.DataArray]:
    """A pressure that decreases along x and ends along y, on graded and on uniform cells."""

    def pressure(grid: Grid) -> xr.DataArray:
        lateral_profile = np.sqrt(np.maximum(1 - (grid.y / 1.2e-4) ** 2, 0.0))
        # The mean of a linear function over a column equals its value at the centre.
        return label_cells(1e9 * (1 - 0.4 * grid.x[:, None] / LENGTH) * lateral_profile, grid)

    return pressure(GRADED_GRID), pressure(UNIFORM_GRID)


def compute_max_magnitude(field: xr.Dataset) -> float:
    return max(float(np.abs(field[name]).max()) for name in field.data_vars)


@pytest.mark.parametrize("body", BODIES)
def test_stresses_match_uniform_cells(body: str, loads) -> None:
    graded_field, uniform_field = (stress_field(BODIES[body], load, friction=FRICTION, x=X, y=Y, z=Z) for load in loads)
    assert compute_max_magnitude(graded_field - uniform_field) < 1e-7 * 1e9


@pytest.mark.parametrize("body", ["half", "finite"])
def test_stresses_are_continuous_at_column_edge(body: str, smooth_loads) -> None:
    """The smooth load has two representations, which differ by up to 1e-3 of the peak at their common depth."""
    edges = GRADED_GRID.x_edges[1:-1]
    load, lateral_points = smooth_loads[0], {"y": [0.0], "z": [1e-7, 1e-6, 1e-5, 1e-4]}
    positions = [np.nextafter(edges, -1.0), edges, np.nextafter(edges, 1.0), edges * (1 - 1e-12)]
    stress_before, stress_on_edge, stress_beyond, stress_near = (
        stress_field(BODIES[body], load, friction=FRICTION, x=x, **lateral_points, inside_cells=load) for x in positions
    )
    for near_stress in (stress_before, stress_beyond, stress_near):
        for name in stress_on_edge.data_vars:
            assert np.abs(near_stress[name].values - stress_on_edge[name].values).max() < 1e-3 * 1e9


@pytest.mark.parametrize("body", BODIES)
def test_displacements_match_uniform_cells(body: str, loads) -> None:
    points = {"x": X, "y": Y, "z": Z}
    graded_field, uniform_field = (
        displacement_field(BODIES[body], load, friction=FRICTION, **points) for load in loads
    )
    assert compute_max_magnitude(graded_field - uniform_field) < 1e-6 * compute_max_magnitude(uniform_field)


@pytest.mark.parametrize("body", BODIES)
def test_smooth_loads_match_uniform_cells(body: str, smooth_loads) -> None:
    points = {"x": X, "y": Y, "z": Z}
    graded_field, uniform_field = (
        stress_field(BODIES[body], smooth_load, friction=FRICTION, **points, inside_cells=smooth_load)
        for smooth_load in smooth_loads
    )
    assert compute_max_magnitude(graded_field - uniform_field) < 1e-3 * 1e9
    graded_field, uniform_field = (
        displacement_field(BODIES[body], load, friction=FRICTION, **points, inside_cells=load) for load in smooth_loads
    )
    assert compute_max_magnitude(graded_field - uniform_field) < 5e-4 * compute_max_magnitude(uniform_field)


@pytest.mark.parametrize("body", BODIES)
def test_mean_surface_displacement_matches_uniform_cells(body: str, loads) -> None:
    graded_field, uniform_field = (surface_displacement(BODIES[body], load, FRICTION) for load in loads)
    column_of_cell = np.repeat(np.arange(GRADED_GRID.cells_x), np.diff(EDGE_INDICES))
    means = np.array([uniform_field.values[column_of_cell == i].mean(axis=0) for i in range(GRADED_GRID.cells_x)])
    # The load has steps between cells: the mean over a column differs from the mean at few centres.
    assert np.abs(graded_field.values - means).max() < 0.02 * np.ptp(means)


@pytest.mark.parametrize("body", ["quarter", "finite", "single-mirror"])
def test_equivalent_loads_match_uniform_cells(body: str, loads) -> None:
    body_with_ends = BODIES[body]
    assert isinstance(body_with_ends, BodyWithFreeEnds)
    graded_field, uniform_field = (equivalent_loads(body_with_ends, load, FRICTION, z=[5e-5, 1e-4]) for load in loads)
    assert set(graded_field.data_vars) == set(uniform_field.data_vars)
    names = [name for name in uniform_field.data_vars if name.startswith("P_v")]
    assert len(names) == 1 + (body != "quarter")
    for name in names:
        assert float(np.abs(graded_field[name] - uniform_field[name]).max()) < 1e-9 * float(
            np.abs(uniform_field[name]).max()
        )


@pytest.mark.parametrize("body", ["quarter", "finite"])
def test_ends_are_free_of_traction_on_graded_cells(body: str, smooth_loads) -> None:
    for load, grid in zip(smooth_loads, (GRADED_GRID, UNIFORM_GRID), strict=True):
        residual = end_traction_residual(
            BODIES[body], sliding(load.values, FRICTION), grid, np.array([0.0, 5e-5]), np.array([2e-5, 1e-4])
        )
        assert residual < 1e-5


@st.composite
def draw_graded_pressure(draw: st.DrawFn) -> xr.DataArray:
    ratios = draw(st.lists(st.floats(0.4, 2.5), min_size=2, max_size=10))
    edges = np.append(0.0, np.cumsum(np.cumprod([1.0, *ratios])))
    grid = Grid.from_edges(LENGTH * edges / edges[-1], Y_RANGE, 12)
    return label_cells(1e9 * np.random.default_rng(draw(st.integers(0, 1000))).random(grid.shape), grid)


def mirror_load(load: xr.DataArray) -> xr.DataArray:
    """Reflect a load about mid-length."""
    reversed_load = load.isel(x=slice(None, None, -1))
    return reversed_load.assign_coords(x=LENGTH - reversed_load.x.values)


@settings(max_examples=8)
@given(load=draw_graded_pressure(), body=st.sampled_from(["half", "mirror", "finite"]))
def test_rotated_body_has_rotated_stresses(load: xr.DataArray, body: str) -> None:
    x = np.array([0.0, 2e-4, 7e-4])
    stress = stress_field(BODIES[body], load, friction=FRICTION, x=x, y=Y, z=Z, inside_cells=load)
    mirrored_load = mirror_load(load)
    mirrored_stress = stress_field(
        BODIES[body], mirrored_load, friction=FRICTION, x=(LENGTH - x)[::-1], y=Y, z=Z, inside_cells=mirrored_load
    ).isel(x=slice(None, None, -1))
    for name in ("sigma_xx", "sigma_yy", "sigma_zz", "tau_yz", "von_mises"):
        assert np.abs(stress[name].values - mirrored_stress[name].values).max() < 1e3
    for name in ("tau_xy", "tau_xz"):
        assert np.abs(stress[name].values + mirrored_stress[name].values).max() < 1e3


@settings(max_examples=8)
@given(load=draw_graded_pressure(), factor=st.floats(0.1, 10.0))
def test_stresses_scale_with_the_load(load: xr.DataArray, factor: float) -> None:
    stress, scaled_stress = (
        stress_field(BODIES["half"], applied_load, friction=FRICTION, x=X, y=Y, z=Z, inside_cells=applied_load)
        for applied_load in (load, factor * load)
    )
    assert np.allclose(scaled_stress["von_mises"], factor * stress["von_mises"], rtol=1e-9)
