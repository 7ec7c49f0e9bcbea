"""Result of `solve`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    Rolling,
    WindowError,
    choose_grid,
    profiles,
    roller_stress,
    solve,
)
from contactstudy.arrays.variables import STRESSES, specification

STEEL = Material(young=210e9, poisson=0.3)
BODY = FiniteLengthSpace(length=0.4e-3, material=STEEL)
CASE = Case(body=BODY, roller=Roller(radius=5e-3, length=0.4e-3), max_pressure=1.5e9, friction=0.1)


@pytest.fixture(scope="module")
def result():
    return solve(CASE, accuracy=0.1, x=[0.0, 0.3e-3], y=[0.0], z=[0.0, 50e-6])


def test_result_contains_documented_variables_with_units(result) -> None:
    documented_names = (
        *("pressure", "traction_y", "gap", "initial_gap", "displacement_z", *STRESSES, "von_mises"),
        *(
            "hertz_half_width",
            "hertz_max_pressure",
            "normal_load",
            "approach",
            "tilt",
            "reference_depth",
            "load_position",
            "iterations",
            "converged",
        ),
        *("iterations", "converged", "load_error", "penetration_error", "open_pressure_error", "load_position_error"),
        "end_traction_residual",
        *(
            name + error
            for name in (
                *("peak_pressure", "peak_pressure_first", "peak_pressure_last"),
                *("end_pressure_first", "end_pressure_last"),
                *("end_load_first", "end_load_last"),
                *("peak_von_mises", "peak_edge_tension"),
            )
            for error in ("", "_error")
        ),
        *(f"peak_von_mises_{axis}" for axis in "xyz"),
        *(f"peak_edge_tension_{axis}" for axis in "xy"),
    )
    assert set(documented_names) == set(result.data_vars)
    for name in documented_names:
        variable_specification = specification(name)
        assert variable_specification is not None
        assert tuple(dim.removesuffix("_field") for dim in result[name].dims) == variable_specification.dims, name
        assert result[name].attrs["units"] == variable_specification.units, name
    for axis in "xyz":
        assert result[axis].attrs["units"] == "m"
    assert result.attrs["Conventions"].startswith("CF")


def test_certificate_is_within_tolerance(result) -> None:
    assert bool(result["converged"])
    assert abs(float(result["load_error"])) < 1e-10
    assert float(result["end_traction_residual"]) < 1e-4
    assert float(result["penetration_error"]) < 1e-5


def test_normal_stress_on_top_equals_pressure(result) -> None:
    surface_stresses = solve(CASE, x=result["x"].values, z=[0.0]).isel(z=0)
    is_inner = (
        surface_stresses["pressure"].values > 0.75e9
    )  # nearer to the contact's border the pressure curves within a cell
    for stress, load, bound in (("sigma_zz", "pressure", 1.5e-2), ("tau_yz", "traction_y", 1.5e-3)):
        assert (
            np.abs(surface_stresses[stress].values + surface_stresses[load].values)[is_inner].max() < bound * 1.5e9
        ), stress


def test_result_survives_netcdf(result, tmp_path) -> None:
    import xarray as xr

    result.to_netcdf(tmp_path / "case.nc")
    with xr.open_dataset(tmp_path / "case.nc") as stored_result:
        for name in STRESSES:
            assert np.array_equal(stored_result[name], result[name])


def test_stresses_have_given_positions_and_zero_end_stress(result) -> None:
    assert result["von_mises"].dims == ("x_field", "y_field", "z")
    assert result["x_field"].values.tolist() == [0.0, 0.3e-3]
    assert abs(result["sigma_xx"].values[0, 0, 1]) < 1e-5 * CASE.hertz_max_pressure  # the residual on the free end


def test_half_space_has_zero_end_traction() -> None:
    case = Case(body=HalfSpace(material=STEEL), roller=CASE.roller, max_pressure=1.5e9)
    assert float(solve(case, x=[0.0], y=[0.0], z=[50e-6], accuracy=0.1)["end_traction_residual"]) == 0.0


def test_grid_beside_roller_raises_error() -> None:
    case = Case(body=HalfSpace(material=STEEL), roller=CASE.roller, max_pressure=1.5e9)
    with pytest.raises(InvalidInputError, match="lies under the roller"):
        solve(case, Grid(x_range=(1.0, 2.0), y_range=(-1e-4, 1e-4), cells_x=8, cells_y=8))
    with pytest.raises(InvalidInputError, match="case = 1"):
        solve(1)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "body",
    [
        pytest.param(FiniteLengthSpace(length=4e-3, material=STEEL), marks=pytest.mark.slow, id="finite"),
        pytest.param(HalfSpace(material=STEEL), id="half-space"),
    ],
)
def test_short_contact_has_sufficient_window(body) -> None:
    crowned_roller = Roller(radius=5e-3, length=4e-3, profile=profiles.FullCrown(0.02))
    case = Case(body=body, roller=crowned_roller, load=400.0)
    with pytest.raises(WindowError, match="choose_grid"):
        solve(case, choose_grid(case), stresses=False)
    computed = solve(case, stresses=False)
    assert bool(computed.converged)
    wide_result = solve(case, choose_grid(case, window=6.0, margin=12.0), stresses=False)
    assert float(computed.pressure.max()) == pytest.approx(float(wide_result.pressure.max()), rel=5e-3)


def test_rough_surface_determines_window() -> None:
    case = Case(
        body=FiniteLengthSpace(length=4e-3, material=STEEL),
        roller=Roller(radius=5e-3, length=4e-3, profile=profiles.FullCrown(0.02)),
        load=400.0,
    )
    grid = choose_grid(case)
    flat_heights = xr.DataArray(np.zeros(grid.shape), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    with pytest.raises(WindowError, match="choose_grid"):
        solve(case, stresses=False, roughness=flat_heights)


@pytest.mark.slow
def test_rolling_case_stresses_include_tractions() -> None:
    """Opposite tractions on two equal bodies with free ends cause equal stresses up to a reflection along y."""
    steel = Material(210e9, 0.3)
    body = FiniteLengthSpace(length=0.5e-3, material=steel)
    roller = Roller(radius=5e-3, length=0.5e-3, material=steel)
    motion = Rolling(longitudinal_creepage=1e-3, spin=1.0)
    case = Case(body=body, roller=roller, max_pressure=1.5e9, friction=0.1, motion=motion)
    grid = choose_grid(case, cells_x=3, cells_y=10, window=1.5)
    result = solve(case, grid, z=[0.0, 5e-5])
    assert result.converged
    assert 0 < int(result.stick.sum()) < int((result.pressure > 0).sum())
    surface_stresses = result.isel(z=0)
    inner_cells = {"x": slice(2, -2)}
    peak = float(result.pressure.max())
    for stress, load in (("tau_yz", "traction_y"), ("tau_xz", "traction_x"), ("sigma_zz", "pressure")):
        assert float(np.abs(surface_stresses[stress] + result[load]).isel(inner_cells).max()) < 2e-2 * peak, stress
    assert float(result.end_traction_residual) < 2e-4
    tractions = {name: result[name] for name in ("traction_x", "traction_y")}
    roller_stresses = roller_stress(case, result.pressure, z=[5e-5], **tractions)
    reversed_case = replace(case, motion=Rolling(longitudinal_creepage=-1e-3, spin=-1.0))
    reversed_result = solve(reversed_case, grid, z=[5e-5])
    assert np.allclose(roller_stresses.von_mises.values, reversed_result.von_mises.values, rtol=1e-4, atol=1e-4 * peak)
    with pytest.raises(InvalidInputError, match="traction_x, traction_y"):
        roller_stress(case, result.pressure, z=[5e-5])


def test_accuracy_with_given_cells_raises_error() -> None:
    case = Case(body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=1e-3), max_pressure=1e9)
    with pytest.raises(InvalidInputError, match=r"accuracy = 0\.01"):
        solve(case, choose_grid(case), accuracy=0.01)
