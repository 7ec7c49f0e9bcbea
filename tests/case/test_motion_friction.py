"""Friction that varies along the axis."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    Rolling,
    choose_grid,
    solve,
    solve_contact,
    surface_displacement,
)

STEEL = Material(210e9, 0.3)
LENGTH = 0.5e-3
ANTISYMMETRIC_FRICTION = xr.DataArray([-0.1, 0.1], coords={"x": [0.0, LENGTH]}, dims="x")


def create_case(friction: object, **arguments: object) -> Case:
    roller = Roller(radius=5e-3, length=LENGTH)
    parameters = {"body": FiniteLengthSpace(length=LENGTH, material=STEEL), "roller": roller, "max_pressure": 1.5e9}
    return Case(**(parameters | {"friction": friction} | arguments))  # type: ignore[arg-type]


def test_traction_of_antisymmetric_friction_is_antisymmetric() -> None:
    case = create_case(ANTISYMMETRIC_FRICTION, body=HalfSpace(material=STEEL))
    grid = choose_grid(case, cells_x=3, cells_y=8, window=1.5)
    positions = {"x": LENGTH * np.array([0.1, 0.3, 0.7, 0.9]), "y": [-2e-5, 0.0, 2e-5], "z": [2e-5]}
    result = solve(case, grid, **positions)
    local_friction = 0.2 * (result.x / LENGTH) - 0.1
    assert np.allclose(result.traction_y, local_friction * result.pressure)
    assert float(result.traction_y.sum()) == pytest.approx(0.0, abs=1e-6 * float(result.pressure.sum()))
    # The shear by the pressure is odd along y; the shear by the traction is even along y and odd about mid-length.
    friction_stress = (result.tau_yz + result.tau_yz[:, ::-1].values).values
    assert np.abs(friction_stress + friction_stress[::-1]).max() < 1e-6 * np.abs(friction_stress).max()


def test_uniform_array_equals_a_number() -> None:
    grid = choose_grid(create_case(0.1), cells_x=3, cells_y=8, window=1.5)
    number_result, array_result = (
        solve(create_case(friction), grid, stresses=False)
        for friction in (0.1, xr.DataArray([0.1, 0.1], coords={"x": [0.0, LENGTH]}, dims="x"))
    )
    assert np.allclose(number_result["traction_y"], array_result["traction_y"], rtol=1e-9)


def test_friction_bound_of_rolling_varies_along_the_axis() -> None:
    friction = xr.DataArray([0.05, 0.1], coords={"x": [0.0, LENGTH]}, dims="x")
    case = create_case(friction, motion=Rolling(longitudinal_creepage=0.1))
    grid = choose_grid(case, cells_x=3, cells_y=8, window=1.5)
    result = solve(case, grid, stresses=False)
    assert result.converged
    bound = (0.05 + 0.05 * result.x / LENGTH) * result.pressure
    assert np.allclose(np.hypot(result.traction_x, result.traction_y), bound, atol=1e-6 * float(bound.max()))


def test_cases_with_axial_friction_are_hashable() -> None:
    assert create_case(ANTISYMMETRIC_FRICTION) == create_case(ANTISYMMETRIC_FRICTION.copy())
    assert hash(create_case(ANTISYMMETRIC_FRICTION)) == hash(create_case(ANTISYMMETRIC_FRICTION.copy()))
    assert create_case(ANTISYMMETRIC_FRICTION) != create_case(2 * ANTISYMMETRIC_FRICTION)


def test_invalid_axial_friction_raises() -> None:
    with pytest.raises(InvalidInputError, match=r"friction.dims"):
        create_case(ANTISYMMETRIC_FRICTION.rename(x="y"))
    with pytest.raises(InvalidInputError, match=r"friction.x.*increasing"):
        create_case(ANTISYMMETRIC_FRICTION[::-1])
    with pytest.raises(InvalidInputError, match=r"friction = .nan at position 1"):
        create_case(xr.DataArray([0.1, np.nan], coords={"x": [0.0, LENGTH]}, dims="x"))
    with pytest.raises(InvalidInputError, match=r"friction = -0.1.*not below zero"):
        create_case(ANTISYMMETRIC_FRICTION, motion=Rolling())
    with pytest.raises(InvalidInputError, match="coupled = True"):
        create_case(ANTISYMMETRIC_FRICTION, coupled=True)


def test_contact_of_gap_with_axial_friction_is_antisymmetric() -> None:
    grid = choose_grid(create_case(0.1), cells_x=3, cells_y=8, window=1.5)
    gap = xr.DataArray(create_case(0.1).gap(grid), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    body = FiniteLengthSpace(length=LENGTH, material=STEEL)
    contact = solve_contact(body, gap, load=100.0, friction=ANTISYMMETRIC_FRICTION)
    assert float(contact.traction_y[0].max()) <= 0 <= float(contact.traction_y[-1].min())
    displacements = surface_displacement(body, 0 * contact.pressure, traction_y=contact.traction_y, components="y")
    assert np.abs(displacements.displacement_y.values + displacements.displacement_y.values[::-1]).max() < 1e-6 * float(
        np.abs(displacements.displacement_y).max()
    )
