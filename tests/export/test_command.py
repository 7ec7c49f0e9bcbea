"""The command ``contactstudy export``."""

from __future__ import annotations

import pandas as pd
import pytest
import xarray as xr
from scipy.io import loadmat

from contactstudy.cli import main
from tests.export.vtk_reader import read_rectilinear
from tests.small_study import BASE, small_study
from tests.stand_in_solver import solve_fake


@pytest.fixture(scope="module")
def case_file(case_result: xr.Dataset, tmp_path_factory):
    path = tmp_path_factory.mktemp("file") / "case.nc"
    case_result.to_netcdf(path)
    return path


@pytest.fixture(scope="module")
def study_folder(tmp_path_factory):
    from contactstudy.study import run_study

    path = tmp_path_factory.mktemp("study")
    run_study(small_study(), path, workers=0, solver=solve_fake, progress=False)
    return path


def run_export(*arguments: object) -> int:
    return main(["export", *map(str, arguments)])


def test_export_writes_vtk_next_to_file(case_file, capsys) -> None:
    assert run_export(case_file, "--format", "vtk", "--variable", "von_mises", "--variable", "tresca") == 0
    assert "case.vtr" in capsys.readouterr().out
    assert list(read_rectilinear(case_file.with_suffix(".vtr"))[1]) == ["von_mises", "tresca"]


def test_line_of_file_is_written_as_csv(case_file, tmp_path, capsys) -> None:
    line = "--line=2.6e-4,-5e-5,0:2.6e-4,5e-5,0"
    assert run_export(case_file, line, "--points", 5, "--variable", "tau_yz", "--out", tmp_path / "line.csv") == 0
    assert len(pd.read_csv(tmp_path / "line.csv")) == 5
    capsys.readouterr()
    assert run_export(case_file, "--variable", "pressure", "--out", "-") == 0
    assert capsys.readouterr().out.startswith("x [m],y [m],pressure [Pa]\n")


def test_selected_case_of_study_is_exported(study_folder, capsys) -> None:
    assert (
        run_export(study_folder, "--select", "e_over_a=1", "--select", "friction=0.10", "--variable", "pressure") == 0
    )
    table = pd.read_csv(study_folder / "export.csv")
    assert float(table["pressure [Pa] (error not estimated)"].max()) > 1e9  # the pressure lies on common cells
    assert run_export(study_folder, "--format", "vtk", "--select", "e_over_a=1", "--select", "friction=0.1") == 0
    assert (study_folder / "export.vtr").exists()


def test_folder_export_contains_only_scalars(study_folder) -> None:
    assert run_export(study_folder) == 0
    table = pd.read_csv(study_folder / "summary.csv")
    assert len(table) == 4
    assert {"e_over_a", "hertz_max_pressure [Pa]"} <= set(table)


def test_study_is_exported_for_matlab(study_folder) -> None:
    assert run_export(study_folder, "--format", "mat") == 0
    summaries = loadmat(study_folder / "export.mat", simplify_cells=True)
    assert summaries["hertz_max_pressure"].shape == (2, 2)
    assert "pressure" not in summaries
    assert run_export(study_folder, "--format", "mat", "--variable", "pressure", "--select", "friction=0.1") == 0
    assert loadmat(study_folder / "export.mat")["pressure"].shape[0] == 2


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
def test_invalid_export_of_file_exits_with_message(case_file, capsys, options: list[str], message: str) -> None:
    assert run_export(case_file, *options) == 2
    assert message in capsys.readouterr().err


def test_invalid_export_of_study_exits_with_message(study_folder, tmp_path, capsys) -> None:
    for options, message in (
        (["--variable", "pressure"], "a value of e_over_a, friction too; such as --select e_over_a="),
        (["--select", "friction=0.3"], "one of 0.0, 0.1"),
        (["--select", "friction=high"], "one of 0.0, 0.1"),
        (["--select", "speed=3"], "swept parameter: e_over_a, friction"),
        (["--select", "friction"], "NAME=VALUE"),
    ):
        assert run_export(study_folder, *options) == 2
        assert message in capsys.readouterr().err
    (tmp_path / "text.nc").write_text("not netCDF")
    for path in (tmp_path / "nothing.nc", tmp_path / "text.nc"):
        assert run_export(path) == 2
        assert "netCDF file or a study's folder" in capsys.readouterr().err


def test_headings_mark_numbers_without_error(tmp_path) -> None:
    from contactstudy.study import run_study

    run_study(small_study(base=BASE | {"stresses": False}), tmp_path, workers=0, progress=False)
    assert run_export(tmp_path) == 0
    columns = list(pd.read_csv(tmp_path / "summary.csv"))
    for name in ("approach [m]", "contact_length [m]", "load_position [m]"):
        assert f"{name} (error not estimated)" in columns
    assert "normal_load [N]" in columns
