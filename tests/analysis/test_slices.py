"""The table per slice."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, analysis


@given(count=st.integers(1, 16))
def test_slices_carry_the_whole_load_however_many(strip_result, count: int) -> None:
    result = strip_result()
    table = analysis.slices(result, count)
    assert float(table["normal_load"].sum()) == pytest.approx(float(analysis.contact_results(result)["resultant"]))
    assert table["normal_load"].values == pytest.approx(float(table["normal_load"].mean()))
    assert float(table["width"].sum()) == pytest.approx(4.0)
    assert float(table["position"].mean()) == pytest.approx(3.0)


def test_columns_of_the_line_contact(strip_result) -> None:
    table = analysis.slices(strip_result(), 4).to_dataframe()
    assert table.index.tolist() == [1, 2, 3, 4]
    assert table["axial_pressure"].to_numpy() == pytest.approx(1, abs=1e-3)
    assert table["half_width"].to_numpy() == pytest.approx(1, abs=1e-9)
    assert table["peak_von_mises"].to_numpy() == pytest.approx(0.5575, abs=1e-3)
    assert table["peak_orthogonal_shear_amplitude_z"].to_numpy() == pytest.approx(0.5, abs=0.03)


def test_slices_without_stress_points_say_so(strip_result) -> None:
    table = analysis.slices(strip_result().isel(x_field=[0]), 4)
    assert table["peak_von_mises"].isnull().values.tolist() == [False, True, True, True]


def test_surfaces_only(opened: xr.Dataset) -> None:
    one = opened.sel(e_over_a=1, friction=0.1, body="finite-length")
    surface = one.drop_vars([name for name in one.data_vars if "z" in one[name].dims])
    table = analysis.slices(surface, 5)
    assert "peak_von_mises" not in table
    assert float(table["normal_load"].sum()) == pytest.approx(float(analysis.contact_results(one)["resultant"]))


def test_real_contact_is_symmetric(solved: xr.Dataset) -> None:
    table = analysis.slices(solved, 6)
    for name in ("normal_load", "axial_pressure", "half_width"):
        assert np.allclose(table[name], table[name][::-1], rtol=1e-5)


def test_bad_input(strip_result, opened: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="number of cells, 16"):
        analysis.slices(strip_result(), 17)
    with pytest.raises(InvalidInputError, match="count"):
        analysis.slices(strip_result(), 0)
    with pytest.raises(InvalidInputError, match="single case"):
        analysis.slices(opened)


def test_order_does_not_matter_and_stresses_at_one_depth_are_left_out(solved: xr.Dataset) -> None:
    there = analysis.slices(solved, 4)
    turned = analysis.slices(solved.isel(x=slice(None, None, -1)), 4)
    assert turned["normal_load"].values == pytest.approx(there["normal_load"].values)
    assert "peak_maximum_shear" not in analysis.slices(solved.isel(z=1), 4)
