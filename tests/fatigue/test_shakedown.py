"""Melan's bound with residual stress along rolling: line contacts, loaded corners, small histories."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import optimize

from contactstudy import InvalidInputError, fatigue, stress_field
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, STRESSES
from contactstudy.fatigue.shakedown import shakedown_summary, to_ball_axes
from contactstudy.verification.closed_forms import hertz_strip

DEPTHS = np.linspace(0.0, 1.5, 61)
Y = np.linspace(-6.0, 6.0, 241)


@pytest.fixture(scope="module")
def line_contact():
    """Make Hertz' line contact of half-width and peak pressure 1, nu = 0.3, at depths from 0."""

    def make_contact(friction: float) -> xr.Dataset:
        result = hertz_strip(Y[:, None], DEPTHS, 1.0, 1.0, 0.3, friction)
        fields = {name: (("y", "z"), values) for name, values in result.items()}
        return xr.Dataset(fields, {"y": Y, "z": DEPTHS}).assign(hertz_max_pressure=1.0)

    return make_contact


LIMITS = {
    0.0: (3.107, 3.536, 4.000),
    0.2: (2.936, 2.972, 3.203),
    0.4: (2.123, 2.206, 2.316),
}
"""Limits of p0 / k by friction: first yield, shakedown by rho_yy, shakedown by rho_yy and rho_xx (4.0 by Johnson).
First yield lies on the surface from f = 0.3, shakedown at f = 0.4."""


@pytest.mark.parametrize("friction", LIMITS)
def test_line_contact_limits_equal_published_values(line_contact, friction: float) -> None:
    first_yield, rolling_limit, two_stress_limit = LIMITS[friction]
    result = line_contact(friction)
    computed, axial = fatigue.shakedown_limit(result), fatigue.shakedown_limit(result, axial=True)
    assert float(computed["first_yield_limit"]) == pytest.approx(first_yield, rel=1e-3)
    assert float(computed["shakedown_limit"]) == pytest.approx(rolling_limit, rel=1e-3)
    assert float(axial["shakedown_limit"]) == pytest.approx(two_stress_limit, rel=1e-3)
    expected_comment = "on the top" if friction == 0.4 else "below the top"
    assert computed["peak_shakedown_stress"].attrs["comment"] == expected_comment


@pytest.mark.parametrize("friction", [0.3, 0.4])
def test_shakedown_stress_on_surface_equals_closed_form(line_contact, friction: float) -> None:
    """On the surface s_zz = -p, s_yy = -p - 2 f p0 y/a, t_yz = -f p, s_xx = nu (s_yy + s_zz) (under the contact)."""
    y = np.linspace(-1, 1, 20001)
    pressure = np.sqrt(1 - y**2)
    zz, yy, shear = -pressure, -pressure - 2 * friction * y, friction * pressure
    xx = 0.3 * (yy + zz)
    squared_stress = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * shear**2
    surface_result = fatigue.shakedown(line_contact(friction)).isel(z=0)
    assert float(surface_result["first_yield_stress"]) == pytest.approx(np.sqrt(squared_stress.max() / 3), rel=1e-4)

    def max_stress(rho: float) -> float:
        return float(np.sqrt((squared_stress + 2 * rho * (yy - 0.5 * (xx + zz)) + rho**2).max() / 3))

    minimum = optimize.minimize_scalar(max_stress, bounds=(-2, 2), options={"xatol": 1e-9}).fun
    assert float(surface_result["shakedown_stress"]) == pytest.approx(minimum, rel=2e-4)


def test_limit_error_covers_difference_from_finer_positions(line_contact) -> None:
    fine_result = line_contact(0.2)
    coarse_result = fine_result.isel(y=slice(None, None, 4), z=slice(None, None, 4))
    result, fine_limits = fatigue.shakedown_limit(coarse_result), fatigue.shakedown_limit(fine_result)
    for name in ("shakedown_limit", "first_yield_limit"):
        error = float(result[f"{name}_error"])
        assert abs(float(result[name] - fine_limits[name])) < error < 0.1 * float(result[name])


def test_limit_error_of_shallow_depths_is_infinite(line_contact) -> None:
    result = fatigue.shakedown_limit(line_contact(0.0).isel(z=slice(0, 10)))
    assert np.isinf(float(result["peak_shakedown_stress_error"]))
    assert np.isinf(float(result["shakedown_limit_error"]))


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_corner_pressure_bounds_the_limit(short_body, strip_pressure, friction: float) -> None:
    """With rho_yy alone the ratio p / k is about 2 / sqrt(1 + 4 f^2), the upper bound."""
    pressure = strip_pressure(8.0, (64, 64))
    stress = stress_field(short_body, pressure, friction=friction, x=[0.0], z=[0.0], inside_cells=pressure)
    result = fatigue.shakedown(stress)
    limit = float(pressure.max() / result["shakedown_stress"].squeeze())
    bound = 2 / np.sqrt(1 + 4 * friction**2)
    assert 0.9 * bound < limit < bound * (1 + 2e-3)


histories = arrays(float, (1, 7, 6), elements=st.integers(-3, 3).map(float))


@settings(max_examples=10)
@given(history=histories)
def test_shakedown_stress_is_minimal(history: np.ndarray) -> None:
    """A one-dimensional search finds the same minimum; integers give many equal instants."""
    names = dict(zip(STRESSES, np.moveaxis(history[0], -1, 0), strict=True))
    data = xr.Dataset({name: ("y", values) for name, values in names.items()}, {"y": np.arange(7.0)})
    result = fatigue.shakedown(data)
    unloaded_history = np.append(history[0], np.zeros((1, 6)), axis=0)
    u, v, remainder = to_ball_axes(unloaded_history)

    def max_stress(rho: float, along_x: float = 0.0) -> float:
        squares = (u + rho - 0.5 * along_x) ** 2 + (v + 0.5 * np.sqrt(3) * along_x) ** 2
        return float(np.sqrt((squares + remainder).max() / 3))

    minimum = optimize.minimize_scalar(max_stress, bounds=(-20, 20), options={"xatol": 1e-10}).fun
    assert float(result["shakedown_stress"]) == pytest.approx(minimum, rel=1e-7, abs=1e-9)
    assert max_stress(float(result["residual_sigma_yy"])) == pytest.approx(float(result["shakedown_stress"]), abs=1e-8)
    axial = fatigue.shakedown(data, axial=True)
    residual = [float(axial[name]) for name in ("residual_sigma_yy", "residual_sigma_xx")]
    assert max_stress(*residual) == pytest.approx(float(axial["shakedown_stress"]), abs=1e-8)
    steps = np.random.default_rng(3).normal(size=(200, 2)) * np.logspace(-3, 0.5, 200)[:, None]
    assert min(max_stress(*(residual + step)) for step in steps) >= float(axial["shakedown_stress"]) * (1 - 1e-9)


def test_residual_stress_cancels_pulsating_stress_along_y() -> None:
    """The residual stress balances the stress along y; the shear keeps its whole amplitude."""
    load_history = xr.DataArray([0.0, 1.0, 0.0], dims="y", coords={"y": [0.0, 1.0, 2.0]})
    result = fatigue.shakedown(xr.Dataset({name: load_history * (name in ("sigma_yy", "tau_xz")) for name in STRESSES}))
    assert float(result["shakedown_stress"]) == pytest.approx(1.0, abs=0.02)
    assert float(result["first_yield_stress"]) == pytest.approx(np.sqrt(4 / 3))


def test_shakedown_stress_scales_with_load(line_contact) -> None:
    unit_result, scaled_result = (fatigue.shakedown(factor * line_contact(0.1)) for factor in (1, 2e9))
    assert np.allclose(scaled_result["shakedown_stress"], 2e9 * unit_result["shakedown_stress"], rtol=1e-9)


def test_shakedown_of_study_has_study_dimensions(case_result: xr.Dataset) -> None:
    result = fatigue.shakedown(case_result)
    assert result["shakedown_stress"].dims == ("x_field", "z")
    assert (result["shakedown_stress"] <= result["first_yield_stress"] * (1 + 1e-9)).all()
    two_cases = xr.concat([case_result[list(STRESSES)].reset_coords(drop=True)] * 2, "case").chunk(case=1)
    study_result = fatigue.shakedown(two_cases)["shakedown_stress"]
    assert study_result.dims == ("case", "x_field", "z")
    assert study_result.chunks is not None
    assert np.allclose(study_result.isel(case=1), result["shakedown_stress"])


def test_limits_of_a_study_equal_single_cases(line_contact) -> None:
    """The study equals the single cases; a case without stresses has NaN."""
    cases = [line_contact(friction).isel(z=slice(0, None, 8)).assign(hertz_half_width=1.0) for friction in (0.0, 0.2)]
    cases.append(cases[0] * np.nan)
    study = xr.concat(cases, xr.Variable("friction", [0.0, 0.2, 0.4])).chunk(friction=1)
    result = fatigue.shakedown_limit(study)
    assert result["shakedown_limit"].dims == ("friction",)
    for index, friction in enumerate((0.0, 0.2)):
        single_limits = fatigue.shakedown_limit(line_contact(friction).isel(z=slice(0, None, 8)))
        for name in ("shakedown_limit", "peak_shakedown_stress", "peak_shakedown_stress_z", "shakedown_limit_error"):
            assert float(result[name][index]) == pytest.approx(float(single_limits[name]))
    assert np.isnan(result["shakedown_limit"][2])
    assert result["shakedown_limit"].attrs["units"] == "1"


def test_axial_stress_at_many_positions_is_rejected(case_result: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="line contact"):
        fatigue.shakedown(case_result, axial=True)


def test_narrow_window_has_an_infinite_error(line_contact) -> None:
    """The shear before and behind the contact equals the critical stress in the middle."""
    result = fatigue.shakedown_limit(line_contact(0.0).sel(y=slice(-0.3, 0.3)))
    assert np.isinf(float(result["shakedown_limit_error"]))
    assert "along y" in result["peak_shakedown_stress_error"].attrs["comment"]


def test_shakedown_stress_has_no_estimated_error(line_contact) -> None:
    result = line_contact(0.1)
    assert all(array.attrs[ERROR_KIND] == NOT_ESTIMATED for array in fatigue.shakedown(result, axial=True).values())
    assert ERROR_KIND not in fatigue.shakedown_limit(result)["peak_shakedown_stress"].attrs


def test_summary_of_passage_equals_limit(line_contact) -> None:
    result = line_contact(0.1).isel(z=slice(0, None, 4))
    summary = shakedown_summary(result)
    limit = fatigue.shakedown_limit(result)
    assert set(summary.data_vars) == set(limit.data_vars)
    assert not summary.coords
    for name in ("shakedown_limit", "first_yield_limit", "shakedown_limit_error"):
        assert float(summary[name]) == float(limit[name])


@pytest.mark.parametrize("missing", ["stresses", "passage", "load"])
def test_summary_of_incomplete_result_is_empty(line_contact, missing: str) -> None:
    result = line_contact(0.1)
    incomplete_results = {
        "stresses": result.drop_vars("tau_xy"),
        "passage": result.sel(y=[0.0]),
        "load": 0.0 * result,
    }
    assert not shakedown_summary(incomplete_results[missing])
