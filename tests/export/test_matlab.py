"""Results for MATLAB, read back by scipy."""

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


def read(path: Path) -> dict:
    return loadmat(path, simplify_cells=True)


def test_round_trip(solved: xr.Dataset, tmp_path: Path) -> None:
    found = read(export.to_mat(solved, tmp_path / "case.mat"))
    for name, array in solved.variables.items():
        np.testing.assert_array_equal(np.squeeze(found[name]), np.squeeze(array.values), err_msg=name)
        if array.ndim > 1:
            assert list(found["dims"][name]) == list(array.dims)
            assert found[name].shape == array.shape
    assert found["units"]["pressure"] == "Pa"
    assert found["units"]["x"] == "m"
    assert found["meaning"]["pressure"] == solved["pressure"].attrs["long_name"]
    assert found["about"]["source"] == solved.attrs["source"]
    assert loadmat(tmp_path / "case.mat")["x"].shape == (solved.sizes["x"], 1)


def test_study(opened: xr.Dataset, tmp_path: Path) -> None:
    found = read(export.to_mat(opened, tmp_path / "study.mat"))
    assert found["pressure"].shape == opened["pressure"].shape
    np.testing.assert_array_equal(found["peak_pressure"], opened["peak_pressure"])
    np.testing.assert_array_equal(found["status"], opened["status"].values.astype(object))
    assert list(found["body"]) == ["finite-length", "half-space"]
    assert list(found["dims"]["peak_pressure"]) == list(opened["peak_pressure"].dims)


def test_measures_tables_and_single_variables(solved: xr.Dataset, tmp_path: Path) -> None:
    found = read(export.to_mat(solved, tmp_path / "one.mat", "tresca"))
    np.testing.assert_allclose(found["tresca"], tresca(solved))
    assert set(found["units"]) == {"tresca", *map(str, tresca(solved).coords)}
    assert "half_width" in read(export.to_mat(slices(solved, 5), tmp_path / "slices.mat"))


def test_bad_input(solved: xr.Dataset, tmp_path: Path) -> None:
    huge = xr.Dataset({"pressure": ("x", np.broadcast_to(np.zeros(1), 3 * 10**8))})
    for call, message in (
        (lambda: export.to_mat(solved, tmp_path / "case.m"), "ends with .mat"),
        (lambda: export.to_mat(solved, 3), "path = 3"),
        (lambda: export.to_mat(solved, tmp_path / "a.mat", "presure"), "presure"),
        (lambda: export.to_mat(solved.rename(pressure="2p"), tmp_path / "a.mat"), "variables = '2p'"),
        (lambda: export.to_mat(solved.rename(pressure="units"), tmp_path / "a.mat"), "variables = 'units'"),
        (lambda: export.to_mat(huge, tmp_path / "a.mat"), "2.4 GB.*at most 2 GB"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()
    with pytest.raises(StoreError, match="cannot write"):
        export.to_mat(solved, tmp_path / "none" / "a.mat")
    assert not list(tmp_path.iterdir())


def test_from_the_command_line(solved: xr.Dataset, tmp_path: Path, capsys) -> None:
    solved.to_netcdf(tmp_path / "case.nc")
    assert main(["export", str(tmp_path / "case.nc"), "--format", "mat"]) == 0
    assert read(tmp_path / "case.mat")["normal_load"] == float(solved["normal_load"])
    assert main(["export", str(tmp_path / "case.nc"), "--format", "mat", "--line=0,0,0:1,0,0"]) == 2
    assert "left out for MAT" in capsys.readouterr().err
