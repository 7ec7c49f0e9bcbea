"""Files for MATLAB, read by scipy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.io import loadmat

from contactstudy import InvalidInputError, export
from contactstudy.analysis import slices
from contactstudy.cli import main
from contactstudy.errors import StoreError
from contactstudy.stress import tresca


def read_mat(path: Path) -> dict:
    return loadmat(path, simplify_cells=True)


def test_mat_file_contains_all_variables(case_result: xr.Dataset, tmp_path: Path) -> None:
    content = read_mat(export.to_mat(case_result, tmp_path / "case.mat"))
    for name, array in case_result.variables.items():
        np.testing.assert_array_equal(np.squeeze(content[name]), np.squeeze(array.values), err_msg=name)
        if array.ndim > 1:
            assert list(content["dims"][name]) == list(array.dims)
            assert content[name].shape == array.shape
    assert content["units"]["pressure"] == "Pa"
    assert content["units"]["x"] == "m"
    assert content["meaning"]["pressure"] == case_result["pressure"].attrs["long_name"]
    assert content["about"]["source"] == case_result.attrs["source"]
    assert loadmat(tmp_path / "case.mat")["x"].shape == (case_result.sizes["x"], 1)


def test_mat_file_of_study_has_arrays_of_study(study_dataset: xr.Dataset, tmp_path: Path) -> None:
    content = read_mat(export.to_mat(study_dataset, tmp_path / "study.mat"))
    assert content["pressure"].shape == study_dataset["pressure"].shape
    np.testing.assert_array_equal(content["peak_pressure"], study_dataset["peak_pressure"])
    np.testing.assert_array_equal(content["status"], study_dataset["status"].values.astype(object))
    assert list(content["body"]) == ["finite-length", "half-space"]
    assert list(content["dims"]["peak_pressure"]) == list(study_dataset["peak_pressure"].dims)


def test_mat_file_contains_measure_or_slices(case_result: xr.Dataset, tmp_path: Path) -> None:
    content = read_mat(export.to_mat(case_result, tmp_path / "one.mat", "tresca"))
    np.testing.assert_allclose(content["tresca"], tresca(case_result))
    assert set(content["units"]) == {"tresca", *map(str, tresca(case_result).coords)}
    assert "half_width" in read_mat(export.to_mat(slices(case_result, 5), tmp_path / "slices.mat"))


def test_invalid_argument_raises(case_result: xr.Dataset, tmp_path: Path) -> None:
    huge_result = xr.Dataset({"pressure": ("x", np.broadcast_to(np.zeros(1), 3 * 10**8))})
    for call, message in (
        (lambda: export.to_mat(case_result, tmp_path / "case.m"), "ends with .mat"),
        (lambda: export.to_mat(case_result, 3), "path = 3"),
        (lambda: export.to_mat(case_result, tmp_path / "a.mat", "presure"), "presure"),
        (lambda: export.to_mat(case_result.rename(pressure="2p"), tmp_path / "a.mat"), "variables = '2p'"),
        (lambda: export.to_mat(case_result.rename(pressure="units"), tmp_path / "a.mat"), "variables = 'units'"),
        (lambda: export.to_mat(huge_result, tmp_path / "a.mat"), "2.4 GB.*at most 2 GB"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()
    with pytest.raises(StoreError, match="cannot write"):
        export.to_mat(case_result, tmp_path / "none" / "a.mat")
    assert not list(tmp_path.iterdir())


def test_command_writes_mat_file_without_lines(case_result: xr.Dataset, tmp_path: Path, capsys) -> None:
    case_result.to_netcdf(tmp_path / "case.nc")
    assert main(["export", str(tmp_path / "case.nc"), "--format", "mat"]) == 0
    assert read_mat(tmp_path / "case.mat")["normal_load"] == float(case_result["normal_load"])
    assert main(["export", str(tmp_path / "case.nc"), "--format", "mat", "--line=0,0,0:1,0,0"]) == 2
    assert "left out for MAT" in capsys.readouterr().err
