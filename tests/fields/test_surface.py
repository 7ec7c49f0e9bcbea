"""Displacement of the top: closed forms, reciprocity, limits, reference, coarse operator."""

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
    surface_displacement,
)
from contactstudy.fields.surface import SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load


def test_hertz_pressure_has_parabolic_displacement(on_cells, half_space: HalfSpace) -> None:
    peak = 2 / np.pi
    pressure = on_cells(lambda x, y: peak * np.sqrt(np.maximum(1 - x**2 - y**2, 0)), (-1.5, 1.5), (-1.5, 1.5), (96, 96))
    displacement = surface_displacement(half_space, pressure)
    squared_radius = pressure.x**2 + pressure.y**2
    assert float(np.abs(displacement - (1 - squared_radius / 2)).where(squared_radius < 0.8).max()) < 2e-3


@pytest.mark.parametrize("is_tangential", [False, True])
def test_operator_is_reciprocal_or_antisymmetric_in_y(short_body: FiniteLengthSpace, is_tangential: bool) -> None:
    grid = Grid(x_range=(0.0, 8.0), y_range=(-2.0, 2.0), cells_x=24, cells_y=16)
    operator = SurfaceOperator.of(short_body, grid, (Load.NORMAL, Load.ALONG_Y))
    first_load, second_load = np.random.default_rng(1).random((2, 24, 16))
    if is_tangential:
        first_displacement = operator({Load.ALONG_Y: first_load})
        mirrored_displacement = operator({Load.ALONG_Y: first_load[:, ::-1]})
        assert np.abs(first_displacement + mirrored_displacement[:, ::-1]).max() < 1e-12
    else:
        works = [
            (observed_load * operator({Load.NORMAL: displacing_load})).sum()
            for observed_load, displacing_load in ((first_load, second_load), (second_load, first_load))
        ]
        assert works[0] == pytest.approx(works[1], rel=1e-12)


def test_long_body_has_displacement_of_half_space(on_cells, unit_material: Material) -> None:
    pressure = on_cells(lambda x, y: np.maximum(1 - (x - 30) ** 2 - y**2, 0.0), (0.0, 60.0), (-1.5, 1.5), (480, 24))
    finite_displacement = surface_displacement(FiniteLengthSpace(length=60.0, material=unit_material), pressure, 0.2)
    half_space_displacement = surface_displacement(HalfSpace(material=unit_material), pressure, 0.2)
    difference = (finite_displacement - half_space_displacement).sel(x=slice(28, 32))
    assert float(difference.max() - difference.min()) < 2e-3 * float(half_space_displacement.max())


def test_incompressible_edge_displacement_equals_published_ratio(unit_material: Material) -> None:
    """The displacement of the edge under a point load is 3.362954 times that of a half-space."""
    length, cells = 20.0, 200
    x = length * (np.arange(cells) + 0.5) / cells
    y = 0.1 * (np.arange(101) - 50)
    load = np.zeros((cells, 101))
    load[0, 50] = 1.0
    pressure = xr.DataArray(load, coords={"x": x, "y": y}, dims=("x", "y"))
    material = Material(0.75, 0.5)
    edge_displacement = surface_displacement(FiniteLengthSpace(length=length, material=material), pressure)[0]
    half_space_row = surface_displacement(HalfSpace(material=material), pressure)[0]
    # Differences along the edge exclude the nearly uniform influence of the second end.
    near_cell, far_cell = 65, 90
    ratio = float(edge_displacement[near_cell] - edge_displacement[far_cell]) / float(
        half_space_row[near_cell] - half_space_row[far_cell]
    )
    assert ratio == pytest.approx(3.362954, rel=2e-2)


def test_friction_lowers_the_surface_ahead(short_body: FiniteLengthSpace, strip_pressure) -> None:
    pressure = strip_pressure(8.0, (32, 32))
    change = surface_displacement(short_body, pressure, 0.3) - surface_displacement(short_body, pressure)
    assert float(change.sel(x=4.0, y=1.0, method="nearest")) > 0
    assert np.abs(change + change.values[:, ::-1]).max() < 1e-12


def test_displacement_has_reference_distance(short_body: FiniteLengthSpace, strip_pressure) -> None:
    displacement = surface_displacement(short_body, strip_pressure(8.0, (16, 16)))
    assert displacement.attrs["reference_distance"] == pytest.approx(80.0)
    assert displacement.attrs["units"] == "m"
    assert displacement.name == "displacement_z"


def test_invalid_input_raises_error(short_body: FiniteLengthSpace, strip_pressure) -> None:
    with pytest.raises(InvalidInputError, match="friction = nan"):
        surface_displacement(short_body, strip_pressure(8.0, (16, 16)), np.nan)
    with pytest.raises(InvalidInputError, match="end at the free end"):
        surface_displacement(short_body, strip_pressure(6.0, (16, 16)))


@pytest.mark.parametrize("cells", [(64, 48), (50, 48)], ids=["even halves", "odd halves"])
def test_coarse_operator_approximates_operator_on_coarse_cells(short_body, unit_material, cells):
    rng = np.random.default_rng(3)
    for body in (short_body, QuarterSpace(material=unit_material), HalfSpace(material=unit_material)):
        grids = (
            Grid(x_range=(0.0, 8.0), y_range=(-3.0, 3.0), cells_x=cells[0], cells_y=cells[1]),
            Grid(x_range=(0.0, 8.0), y_range=(-3.0, 3.0), cells_x=cells[0] // 2, cells_y=cells[1] // 2),
        )
        operator, built_operator = (surface_operator(body, grid) for grid in grids)
        pressure = rng.random((cells[0] // 2, cells[1] // 2))
        expected = built_operator({Load.NORMAL: pressure})
        assert np.abs(operator.coarse({Load.NORMAL: pressure}) - expected).max() < 5e-3 * np.ptp(expected)


@pytest.mark.parametrize("model", ["exact", "mirror"])
def test_displacement_vanishes_at_reference(unit_material: Material, model: str) -> None:
    body = FiniteLengthSpace(length=1.0, material=unit_material, model=model)
    displacement = []
    for window, cells in ((10.5, 210), (2.5, 50)):
        grid = Grid(x_range=(0.0, 1.0), y_range=(-window, window), cells_x=8, cells_y=cells)
        load = np.zeros(grid.shape)
        load[:, cells // 2 - 3 : cells // 2 + 3] = 1.0
        pressure = xr.DataArray(load, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
        displacement.append(surface_displacement(body, pressure))
    reference_displacement = displacement[0].interp(y=displacement[0].attrs["reference_distance"])
    assert float(np.abs(reference_displacement).max()) < 1e-3 * float(displacement[0].max())
    np.testing.assert_allclose(
        displacement[0].sel(y=slice(-2.5, 2.5)), displacement[1], atol=1e-5 * float(displacement[0].max())
    )
