"""Public linear operators equal the functions of labelled arrays; their transposes are exact."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    equivalent_loads,
    stress_field,
)
from contactstudy.arrays.variables import STRESSES
from contactstudy.fields.surface import surface_displacement as displacement_of
from contactstudy.operators import LOADS, Overlapping, stress, surface_displacement

STEEL = Material(210e9, 0.3)
BODIES = [HalfSpace(material=STEEL), QuarterSpace(material=STEEL), FiniteLengthSpace(length=2.0, material=STEEL)]
GRIDS = [
    Grid(x_range=(0.0, 2.0), y_range=(-1.5, 1.5), cells_x=8, cells_y=6),
    Grid.from_edges([0.0, 0.1, 0.3, 0.7, 1.2, 1.7, 2.0], (-1.5, 1.5), 6),
]
for_bodies_and_grids = pytest.mark.parametrize(
    ("body", "grid"),
    [(BODIES[0], GRIDS[0]), (BODIES[1], GRIDS[0]), (BODIES[2], GRIDS[0]), (BODIES[2], GRIDS[1])],
    ids=["half", "quarter", "finite", "finite on columns"],
)


def make_pressure(grid: Grid, cell_loads: np.ndarray) -> xr.DataArray:
    coords = {"x": grid.x, "y": grid.y, "x_width": ("x", grid.widths)}
    return xr.DataArray(cell_loads, coords, ("x", "y"))


def make_load_arguments(grid: Grid, cell_loads: np.ndarray, load: str) -> dict[str, xr.DataArray]:
    """Keywords of the labelled functions for one load."""
    if load == "pressure":
        return {"pressure": make_pressure(grid, cell_loads)}
    return {"pressure": make_pressure(grid, 0 * cell_loads), load: make_pressure(grid, cell_loads)}


def assert_exact_transpose(operator) -> None:
    generator = np.random.default_rng(0)
    column_vector, row_vector = (
        generator.standard_normal(operator.shape[1]),
        generator.standard_normal(operator.shape[0]),
    )
    forward, backward = operator @ column_vector, operator.T @ row_vector
    scale = np.linalg.norm(forward) * np.linalg.norm(row_vector)
    assert row_vector @ forward == pytest.approx(column_vector @ backward, abs=1e-9 * scale)


@for_bodies_and_grids
@pytest.mark.parametrize("load", LOADS)
def test_stress_operator_matches_stress_field(body, grid: Grid, load: str) -> None:
    cell_loads = np.random.default_rng(1).random(grid.shape)
    axes = {"x": [0.0, 0.6], "y": [-0.6, 0.1], "z": [0.0, 0.2]}
    operator = stress(body, grid, load=load, **axes)
    field = stress_field(body, **make_load_arguments(grid, cell_loads, load), **axes)
    expected = np.array([field[name].values for name in STRESSES]).ravel()
    assert operator @ cell_loads.ravel() == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert_exact_transpose(operator)


@for_bodies_and_grids
@pytest.mark.parametrize("component", ["x", "y", "z"])
@pytest.mark.parametrize("load", LOADS)
def test_displacement_operator_matches_surface_displacement(body, grid: Grid, load: str, component: str) -> None:
    cell_loads = np.random.default_rng(2).random(grid.shape)
    operator = surface_displacement(body, grid, load, component)
    displacements = displacement_of(body, **make_load_arguments(grid, cell_loads, load), components=component)
    expected = displacements[f"displacement_{component}"].values.ravel()
    assert operator @ cell_loads.ravel() == pytest.approx(expected, abs=1e-12 * np.abs(expected).max() + 1e-30)
    assert_exact_transpose(operator)


@pytest.mark.parametrize("load", LOADS)
def test_load_operators_match_equivalent_loads(load: str) -> None:
    body, grid = BODIES[2], GRIDS[1]
    cell_loads = np.random.default_rng(3).random(grid.shape)
    method = Overlapping(body=body, grid=grid, z=[0.2, 0.5], load=load)
    loads = equivalent_loads(body, **make_load_arguments(grid, cell_loads, load), z=[0.2, 0.5])
    for name in ("P_h1", "P_v1", "P_v2"):
        assert getattr(method, name) @ cell_loads.ravel() == pytest.approx(loads[name].values.ravel(), abs=1e-9)
    unit_loads = np.eye(cell_loads.size)[:, :2]
    np.testing.assert_allclose(
        method.P_v2 @ unit_loads, np.stack([method.P_v2 @ unit_load for unit_load in unit_loads.T], axis=1)
    )


def test_invalid_operator_raises() -> None:
    single_mirror = FiniteLengthSpace(length=2.0, material=STEEL, model="single-mirror")
    with pytest.raises(InvalidInputError, match="single-mirror"):
        surface_displacement(single_mirror, GRIDS[0])
    with pytest.raises(InvalidInputError, match="body"):
        Overlapping(body=BODIES[0], grid=GRIDS[0])
    with pytest.raises(InvalidInputError, match="end II"):
        Overlapping(body=BODIES[1], grid=GRIDS[0]).P_v2  # noqa: B018
    with pytest.raises(InvalidInputError, match="load"):
        stress(BODIES[0], GRIDS[0], load="friction")
