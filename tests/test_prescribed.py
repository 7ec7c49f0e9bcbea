"""What may be prescribed of a contact: load, its position, the tilt, the approach; and rough surfaces."""

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
    choose_grid,
    profiles,
    solve,
    solve_contact,
)

STEEL = Material(210e9, 0.3)
HALF_WIDTH = 65e-6
LENGTH = 20 * HALF_WIDTH
BODY = FiniteLengthSpace(length=LENGTH, material=STEEL)
CROWNED = profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=STEEL.plane_strain_modulus)


def case_with(**arguments) -> Case:
    roller = Roller(radius=5e-3, length=16 * HALF_WIDTH, profile=CROWNED)
    return Case(**({"body": BODY, "roller": roller, "max_pressure": 1e9} | arguments))


@pytest.mark.parametrize("offset", [-2.5, 0.0, 1.0, 3.5])
def test_the_resultant_acts_where_it_was_prescribed(offset: float):
    position = 0.5 * LENGTH + offset * HALF_WIDTH
    result = solve(case_with(load_position=position), stresses=False)
    assert bool(result.converged)
    line = result.pressure.sum("y")
    assert abs(float((line * line.x).sum() / line.sum()) - position) < 1e-6 * LENGTH
    assert float(result.load_position) == pytest.approx(position, abs=1e-6 * LENGTH)
    assert np.sign(float(result.tilt)) == np.sign(offset) or offset == 0
    assert float(result.penetration_error) < 1e-5


def test_the_tilt_that_follows_from_the_position_gives_the_position():
    free = solve(case_with(load_position=0.5 * LENGTH + HALF_WIDTH), stresses=False)
    held = solve(case_with(tilt=float(free.tilt)), stresses=False)
    np.testing.assert_allclose(held.pressure, free.pressure, atol=2e-5 * float(free.pressure.max()))
    assert float(held.load_position) == pytest.approx(float(free.load_position), abs=1e-5 * LENGTH)


def test_opposite_tilts_mirror_the_pressure():
    first, second = (solve(case_with(tilt=tilt), stresses=False).pressure.values for tilt in (2e-4, -2e-4))
    np.testing.assert_allclose(first, second[::-1], atol=1e-5 * first.max())
    assert first[first.shape[0] // 2 :].sum() > first[: first.shape[0] // 2].sum()


def test_a_load_on_mid_length_does_not_tilt():
    free, held = (solve(case_with(load_position=at), stresses=False) for at in (0.5 * LENGTH, None))
    assert abs(float(free.tilt)) < 1e-9
    np.testing.assert_allclose(free.pressure, held.pressure, atol=1e-5 * float(held.pressure.max()))


@pytest.mark.parametrize("body", [BODY, HalfSpace(material=STEEL)], ids=["finite", "half-space"])
def test_approach_and_load_are_two_ways_to_prescribe_one_contact(body):
    case = case_with(body=body, end_distance=2 * HALF_WIDTH)
    grid = choose_grid(case)
    gap = xr.DataArray(case.gap(grid), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    by_load = solve_contact(body, gap, case.normal_load)
    by_approach = solve_contact(body, gap, approach=float(by_load.approach))
    assert bool(by_approach.converged)
    assert float(by_approach["load"]) == pytest.approx(case.normal_load, rel=1e-5)
    np.testing.assert_allclose(by_approach.pressure, by_load.pressure, atol=1e-4 * float(by_load.pressure.max()))
    assert float(by_approach.approach) == float(by_load.approach)


def test_hertz_point_contact_by_its_approach():
    centres = np.linspace(-1.5, 1.5, 97)
    gap = xr.DataArray(0.5 * (centres[:, None] ** 2 + centres**2), coords={"x": centres, "y": centres}, dims=("x", "y"))
    contact = solve_contact(HalfSpace(material=Material(0.75, 0.5)), gap, approach=1.0)  # contact radius 1, load 4/3
    assert float(contact["load"]) == pytest.approx(4 / 3, rel=1e-3)
    assert float(contact.pressure.max()) == pytest.approx(2 / np.pi, rel=1e-3)


def test_wavy_surface_closes_at_westergaards_mean_pressure():
    """A long wavy line on a half-space touches everywhere once the mean pressure is pi E* h / wavelength."""
    case = case_with(body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=16 * HALF_WIDTH))
    grid = choose_grid(case, cells_x=16, margin=1.0)
    wavelength = 2 * HALF_WIDTH
    middle = case.roller_start + 0.5 * case.roller.length
    touching = []
    for factor in (0.5, 2.0):
        # Under the middle of the line the mean pressure across the waves is the smooth contact's, at most 1 GPa.
        height = factor * 1e9 * wavelength / (np.pi * STEEL.plane_strain_modulus)
        heights = height * np.cos(2 * np.pi * (grid.x[:, None] - middle) / wavelength) + 0 * grid.y
        rough = xr.DataArray(heights, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
        result = solve(case, grid, roughness=rough, stresses=False)
        assert bool(result.converged)
        centre = result.pressure.sel(y=0.0, method="nearest").sel(x=slice(middle - wavelength, middle + wavelength))
        touching.append(float((centre > 0).mean()))
    assert touching[0] == 1.0
    assert touching[1] < 0.9


def test_a_flat_height_map_changes_nothing_but_the_approach():
    case = case_with()
    grid = choose_grid(case)
    flat = xr.DataArray(np.full(grid.shape, 1e-6), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    smooth, rough = (solve(case, grid, roughness=heights, stresses=False) for heights in (None, flat))
    np.testing.assert_allclose(rough.pressure, smooth.pressure, atol=1e-6 * float(smooth.pressure.max()))
    assert float(rough.approach) == pytest.approx(float(smooth.approach) - 1e-6, rel=1e-6)


def test_error_estimate_stands_with_the_result():
    result = solve(case_with(), stresses=False, error_estimate=True)
    assert float(result.peak_pressure) == pytest.approx(float(result.pressure.max()), rel=1e-2)
    assert 0 < float(result.peak_pressure_error) < 0.02 * float(result.peak_pressure)


@pytest.mark.parametrize(
    ("arguments", "parameter"),
    [
        ({"tilt": 0.2}, "tilt"),
        ({"tilt": np.nan}, "tilt"),
        ({"load_position": -1e-3}, "load_position"),
        ({"load_position": 0.5 * HALF_WIDTH}, "load_position"),
        ({"load_position": np.inf}, "load_position"),
    ],
)
def test_bad_cases(arguments, parameter: str):
    with pytest.raises(InvalidInputError, match=parameter):
        case_with(**arguments)


@pytest.mark.parametrize(
    ("arguments", "parameter"),
    [
        ({}, "load, approach"),
        ({"load": 1.0, "approach": 1e-6}, "load, approach"),
        ({"approach": -1e-6}, "approach"),
        ({"approach": np.nan}, "approach"),
        ({"approach": 1e-6, "load_position": 0.5 * LENGTH}, "load_position"),
        ({"load": 1.0, "load_position": 2 * LENGTH}, "load_position"),
    ],
)
def test_bad_prescriptions(arguments, parameter: str):
    case = case_with()
    grid = choose_grid(case, cells_x=2, cells_y=4)
    gap = xr.DataArray(case.gap(grid), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match=parameter):
        solve_contact(BODY, gap, **arguments)


def test_roughness_must_lie_on_the_cells():
    case = case_with()
    grid = choose_grid(case, cells_x=2, cells_y=4)
    rough = xr.DataArray(np.zeros((4, 4)), coords={"x": np.arange(4.0), "y": np.arange(4.0)}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match="roughness"):
        solve(case, grid, roughness=rough)
