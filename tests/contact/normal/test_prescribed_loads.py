"""Prescribed values of a contact: load, its position, tilt, approach; and rough surfaces."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    ConvergenceWarning,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    choose_grid,
    profiles,
    solve,
    solve_contact,
)
from contactstudy.contact import ContactSettings
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.roughness import self_affine
from tests.crowned_case import BODY, HALF_WIDTH, LENGTH, STEEL, make_crowned_case
from tests.reference_line import compute_line_slope


@pytest.mark.parametrize("offset", [-2.5, 0.0])
def test_resultant_acts_at_prescribed_position(offset: float):
    position = 0.5 * LENGTH + offset * HALF_WIDTH
    result = solve(make_crowned_case(load_position=position), stresses=False, accuracy=0.05)
    assert bool(result.converged)
    line_load = result.pressure.sum("y") * result.x_width
    assert abs(float((line_load * line_load.x).sum() / line_load.sum()) - position) < 1e-6 * LENGTH
    assert float(result.load_position) == pytest.approx(position, abs=1e-6 * LENGTH)
    if offset == 0:
        assert abs(float(result.tilt)) < 1e-9
    else:
        assert float(result.tilt) * offset > 1e-6 * abs(offset)
    assert float(result.penetration_error) < 1e-5


def test_resulting_tilt_reproduces_position():
    case = make_crowned_case(load_position=0.5 * LENGTH + HALF_WIDTH)
    grid = choose_grid(case, cells_x=8, cells_y=8)
    free_result = solve(case, grid, stresses=False)
    tilted_result = solve(make_crowned_case(tilt=float(free_result.tilt)), grid, stresses=False)
    np.testing.assert_allclose(
        tilted_result.pressure, free_result.pressure, atol=5e-5 * float(free_result.pressure.max())
    )
    assert float(tilted_result.load_position) == pytest.approx(float(free_result.load_position), abs=1e-5 * LENGTH)


def test_opposite_tilts_mirror_the_pressure():
    results = [solve(make_crowned_case(tilt=tilt), stresses=False, accuracy=0.05) for tilt in (2e-4, -2e-4)]
    tilted_pressure, mirrored_pressure = (result.pressure.values for result in results)
    np.testing.assert_allclose(tilted_pressure, mirrored_pressure[::-1], atol=1e-5 * tilted_pressure.max())
    assert float(results[0].load_position) > 0.5 * LENGTH + 0.1 * HALF_WIDTH


def test_load_at_mid_length_has_no_tilt():
    free_result, held_result = (
        solve(make_crowned_case(load_position=load_position), stresses=False) for load_position in (0.5 * LENGTH, None)
    )
    assert abs(float(free_result.tilt)) < 1e-9
    np.testing.assert_allclose(
        free_result.pressure, held_result.pressure, atol=1e-5 * float(held_result.pressure.max())
    )


@pytest.mark.parametrize("body", [BODY, HalfSpace(material=STEEL)], ids=["finite", "half-space"])
def test_prescribed_approach_equals_prescribed_load(body):
    case = make_crowned_case(body=body, end_distance=2 * HALF_WIDTH)
    grid = choose_grid(case)
    gap = xr.DataArray(case.gap(grid), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    contact_by_load = solve_contact(body, gap, load=case.normal_load)
    contact_by_approach = solve_contact(body, gap, approach=float(contact_by_load.approach))
    assert bool(contact_by_approach.converged)
    assert float(contact_by_approach["normal_load"]) == pytest.approx(case.normal_load, rel=1e-5)
    np.testing.assert_allclose(
        contact_by_approach.pressure, contact_by_load.pressure, atol=1e-4 * float(contact_by_load.pressure.max())
    )
    assert float(contact_by_approach.approach) == float(contact_by_load.approach)


def test_approach_of_hertz_point_contact():
    centres = np.linspace(-1.5, 1.5, 97)
    gap = xr.DataArray(0.5 * (centres[:, None] ** 2 + centres**2), coords={"x": centres, "y": centres}, dims=("x", "y"))
    contact = solve_contact(HalfSpace(material=Material(0.75, 0.5)), gap, approach=1.0)  # radius 1, load 4/3
    assert float(contact["normal_load"]) == pytest.approx(4 / 3, rel=1e-3)
    assert float(contact.pressure.max()) == pytest.approx(2 / np.pi, rel=1e-3)


@pytest.mark.parametrize("closure", [0.2, 0.8, 1.2])
def test_wavy_surface_matches_westergaard(closure: float):
    """The pressure on the touching part of a wave follows from the mean pressure (Johnson, section 13.2).

    A body with mirrored ends is periodic along x; over one short wavelength the mean pressure is uniform along y.
    """
    modulus, wavelength = STEEL.plane_strain_modulus, 0.25 * HALF_WIDTH
    body = FiniteLengthSpace(length=wavelength, material=STEEL, model="mirror")
    case = Case(body=body, roller=Roller(radius=5e-3, length=wavelength), max_pressure=1.5e9)
    grid = choose_grid(case, cells_x=256, cells_y=32, window=1.5)
    amplitude = 1.5e9 / closure * wavelength / (np.pi * modulus)
    phase = np.pi * (grid.x / wavelength - 0.5)
    heights = amplitude * np.cos(2 * phase)[:, None] + 0 * grid.y
    roughness = xr.DataArray(heights, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    result = solve(case, grid, roughness=roughness, stresses=False)
    assert bool(result.converged)
    wave_pressure = result.pressure.sel(y=0.0, method="nearest")
    mean_pressure = float(wave_pressure.mean())
    ratio = mean_pressure * wavelength / (np.pi * modulus * amplitude)
    if closure > 1:
        assert bool((wave_pressure > 0).all())
        expected = mean_pressure + (mean_pressure / ratio) * np.cos(2 * phase)
    else:
        edge = phase[wave_pressure.values > 0].max() + 0.5 * np.pi / grid.cells_x
        assert np.sin(edge) ** 2 == pytest.approx(ratio, abs=0.025)
        squared_profile = np.maximum(ratio - np.sin(phase) ** 2, 0.0)
        expected = 2 * mean_pressure * np.cos(phase) / ratio * np.sqrt(squared_profile)
    assert np.abs(wave_pressure - expected).max() < 0.05 * mean_pressure / min(ratio, 1.0)
    assert np.abs(wave_pressure - expected).mean() < 0.01 * mean_pressure


def test_self_affine_surfaces_converge():
    case = make_crowned_case()
    grid = choose_grid(case, window=4.0, cells_y=8)
    roughness = self_affine(
        grid, rms_height=0.1e-6, hurst=0.8, longest=2 * HALF_WIDTH, shortest=4 * max(grid.dx, grid.dy), seed=1
    )
    result = solve(case, grid, roughness=roughness, stresses=False)
    smooth_result = solve(case, grid, stresses=False)
    assert bool(result.converged)
    assert int(result.iterations) < 150
    assert abs(float(result.load_error)) < 1e-12
    assert float(result.penetration_error) < 1e-5
    assert float(result.pressure.max()) > 1.5 * float(smooth_result.pressure.max())
    assert int((result.pressure > 0).sum()) < int((smooth_result.pressure > 0).sum())


def test_roughness_on_other_cells_is_interpolated():
    case = make_crowned_case()
    grid = choose_grid(case)
    wider_grid = Grid(
        x_range=(-0.1 * LENGTH, 1.1 * LENGTH), y_range=(-5 * HALF_WIDTH, 5 * HALF_WIDTH), cells_x=150, cells_y=90
    )

    def compute_sloping_heights(cells: Grid) -> xr.DataArray:  # the plane is bilinear, so that interpolation is exact
        heights = 1e-3 * (cells.x[:, None] - 0.5 * LENGTH) + 2e-3 * cells.y
        return xr.DataArray(heights, coords={"x": cells.x, "y": cells.y}, dims=("x", "y"))

    expected, interpolated_result = (
        solve(case, grid, roughness=compute_sloping_heights(cells), stresses=False) for cells in (grid, wider_grid)
    )
    np.testing.assert_allclose(interpolated_result.initial_gap, expected.initial_gap, atol=1e-18)
    tilted_result = solve(make_crowned_case(tilt=1e-3), grid, stresses=False)
    assert float(expected.load_position) == pytest.approx(float(tilted_result.load_position), abs=1e-2 * HALF_WIDTH)


def test_flat_height_map_changes_approach_only():
    case = make_crowned_case()
    grid = choose_grid(case)
    flat_heights = xr.DataArray(np.full(grid.shape, 1e-6), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    smooth_result, rough_result = (
        solve(case, grid, roughness=heights, stresses=False) for heights in (None, flat_heights)
    )
    np.testing.assert_allclose(
        rough_result.pressure, smooth_result.pressure, atol=1e-6 * float(smooth_result.pressure.max())
    )
    assert float(rough_result.approach) == pytest.approx(float(smooth_result.approach) - 1e-6, rel=1e-6)


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
def test_invalid_cases_raise_error(arguments, parameter: str):
    with pytest.raises(InvalidInputError, match=parameter):
        make_crowned_case(**arguments)


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
def test_invalid_prescriptions_raise_error(arguments, parameter: str):
    case = make_crowned_case()
    grid = choose_grid(case, cells_x=2, cells_y=4)
    gap = xr.DataArray(case.gap(grid), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    settings = ContactSettings(load_position=arguments.pop("load_position", None))
    with pytest.raises(InvalidInputError, match=parameter):
        solve_contact(BODY, gap, **arguments, settings=settings)


def test_roughness_must_cover_the_cells():
    case = make_crowned_case()
    grid = choose_grid(case, cells_x=2, cells_y=4)
    roughness = xr.DataArray(np.zeros((4, 4)), coords={"x": np.arange(4.0), "y": np.arange(4.0)}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match="roughness"):
        solve(case, grid, roughness=roughness)


def test_approach_and_tilt_state_reference():
    result = solve(make_crowned_case(load_position=11 * HALF_WIDTH), stresses=False)
    assert float(result.reference_depth) == LENGTH
    assert "roller_reference_depth" not in result
    assert all("reference_depth" in result[name].attrs["long_name"] for name in ("approach", "tilt"))
    assert result.tilt.attrs["centre"] == "load_position"
    assert solve(make_crowned_case(tilt=1e-4), stresses=False).tilt.attrs["centre"] == "the roller's mid-length"


def test_load_near_end_acts_at_prescribed_position():
    """The initial guess lies on one side of the load: no multiple of this guess balances the load."""
    body = FiniteLengthSpace(length=2e-3, material=STEEL)
    crowned_roller = Roller(radius=5e-3, length=10e-3, profile=profiles.FullCrown(0.2))
    arguments = {"body": body, "max_pressure": 1.5e9, "end_distance": -9.9e-3, "load_position": 5e-5}
    for grid in (None, Grid(x_range=(0.0, 2e-3), y_range=(-4e-4, 4e-4), cells_x=320, cells_y=64)):
        result = solve(Case(roller=crowned_roller, **arguments), grid, stresses=False)
        assert bool(result.converged)
        assert float(result.load_position) == pytest.approx(5e-5, abs=1e-9)
    steep_roller = Roller(radius=5e-3, length=10e-3, profile=profiles.FullCrown(5e-3))
    with pytest.raises(InvalidInputError, match=r"load_position = 5e-05: must be None, .* inclined"):
        Case(roller=steep_roller, **arguments)


def compute_balanced_tilt(scale: float) -> float:
    """Tilt relative to the body far away that balances a load off the middle, all lengths times `scale`."""
    length, cells = 0.2e-3 * scale, 16
    x = (np.arange(cells) + 0.5) * length / cells
    y = (np.arange(cells) + 0.5 - cells / 2) * 1e-5 * scale
    gap = xr.DataArray(
        np.broadcast_to(y**2 / (2 * 5e-3 * scale), (cells, cells)), coords={"x": x, "y": y}, dims=("x", "y")
    )
    body = FiniteLengthSpace(length=length, material=STEEL)
    result = solve_contact(body, gap, load=5.0 * scale**2, settings=ContactSettings(load_position=0.6 * length))
    assert bool(result.converged)
    return float(result.tilt) + compute_line_slope(body, result.pressure, length)


def test_balanced_load_scales_with_unit_of_length() -> None:
    tilt = compute_balanced_tilt(1.0)
    # Quadratures of the ends four times finer give 1.341671e-3.
    assert tilt == pytest.approx(1.341671e-3, rel=2e-5)
    assert compute_balanced_tilt(1e-6) == pytest.approx(tilt, rel=1e-9)


def test_tolerance_below_rounding_does_not_converge(on_cells, half_space: HalfSpace):
    gap = on_cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.5, 1.5), (-1.5, 1.5), (24, 24))
    with pytest.warns(ConvergenceWarning, match="penetration_error"):
        result = solve_contact(half_space, gap, load=4 / 3, settings=ContactSettings(tolerance=1e-40))
    assert not bool(result.converged)


def test_several_approaches_form_dimension(on_cells) -> None:
    gap = on_cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.6, 1.6), (-1.6, 1.6), (32, 32))
    body = HalfSpace(material=Material(0.75, 0.5))
    steps = [0.25, 0.5, 1.0]
    computed = solve_contact(body, gap, approach=steps)
    assert computed["pressure"].dims == ("approach", "x", "y")
    assert computed["approach"].values.tolist() == steps
    assert computed["approach"].attrs["units"] == "m"
    xr.testing.assert_allclose(
        computed.sel(approach=0.5).drop_vars("approach"), solve_contact(body, gap, approach=0.5).drop_vars("approach")
    )
    # Hertz: W = 4/3 E* R**(1/2) d**(3/2), with E* = R = 1
    np.testing.assert_allclose(computed["normal_load"], 4 / 3 * np.array(steps) ** 1.5, rtol=0.02)
    for invalid_approach in ([], [0.1, np.nan], [[0.1]], "deep"):
        with pytest.raises(InvalidInputError, match="approach"):
            solve_contact(body, gap, approach=invalid_approach)
    with pytest.raises(InvalidInputError, match="after"):
        solve_contact(body, gap, approach=steps, settings=ContactSettings(after=computed))


def test_levers_are_relative_to_largest() -> None:
    for position in (0.0, 5.0):
        grid = Grid.between(position + np.array([0.0, 1.0, 2.0, 4.0]), (0.0, 1.0), 2)
        request = PrescribedLoad(3.0, position + 1.0)
        assert request.max_arm(grid) == pytest.approx(2.0)
        computed = request.resultants(grid)
        assert computed.lever is not None
        assert computed.lever[:, 0] == pytest.approx([-0.25, 0.25, 1.0])
        assert computed.total == pytest.approx(3.0 / grid.cell_area)
