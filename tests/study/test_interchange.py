"""The files in other hands: CF conventions, and readers that are not ours."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from contactstudy.cli import main
from contactstudy.study import run_study
from contactstudy.study.store import load_case
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """One case of every level, and the merged summary."""
    found = []
    for level in ("summary", "surface", "fields"):
        folder = tmp_path_factory.mktemp(level)
        sweep = {"e_over_a": [1.0], "friction": [0.1], "profile": [{"kind": "cylinder", "name": "sharp"}]}
        run_study(small_study(level=level, sweep=sweep), folder, workers=0, solver=solve_fake)
        found += sorted(folder.glob("cases/*.nc"))
    assert main(["collect", str(folder)]) == 0
    return [*found, folder / "summary.nc"]


def program(name):
    """Path of a program, of this environment or of the system; without it the test is skipped."""
    path = shutil.which(name, path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))
    if path is None:
        pytest.skip(f"the program {name} is not installed")
    return path


def test_ncdump_shows_header_and_values(files):
    for path in files:
        done = subprocess.run([program("ncdump"), str(path)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert 'peak_pressure:units = "Pa"' in done.stdout
        assert "contactstudy_" in done.stdout
    values = subprocess.run(
        [program("ncdump"), "-p", "9,17", "-v", "pressure", str(files[2])], capture_output=True, text=True, check=True
    ).stdout
    listed = re.findall(r"[-+.\de]+", values.rsplit("pressure =", 1)[1])
    np.testing.assert_array_equal([float(word) for word in listed], load_case(files[2])["pressure"].values.ravel())


def test_the_public_checker_finds_nothing(files):
    checker = program("compliance-checker")
    for path in files:
        done = subprocess.run([checker, "--test=cf:1.11", str(path)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "All tests passed!" in done.stdout, done.stdout


def test_rules_of_cf_that_need_no_checker(files):
    for path in files:
        with netCDF4.Dataset(path) as file:
            assert file.Conventions == "CF-1.11"
            for name in ("title", "source", "history"):
                assert str(file.getncattr(name)), name
            for name, variable in file.variables.items():
                assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name)
                assert variable.long_name
                assert variable.dtype is str or "units" in variable.ncattrs() or name in ("case",), name
                if name in file.dimensions:
                    assert "_FillValue" not in variable.ncattrs(), name
                    if variable.dtype is not str:
                        assert variable.size == 1 or (np.diff(variable[:]) > 0).all(), name


def test_netcdf4_and_h5netcdf_read_the_same(files):
    h5netcdf = pytest.importorskip("h5netcdf")
    for path in files:
        with netCDF4.Dataset(path) as one, h5netcdf.File(path, "r") as other:
            one.set_auto_mask(False)
            assert set(one.variables) == set(other.variables)
            for name, variable in one.variables.items():
                if variable.dtype is not str:
                    np.testing.assert_array_equal(variable[...], other.variables[name][...], err_msg=name)
