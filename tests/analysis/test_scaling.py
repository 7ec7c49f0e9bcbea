"""Units of the Hertz line contact."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis


def test_results_of_different_size_are_the_same_over_p0_and_a(strip_result) -> None:
    small, large = (analysis.normalized(strip_result(*scale)) for scale in ((1e-4, 1e9), (3e-4, 3e9)))
    for name in ("pressure", "von_mises", "tau_yz"):
        assert np.allclose(small[name], large[name], atol=1e-12)
        assert small[name].attrs["units"] == "1"
    for name in ("x", "z", "x_field"):
        assert np.allclose(small[name], large[name])
    assert "over p0" in small["pressure"].attrs["long_name"]
    assert float(small["hertz_max_pressure"]) == 1e9


def test_scalars_scale_by_their_units(strip_result) -> None:
    result = strip_result(2e-4, 1e9)
    scalars = analysis.contact_results(result).assign(result[["hertz_half_width", "hertz_max_pressure"]])
    scaled = analysis.normalized(scalars)
    assert float(scaled["contact_area"]) == pytest.approx(4 * 2, rel=0.05)
    assert float(scaled["resultant"]) == pytest.approx(4 * np.pi / 2, rel=2e-3)
    assert scaled["resultant"].attrs["long_name"].endswith("over p0 a**2")


def test_a_study_scales_each_case_by_its_own(opened: xr.Dataset) -> None:
    scaled = analysis.normalized(opened)
    chosen = {"e_over_a": 1.0, "friction": 0.1, "body": "finite-length"}
    expected = opened["pressure"].sel(chosen) / 1.5e9
    assert np.allclose(scaled["pressure"].sel(chosen), expected, equal_nan=True)
    assert scaled["pressure"].dims == opened["pressure"].dims
    # Positions of each case are divided by its own a; those that all share in metres stay.
    own = scaled["x"].sel(chosen)
    assert np.allclose(own, opened["x_over_a"].where(own.notnull()), equal_nan=True)
    assert np.array_equal(scaled["y_field"], opened["y_field"])


def test_scales_must_be_there() -> None:
    with pytest.raises(InvalidInputError, match="hertz_half_width"):
        analysis.normalized(xr.Dataset({"pressure": 1.0}))
