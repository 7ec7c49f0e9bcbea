"""Results over half-width and peak pressure of the Hertz line contact."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis


def test_normalized_results_of_similar_contacts_are_equal(strip_result) -> None:
    small_result, large_result = (
        analysis.normalized(strip_result(*length_scale)) for length_scale in ((1e-4, 1e9), (3e-4, 3e9))
    )
    for name in ("pressure", "von_mises", "tau_yz"):
        assert np.allclose(small_result[name], large_result[name], atol=1e-12)
        assert small_result[name].attrs["units"] == "1"
    for name in ("x", "z", "x_field"):
        assert np.allclose(small_result[name], large_result[name])
    assert "over p0" in small_result["pressure"].attrs["long_name"]
    assert float(small_result["hertz_max_pressure"]) == 1e9


def test_normalized_scalars_follow_their_units(strip_result) -> None:
    result = strip_result(2e-4, 1e9)
    scalars = analysis.contact_results(result).assign(result[["hertz_half_width", "hertz_max_pressure"]])
    normalized_scalars = analysis.normalized(scalars)
    assert float(normalized_scalars["contact_area"]) == pytest.approx(4 * 2, rel=0.05)
    assert float(normalized_scalars["resultant"]) == pytest.approx(4 * np.pi / 2, rel=2e-3)
    assert normalized_scalars["resultant"].attrs["long_name"].endswith("over p0 a**2")


def test_normalized_study_uses_scales_of_each_case(study_dataset: xr.Dataset) -> None:
    scaled_study = analysis.normalized(study_dataset)
    selected_case = {"e_over_a": 1.0, "friction": 0.1, "body": "finite-length"}
    expected = study_dataset["pressure"].sel(selected_case) / 1.5e9
    assert np.allclose(scaled_study["pressure"].sel(selected_case), expected, equal_nan=True)
    assert scaled_study["pressure"].dims == study_dataset["pressure"].dims
    # The positions of each case are divided by the case's a.
    case_positions = scaled_study["x"].sel(selected_case)
    assert np.allclose(case_positions, study_dataset["x_over_a"].where(case_positions.notnull()), equal_nan=True)
    assert np.allclose(scaled_study["y_field"].sel(selected_case), study_dataset["y_field_over_a"])


def test_normalized_result_without_scales_raises() -> None:
    with pytest.raises(InvalidInputError, match="hertz_half_width"):
        analysis.normalized(xr.Dataset({"pressure": 1.0}))


def test_positions_over_a_select_same_cells(case_result: xr.Dataset) -> None:
    case_over_a = analysis.positions_over_a(case_result)
    half_width = float(case_result["hertz_half_width"])
    expected = case_result["pressure"].sel(x=2 * half_width, y=0.5 * half_width, method="nearest")
    assert float(case_over_a["pressure"].sel(x_over_a=2, y_over_a=0.5, method="nearest")) == float(expected)
    assert case_over_a["von_mises"].dims == ("x_field_over_a", "y_field_over_a", "z_over_a")
    assert case_over_a["von_mises"].sel(z_over_a=slice(0.2, 0.8)).sizes["z_over_a"] == 3
    coordinates = {name: case_over_a[name].item() for name in ("e_over_a", "friction", "gamma", "profile")}
    assert coordinates.pop("profile").startswith("Cylinder(fillet_radius=")
    assert coordinates == pytest.approx({"e_over_a": 1.0, "friction": 0.1, "gamma": 0.104}, rel=2e-3)


def test_single_case_inverts_positions_over_a(case_result: xr.Dataset) -> None:
    restored_case = analysis.single_case(analysis.positions_over_a(case_result))
    for name in ("pressure", "von_mises"):
        assert restored_case[name].dims == case_result[name].dims
        assert np.array_equal(restored_case[name], case_result[name])
    assert np.array_equal(restored_case["x"], case_result["x"])


def test_joined_results_over_a_are_equal(strip_result) -> None:
    results = [analysis.positions_over_a(strip_result(*scale)) for scale in ((1e-4, 1e9), (3e-4, 3e9))]
    labelled_results = [result.assign_coords(e_over_a=i) for i, result in enumerate(results)]
    joined_results = xr.concat(labelled_results, "e_over_a", join="override", coords="different", compat="equals")
    pressure = (
        joined_results["pressure"].sel(x_over_a=2, y_over_a=0, method="nearest") / joined_results["hertz_max_pressure"]
    )
    assert np.allclose(pressure, pressure[0])
    assert joined_results["x"].sel(e_over_a=1, x_over_a=2, method="nearest") == pytest.approx(2.1e-4 * 3, rel=0.02)


def test_study_with_one_half_width_keeps_values_over_a(study_dataset: xr.Dataset) -> None:
    # All cases share the positions y in metres and have one half-width.
    study_over_a = analysis.positions_over_a(study_dataset)
    assert study_over_a["pressure"].dims[-2:] == ("x_over_a", "y_over_a")
    assert np.array_equal(study_over_a["pressure"], study_dataset["pressure"], equal_nan=True)
    assert np.array_equal(study_over_a["von_mises"].x_over_a, study_dataset["x_over_a"])


def test_study_with_differing_positions_over_a_raises(strip_result) -> None:
    result = strip_result(1e-4, 1e9)
    cases = result.assign(hertz_half_width=("load", [1e-4, 2e-4]))
    with pytest.raises(InvalidInputError, match="the same x_over_a in all cases; select one case"):
        analysis.positions_over_a(cases)
    assert analysis.positions_over_a(cases.isel(load=1))["x_over_a"].max() == pytest.approx(2.9375)


def test_dimension_without_positions_raises(strip_result) -> None:
    with pytest.raises(InvalidInputError, match=r"coords = .*must be with the positions x \(metres\)"):
        analysis.positions_over_a(strip_result(1e-4, 1e9).drop_vars("x"))


def test_positions_over_a_have_attributes_of_normalized_positions(strip_result) -> None:
    result = strip_result(1e-4, 1e9)
    normalized_scalars, result_over_a = analysis.normalized(result), analysis.positions_over_a(result)
    for name in ("x", "y", "z", "x_field"):
        assert normalized_scalars[name].attrs == result_over_a[f"{name}_over_a"].attrs, name
    assert normalized_scalars["z"].attrs["long_name"] == "z over a"
    assert normalized_scalars["z"].attrs["comment"] == "depth, below the loaded surface"


def test_positions_in_millimetres_have_same_ratio(strip_result) -> None:
    result = strip_result(1e-4, 1e9)
    result_in_mm = result.assign_coords(x=(1e3 * result["x"]).assign_attrs(units="mm"))
    assert np.allclose(
        analysis.positions_over_a(result_in_mm)["x_over_a"], analysis.positions_over_a(result)["x_over_a"]
    )


def test_positions_over_a_of_normalized_result_raise(strip_result) -> None:
    result_over_a = analysis.normalized(strip_result(1e-4, 1e9))
    with pytest.raises(InvalidInputError, match="already"):
        analysis.positions_over_a(result_over_a)
