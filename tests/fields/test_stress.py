"""Stresses near the top, equilibrium, symmetry and invalid input; `verification/test_suite_checks` has closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import FiniteLengthSpace, HalfSpace, InvalidInputError, Material, cache, stress_field
from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.variables import STRESSES
from contactstudy.fields.loads import sliding
from contactstudy.fields.stress import stresses_at
from tests.closed_forms import compute_hertz_surface_stress, compute_sliding_surface_stress

Y = [-1.2, -0.4, 0.0, 0.3, 0.8]


@pytest.fixture(scope="module")
def circle_pressure(on_cells) -> xr.DataArray:
    return on_cells(lambda x, y: np.sqrt(np.maximum(1 - x**2 - y**2, 0)), (-1.25, 1.25), (-1.25, 1.25), (120, 120))


def test_surface_stresses_of_sliding_circle_equal_closed_form(
    circle_pressure: xr.DataArray, half_space: HalfSpace
) -> None:
    stress = stress_field(half_space, circle_pressure, friction=0.3, z=[0.0]).isel(z=0).sel(x=0.0, method="nearest")
    is_inside = np.abs(stress["y"].values) < 0.95
    x = np.full(int(is_inside.sum()), float(stress["x"]))
    traction = compute_sliding_surface_stress(x, stress["y"].values[is_inside], 1.0, 0.3, 0.3)
    radial, hoop = compute_hertz_surface_stress(np.hypot(x, stress["y"].values[is_inside]), 1.0, 1.0, 0.3)
    assert np.abs(stress["sigma_yy"].values[is_inside] - radial - traction["sigma_yy"]).max() < 2e-2
    assert np.abs(stress["sigma_xx"].values[is_inside] - hoop - traction["sigma_xx"]).max() < 2e-2


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_stress_is_in_equilibrium_inside(short_body: FiniteLengthSpace, strip_pressure, friction: float) -> None:
    pressure = strip_pressure(8.0, (64, 64))
    step = 0.02
    for centre in ([0.3, 0.4, 0.5], [4.0, -0.6, 1.0], [7.9, 0.2, 0.3]):
        axes = [np.array([c - step, c, c + step]) for c in centre]
        grid = Grid.from_centres(pressure.x.values, pressure.y.values)
        (stress_components,) = stresses_at(
            short_body, sliding(pressure.values, friction), grid, [Points(*axes)], pressure.values
        )
        xx, yy, zz, xy, xz, yz = stress_components

        def compute_slope(component: np.ndarray, axis: int) -> float:
            indices = [1, 1, 1]
            indices[axis] = 2
            upper = component[tuple(indices)]
            indices[axis] = 0
            return float(upper - component[tuple(indices)]) / (2 * step)

        for terms in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)):
            assert abs(sum(compute_slope(term, axis) for axis, term in enumerate(terms))) < 5e-3


def test_stresses_follow_symmetries_of_load(short_body: FiniteLengthSpace, strip_pressure) -> None:
    x, y = [0.0, 0.7, 4.0, 7.3, 8.0], [-0.6, 0.0, 0.6]
    stress = stress_field(short_body, strip_pressure(8.0, (48, 32)), x=x, y=y, z=[0.2, 1.0])
    for name in ("sigma_xx", "sigma_yy", "sigma_zz", "tau_yz", "tau_xy", "tau_xz"):
        component = stress[name].values
        sign_x = -1 if name in ("tau_xy", "tau_xz") else 1
        sign_y = -1 if name in ("tau_xy", "tau_yz") else 1
        assert np.abs(component - sign_x * component[::-1]).max() < 1e-7, name
        assert np.abs(component - sign_y * component[:, ::-1]).max() < 1e-7, name


def test_loaded_corner_matches_theory(short_body: FiniteLengthSpace, strip_pressure) -> None:
    stress = stress_field(short_body, strip_pressure(8.0, (64, 65)), x=[0.0], y=[0.0], z=[0.0]).isel(x=0, y=0, z=0)
    assert float(stress["sigma_zz"]) == pytest.approx(-1.0, abs=1e-3)
    assert float(stress["sigma_xx"]) == 0.0
    assert float(stress["tau_xz"]) == 0.0


def test_stresses_are_linear_in_friction(short_body: FiniteLengthSpace, strip_pressure) -> None:
    pressure = strip_pressure(8.0, (32, 32))
    points = {"x": [0.0, 1.0], "y": [0.3], "z": [0.0, 0.4]}
    frictionless_stress, stress_at_friction, stress_at_double_friction = (
        stress_field(short_body, pressure, friction=friction_coefficient, **points)
        for friction_coefficient in (0.0, 0.2, 0.4)
    )
    for name in STRESSES:
        assert np.allclose(
            stress_at_double_friction[name] - frictionless_stress[name],
            2 * (stress_at_friction[name] - frictionless_stress[name]),
            atol=1e-10,
        ), name


def test_frictions_share_stresses_bit_for_bit(short_body: FiniteLengthSpace, strip_pressure) -> None:
    """Stresses of the pressure from the cache of a sliding contact are identical to those without friction."""
    pressure = strip_pressure(8.0, (32, 32))
    fields = []
    for frictions in ((0.0,), (0.1, 0.0)):
        cache.clear()
        for friction in frictions:
            stress = stress_field(short_body, pressure, friction=friction, x=[0.0, 0.3], y=[0.1, 0.4], z=[0.0, 0.2])
        fields.append(stress)
    assert cache.info().kinds["stress fields"].reused == 1
    xr.testing.assert_identical(*fields)


def test_stresses_do_not_depend_on_order_of_points(short_body: FiniteLengthSpace, strip_pressure) -> None:
    pressure = strip_pressure(8.0, (32, 32))
    sorted_stresses = stress_field(short_body, pressure, x=[0.5, 3.0], y=[0.0], z=[0.5, 1.0])
    shuffled_stresses = stress_field(short_body, pressure, x=[3.0, 0.5], y=[0.0], z=[1.0, 0.5])
    for name in STRESSES:
        assert np.allclose(sorted_stresses[name].values[::-1, :, ::-1], shuffled_stresses[name].values, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"z": [-1e-9]}, "z = -1e-09: must be not negative"),
        ({"x": [8.1]}, r"x = 8.1: must be inside the body"),
        ({"x": [-0.1]}, "inside the body"),
        ({"y": [np.nan]}, "y = 'nan at position 0'"),
        ({"z": []}, "non-empty"),
        ({"friction": "rough"}, "friction = 'rough'"),
    ],
)
def test_invalid_positions_raise_error(
    short_body: FiniteLengthSpace, strip_pressure, change: dict[str, object], message: str
) -> None:
    with pytest.raises(InvalidInputError, match=message):
        stress_field(short_body, strip_pressure(8.0, (16, 16)), **change)  # type: ignore[arg-type]


def test_too_thin_body_raises_error(on_cells) -> None:
    pressure = on_cells(lambda x, y: np.sqrt(np.maximum(1 - y**2, 0)) + 0 * x, (0.0, 0.005), (-1.5, 1.5), (4, 48))
    thin_body = FiniteLengthSpace(material=Material(1.0, 0.3), length=0.005)
    with pytest.raises(InvalidInputError, match=r"body.length = 0.005: must be at least 0.004 of the width"):
        stress_field(thin_body, pressure, z=[0.1])


def test_points_near_end_snap_to_end(short_body: FiniteLengthSpace, strip_pressure) -> None:
    pressure = strip_pressure(8.0, (16, 16))
    end_stress, adjacent_stress = (stress_field(short_body, pressure, x=[x], z=[0.5]) for x in (0.0, 5e-324))
    assert adjacent_stress["x"].item() == 0.0
    np.testing.assert_array_equal(adjacent_stress["sigma_zz"], end_stress["sigma_zz"])


@pytest.mark.parametrize(("axis", "coordinate"), [("y", 1e6), ("y", -1e45), ("z", 1e45)])
def test_too_distant_points_raise_error(
    short_body: FiniteLengthSpace, strip_pressure, axis: str, coordinate: float
) -> None:
    points = {"x": [4.0], "y": [0.0], "z": [0.5]} | {axis: [coordinate]}
    with pytest.raises(InvalidInputError, match=f"^{axis} = .* within 10000 times the size"):
        stress_field(short_body, strip_pressure(8.0, (16, 16)), **points)


@pytest.mark.parametrize("inside_cells", ["uniform", "pressure"])
def test_loads_on_different_cells_are_additive_between_free_ends(inside_cells: str) -> None:
    """The positions on the faces follow from the grid, not from the loaded cells."""
    body = FiniteLengthSpace(length=10.0, material=Material(1.0, 0.3))
    grid = Grid(x_range=(0.0, 10.0), y_range=(-2.0, 2.0), cells_x=40, cells_y=16)
    squared_pressure = 1 - ((grid.x[:, None] - 5) / 3) ** 2 - grid.y**2
    pressure = xr.DataArray(np.sqrt(np.maximum(squared_pressure, 0.0)), {"x": grid.x, "y": grid.y}, ("x", "y"))
    random_pressure = pressure.copy(data=np.random.default_rng(0).random(grid.shape))
    cells = {"inside_cells": pressure if inside_cells == "pressure" else inside_cells}
    pressure_stress, random_stress, sum_stress = (
        stress_field(body, load, friction=0.2, x=[9.0, 2.5], y=[0.5], z=[0.0, 0.9], **cells)[list(STRESSES)].to_array()
        for load in (pressure, random_pressure, pressure + random_pressure)
    )
    np.testing.assert_allclose(pressure_stress + random_stress, sum_stress, rtol=0, atol=1e-10)
