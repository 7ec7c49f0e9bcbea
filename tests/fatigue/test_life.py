"""Relative life: integrals in closed form, and the load exponents of bearing standards."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis, fatigue
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED
from contactstudy.fatigue import LifeExponents


def compute_orthogonal_shear(result: xr.Dataset) -> xr.DataArray:
    return analysis.measure(result, "orthogonal_shear_amplitude")


def test_line_contact_risk_equals_the_integral(strip_result) -> None:
    result = fatigue.lundberg_palmgren(strip_result())
    # The maximum between the positions along y is 0.25.
    assert result["shear_amplitude"].values == pytest.approx(0.25, abs=3e-4)
    assert result["shear_depth"].values == pytest.approx(0.5, abs=1e-2)
    expected = 0.25 ** (31 / 3) * 0.5 ** (1 - 7 / 3) * 4.0
    assert float(result["risk"]) == pytest.approx(expected, rel=2e-2)


@pytest.mark.parametrize("factor", [0.7, 2.3])
def test_line_contact_life_exponent_is_four(strip_result, factor: float) -> None:
    """The load of a line contact is proportional to p0 squared, and a to p0, at constant roller length."""
    lives = []
    for model in (fatigue.lundberg_palmgren, lambda result: fatigue.ioannides_harris(compute_orthogonal_shear(result))):
        base_result, loaded_result = strip_result(), strip_result(factor, factor)
        loaded_result = loaded_result.assign_coords(x_field=base_result["x_field"])
        lives.append(float(fatigue.relative_life(model(loaded_result), model(base_result))))
    assert lives == pytest.approx([factor**-8] * 2, rel=1e-6)


def test_point_contact_life_exponent_is_three(strip_result) -> None:
    """A point contact also grows along x: risk ~ p0**10, life ~ p0**-9, load ~ p0**3."""
    exponents = LifeExponents(weibull=10 / 9)
    risks = [fatigue.lundberg_palmgren(contact, exponents) for contact in (strip_result(2.0, 2.0), strip_result())]
    assert float(fatigue.relative_life(*risks, exponents)) == pytest.approx(2.0**-9)


def test_fatigue_limit_increases_relative_life(strip_result) -> None:
    reference_risk = fatigue.ioannides_harris(compute_orthogonal_shear(strip_result()), limit=0.2)
    lower_result = strip_result(0.9, 0.9)
    lives = []
    for stress_limit in (0.0, 0.1, 0.2):
        risks = [
            fatigue.ioannides_harris(compute_orthogonal_shear(contact), stress_limit)
            for contact in (lower_result, strip_result())
        ]
        lives.append(float(fatigue.relative_life(*risks)))
    assert lives[0] < lives[1] < lives[2]
    zero_risk = fatigue.ioannides_harris(compute_orthogonal_shear(lower_result), limit=0.3)
    assert float(zero_risk["risk"]) == 0.0
    assert np.isnan(zero_risk["mean_depth"]).all()
    loaded_risk = fatigue.ioannides_harris(compute_orthogonal_shear(strip_result(1.5, 1.5)), limit=0.3)
    assert float(fatigue.relative_life(zero_risk, loaded_risk)) == np.inf
    assert np.isnan(float(fatigue.relative_life(zero_risk, zero_risk)))
    with pytest.raises(InvalidInputError, match=r"fatigue_limit = 0.2.*fatigue_limit = 0.3"):
        fatigue.relative_life(zero_risk, reference_risk)
    with pytest.raises(InvalidInputError, match="theory = Ioannides and Harris"):
        fatigue.relative_life(
            fatigue.lundberg_palmgren(lower_result), fatigue.ioannides_harris(compute_orthogonal_shear(lower_result))
        )


@pytest.mark.parametrize("step", [1, 2, 3])
def test_risk_error_covers_spacing_of_positions(strip_result, step: int) -> None:
    result = strip_result().isel(z=slice(None, None, step), y_field=slice(None, None, step))
    computed = fatigue.lundberg_palmgren(result)
    expected = 0.25 ** (31 / 3) * 0.5 ** (1 - 7 / 3) * 4.0
    error = float(computed["risk_error"])
    assert abs(float(computed["risk"]) - expected) < error < 0.9 * step**2 * expected
    assert "positions alone" in computed["risk_error"].attrs["comment"]
    assert computed["risk_error"].attrs["units"] == computed["risk"].attrs["units"]


def test_risk_error_includes_pressure_error(strip_result) -> None:
    result_without_error = fatigue.lundberg_palmgren(strip_result())
    result_with_error = strip_result().assign(peak_pressure=1.0, peak_pressure_error=0.01)
    result = fatigue.lundberg_palmgren(result_with_error)
    increase = float(result["risk_error"] - result_without_error["risk_error"]) / float(result_without_error["risk"])
    assert increase == pytest.approx(0.01 * 31 / 3)
    first_error, reference_error = (float(risk["risk_error"] / risk["risk"]) for risk in (result, result_without_error))
    life = fatigue.relative_life(result, result_without_error)
    # The error is the difference from the longest life within both errors.
    assert float(life["relative_life_error"]) == pytest.approx(
        ((1 + reference_error) / (1 - first_error)) ** (8 / 9) - 1
    )
    singular_result = strip_result().assign(peak_pressure=np.inf, peak_pressure_error=np.inf)
    assert float(fatigue.lundberg_palmgren(singular_result)["risk_error"]) == np.inf


@pytest.mark.parametrize(("first", "last"), [(0.1, 0.7), (0.1, 1.0), (0.3, 2.0), (0.4, 2.0), (0.2, 0.8)])
def test_risk_error_covers_missing_depths(strip_result, first: float, last: float) -> None:
    amplitude = compute_orthogonal_shear(strip_result())
    full_result = fatigue.ioannides_harris(amplitude)
    partial_result = fatigue.ioannides_harris(amplitude.sel(z=slice(first - 1e-9, last + 1e-9)))
    assert abs(float(partial_result["risk"] - full_result["risk"])) < float(partial_result["risk_error"])


def test_risk_error_of_few_positions_along_x_is_infinite(strip_result) -> None:
    for indices in ([0, -1], [0, 4, -1]):
        assert float(fatigue.lundberg_palmgren(strip_result().isel(x_field=indices))["risk_error"]) == np.inf


def test_risk_of_utilisation_has_unit_of_length_power(strip_result) -> None:
    utilisation = (compute_orthogonal_shear(strip_result()) / 0.25).assign_attrs(units="1")
    assert fatigue.ioannides_harris(utilisation, 0.5)["risk"].attrs["units"] == "m**-0.333333"


def test_risk_error_of_few_depths_is_infinite(strip_result) -> None:
    result = fatigue.lundberg_palmgren(strip_result().isel(z=slice(0, None, 12)))
    assert float(result["risk_error"]) == np.inf
    assert float(fatigue.relative_life(result, result)["relative_life_error"]) == np.inf


@pytest.mark.slow
def test_risk_error_of_solved_case_covers_half_of_positions(case_result: xr.Dataset) -> None:
    """The risk on half of the positions is within the error."""
    full_result = fatigue.lundberg_palmgren(case_result)
    assert 0 < float(full_result["risk_error"]) < np.inf
    half_of_positions = fatigue.lundberg_palmgren(case_result.isel(x_field=slice(None, None, 2)))
    assert abs(float(half_of_positions["risk"] - full_result["risk"])) <= float(
        half_of_positions["risk_error"] + full_result["risk_error"]
    )
    case_pair = xr.concat([case_result[["tau_yz"]], 1.1 * case_result[["tau_yz"]]], "case")
    single_errors = [fatigue.lundberg_palmgren(case_pair.isel(case=index))["risk_error"] for index in (0, 1)]
    np.testing.assert_allclose(fatigue.lundberg_palmgren(case_pair)["risk_error"], single_errors)


def test_incomplete_passage_is_rejected(strip_result) -> None:
    """The largest shear lies at y = 0.87 a and z = 0.5 a, outside the positions."""
    result = strip_result()
    narrow_result = result.sel(y_field=slice(-0.7, 0.7))
    shallow_result, deep_result = result.sel(z=slice(0.0, 0.45)), result.sel(z=slice(0.55, None))
    with pytest.raises(InvalidInputError, match="first or last y in sections with 1 of the risk"):
        fatigue.lundberg_palmgren(narrow_result)
    for call in (fatigue.lundberg_palmgren, lambda risk: fatigue.ioannides_harris(compute_orthogonal_shear(risk))):
        with pytest.raises(InvalidInputError, match="first or last depth in sections with 1 of the risk"):
            call(shallow_result)
        with pytest.raises(InvalidInputError, match="first or last depth in sections with 1 of the risk"):
            call(deep_result)


def test_risk_of_stresses_in_megapascals_is_equal(strip_result) -> None:
    result = strip_result(1e9, 1e-3)
    converted_result = result.assign({"tau_yz": (1e-6 * result["tau_yz"]).assign_attrs(units="MPa")})
    converted_result = converted_result.assign_coords({"z": (1e3 * converted_result["z"]).assign_attrs(units="mm")})
    xr.testing.assert_allclose(fatigue.lundberg_palmgren(converted_result), fatigue.lundberg_palmgren(result))
    shear_in_pascals, shear_in_megapascals = (
        compute_orthogonal_shear(result),
        (1e-6 * compute_orthogonal_shear(result)).assign_attrs(units="MPa"),
    )
    xr.testing.assert_allclose(
        fatigue.ioannides_harris(shear_in_megapascals, 1e8), fatigue.ioannides_harris(shear_in_pascals, 1e8)
    )


def test_risk_of_linear_stress_equals_integral_by_hand() -> None:
    """The integral of (1 - z) on 0..1 with c = 1 has volume 1/2 and mean depth 1/3, over a length of 2."""
    z = np.linspace(0, 1, 401)
    stress = xr.DataArray(np.tile(1 - z, (3, 1)), dims=("x", "z"), coords={"x": [0.0, 0.5, 2.0], "z": z})
    result = fatigue.ioannides_harris(stress, exponents=LifeExponents(stress=1, depth=2, weibull=1))
    assert result["mean_depth"].values == pytest.approx(1 / 3, rel=1e-4)
    assert float(result["risk"]) == pytest.approx(2 * 0.5 * 9, rel=1e-4)


def test_life_of_double_length_follows_weibull_exponent(strip_result) -> None:
    short_contact = strip_result()
    long_contact = short_contact.assign_coords(x_field=2 * short_contact["x_field"])
    lives = fatigue.relative_life(fatigue.lundberg_palmgren(long_contact), fatigue.lundberg_palmgren(short_contact))
    assert float(lives) == pytest.approx(2 ** (-8 / 9))


def test_risk_is_largest_at_the_roller_ends(case_result: xr.Dataset) -> None:
    result = fatigue.lundberg_palmgren(case_result)
    assert np.allclose(result["risk_density"], result["risk_density"][::-1], rtol=1e-3)
    # The risk is larger at the ends of the roller, over a fillet, than at mid-length.
    middle_risk = result["risk_density"].sel(x_field=0.26e-3, method="nearest")
    assert float(result["risk_density"].max()) > 1.5 * float(middle_risk)


def test_risk_of_von_mises_stress_is_positive(case_result: xr.Dataset) -> None:
    largest = case_result["von_mises"].max("y_field")
    assert float(fatigue.ioannides_harris(largest, 600e6)["risk"]) > 0


def test_units_follow_the_exponents(strip_result) -> None:
    result = fatigue.lundberg_palmgren(strip_result(), LifeExponents(stress=9, depth=2, weibull=1))
    assert result["risk"].attrs["units"] == "Pa**9 m**0"
    assert result["risk_density"].attrs["units"] == "Pa**9 m**-1"


def test_invalid_argument_raises(strip_result) -> None:
    result, amplitude = strip_result(), compute_orthogonal_shear(strip_result())
    for call, message in (
        (lambda: fatigue.lundberg_palmgren(result.drop_vars("tau_yz")), "tau_yz is missing"),
        (lambda: fatigue.lundberg_palmgren(result.isel(z=[0, 1])), "three or more depths"),
        (lambda: fatigue.lundberg_palmgren(result.isel(x_field=[0])), "two or more positions"),
        (lambda: fatigue.lundberg_palmgren(result, 3), "LifeExponents"),
        (lambda: fatigue.lundberg_palmgren(result.isel(x_field=[1, 0])), "increasing"),
        (lambda: fatigue.ioannides_harris(result), "DataArray"),
        (lambda: fatigue.ioannides_harris(result["von_mises"]), "without the rolling direction"),
        (lambda: fatigue.ioannides_harris(amplitude, -1.0), "limit"),
        (lambda: fatigue.relative_life(result, result), "with risk"),
        (lambda: LifeExponents(stress=0), "stress"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()
    other_exponents = fatigue.lundberg_palmgren(result, LifeExponents(stress=9))
    with pytest.raises(InvalidInputError, match="same exponents"):
        fatigue.relative_life(other_exponents, fatigue.lundberg_palmgren(result))


def test_lundberg_palmgren_rejects_heavy_friction() -> None:
    """Under heavy friction the orthogonal shear is largest at depth 0, where the risk is infinite."""
    passage = xr.DataArray([0.0, -1.0, 0.0], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    depth = xr.DataArray([1.0, 0.5, 0.1], dims="z", coords={"z": [0.0, 0.5, 1.0]})
    shear = (passage * depth).expand_dims(x=[0.0, 1.0])
    with pytest.raises(InvalidInputError, match="Ioannides and Harris"):
        fatigue.lundberg_palmgren(xr.Dataset({"tau_yz": shear}))
    assert float(fatigue.ioannides_harris(compute_orthogonal_shear(xr.Dataset({"tau_yz": shear})))["risk"]) > 0


def test_point_values_are_marked_not_estimated(strip_result) -> None:
    result = strip_result()
    computed = fatigue.lundberg_palmgren(result).merge(
        fatigue.ioannides_harris(compute_orthogonal_shear(result))["mean_depth"]
    )
    for name in ("risk_density", "shear_amplitude", "shear_depth", "mean_depth"):
        assert computed[name].attrs[ERROR_KIND] == NOT_ESTIMATED, name
    life_without_error = fatigue.lundberg_palmgren(result).drop_vars("risk_error")
    assert fatigue.relative_life(life_without_error, life_without_error).attrs[ERROR_KIND] == NOT_ESTIMATED


@pytest.mark.parametrize("count", [1, 2])
def test_plane_without_a_passage_is_rejected(count: int) -> None:
    y = np.linspace(0.0, 1.0, count)
    shear = xr.DataArray(np.ones((2, count, 3)), {"x": [0.0, 1.0], "y": y, "z": [0.0, 0.5, 1.0]}, ("x", "y", "z"))
    with pytest.raises(InvalidInputError, match=rf"stress.sizes\['y'\] = {count}: must be at least 3"):
        fatigue.lundberg_palmgren(xr.Dataset({"tau_yz": shear}))
