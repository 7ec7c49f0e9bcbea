"""Columns of text and netCDF files."""

import io
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest

from contactstudy.errors import InvalidInputError
from contactstudy.profiles import measurement_files
from contactstudy.profiles.measurement_files import read_columns, read_heights, read_netcdf

POINTS = [(0.0, 0.0), (2.5, 1.25), (5.0, 3.125)]
COLUMNS = ("x",), ("drop",)


def format_german_table(separator: str, decimal_mark: str = ",") -> str:
    rows = [f"{x:.2f}{separator}{drop:.3f}".replace(".", decimal_mark) for x, drop in POINTS]
    return "\n".join([f"x [mm]{separator}drop [µm]", *rows])


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "utf-8", "utf-8-sig", "utf-16", "mac-roman"])
@pytest.mark.parametrize("separator", [";", "\t"])
def test_german_spreadsheet_is_readable(tmp_path: Path, encoding: str, separator: str) -> None:
    (tmp_path / "a.csv").write_bytes(format_german_table(separator).encode(encoding))
    columns = read_columns(tmp_path / "a.csv", *COLUMNS)
    np.testing.assert_allclose(np.transpose([columns["x"], columns["drop"]]), np.multiply(POINTS, [1e-3, 1e-6]))


def test_unknown_encoding_raises_with_remedy(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(format_german_table(";").encode("cp850"))
    with pytest.raises(InvalidInputError, match=r"unit of drop.*save the file as UTF-8"):
        read_columns(tmp_path / "a.csv", *COLUMNS)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("1,000;2,500\n2,000;3,500", "line 3, drop = '3,500': must be a number of one meaning.*decimal points"),
        ("1,5;2.5", "line 2, x = '1,5': must be a number with the decimal mark of all others; line 2, drop is '2.5'"),
        ("1,234.5;2", "line 2, x = '1,234.5'"),
    ],
)
def test_ambiguous_commas_are_rejected(tmp_path: Path, rows: str, message: str) -> None:
    (tmp_path / "a.csv").write_text(f"x [mm];drop [um]\n{rows}\n")
    with pytest.raises(InvalidInputError, match=message):
        read_columns(tmp_path / "a.csv", *COLUMNS)


@pytest.mark.parametrize("header", ["x / mm;drop / um", "x/mm; drop/um", "x (mm);drop [um]"])
def test_header_units_have_several_notations(tmp_path: Path, header: str) -> None:
    (tmp_path / "a.csv").write_text(f"{header}\n1;2\n2;3\n")
    columns = read_columns(tmp_path / "a.csv", *COLUMNS)
    x, drop = columns["x"], columns["drop"]
    assert x.tolist() == pytest.approx([1e-3, 2e-3])
    assert drop.tolist() == pytest.approx([2e-6, 3e-6])


def make_workbook() -> bytes:
    with zipfile.ZipFile(content := io.BytesIO(), "w") as archive:
        archive.writestr("xl/workbook.xml", "<workbook/>")
    return content.getvalue()


FOREIGN_FILES = {
    "picture": (b"\x89PNG\r\n\x1a\n and so on", "it is a picture without heights"),
    "workbook": (make_workbook(), "it is a workbook of a spreadsheet program: save the sheet as 'CSV UTF-8'"),
    "bitmap": (b"BM" + (1078).to_bytes(4, "little") + bytes(8), "it is a picture"),
    "netCDF": (b"CDF\x01" + bytes(8), "it is netCDF: let its name end with .nc"),
    "document": (b"%PDF-1.7 and so on", "it is a PDF document"),
    "unknown": (bytes(range(256)), "ending"),
}


@pytest.mark.parametrize("kind", FOREIGN_FILES)
@pytest.mark.parametrize("name", ["a.csv", "a"])
def test_foreign_files_are_identified(tmp_path: Path, kind: str, name: str) -> None:
    content, message = FOREIGN_FILES[kind]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InvalidInputError, match=rf"columns as text.*netCDF.*extra `measured`.*{message}"):
        read_columns(tmp_path / name, *COLUMNS)


@pytest.mark.parametrize("column", ["BM nr", "CDF"])
def test_column_name_may_equal_file_signature(tmp_path: Path, column: str) -> None:
    (tmp_path / "a.csv").write_text(f"{column},x [mm], drop [um]\n1,0,2\n2,1,3\n")
    columns = read_columns(tmp_path / "a.csv", *COLUMNS)
    np.testing.assert_allclose([columns["x"], columns["drop"]], [[0, 1e-3], [2e-6, 3e-6]])


@pytest.mark.parametrize(("name", "kind"), [("a.png", "picture"), ("a.xlsx", "workbook"), ("a.pdf", "document")])
def test_foreign_file_does_not_ask_for_the_extra(tmp_path: Path, monkeypatch, name: str, kind: str) -> None:
    content, message = FOREIGN_FILES[kind]
    (tmp_path / name).write_bytes(content)
    monkeypatch.setattr(measurement_files, "find_spec", lambda name: None)
    with pytest.raises(InvalidInputError, match=message):
        read_heights(tmp_path / name)


def write_and_read(path, text):
    path.write_text(text, encoding="utf-8")
    return read_columns(path, ("x",), ("drop",))


@pytest.mark.parametrize("field", ["1_2.5", "١٢", "1,5e", "0x10", "1 2", "--1", "1" * 200_000 + "a"])
def test_other_number_formats_are_rejected(tmp_path, field):
    with pytest.raises(InvalidInputError, match="line 3") as caught:
        write_and_read(tmp_path / "a.csv", f"x [m]; drop [m]\n1; 2\n3; {field}\n")
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("field", ["1", "+1.", "-.5e-3", " 2.5E+4 ", "nan", "", "inf"])
def test_accepted_number_formats(tmp_path, field):
    expected = float(field) if field.strip() else np.nan
    columns = write_and_read(tmp_path / "a.csv", f"x [m], drop [m]\n1, {field}\n")
    np.testing.assert_equal(columns["drop"], [expected])


@pytest.mark.parametrize("line", ['1,"2\n', '1,"2\n3"\n', "1," + '"' + "2" * 200_000 + '"'])
def test_unclosed_quotation_mark_is_rejected(tmp_path, line):
    with pytest.raises(InvalidInputError, match="line 2"):
        write_and_read(tmp_path / "a.csv", f"x [m],drop [m]\n{line}")


def test_error_does_not_disclose_a_foreign_file(tmp_path):
    with pytest.raises(InvalidInputError, match="each with its unit") as caught:
        write_and_read(tmp_path / "passwd", "root:secret-password:0:0,PASSWORD=hunter2,x\n")
    assert "secret" not in str(caught.value)
    assert "hunter2" not in str(caught.value)


def test_error_contains_the_column_names(tmp_path):
    with pytest.raises(InvalidInputError, match=r"\['x', 'depth'\]"):
        write_and_read(tmp_path / "a.csv", "x [mm], depth [um]\n1, 2\n")


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null"])
def test_devices_are_rejected(path):
    with pytest.raises(InvalidInputError, match="a regular file"):
        read_columns(path, ("x",), ("drop",))


def test_pipes_and_folders_are_rejected(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe"):
        with pytest.raises(InvalidInputError, match="a regular file"):
            read_columns(path, ("x",), ("drop",))


def test_non_netcdf_file_raises_package_error(tmp_path):
    (tmp_path / "a.nc").write_text("text")
    with pytest.raises(InvalidInputError, match="a netCDF file that can be read") as caught:
        read_netcdf(tmp_path / "a.nc", *COLUMNS)
    assert "xarray" not in str(caught.value)
