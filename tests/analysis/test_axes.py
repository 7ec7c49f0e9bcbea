"""Dimensions and positions of single results and of studies."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis
from contactstudy.analysis.axes import axis_dimensions, cell_size
from tests.stand_in_solver import FAILS


@pytest.mark.parametrize("dims", [("y", "z"), ("x", "x_field")])
def test_array_without_one_dimension_along_axis_raises(dims: tuple[str, str]) -> None:
    with pytest.raises(InvalidInputError, match="exactly one dimension along x"):
        analysis.dimension_along(xr.DataArray(np.zeros((1, 1)), dims=dims), "x")


def test_positions_of_study_have_study_dimensions(study_dataset: xr.Dataset) -> None:
    positions = analysis.positions(study_dataset["pressure"], "x")
    assert positions.dims == ("e_over_a", "friction", "body", "x_over_a")
    assert axis_dimensions(study_dataset["von_mises"]) == {"x": "x_over_a", "y": "y_field_over_a", "z": "z_over_a"}


def test_array_without_positions_raises() -> None:
    with pytest.raises(InvalidInputError, match="with the positions x"):
        analysis.positions(xr.DataArray([1.0], dims="x_index"), "x")


def test_cell_size_ignores_padding() -> None:
    array = xr.DataArray([0.0, 0.0, np.nan], dims="x_index", coords={"x": ("x_index", [1.0, 1.5, np.nan])})
    assert float(cell_size(array, "x")) == 0.5


def test_single_case_of_study_has_no_padding(study_dataset: xr.Dataset) -> None:
    study_case = study_dataset.sel(e_over_a=1, friction=0.1, body="finite-length")
    case = analysis.single_case(study_case)
    assert case["pressure"].dims == ("x", "y")
    assert case["von_mises"].dims == ("x_field", "y_field", "z")
    assert np.isfinite(case["pressure"]).all()
    assert np.array_equal(case["x"], study_case["x"].values[np.isfinite(study_case["x"])])
    assert analysis.single_case(case).identical(case)


def test_failed_case_raises_with_its_message(study_dataset: xr.Dataset) -> None:
    failed_case = analysis.single_case(study_dataset.sel(e_over_a=1, friction=FAILS, body="finite-length"))
    assert "pressure" not in failed_case
    with pytest.raises(InvalidInputError, match=r"'a failed case': must be a solved case; .*this friction fails"):
        failed_case.contact.slices()


def test_single_case_of_several_cases_raises(study_dataset: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match=r"single case; select one"):
        analysis.single_case(study_dataset)
    with pytest.raises(InvalidInputError, match="Dataset"):
        analysis.single_case(study_dataset["pressure"])  # type: ignore[arg-type]
