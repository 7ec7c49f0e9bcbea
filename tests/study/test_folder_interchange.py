"""Files follow the CF conventions and are readable by other programs."""

import re
import subprocess
import sys
from pathlib import Path

import h5netcdf
import netCDF4
import numpy as np
import pytest

from contactstudy.cli import main
from contactstudy.study import load_case, run_study
from contactstudy.study.folder import Folder
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake


@pytest.fixture(scope="module")
def result_files(tmp_path_factory):
    """A batch of each level, and the summary file."""
    paths = []
    for level in ("summary", "surface", "fields"):
        folder = tmp_path_factory.mktemp(level)
        sweep = {"e_over_a": [1.0], "friction": [0.1], "profile": [{"kind": "cylinder", "name": "sharp"}]}
        run_study(small_study(level=level, sweep=sweep), folder, workers=0, solver=solve_fake)
        paths += sorted(folder.glob("batches/*.nc"))
    assert main(["collect", str(folder)]) == 0
    return [*paths, folder / "summary.nc"]


@pytest.mark.system
def test_batch_is_readable_without_hdf5_library(result_files):
    """Pyfive reads the files in pure Python, without the HDF5 library."""
    import pyfive  # part of the `dev` extra; requires newer packages than contactstudy

    for path in result_files:
        with pyfive.File(path) as file:
            assert file["peak_pressure"].attrs["units"] in ("Pa", b"Pa")
            assert any(name.startswith("contactstudy_") for name in file.attrs)
    with pyfive.File(result_files[2]) as file:
        (case,) = Folder(result_files[2].parents[1]).results().cases.index
        pressure = load_case(result_files[2].parents[1], case)["pressure"].values
        np.testing.assert_array_equal(file["pressure"][...], pressure.ravel())


@pytest.mark.system
def test_cf_checker_finds_no_errors(result_files):
    command = Path(sys.executable).with_name("compliance-checker")
    process = subprocess.run([command, "--test=cf:1.11", *result_files], capture_output=True, text=True, check=False)
    assert process.returncode == 0, process.stdout + process.stderr
    assert process.stdout.count("All tests passed!") == len(result_files), process.stdout


def test_batch_follows_cf_rules(result_files):
    for path in result_files:
        with netCDF4.Dataset(path) as file:
            assert file.Conventions == "CF-1.11"
            for name in ("title", "source", "history"):
                assert str(file.getncattr(name)), name
            for name, variable in file.variables.items():
                assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name)
                assert variable.long_name
                assert (
                    variable.dtype is str
                    or variable.dtype.kind == "S"
                    or "units" in variable.ncattrs()
                    or name in ("case",)
                ), name
                if name in file.dimensions:
                    assert "_FillValue" not in variable.ncattrs(), name
                    if variable.dtype is not str:
                        assert variable.size == 1 or (np.diff(variable[:]) > 0).all(), name


def test_netcdf4_and_h5netcdf_read_equal_values(result_files):
    for path in result_files:
        with netCDF4.Dataset(path) as netcdf4_file, h5netcdf.File(path, "r") as h5netcdf_file:
            netcdf4_file.set_auto_mask(False)
            netcdf4_file.set_auto_chartostring(False)
            assert set(netcdf4_file.variables) == set(h5netcdf_file.variables)
            for name, variable in netcdf4_file.variables.items():
                if variable.dtype is not str:
                    np.testing.assert_array_equal(variable[...], h5netcdf_file.variables[name][...], err_msg=name)
