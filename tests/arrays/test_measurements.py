"""Files of measurements that nobody should have made."""

import os

import numpy as np
import pytest

from contactstudy.arrays.measurements import read_columns, read_netcdf
from contactstudy.errors import InvalidInputError


def read(path, text):
    path.write_text(text, encoding="utf-8")
    return read_columns(path, ("x",), ("drop",))


@pytest.mark.parametrize("field", ["1_2.5", "١٢", "1,5e", "0x10", "1 2", "--1", "1" * 200_000 + "a"])
def test_only_plain_numbers_are_numbers(tmp_path, field):
    with pytest.raises(InvalidInputError, match="line 3") as caught:
        read(tmp_path / "a.csv", f"x [m]; drop [m]\n1; 2\n3; {field}\n")
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("field", ["1", "+1.", "-.5e-3", " 2.5E+4 ", "nan", "", "inf"])
def test_numbers_are_read(tmp_path, field):
    expected = float(field) if field.strip() else np.nan
    found = read(tmp_path / "a.csv", f"x [m], drop [m]\n1, {field}\n")
    np.testing.assert_equal(found["drop"], [expected])


@pytest.mark.parametrize("line", ['1,"2\n', '1,"2\n3"\n', "1," + '"' + "2" * 200_000 + '"'])
def test_quotation_marks_end_with_the_line(tmp_path, line):
    with pytest.raises(InvalidInputError, match="line 2"):
        read(tmp_path / "a.csv", f"x [m],drop [m]\n{line}")


def test_little_is_quoted_of_a_foreign_file(tmp_path):
    with pytest.raises(InvalidInputError, match="each with its unit") as caught:
        read(tmp_path / "passwd", "root:secret-password:0:0,PASSWORD=hunter2,x\n")
    assert "secret" not in str(caught.value)
    assert "hunter2" not in str(caught.value)


def test_names_of_columns_are_quoted(tmp_path):
    with pytest.raises(InvalidInputError, match=r"\['x', 'depth'\]"):
        read(tmp_path / "a.csv", "x [mm], depth [um]\n1, 2\n")


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null"])
def test_devices_are_no_files(path):
    with pytest.raises(InvalidInputError, match="a regular file"):
        read_columns(path, ("x",), ("drop",))


def test_pipes_and_folders_are_no_files(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe"):
        with pytest.raises(InvalidInputError, match="a regular file"):
            read_columns(path, ("x",), ("drop",))


def test_what_is_not_netcdf_is_said_in_our_words(tmp_path):
    (tmp_path / "a.nc").write_text("text")
    with pytest.raises(InvalidInputError, match="a netCDF file that can be read") as caught:
        read_netcdf(tmp_path / "a.nc")
    assert "xarray" not in str(caught.value)


def test_half_a_million_lines_are_read_in_seconds(tmp_path):
    import time

    path = tmp_path / "long.csv"
    path.write_text("x [um], drop [um]\n" + "\n".join(f"{number}, 1.5" for number in range(500_000)))
    began = time.process_time()
    assert read_columns(path, ("x",), ("drop",))["x"].size == 500_000
    assert time.process_time() - began < 5.0
