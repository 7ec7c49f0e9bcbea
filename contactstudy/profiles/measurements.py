"""Columns of measured values with units, from text files in any common encoding and number format, and from netCDF."""

from __future__ import annotations

import codecs
import csv
import re
import stat
import zipfile
from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contactstudy import checks
from contactstudy.checks import UNIT_SIZES, FloatArray
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    import xarray as xr


# Of a file with measurements; a height map of ten million points has as many.
MOST_BYTES = 500_000_000

NEVER_TEXT = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a\x1b"))  # Bytes that text in no encoding of single bytes has
MICRO = "\N{MICRO SIGN}"

FOREIGN_MICRO = "\udcb5"  # Python's surrogate of the byte 0xB5 outside UTF-8
PICTURE = "a picture, which shows heights but does not hold them: export them from the instrument's software"
SHEET = "a workbook of a spreadsheet program: save the sheet as 'CSV UTF-8'"

# First bytes of other kinds of files, with advice
BEGINNINGS = (
    (b"\x89PNG", PICTURE),
    (b"\xff\xd8\xff", PICTURE),
    (b"GIF8", PICTURE),
    (b"BM", PICTURE),
    (b"%PDF", "a PDF document: export the heights from the instrument's software"),
    (b"CDF", "netCDF: let its name end with .nc"),
    (b"\x89HDF", "netCDF or HDF5: let the name of a netCDF file end with .nc"),
)
# What is read, as the end of the sentence "must be ..."
READ = (
    "columns as text (.csv, .txt, .tsv, .dat), netCDF (.nc), or with the extra `measured` x3p (.x3p) "
    "and the formats of profilometers that SurfaceTopography knows"
)


def regular_file(path: Path, kind: str = "text") -> None:
    """Raise unless `path` is a file of a sensible size: a pipe or a device would never end."""
    try:
        state = path.stat()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InvalidInputError("path", str(path), f"a {kind} file that can be read", reason) from error
    if not stat.S_ISREG(state.st_mode):
        raise InvalidInputError("path", str(path), "a regular file, not a folder, pipe or device")
    if state.st_size > MOST_BYTES:
        raise InvalidInputError("path", str(path), f"at most {MOST_BYTES:.0e} bytes", f"it has {state.st_size}")


def lines_of(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of a text file with their numbers, without empty lines and comments."""
    regular_file(path)
    try:
        with open(path, encoding=_encoding(path), errors="surrogateescape") as file:
            for number, line in enumerate(file, start=1):
                if (content := line.strip()) and not content.startswith("#"):
                    yield number, line.replace(FOREIGN_MICRO, MICRO)
    except (OSError, UnicodeError) as error:
        reason = error.strerror or str(error) if isinstance(error, OSError) else "it is no text"
        raise InvalidInputError("path", str(path), "a text file that can be read", reason.lower()) from error


def known_otherwise(path: Path) -> str:
    """Return the kind of a file without measurements, with advice; empty if unknown."""
    head = _head(path)
    for beginning, words in BEGINNINGS:
        # Length of beginnings that also occur in text: these count in binary files only
        if head.startswith(beginning) and (len(beginning) > 3 or _is_no_text(head)):
            return words
    if head.startswith(b"PK"):
        try:
            with zipfile.ZipFile(path) as archive:
                names = archive.namelist()
        except (OSError, zipfile.BadZipFile, ValueError):
            return ""
        if any(name.startswith("xl/") for name in names) or "content.xml" in names:
            return SHEET
        return "x3p: let its name end with .x3p" if "main.xml" in names else ""
    return SHEET if path.suffix.lower() == ".xls" else ""


def _head(path: Path) -> bytes:
    """First bytes of a file."""
    try:
        with open(path, "rb") as file:
            return file.read(4096)  # First bytes of a file, which determine its kind
    except OSError:
        return b""  # opening it raises the error


def _is_no_text(head: bytes) -> bool:
    """Whether the first bytes of a file contain bytes outside any single-byte text."""
    return head.translate(None, NEVER_TEXT) != head


def _encoding(path: Path) -> str:
    """Return the encoding of a text file by its first bytes, or raise with its kind."""
    head = _head(path)
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if words := known_otherwise(path):
        raise InvalidInputError("path", str(path), READ, f"it is {words}")
    if _is_no_text(head):
        hint = "named as text, it holds none: give a profilometer's file its own ending, or export columns"
        raise InvalidInputError("path", str(path), READ, hint)
    return "utf-8-sig"


NUMBER = re.compile(r"\s*[+-]?(?:(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?|nan|inf)\s*", re.ASCII | re.IGNORECASE)

# A number that could have a comma between its thousands
THOUSANDS = re.compile(r"\s*[+-]?[1-9]\d{0,2},\d{3}\s*", re.ASCII)
LONGEST_QUOTE = 24


def quoted(text: str) -> str:
    """Return the beginning of a text: enough to locate it, too little to disclose a foreign file."""
    text = text.strip()
    return text if len(text) <= LONGEST_QUOTE else f"{text[: LONGEST_QUOTE - 3]}..."


class Numbers:
    """Numbers of one file with one decimal mark.

    A comma is one unless it separates columns, a number has a point, or all commas may separate thousands.
    """

    def __init__(self, separator: str) -> None:
        self._may_be_comma = separator != ","
        self._with_point: tuple[str, str] | None = None
        self._with_comma: tuple[str, str] | None = None
        self._sure = False

    def read(self, line: int, name: str, field: str) -> float:
        """Return a field of a column as a number; an empty one is NaN."""
        # Python's own reading takes underscores and the digits of all scripts as well.
        if NUMBER.fullmatch(field):
            if self._with_point is None and "." in field:
                self._with_point = f"line {line}, {name}", field
            return float(field)
        if not field.strip():
            return np.nan
        if self._may_be_comma and "." not in field and NUMBER.fullmatch(pointed := field.replace(",", ".", 1)):
            self._with_comma = f"line {line}, {name}", field
            self._sure = self._sure or not THOUSANDS.fullmatch(field)
            return float(pointed)
        allowed = "a number with a decimal point" + (" or comma" if self._may_be_comma else "")
        raise InvalidInputError(f"line {line}, {name}", quoted(field), allowed)

    def check(self) -> None:
        """Raise if numbers with commas could mean something else."""
        if self._with_comma is None:
            return
        position, field = self._with_comma
        if self._with_point is not None:
            other = f"{self._with_point[0]} is {quoted(self._with_point[1])!r}"
            raise InvalidInputError(position, quoted(field), "a number with the decimal mark of all others", other)
        if not self._sure:
            hint = "here it may be a decimal comma or one between thousands: write decimal points"
            raise InvalidInputError(position, quoted(field), "a number of one meaning", hint)


WIDEST_STEP = 3.0  # A step between positions that is this many times as wide as the steps beside it is a gap
# Messages quote names of columns only: the file may be a foreign one.
NAME = re.compile(r"[A-Za-z]\w{0,15}", re.ASCII)
MOST_NAMES = 8


def read_netcdf(path: Path) -> xr.Dataset:
    """Content of a netCDF file, or an error that names it."""
    import xarray as xr

    regular_file(path, "netCDF")
    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            return opened.load()
    except (OSError, ValueError) as error:
        reason = (error.strerror or "it is not netCDF") if isinstance(error, OSError) else str(error)
        raise InvalidInputError("path", str(path), "a netCDF file that can be read", reason.lower()) from error


def unit_in_metres(name: str, unit: object) -> float:
    """Size of a unit of length in metres."""
    text = str(unit).strip() if unit else ""
    if text not in UNIT_SIZES["m"]:
        hint = f"a header says it in brackets, such as {name} [mm]; netCDF in the attribute units"
        if any("\udc80" <= sign <= "\udcff" for sign in text):  # surrogates of an unknown encoding
            hint = "its encoding is not known: save the file as UTF-8 (in Excel 'CSV UTF-8'), or write um"
        raise InvalidInputError(f"unit of {name}", text or None, f"one of {', '.join(UNIT_SIZES['m'])}", hint)
    return UNIT_SIZES["m"][text]


def read_columns(path: str | Path, positions: tuple[str, ...], values: tuple[str, ...]) -> dict[str, FloatArray]:
    """Columns of a CSV file by name, metres: `positions`, and exactly one of `values`; an empty field is NaN.

    Format: docs/how-to/measured_profile.md.
    """
    path = Path(path)
    lines = lines_of(path)
    first = next(lines, None)
    if first is None:
        hint = f"a header such as: {_wanted_header(positions, values)}"
        raise InvalidInputError("path", str(path), "a file with a header and data", hint)
    separator = next((mark for mark in ";\t" if mark in first[1]), ",")
    header = [_named_unit(entry) for entry in _fields(*first, separator)]
    names = _chosen([name for name, _ in header], positions, values, path)
    indices = [next(index for index, (title, _) in enumerate(header) if title == name) for name in names]
    columns, numbers = [array("d") for _ in names], Numbers(separator)
    for number, line in lines:
        row = _fields(number, line, separator)
        if len(row) != len(header):
            raise InvalidInputError(f"line {number}", f"{len(row)} fields", f"{len(header)} fields, as the header has")
        for name, index, column in zip(names, indices, columns, strict=True):
            column.append(numbers.read(number, name, row[index]))
    numbers.check()
    return {
        name: unit_in_metres(name, header[index][1]) * np.array(column)
        for name, index, column in zip(names, indices, columns, strict=True)
    }


def _fields(number: int, line: str, separator: str) -> list[str]:
    """Split one line; a quotation mark cannot make it go on in the next."""
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader((line.rstrip("\r\n"),), delimiter=separator, skipinitialspace=True, strict=True))
    except csv.Error as error:
        raise InvalidInputError(f"line {number}", quoted(line), "fields of numbers", str(error)) from None


def _named_unit(entry: str) -> tuple[str, str]:
    """Name and unit of a header's entry."""
    match = re.fullmatch(r"\s*([^\[(]*?)\s*[\[(]\s*(.*?)\s*[\])]\s*", entry)
    match = match or re.fullmatch(r"\s*(\w+)\s*/\s*(\S+)\s*", entry)  # as DIN 1313 has it
    return (match[1].lower(), match[2]) if match else (entry.strip().lower(), "")


def _chosen(titles: list[str], positions: tuple[str, ...], values: tuple[str, ...], path: Path) -> list[str]:
    """Names of the required columns, each once."""
    present = [name for name in values if name in titles]
    if any(titles.count(name) != 1 for name in positions) or len(present) != 1 or titles.count(present[0]) != 1:
        required = f"{', '.join(positions)} and one of {', '.join(values)}"
        quoted_titles = [name if NAME.fullmatch(name) else "..." for name in titles[:MOST_NAMES]]
        header = _wanted_header(positions, values)
        hint = f"the first line of {path} that is no comment names the columns, such as: {header}"
        raise InvalidInputError("columns", quoted_titles, f"{required}, each with its unit", hint)
    return [*positions, present[0]]


def _wanted_header(positions: tuple[str, ...], values: tuple[str, ...]) -> str:
    """Return an example of a header that would fit."""
    return ", ".join([*(f"{name} [mm]" for name in positions), f"{values[0]} [um]"])


def check_positions(name: str, positions: FloatArray, least: int = 2) -> None:
    """Raise unless positions are finite, increasing, and without gaps."""
    checks.coordinates(name, positions)
    if positions.size < least:
        raise InvalidInputError(name, f"{positions.size} positions", f"at least {least} positions")
    steps = np.diff(positions)
    back = np.flatnonzero(steps <= 0)
    if back.size:
        index = int(back[0]) + 1
        hint = "it is a duplicate" if steps[index - 1] == 0 else f"{positions[index - 1]:g} m is before it"
        raise InvalidInputError(name, f"{positions[index]:g} m at entry {index + 1}", "increasing", hint)
    padded = np.concatenate([[0.0], steps, [0.0]])
    neighbours = np.maximum(padded[:-2], padded[2:])
    gaps = np.flatnonzero(steps > WIDEST_STEP * neighbours) if steps.size > 1 else np.array([], dtype=int)
    if gaps.size:
        intervals = ", ".join(f"{positions[index]:g} to {positions[index + 1]:g} m" for index in gaps[:5])
        raise InvalidInputError(
            name, f"{gaps.size} gaps: {intervals}", f"without steps over {WIDEST_STEP:g} times as wide"
        )


def check_values(name: str, values: FloatArray, *positions: tuple[str, FloatArray]) -> None:
    """Raise with the first positions of a value that is not finite; one pair of name and positions per axis."""
    bad = np.argwhere(~np.isfinite(values))
    if not bad.size:
        return
    positions_text = "; ".join(
        ", ".join(f"{axis} = {where[index]:g} m" for (axis, where), index in zip(positions, entry, strict=True))
        for entry in bad[:5]
    )
    hint = f"{len(bad)} values are not: fill the gaps first, for example with the instrument's software"
    raise InvalidInputError(name, f"missing or not finite at {positions_text}", "given everywhere", hint)
