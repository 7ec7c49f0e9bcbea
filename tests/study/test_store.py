import json
import subprocess
import sys

import h5netcdf
import numpy as np
import pytest
import xarray as xr

from contactstudy.study import run_study
from contactstudy.study.errors import StoreError
from contactstudy.study.folder import Folder
from contactstudy.study.process import process_name
from contactstudy.study.setup import build_setup
from contactstudy.study.store import load_case, read_header, read_structure, remove_dead_parts, write_text
from tests.small_study import BASE, identity, small_study
from tests.solved_case import solved_case
from tests.stand_in_solver import solve_fake


@pytest.fixture
def case_file(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake)
    return Folder(tmp_path).case_path(identity(e_over_a=1, friction=0.1))


def expected():
    setup = build_setup(BASE | {"e_over_a": 1, "friction": 0.1})
    return solve_fake(setup.case, setup.grid, **setup.options)


def test_surfaces_are_exact_and_fields_in_single_precision(case_file):
    stored, solved = load_case(case_file), expected()
    np.testing.assert_array_equal(stored["pressure"], solved["pressure"])
    assert stored["von_mises"].dtype == np.float32
    np.testing.assert_array_equal(stored["von_mises"], solved["von_mises"].astype(np.float32))
    np.testing.assert_array_equal(stored["x_field"], solved["x_field"])


def test_a_file_alone_repeats_the_case(case_file):
    header = read_header(case_file)
    setup = build_setup(header.parameters)
    again = solve_fake(setup.case, setup.grid, **setup.options)
    np.testing.assert_array_equal(load_case(case_file)["pressure"], again["pressure"])
    assert {"contactstudy", "numpy", "scipy", "xarray", "time", "study", "level"} <= set(header.run)


def test_other_readers_open_it(case_file):
    with h5netcdf.File(case_file, "r") as file:
        values = file.variables["pressure"][...]
    np.testing.assert_array_equal(values, expected()["pressure"])
    with xr.open_dataset(case_file, engine="h5netcdf") as dataset:
        assert json.loads(dataset.attrs["contactstudy_case"])["e_over_a"] == 1


def test_the_structure_of_a_file_is_what_xarray_says(tmp_path):
    result = solved_case()
    result = result.assign(pressed=result["pressure"] > 0, counts=("unnamed", np.arange(3)))
    result = result.assign_coords(x_width=("x", np.gradient(result["x"])))
    result.rename(traction_y="shear_traction").to_netcdf(tmp_path / "case.nc")
    structure = read_structure(tmp_path / "case.nc", {})
    stored = load_case(tmp_path / "case.nc")
    assert {"pressed", "traction_y", "counts"} <= set(structure.variables)
    assert set(structure.variables) == {name for name, entry in stored.data_vars.items() if entry.ndim}
    for name, (dims, dtype, attributes) in structure.variables.items():
        assert (dims, dtype, attributes) == (stored[name].dims, stored[name].dtype, stored[name].attrs), name
    for name in ("x", "y", "z", "x_width"):
        np.testing.assert_array_equal(structure.positions[name], stored[name])
    np.testing.assert_array_equal(structure.positions["unnamed"], [0, 1, 2])


def test_files_alike_share_what_xarray_says_of_the_first(case_file):
    alike = {}
    first, second = (read_structure(case_file, alike) for _ in range(2))
    assert first.variables is second.variables
    assert len(alike) == 1


def test_every_variable_says_what_it_is(case_file):
    stored = load_case(case_file)
    for name, variable in stored.variables.items():
        assert {"units", "long_name"} <= set(variable.attrs), name
    assert stored.attrs["Conventions"].startswith("CF-")


@pytest.mark.parametrize(
    ("level", "kept", "dropped"),
    [
        ("summary", "peak_pressure", "pressure"),
        ("surface", "pressure", "von_mises"),
        ("fields", "von_mises", None),
    ],
)
def test_levels(tmp_path, level, kept, dropped):
    run_study(small_study(level=level), tmp_path, workers=0, solver=solve_fake)
    stored = load_case(Folder(tmp_path).case_path(identity(e_over_a=1, friction=0.1)))
    assert kept in stored
    assert dropped not in stored
    assert "peak_von_mises" in stored


def damage(path, how):
    content = bytearray(path.read_bytes())
    if how == "truncated":
        content = content[: len(content) // 2]
    elif how == "empty":
        content = bytearray()
    elif how == "text":
        content = bytearray(b"not a netCDF file")
    else:  # one bit of the compressed data, found by looking for where a change is noticed only on reading
        for position in range(len(content) // 2, len(content), 997):
            content[position] ^= 0x10
    path.write_bytes(content)


@pytest.mark.parametrize("how", ["truncated", "empty", "text", "bits"])
def test_damaged_files_are_named(case_file, how):
    damage(case_file, how)
    with pytest.raises(StoreError, match=case_file.name):
        read_header(case_file, verify=True)


def test_foreign_netcdf_is_named(tmp_path):
    path = tmp_path / "other.nc"
    xr.Dataset({"a": 1.0}).to_netcdf(path)
    with pytest.raises(StoreError, match="not a case"):
        read_header(path)


def test_parameters_that_do_not_belong_to_the_identity(case_file):
    dataset = load_case(case_file)
    dataset.attrs["contactstudy_case"] = json.dumps({"friction": 0.2})
    dataset.to_netcdf(case_file.with_name("edited.nc"))
    with pytest.raises(StoreError, match="identity"):
        read_header(case_file.with_name("edited.nc"))


def test_a_failed_write_leaves_the_old_file_and_no_part(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    write_text(path, "old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    with pytest.raises(StoreError, match="No space left"):
        write_text(path, "new")
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]


def test_only_parts_of_dead_processes_are_removed(tmp_path):
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    host = process_name().rsplit("-", 1)[0]
    mine, dead, elsewhere = (
        tmp_path / f"a.nc.part-{name}" for name in (process_name(), f"{host}-{gone.pid}", f"other-host-{gone.pid}")
    )
    for path in (mine, dead, elsewhere):
        path.write_text("")
    assert remove_dead_parts(tmp_path) == 1
    assert (mine.exists(), dead.exists(), elsewhere.exists()) == (True, False, True)
