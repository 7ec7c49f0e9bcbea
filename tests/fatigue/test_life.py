"""Relative life: integrals by hand, and the load exponents that bearing standards use."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis, fatigue
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED
from contactstudy.fatigue import LifeExponents


def orthogonal(result: xr.Dataset) -> xr.DataArray:
    return analysis.measure(result, "orthogonal_shear_amplitude")


def test_line_contact(strip_result) -> None:
    result = fatigue.lundberg_palmgren(strip_result())
    # Less than a quarter by what lies between the positions along y.
    assert result["shear_amplitude"].values == pytest.approx(0.25, abs=3e-4)
    assert result["shear_depth"].values == pytest.approx(0.5, abs=1e-2)
    expected = 0.25 ** (31 / 3) * 0.5 ** (1 - 7 / 3) * 4.0
    assert float(result["risk"]) == pytest.approx(expected, rel=2e-2)


@pytest.mark.parametrize("factor", [0.7, 2.3])
def test_load_exponent_of_the_life(strip_result, factor: float) -> None:
    """The load of a line contact goes with the square of p0, and a with p0; the roller's length stays."""
    lives = []
    for model in (fatigue.lundberg_palmgren, lambda result: fatigue.ioannides_harris(orthogonal(result))):
        base, loaded = strip_result(), strip_result(factor, factor)
        loaded = loaded.assign_coords(x_field=base["x_field"])
        lives.append(float(fatigue.relative_life(model(loaded), model(base))))
    assert lives == pytest.approx([factor**-8] * 2, rel=1e-6)


def test_point_contact_exponents_give_the_cube(strip_result) -> None:
    """A point contact grows along x as well: its risk goes with p0**10, its life with p0**-9, its load with p0**3."""
    exponents = LifeExponents(weibull=10 / 9)
    risks = [fatigue.lundberg_palmgren(one, exponents) for one in (strip_result(2.0, 2.0), strip_result())]
    assert float(fatigue.relative_life(*risks, exponents)) == pytest.approx(2.0**-9)


def test_fatigue_limit(strip_result) -> None:
    base = fatigue.ioannides_harris(orthogonal(strip_result()), limit=0.2)
    lower = strip_result(0.9, 0.9)
    lives = []
    for limit in (0.0, 0.1, 0.2):
        risks = [fatigue.ioannides_harris(orthogonal(one), limit) for one in (lower, strip_result())]
        lives.append(float(fatigue.relative_life(*risks)))
    assert lives[0] < lives[1] < lives[2]
    none = fatigue.ioannides_harris(orthogonal(lower), limit=0.3)
    assert float(none["risk"]) == 0.0
    assert np.isnan(none["mean_depth"]).all()
    loaded = fatigue.ioannides_harris(orthogonal(strip_result(1.5, 1.5)), limit=0.3)
    assert float(fatigue.relative_life(none, loaded)) == np.inf
    assert np.isnan(float(fatigue.relative_life(none, none)))
    with pytest.raises(InvalidInputError, match=r"fatigue_limit = 0.2.*fatigue_limit = 0.3"):
        fatigue.relative_life(none, base)
    with pytest.raises(InvalidInputError, match="theory = Ioannides and Harris"):
        fatigue.relative_life(fatigue.lundberg_palmgren(lower), fatigue.ioannides_harris(orthogonal(lower)))


@pytest.mark.parametrize("step", [1, 2, 3])
def test_error_of_the_positions(strip_result, step: int) -> None:
    result = strip_result().isel(z=slice(None, None, step), y_field=slice(None, None, step))
    found = fatigue.lundberg_palmgren(result)
    expected = 0.25 ** (31 / 3) * 0.5 ** (1 - 7 / 3) * 4.0
    error = float(found["risk_error"])
    assert abs(float(found["risk"]) - expected) < error < 0.9 * step**2 * expected
    assert "positions alone" in found["risk_error"].attrs["comment"]
    assert found["risk_error"].attrs["units"] == found["risk"].attrs["units"]


def test_error_of_the_pressure(strip_result) -> None:
    plain = fatigue.lundberg_palmgren(strip_result())
    stated = strip_result().assign(peak_pressure=1.0, peak_pressure_error=0.01)
    found = fatigue.lundberg_palmgren(stated)
    added = float(found["risk_error"] - plain["risk_error"]) / float(plain["risk"])
    assert added == pytest.approx(0.01 * 31 / 3)
    own, other = (float(each["risk_error"] / each["risk"]) for each in (found, plain))
    life = fatigue.relative_life(found, plain)
    # The longest life that both errors allow.
    assert float(life["relative_life_error"]) == pytest.approx(((1 + other) / (1 - own)) ** (8 / 9) - 1)
    endless = strip_result().assign(peak_pressure=np.inf, peak_pressure_error=np.inf)
    assert float(fatigue.lundberg_palmgren(endless)["risk_error"]) == np.inf


@pytest.mark.parametrize(("first", "last"), [(0.1, 0.7), (0.1, 1.0), (0.3, 2.0), (0.4, 2.0), (0.2, 0.8)])
def test_error_of_the_depths(strip_result, first: float, last: float) -> None:
    amplitude = orthogonal(strip_result())
    whole = fatigue.ioannides_harris(amplitude)
    part = fatigue.ioannides_harris(amplitude.sel(z=slice(first - 1e-9, last + 1e-9)))
    assert abs(float(part["risk"] - whole["risk"])) < float(part["risk_error"])


def test_few_positions_along_x(strip_result) -> None:
    for few in ([0, -1], [0, 4, -1]):
        assert float(fatigue.lundberg_palmgren(strip_result().isel(x_field=few))["risk_error"]) == np.inf


def test_risk_of_a_utilisation(strip_result) -> None:
    share = (orthogonal(strip_result()) / 0.25).assign_attrs(units="1")
    assert fatigue.ioannides_harris(share, 0.5)["risk"].attrs["units"] == "m**-0.333333"


def test_too_few_positions_tell_no_error(strip_result) -> None:
    found = fatigue.lundberg_palmgren(strip_result().isel(z=slice(0, None, 12)))
    assert float(found["risk_error"]) == np.inf
    assert float(fatigue.relative_life(found, found)["relative_life_error"]) == np.inf


def test_error_of_solved_cases(case_result: xr.Dataset) -> None:
    """On half of the positions the risk is within the error of that on all."""
    whole = fatigue.lundberg_palmgren(case_result)
    assert 0 < float(whole["risk_error"]) < np.inf
    half = fatigue.lundberg_palmgren(case_result.isel(x_field=slice(None, None, 2)))
    assert abs(float(half["risk"] - whole["risk"])) <= float(half["risk_error"] + whole["risk_error"])
    pair = xr.concat([case_result[["tau_yz"]], 1.1 * case_result[["tau_yz"]]], "case")
    alone = [fatigue.lundberg_palmgren(pair.isel(case=number))["risk_error"] for number in (0, 1)]
    np.testing.assert_allclose(fatigue.lundberg_palmgren(pair)["risk_error"], alone)


def test_incomplete_passage(strip_result) -> None:
    """The largest shear lies at y = 0.87 a and z = 0.5 a: nothing may end short of it."""
    result = strip_result()
    narrow = result.sel(y_field=slice(-0.7, 0.7))
    shallow, deep = result.sel(z=slice(0.0, 0.45)), result.sel(z=slice(0.55, None))
    with pytest.raises(InvalidInputError, match="first or last y in sections with 1 of the risk"):
        fatigue.lundberg_palmgren(narrow)
    for call in (fatigue.lundberg_palmgren, lambda each: fatigue.ioannides_harris(orthogonal(each))):
        with pytest.raises(InvalidInputError, match="first or last depth in sections with 1 of the risk"):
            call(shallow)
        with pytest.raises(InvalidInputError, match="first or last depth in sections with 1 of the risk"):
            call(deep)


def test_stresses_in_megapascals(strip_result) -> None:
    result = strip_result(1e9, 1e-3)
    metric = result.assign({"tau_yz": (1e-6 * result["tau_yz"]).assign_attrs(units="MPa")})
    metric = metric.assign_coords({"z": (1e3 * metric["z"]).assign_attrs(units="mm")})
    xr.testing.assert_allclose(fatigue.lundberg_palmgren(metric), fatigue.lundberg_palmgren(result))
    in_pascal, in_mega = orthogonal(result), (1e-6 * orthogonal(result)).assign_attrs(units="MPa")
    xr.testing.assert_allclose(fatigue.ioannides_harris(in_mega, 1e8), fatigue.ioannides_harris(in_pascal, 1e8))


def test_integral_by_hand() -> None:
    """(1 - z) on 0..1 with c = 1: volume 1/2, mean depth 1/3; over a length of 2."""
    z = np.linspace(0, 1, 401)
    stress = xr.DataArray(np.tile(1 - z, (3, 1)), dims=("x", "z"), coords={"x": [0.0, 0.5, 2.0], "z": z})
    result = fatigue.ioannides_harris(stress, exponents=LifeExponents(stress=1, depth=2, weibull=1))
    assert result["mean_depth"].values == pytest.approx(1 / 3, rel=1e-4)
    assert float(result["risk"]) == pytest.approx(2 * 0.5 * 9, rel=1e-4)


def test_double_length_costs_the_weibull_share(strip_result) -> None:
    base = strip_result()
    longer = base.assign_coords(x_field=2 * base["x_field"])
    lives = fatigue.relative_life(fatigue.lundberg_palmgren(longer), fatigue.lundberg_palmgren(base))
    assert float(lives) == pytest.approx(2 ** (-8 / 9))


def test_free_ends_of_a_real_contact(case_result: xr.Dataset) -> None:
    result = fatigue.lundberg_palmgren(case_result)
    assert np.allclose(result["risk_density"], result["risk_density"][::-1], rtol=1e-3)
    # The ends of the roller, over a fillet, are at greater risk than its middle.
    middle = result["risk_density"].sel(x_field=0.26e-3, method="nearest")
    assert float(result["risk_density"].max()) > 1.5 * float(middle)


def test_other_measures_of_the_passage(case_result: xr.Dataset) -> None:
    largest = case_result["von_mises"].max("y_field")
    assert float(fatigue.ioannides_harris(largest, 600e6)["risk"]) > 0


def test_units_follow_the_exponents(strip_result) -> None:
    result = fatigue.lundberg_palmgren(strip_result(), LifeExponents(stress=9, depth=2, weibull=1))
    assert result["risk"].attrs["units"] == "Pa**9 m**0"
    assert result["risk_density"].attrs["units"] == "Pa**9 m**-1"


def test_bad_input(strip_result) -> None:
    result, amplitude = strip_result(), orthogonal(strip_result())
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
    other = fatigue.lundberg_palmgren(result, LifeExponents(stress=9))
    with pytest.raises(InvalidInputError, match="same exponents"):
        fatigue.relative_life(other, fatigue.lundberg_palmgren(result))


def test_friction_is_refused() -> None:
    """Heavy friction: the largest orthogonal shear is on the surface itself, and no depth divides."""
    passage = xr.DataArray([0.0, -1.0, 0.0], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    depth = xr.DataArray([1.0, 0.5, 0.1], dims="z", coords={"z": [0.0, 0.5, 1.0]})
    shear = (passage * depth).expand_dims(x=[0.0, 1.0])
    with pytest.raises(InvalidInputError, match="Ioannides and Harris"):
        fatigue.lundberg_palmgren(xr.Dataset({"tau_yz": shear}))
    assert float(fatigue.ioannides_harris(orthogonal(xr.Dataset({"tau_yz": shear})))["risk"]) > 0


def test_error_kinds_beside_the_risk(strip_result) -> None:
    result = strip_result()
    found = fatigue.lundberg_palmgren(result).merge(fatigue.ioannides_harris(orthogonal(result))["mean_depth"])
    for name in ("risk_density", "shear_amplitude", "shear_depth", "mean_depth"):
        assert found[name].attrs[ERROR_KIND] == NOT_ESTIMATED, name
    without = fatigue.lundberg_palmgren(result).drop_vars("risk_error")
    assert fatigue.relative_life(without, without).attrs[ERROR_KIND] == NOT_ESTIMATED


@pytest.mark.parametrize("count", [1, 2])
def test_plane_without_a_passage_is_refused(count: int) -> None:
    y = np.linspace(0.0, 1.0, count)
    shear = xr.DataArray(np.ones((2, count, 3)), {"x": [0.0, 1.0], "y": y, "z": [0.0, 0.5, 1.0]}, ("x", "y", "z"))
    with pytest.raises(InvalidInputError, match=rf"stress.sizes\['y'\] = {count}: must be at least 3"):
        fatigue.lundberg_palmgren(xr.Dataset({"tau_yz": shear}))
