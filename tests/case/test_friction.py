"""Friction that varies along the axis."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
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
BOTH_WAYS = xr.DataArray([-0.1, 0.1], coords={"x": [0.0, LENGTH]}, dims="x")


def case(friction: object, **named: object) -> Case:
    body = FiniteLengthSpace(length=LENGTH, material=STEEL)
    roller = Roller(radius=5e-3, length=LENGTH)
    return Case(body=body, roller=roller, max_pressure=1.5e9, friction=friction, **named)  # type: ignore[arg-type]


def test_a_roller_that_slides_both_ways() -> None:
    asked = case(BOTH_WAYS)
    grid = choose_grid(asked, cells_x=3, cells_y=8, window=1.5)
    positions = {"x": LENGTH * np.array([0.1, 0.3, 0.7, 0.9]), "y": [-2e-5, 0.0, 2e-5], "z": [2e-5]}
    result = solve(asked, grid, **positions)
    along = 0.2 * (result.x / LENGTH) - 0.1
    assert np.allclose(result.traction_y, along * result.pressure)
    assert float(result.traction_y.sum()) == pytest.approx(0.0, abs=1e-6 * float(result.pressure.sum()))
    # Of the shear, the pressure's part is odd along y; the traction's part is even, and odd about mid-length.
    change = (result.tau_yz + result.tau_yz[:, ::-1].values).values
    assert np.abs(change + change[::-1]).max() < 1e-6 * np.abs(change).max()


def test_equal_values_are_the_number() -> None:
    grid = choose_grid(case(0.1), cells_x=3, cells_y=8, window=1.5)
    numbers, values = (
        solve(case(friction), grid, stresses=False)
        for friction in (0.1, xr.DataArray([0.1, 0.1], coords={"x": [0.0, LENGTH]}, dims="x"))
    )
    assert np.allclose(numbers["traction_y"], values["traction_y"], rtol=1e-9)


def test_the_bound_of_rolling_varies_along_the_axis() -> None:
    friction = xr.DataArray([0.05, 0.1], coords={"x": [0.0, LENGTH]}, dims="x")
    asked = case(friction, motion=Rolling(longitudinal_creepage=0.1))
    grid = choose_grid(asked, cells_x=3, cells_y=8, window=1.5)
    result = solve(asked, grid, stresses=False)
    assert result.converged
    bound = (0.05 + 0.05 * result.x / LENGTH) * result.pressure
    assert np.allclose(np.hypot(result.traction_x, result.traction_y), bound, atol=1e-6 * float(bound.max()))


def test_cases_with_it_are_values() -> None:
    assert case(BOTH_WAYS) == case(BOTH_WAYS.copy())
    assert hash(case(BOTH_WAYS)) == hash(case(BOTH_WAYS.copy()))
    assert case(BOTH_WAYS) != case(2 * BOTH_WAYS)


def test_bad_input_is_named() -> None:
    with pytest.raises(InvalidInputError, match=r"friction.dims"):
        case(BOTH_WAYS.rename(x="y"))
    with pytest.raises(InvalidInputError, match=r"friction.x.*increasing"):
        case(BOTH_WAYS[::-1])
    with pytest.raises(InvalidInputError, match=r"friction = .nan at position 1"):
        case(xr.DataArray([0.1, np.nan], coords={"x": [0.0, LENGTH]}, dims="x"))
    with pytest.raises(InvalidInputError, match=r"friction = -0.1.*not below zero"):
        case(BOTH_WAYS, motion=Rolling())
    with pytest.raises(InvalidInputError, match="coupled = True"):
        case(BOTH_WAYS, coupled=True)


def test_any_shape_may_have_it() -> None:
    grid = choose_grid(case(0.1), cells_x=3, cells_y=8, window=1.5)
    gap = xr.DataArray(case(0.1).gap(grid), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    body = FiniteLengthSpace(length=LENGTH, material=STEEL)
    found = solve_contact(body, gap, load=100.0, friction=BOTH_WAYS)
    assert float(found.traction_y[0].max()) <= 0 <= float(found.traction_y[-1].min())
    dragged = surface_displacement(body, 0 * found.pressure, traction_y=found.traction_y, components="y")
    assert np.abs(dragged.displacement_y.values + dragged.displacement_y.values[::-1]).max() < 1e-6 * float(
        np.abs(dragged.displacement_y).max()
    )
