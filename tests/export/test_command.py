"""``contactstudy export`` of fields."""

from __future__ import annotations

import pandas as pd
import pytest
import xarray as xr
from scipy.io import loadmat

from contactstudy.cli import main
from tests.export.vtk_reader import read
from tests.small_study import BASE, small_study
from tests.stand_in_solver import solve_fake


@pytest.fixture(scope="module")
def case(case_result: xr.Dataset, tmp_path_factory):
    path = tmp_path_factory.mktemp("file") / "case.nc"
    case_result.to_netcdf(path)
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    from contactstudy.study import run_study

    path = tmp_path_factory.mktemp("study")
    run_study(small_study(), path, workers=0, solver=solve_fake, progress=False)
    return path


def command(*arguments: object) -> int:
    return main(["export", *map(str, arguments)])


def test_export_writes_vtk_next_to_file(case, capsys) -> None:
    assert command(case, "--format", "vtk", "--variable", "von_mises", "--variable", "tresca") == 0
    assert "case.vtr" in capsys.readouterr().out
    assert list(read(case.with_suffix(".vtr"))[1]) == ["von_mises", "tresca"]


def test_line_of_a_file(case, tmp_path, capsys) -> None:
    line = "--line=2.6e-4,-5e-5,0:2.6e-4,5e-5,0"
    assert command(case, line, "--points", 5, "--variable", "tau_yz", "--out", tmp_path / "line.csv") == 0
    assert len(pd.read_csv(tmp_path / "line.csv")) == 5
    capsys.readouterr()
    assert command(case, "--variable", "pressure", "--out", "-") == 0
    assert capsys.readouterr().out.startswith("x [m],y [m],pressure [Pa]\n")


def test_case_of_a_study(folder, capsys) -> None:
    assert command(folder, "--select", "e_over_a=1", "--select", "friction=0.10", "--variable", "pressure") == 0
    table = pd.read_csv(folder / "export.csv")
    assert float(table["pressure [Pa] (error not estimated)"].max()) > 1e9  # the pressure lies on common cells
    assert command(folder, "--format", "vtk", "--select", "e_over_a=1", "--select", "friction=0.1") == 0
    assert (folder / "export.vtr").exists()


def test_folder_export_contains_only_scalars(folder) -> None:
    assert command(folder) == 0
    table = pd.read_csv(folder / "summary.csv")
    assert len(table) == 4
    assert {"e_over_a", "hertz_max_pressure [Pa]"} <= set(table)


def test_all_cases_for_matlab(folder) -> None:
    assert command(folder, "--format", "mat") == 0
    summaries = loadmat(folder / "export.mat", simplify_cells=True)
    assert summaries["hertz_max_pressure"].shape == (2, 2)
    assert "pressure" not in summaries
    assert command(folder, "--format", "mat", "--variable", "pressure", "--select", "friction=0.1") == 0
    assert loadmat(folder / "export.mat")["pressure"].shape[0] == 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--variable", "presure"], "did you mean 'pressure'"),
        ([], "name variables on the same points"),
        (["--line", "0,0,0"], "X,Y,Z:X,Y,Z"),
        (["--line", "0,0,0:1,0,0"], "within the result"),
        (["--format", "vtk", "--line", "0,0,0:1,0,0"], "left out for VTK"),
        (["--format", "vtk", "--out", "-"], "ends with .vtr"),
        (["--select", "friction=0.1"], "swept parameter: none"),
    ],
)
def test_wrong_use_of_a_file(case, capsys, options: list[str], message: str) -> None:
    assert command(case, *options) == 2
    assert message in capsys.readouterr().err


def test_wrong_use_of_a_study(folder, tmp_path, capsys) -> None:
    for options, message in (
        (["--variable", "pressure"], "a value of e_over_a, friction too; such as --select e_over_a="),
        (["--select", "friction=0.3"], "one of 0.0, 0.1"),
        (["--select", "friction=high"], "one of 0.0, 0.1"),
        (["--select", "speed=3"], "swept parameter: e_over_a, friction"),
        (["--select", "friction"], "NAME=VALUE"),
    ):
        assert command(folder, *options) == 2
        assert message in capsys.readouterr().err
    (tmp_path / "text.nc").write_text("not netCDF")
    for path in (tmp_path / "nothing.nc", tmp_path / "text.nc"):
        assert command(path) == 2
        assert "netCDF file or a study's folder" in capsys.readouterr().err


def test_marks_of_numbers_without_an_error(tmp_path) -> None:
    from contactstudy.study import run_study

    run_study(small_study(base=BASE | {"stresses": False}), tmp_path, workers=0, progress=False)
    assert command(tmp_path) == 0
    columns = list(pd.read_csv(tmp_path / "summary.csv"))
    for name in ("approach [m]", "contact_length [m]", "load_position [m]"):
        assert f"{name} (error not estimated)" in columns
    assert "normal_load [N]" in columns
