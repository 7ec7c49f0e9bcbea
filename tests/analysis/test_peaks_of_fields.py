"""Peak stress between the samples, with its error."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, HalfSpace, InvalidInputError, Material, Roller, analysis, solve
from contactstudy.arrays.variables import STRESSES

STEEL = Material(210e9, 0.3)
HALF_WIDTH = 2 * 1.5e9 * 5e-3 / STEEL.plane_strain_modulus


def make_pure_shear(values: xr.DataArray) -> xr.Dataset:
    """Stresses of pure shear: the maximum shear equals the absolute value of the shear."""
    zero = xr.zeros_like(values)
    return xr.Dataset(dict.fromkeys(STRESSES, zero) | {"tau_yz": values})


def make_gaussian_shear(x: np.ndarray, z: np.ndarray) -> xr.Dataset:
    """A Gaussian shear stress with the maximum 3 at x = 0.3, z = 0.7."""
    x_term, z_term = xr.DataArray(x, dims="x", coords={"x": x}), xr.DataArray(z, dims="z", coords={"z": z})
    values = 3 * np.exp(-((x_term - 0.3) ** 2) - (z_term - 0.7) ** 2)
    return make_pure_shear(values.expand_dims(y=[0.0]).transpose("x", "y", "z"))


@pytest.mark.parametrize("spacing", [0.3, 0.2, 0.1])
def test_peak_between_samples_is_within_error(spacing: float) -> None:
    peak = analysis.peak(
        make_gaussian_shear(np.arange(-1.0, 2.0, spacing), np.arange(0.0, 2.0, spacing)), "maximum_shear"
    )
    assert abs(float(peak.peak_maximum_shear) - 3) <= float(peak.peak_maximum_shear_error) < 0.1
    assert float(peak.peak_maximum_shear_x) == pytest.approx(0.3, abs=0.1 * spacing)
    assert float(peak.peak_maximum_shear_z) == pytest.approx(0.7, abs=0.1 * spacing)
    assert peak.peak_maximum_shear_error.attrs["units"] == "Pa"


@pytest.mark.parametrize(("z", "axis"), [(np.linspace(0.8, 2.0, 9), "z"), (np.linspace(0.0, 0.6, 9), "z")])
def test_peak_at_outermost_depth_has_infinite_error(z: np.ndarray, axis: str) -> None:
    peak = analysis.peak(make_gaussian_shear(np.linspace(-1.0, 2.0, 9), z), "maximum_shear")
    assert np.isinf(float(peak.peak_maximum_shear_error))
    assert f"edge of the points along {axis}" in peak.peak_maximum_shear_error.attrs["comment"]


def test_peak_on_the_top_has_finite_error() -> None:
    z = np.linspace(0.0, 2.0, 11)
    values = xr.DataArray(np.exp(-z)[None, None], dims=("x", "y", "z"), coords={"x": [0.0], "y": [0.0], "z": z})
    peak = analysis.peak(make_pure_shear(values), "maximum_shear")
    assert float(peak.peak_maximum_shear_z) == 0.0
    assert float(peak.peak_maximum_shear_error) < 0.1


def solve_with_depths(count: int, **roller: object) -> xr.Dataset:
    body = FiniteLengthSpace(length=12 * HALF_WIDTH, material=STEEL)
    case = Case(
        body=body, roller=Roller(radius=5e-3, length=12 * HALF_WIDTH, **roller), max_pressure=1.5e9, friction=0.1
    )
    points = np.linspace(0.0, 6 * HALF_WIDTH, 2 * count)
    return solve(
        case,
        accuracy=0.05,
        x=points,
        y=HALF_WIDTH * np.linspace(-1, 1, count),
        z=HALF_WIDTH * np.linspace(0, 1.5, count),
    )


@pytest.mark.slow
def test_peak_on_coarse_points_is_within_error() -> None:
    coarse_result, fine_result = (analysis.peak(solve_with_depths(count), "tresca") for count in (9, 25))
    error = abs(float(coarse_result.peak_tresca - fine_result.peak_tresca))
    assert error <= float(coarse_result.peak_tresca_error)
    assert error < 0.005 * float(fine_result.peak_tresca)
    assert float(coarse_result.peak_tresca_z) == pytest.approx(float(fine_result.peak_tresca_z), abs=0.03 * HALF_WIDTH)


def test_peak_of_solved_case_is_stored_peak(case_result: xr.Dataset) -> None:
    peak = analysis.peak(case_result)
    assert float(peak.peak_von_mises) == float(case_result.peak_von_mises)
    assert set(peak.data_vars) == {f"peak_von_mises{suffix}" for suffix in ("", "_error", "_x", "_y", "_z")}


@pytest.mark.parametrize(("spacing_x", "spacing_z", "axis"), [(0.02, 0.2, "z"), (0.15, 0.02, "x")])
def test_peak_with_unresolved_ridge_has_infinite_error(spacing_x: float, spacing_z: float, axis: str) -> None:
    """The pressure has a ridge 0.2 wide along x; the polynomials through the points do not resolve the ridge."""
    positions = np.arange(-1.0, 1.0, 0.02)
    ridge = np.sqrt(np.maximum(1 - (positions / 0.2) ** 2, 0.0))[:, None] * np.ones(20)
    pressure = xr.DataArray(ridge, coords={"x": positions, "y": 0.1 * np.arange(20)}, dims=("x", "y"))
    field = make_gaussian_shear(np.arange(-0.9, 1.0, spacing_x), np.arange(0.0, 2.0, spacing_z)).rename(
        x="x_field", y="y_field"
    )
    peak = analysis.peak(field.assign(pressure=pressure), "maximum_shear")
    assert np.isinf(float(peak.peak_maximum_shear_error))
    comment = peak.peak_maximum_shear_error.attrs["comment"]
    assert f"m apart along {axis}, the pressure varies within 0.2 m: take at most 0.1 m" in comment


def make_stress_beside_narrow_peak(point_x: np.ndarray) -> xr.Dataset:
    """A uniform pressure with a peak 0.1 wide at x = 5; the maximum of the stress is at x = 0.3."""
    positions = np.arange(-2.0, 6.0, 0.02)
    axial_pressure = 1.0 + np.sqrt(np.maximum(1 - ((positions - 5.0) / 0.1) ** 2, 0.0))
    pressure = xr.DataArray(
        axial_pressure[:, None] * np.ones(40), coords={"x": positions, "y": 0.1 * np.arange(40)}, dims=("x", "y")
    )
    x = np.concatenate([np.arange(-1.0, 1.5, 0.3), point_x])
    return make_gaussian_shear(x, np.arange(0.0, 2.0, 0.04)).rename(x="x_field", y="y_field").assign(pressure=pressure)


@pytest.mark.parametrize("x", [np.array([2.0, 3.0]), np.concatenate([[2.0], np.arange(4.8, 5.2, 0.04)])])
def test_peak_away_from_narrow_pressure_has_finite_error(x: np.ndarray) -> None:
    """The narrow peak lies outside the points, or the points at the peak are dense."""
    peak = analysis.peak(make_stress_beside_narrow_peak(x), "maximum_shear")
    assert abs(float(peak.peak_maximum_shear) - 3) <= float(peak.peak_maximum_shear_error) < 0.1


def test_coarse_points_at_narrow_pressure_have_infinite_error() -> None:
    peak = analysis.peak(make_stress_beside_narrow_peak(np.array([2.0, 3.0, 4.0, 4.8, 5.3])), "maximum_shear")
    assert np.isinf(float(peak.peak_maximum_shear_error))


def test_peak_with_singular_pressure_has_infinite_error() -> None:
    case = Case(body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=8 * HALF_WIDTH), max_pressure=1.5e9)
    depths = HALF_WIDTH * np.linspace(0.1, 1.0, 5)
    peak = analysis.peak(solve(case, accuracy=0.05, x=[0.0, HALF_WIDTH, 2 * HALF_WIDTH], y=[0.0], z=depths))
    assert np.isinf(float(peak.peak_von_mises_error))
    assert "singular" in peak.peak_von_mises_error.attrs["comment"]


def test_peak_of_range_over_cycle_raises() -> None:
    with pytest.raises(InvalidInputError, match="orthogonal"):
        analysis.peak(make_gaussian_shear(np.arange(3.0), np.arange(3.0)), "orthogonal_shear_range")


def test_peak_does_not_depend_on_order_of_points() -> None:
    z = np.linspace(0.0, 2.0, 9)
    full_stresses, edge_stresses = (make_gaussian_shear(np.linspace(-1.0, 2.0, 11), depths) for depths in (z, z[:4]))
    for stresses in (full_stresses, edge_stresses):
        unsorted_peak = analysis.peak(stresses, "maximum_shear")
        rolled_peak = analysis.peak(stresses.isel(z=np.roll(np.arange(stresses.sizes["z"]), 2)), "maximum_shear")
        assert float(rolled_peak.peak_maximum_shear) == pytest.approx(
            float(unsorted_peak.peak_maximum_shear), rel=1e-12
        )
        assert float(rolled_peak.peak_maximum_shear_error) == pytest.approx(
            float(unsorted_peak.peak_maximum_shear_error), rel=1e-9
        )


def test_peak_of_negative_stress_has_error() -> None:
    x = np.linspace(-1.0, 1.2, 12)
    hydrostatic = xr.DataArray(-5 + np.exp(-(x**2)), dims="x", coords={"x": x}).expand_dims(y=[0.0], z=[1.0])
    stresses = xr.Dataset(
        {name: hydrostatic if name.startswith("sigma") else xr.zeros_like(hydrostatic) for name in STRESSES}
    )
    peak = analysis.peak(stresses.assign(peak_pressure=10.0, peak_pressure_error=1.0), "hydrostatic")
    assert float(peak.peak_hydrostatic) == pytest.approx(-4.0, abs=0.01)
    assert float(peak.peak_hydrostatic_error) > 0.39
