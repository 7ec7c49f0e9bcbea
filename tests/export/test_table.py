"""Tables of results and their CSV files."""

from __future__ import annotations

import csv

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.figure import Figure

from contactstudy import InvalidInputError, analysis, checks, export, plots, report
from contactstudy.errors import StoreError
from contactstudy.export import csv_text, headings


def test_csv_of_line_equals_line_of_analysis(case_result: xr.Dataset, tmp_path) -> None:
    line = ((0.26e-3, 0, 0), (0.26e-3, 0, 90e-6))
    path = export.to_csv(case_result, tmp_path / "depth.csv", ["von_mises", "tresca"], line=line, points=4)
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["distance [m]", "x [m]", "y [m]", "z [m]", "von_mises [Pa]", "tresca [Pa]"]
    cut = analysis.along_line(case_result, *line, points=4, variables="tresca")
    assert [float(row["tresca [Pa]"]) for row in rows] == pytest.approx(cut["tresca"].values, rel=1e-12)


def test_table_of_variable_has_all_points(case_result: xr.Dataset) -> None:
    table = export.to_table(case_result, "pressure")
    assert table.columns.tolist() == ["x [m]", "y [m]", "pressure [Pa]"]
    assert np.array_equal(
        table["pressure [Pa]"].to_numpy().reshape(case_result["pressure"].shape), case_result["pressure"]
    )


def test_table_of_analysis_results_contains_columns_with_units(case_result: xr.Dataset) -> None:
    table = export.to_table(analysis.slices(case_result, 7))
    assert len(table) == 7
    assert "half_width [m] (error not estimated)" in table
    assert "axial_pressure [Pa] (error not estimated)" in table
    assert table["axial_pressure_error [Pa]"].isnull().all()
    assert "width [m]" in table
    assert "half_width [m] (error not estimated)" in export.to_table(analysis.axial_profiles(case_result))
    assert "von_mises" in export.to_table(analysis.normalized(case_result), "von_mises")


def test_table_of_study_case_has_no_padding(study_dataset: xr.Dataset) -> None:
    study_case = study_dataset.sel(e_over_a=1, friction=0.1, body="finite-length")
    table = export.to_table(study_case, "pressure")
    assert table.notnull().all(axis=None)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({}, r"pressure, .* \(x, y\) or sigma_xx, .* \(x_field, y_field, z\)"),
        ({"variables": ["pressure", "von_mises"]}, "same points"),
        ({"variables": "pressures"}, "did you mean"),
        ({"variables": "normal_load"}, "same points"),
        ({"line": 3}, "pair of points"),
        ({"line": ((0, 0, 0),)}, "pair of points"),
        ({"line": ((0, 0, 0), (1, 0, 0))}, "within the result"),
    ],
)
def test_invalid_argument_raises(case_result: xr.Dataset, settings: dict, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        export.to_table(case_result, **settings)


def test_csv_of_several_cases_raises(study_dataset: xr.Dataset, tmp_path) -> None:
    with pytest.raises(InvalidInputError, match="single case"):
        export.to_csv(study_dataset, tmp_path / "a.csv", "pressure")
    with pytest.raises(InvalidInputError, match="path"):
        export.to_csv(study_dataset, None)  # type: ignore[arg-type]


def test_unwritable_file_raises(case_result: xr.Dataset, tmp_path) -> None:
    with pytest.raises(StoreError, match="cannot write"):
        export.to_csv(case_result, tmp_path / "nowhere" / "a.csv", "pressure")
    with pytest.raises(StoreError, match="cannot write"):
        export.to_vtk(case_result, tmp_path / "nowhere" / "a.vtr", "pressure")


@pytest.mark.parametrize("write", [export.to_csv, report.write, plots.save])
def test_link_is_replaced_and_its_target_unchanged(case_result: xr.Dataset, tmp_path, write) -> None:
    suffix = {"to_csv": ".csv", "write": ".html", "save": ".png"}[write.__name__]
    target, link = tmp_path / "outside.txt", tmp_path / "folder" / f"result{suffix}"
    target.write_text("untouched")
    link.parent.mkdir()
    link.symlink_to(target)
    source = Figure() if write is plots.save else case_result[["pressure"]]
    write(source, link)
    assert target.read_text() == "untouched"
    assert not link.is_symlink()
    assert link.read_bytes()
    assert {path.suffix for path in link.parent.iterdir()} <= {suffix, ".pdf"}


def test_failed_write_keeps_previous_content(tmp_path) -> None:
    path = tmp_path / "result.csv"
    path.write_text("previous")
    with pytest.raises(UnicodeEncodeError), checks.writing(path) as temporary_path:
        temporary_path.write_text("half \ud800", encoding="utf-8")
    assert [entry.name for entry in tmp_path.iterdir()] == ["result.csv"]
    assert path.read_text() == "previous"


def test_csv_escapes_formulas_and_headings_mark_missing_errors() -> None:
    half_width = ((), 1e-4, {"error_kind": "not estimated"})
    dataset = xr.Dataset({"peak_pressure": 1e9, "friction": 0.1, "half_width": half_width})
    expected = {"friction": "friction", "half_width": "half_width [m] (error not estimated)"}
    assert headings(dataset, ["friction", "half_width"]) == expected
    table = pd.DataFrame({"profile": ["=1+1", "sharp"], "load": [-1.0, 2.0]})
    assert csv_text(table) == "profile,load\n'=1+1,-1.0\nsharp,2.0\n"
