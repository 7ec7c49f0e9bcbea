"""Tables and CSV."""

from __future__ import annotations

import csv

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis, export


def test_a_line_as_csv(solved: xr.Dataset, tmp_path) -> None:
    line = ((0.26e-3, 0, 0), (0.26e-3, 0, 90e-6))
    path = export.to_csv(solved, tmp_path / "depth.csv", ["von_mises", "tresca"], line=line, points=4)
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["distance [m]", "x [m]", "y [m]", "z [m]", "von_mises [Pa]", "tresca [Pa]"]
    cut = analysis.along_line(solved, *line, points=4, variables="tresca")
    assert [float(row["tresca [Pa]"]) for row in rows] == pytest.approx(cut["tresca"].values, rel=1e-12)


def test_all_points_of_a_variable(solved: xr.Dataset) -> None:
    table = export.to_table(solved, "pressure")
    assert table.columns.tolist() == ["x [m]", "y [m]", "pressure [Pa]"]
    assert np.array_equal(table["pressure [Pa]"].to_numpy().reshape(solved["pressure"].shape), solved["pressure"])


def test_what_the_analysis_returns(solved: xr.Dataset) -> None:
    table = export.to_table(analysis.slices(solved, 7))
    assert len(table) == 7
    assert "half_width [m] (no error known)" in table
    assert "axial_pressure [Pa] (no error known)" in table
    assert table["axial_pressure_error [Pa]"].isnull().all()
    assert "width [m]" in table
    assert "half_width [m] (no error known)" in export.to_table(analysis.axial_profiles(solved))
    assert "von_mises" in export.to_table(analysis.normalized(solved), "von_mises")


def test_a_case_of_a_study(opened: xr.Dataset) -> None:
    one = opened.sel(e_over_a=1, friction=0.1, body="finite-length")
    table = export.to_table(one, "pressure")
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
def test_bad_input(solved: xr.Dataset, settings: dict, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        export.to_table(solved, **settings)


def test_more_than_one_case(opened: xr.Dataset, tmp_path) -> None:
    with pytest.raises(InvalidInputError, match="single case"):
        export.to_csv(opened, tmp_path / "a.csv", "pressure")
    with pytest.raises(InvalidInputError, match="path"):
        export.to_csv(opened, None)  # type: ignore[arg-type]


def test_a_file_that_cannot_be_written(solved: xr.Dataset, tmp_path) -> None:
    with pytest.raises(InvalidInputError, match=r"path = .*can be written"):
        export.to_csv(solved, tmp_path / "nowhere" / "a.csv", "pressure")
    with pytest.raises(InvalidInputError, match=r"path = .*can be written"):
        export.to_vtk(solved, tmp_path / "nowhere" / "a.vtr", "pressure")
