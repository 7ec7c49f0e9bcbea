"""Files of measurements: columns as text in any common encoding and number format, netCDF, and instruments' formats.

The extra ``measured`` reads files of instruments, by x3pio and SurfaceTopography. With ``pandas.read_csv`` alone users
would lose decimal commas, encodings other than UTF-8, units in headers, and errors with line and column.
"""

from __future__ import annotations

import codecs
import csv
import logging
import re
import stat
from array import array
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import BadZipFile, ZipFile

import numpy as np
import pandas as pd
import xarray as xr

from contactstudy import checks
from contactstudy.checks import UNIT_SIZES, FloatArray
from contactstudy.errors import ContactStudyError, InvalidInputError

# Largest size of a file, bytes: a height map of ten million points. Limit.
MAX_BYTES = 500_000_000

BINARY_BYTES = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a\x1b"))  # Bytes outside text of single-byte encodings
MICRO = "\N{MICRO SIGN}"

FOREIGN_MICRO = "\udcb5"  # Python's surrogate of the byte 0xB5 outside UTF-8
WORKBOOK_ADVICE = "a workbook of a spreadsheet program: save the sheet as 'CSV UTF-8'"

SIGNATURES = {  # first bytes of foreign files, with advice
    **dict.fromkeys(
        (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"BM"),
        "a picture without heights: export the heights from the instrument's software",
    ),
    b"%PDF": "a PDF document: export the heights from the instrument's software",
    b"CDF": "netCDF: let its name end with .nc",
    b"\x89HDF": "netCDF or HDF5: let the name of a netCDF file end with .nc",
}
# Readable files, as the end of the sentence "must be ..."
READABLE_FILES = (
    "columns as text (.csv, .txt, .tsv, .dat), netCDF (.nc), or with the extra `measured` x3p (.x3p) "
    "and the profilometer formats of SurfaceTopography"
)


def check_regular_file(path: Path, kind: str = "text") -> None:
    """Raise unless `path` is a regular file of limited size: a pipe or a device would never end."""
    try:
        status = path.stat()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InvalidInputError("path", str(path), f"a {kind} file that can be read", reason) from error
    if not stat.S_ISREG(status.st_mode):
        raise InvalidInputError("path", str(path), "a regular file, not a folder, pipe or device")
    if status.st_size > MAX_BYTES:
        raise InvalidInputError("path", str(path), f"at most {MAX_BYTES:.0e} bytes", f"it has {status.st_size}")


def read_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of a text file with their numbers, without empty lines and comments."""
    check_regular_file(path)
    try:
        with open(path, encoding=_detect_encoding(path), errors="surrogateescape") as file:
            for line_number, line in enumerate(file, start=1):
                if (content := line.strip()) and not content.startswith("#"):
                    yield line_number, line.replace(FOREIGN_MICRO, MICRO)
    except (OSError, UnicodeError) as error:
        reason = error.strerror or str(error) if isinstance(error, OSError) else "it is no text"
        raise InvalidInputError("path", str(path), "a text file that can be read", reason.lower()) from error


def describe_foreign_file(path: Path) -> str:
    """Return the kind of a file without measurements, and advice; an empty text for an unknown kind."""
    head = _read_head(path)
    for signature, description in SIGNATURES.items():
        # Short signatures also occur in text: the code ignores them in text files.
        if head.startswith(signature) and (len(signature) > 3 or _is_binary(head)):
            return description
    if head.startswith(b"PK"):
        try:
            with ZipFile(path) as archive:
                names = archive.namelist()
        except (BadZipFile, OSError, ValueError, NotImplementedError):
            return ""
        if any(name.startswith("xl/") for name in names) or "content.xml" in names:
            return WORKBOOK_ADVICE
        return "x3p: let its name end with .x3p" if "main.xml" in names else ""
    return WORKBOOK_ADVICE if path.suffix.lower() == ".xls" else ""


def _read_head(path: Path) -> bytes:
    """First bytes of a file."""
    try:
        with open(path, "rb") as file:
            return file.read(4096)  # The first bytes determine the kind
    except OSError:
        return b""  # opening the file raises the error


def _is_binary(head: bytes) -> bool:
    """Whether the first bytes of a file contain bytes outside any single-byte text."""
    return head.translate(None, BINARY_BYTES) != head


def _detect_encoding(path: Path) -> str:
    """Return the encoding of a text file by its first bytes, or raise with its kind."""
    head = _read_head(path)
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if description := describe_foreign_file(path):
        raise InvalidInputError("path", str(path), READABLE_FILES, f"it is {description}")
    if _is_binary(head):
        hint = "a binary file with the name of a text file: restore the profilometer's ending, or export columns"
        raise InvalidInputError("path", str(path), READABLE_FILES, hint)
    return "utf-8-sig"


NUMERAL = re.compile(r"\s*[+-]?(?:(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?|nan|inf)\s*", re.ASCII | re.IGNORECASE)

# A number with a possible comma between thousands
THOUSANDS_PATTERN = re.compile(r"\s*[+-]?[1-9]\d{0,2},\d{3}\s*", re.ASCII)
QUOTE_LENGTH = 24  # Largest number of characters of a file in a message. Limit.


def truncate(text: str) -> str:
    """Return the beginning of a text, too short to disclose a foreign file."""
    text = text.strip()
    return text if len(text) <= QUOTE_LENGTH else f"{text[: QUOTE_LENGTH - 3]}..."


class NumberParser:
    """Parser of numbers with one decimal mark: a comma, unless it separates columns or thousands or points occur."""

    def __init__(self, separator: str) -> None:
        self._comma_allowed = separator != ","
        # the first number with a point, the last number with a comma
        self._marked_fields: dict[str, tuple[str, str]] = {}
        self._is_decimal_comma = False

    def parse(self, line_number: int, name: str, field: str) -> float:
        """Return a field of a column as a number; NaN for an empty field."""
        if not field.strip():
            return np.nan
        field_name = f"line {line_number}, {name}"
        numeral = field.replace(",", ".", 1) if self._comma_allowed and "." not in field else field
        # Python's float also accepts underscores and the digits of all scripts.
        if not NUMERAL.fullmatch(numeral):
            allowed = "a number with a decimal point" + (" or comma" if self._comma_allowed else "")
            raise InvalidInputError(field_name, truncate(field), allowed)
        if "," in field:
            self._marked_fields[","] = field_name, field
            self._is_decimal_comma = self._is_decimal_comma or not THOUSANDS_PATTERN.fullmatch(field)
        elif "." in field:
            self._marked_fields.setdefault(".", (field_name, field))
        return float(numeral)

    def check(self) -> None:
        """Raise if numbers with commas are ambiguous."""
        if "," not in self._marked_fields:
            return
        field_name, field = self._marked_fields[","]
        if "." in self._marked_fields:
            point_name, point_field = self._marked_fields["."]
            reason = f"{point_name} is {truncate(point_field)!r}"
            raise InvalidInputError(field_name, truncate(field), "a number with the decimal mark of all others", reason)
        if not self._is_decimal_comma:
            hint = "a decimal comma, or a comma between thousands: write decimal points"
            raise InvalidInputError(field_name, truncate(field), "a number of one meaning", hint)


MAX_STEP_RATIO = 3.0  # Width of a gap over the neighbouring steps. Limit.
# Messages quote only names of columns: the file may be foreign.
NAME_PATTERN = re.compile(r"[A-Za-z]\w{0,15}", re.ASCII)
MAX_NAMES = 8  # Largest number of names in a message. Limit.


def read_netcdf(path: Path, positions: tuple[str, ...], values: tuple[str, ...]) -> dict[str, FloatArray]:
    """Arrays of a netCDF file by name, metres: `positions`, and exactly one of `values` along these axes."""
    check_regular_file(path, "netCDF")
    try:
        with xr.open_dataset(path, engine="netcdf4") as file:
            dataset = file.load()
    except (OSError, ValueError) as error:
        reason = (error.strerror or "it is not netCDF") if isinstance(error, OSError) else str(error)
        raise InvalidInputError("path", str(path), "a netCDF file that can be read", reason.lower()) from error
    arrays = {name: dataset[name] for name in (*positions, *values) if name in dataset.variables}
    axes = [axis for name in positions if name in arrays for axis in arrays[name].dims]
    if [*arrays][:-1] != [*positions] or len(axes) != len(positions) or {*axes} != {*arrays[[*arrays][-1]].dims}:
        allowed = f"a file with {' or '.join(values)} along {' and '.join(positions)}, and with these positions"
        raise InvalidInputError("path", str(path), allowed)
    return {
        name: unit_in_metres(name, array.attrs.get("units"))
        * array.transpose(*(axis for axis in axes if axis in array.dims)).values.astype(np.float64)
        for name, array in arrays.items()
    }


def unit_in_metres(name: str, unit: object) -> float:
    """Size of a unit of length in metres."""
    text = str(unit).strip() if unit else ""
    if text not in UNIT_SIZES["m"]:
        hint = f"a header has the unit in brackets, such as {name} [mm]; netCDF in the attribute units"
        if any("\udc80" <= character <= "\udcff" for character in text):  # surrogates of an unknown encoding
            hint = "the encoding is unknown: save the file as UTF-8 (in Excel 'CSV UTF-8'), or write um"
        raise InvalidInputError(f"unit of {name}", text or None, f"one of {', '.join(UNIT_SIZES['m'])}", hint)
    return UNIT_SIZES["m"][text]


def read_columns(path: str | Path, positions: tuple[str, ...], values: tuple[str, ...]) -> dict[str, FloatArray]:
    """Columns of a CSV file by name, metres: `positions`, and exactly one of `values`; an empty field is NaN."""
    path = Path(path)
    lines = read_lines(path)
    header_line = next(lines, None)
    if header_line is None:
        hint = f"a header such as: {_example_header(positions, values)}"
        raise InvalidInputError("path", str(path), "a file with a header and data", hint)
    separator = next((mark for mark in ";\t" if mark in header_line[1]), ",")
    header = [_split_unit(entry) for entry in _split_fields(*header_line, separator)]
    indices = _select_columns([name for name, _ in header], positions, values, path)
    columns, parser = {index: array("d") for index in indices}, NumberParser(separator)
    for line_number, line in lines:
        row = _split_fields(line_number, line, separator)
        if len(row) != len(header):
            allowed = f"{len(header)} fields, as the header has"
            raise InvalidInputError(f"line {line_number}", f"{len(row)} fields", allowed)
        for index, column in columns.items():
            column.append(parser.parse(line_number, header[index][0], row[index]))
    parser.check()
    return {header[index][0]: unit_in_metres(*header[index]) * np.array(column) for index, column in columns.items()}


def _split_fields(line_number: int, line: str, separator: str) -> list[str]:
    """Split one line; a quotation mark cannot extend the field to the next line."""
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader((line.rstrip("\r\n"),), delimiter=separator, skipinitialspace=True, strict=True))
    except csv.Error as error:
        raise InvalidInputError(f"line {line_number}", truncate(line), "fields of numbers", str(error)) from None


def _split_unit(entry: str) -> tuple[str, str]:
    """Name and unit of a header's entry."""
    match = re.fullmatch(r"\s*([^\[(]*?)\s*[\[(]\s*(.*?)\s*[\])]\s*", entry)
    match = match or re.fullmatch(r"\s*(\w+)\s*/\s*(\S+)\s*", entry)  # DIN 1313
    return (match[1].lower(), match[2]) if match else (entry.strip().lower(), "")


def _select_columns(titles: list[str], positions: tuple[str, ...], values: tuple[str, ...], path: Path) -> list[int]:
    """Return the indices of the required columns; raise for missing or repeated columns."""
    value_names = [name for name in values if name in titles]
    if any(titles.count(name) != 1 for name in positions) or len(value_names) != 1 or titles.count(value_names[0]) != 1:
        required = f"{', '.join(positions)} and one of {', '.join(values)}"
        quoted_titles = [name if NAME_PATTERN.fullmatch(name) else "..." for name in titles[:MAX_NAMES]]
        header = _example_header(positions, values)
        hint = f"the first line of {path} without comments contains the names of the columns, such as: {header}"
        raise InvalidInputError("columns", quoted_titles, f"{required}, each with its unit", hint)
    return [titles.index(name) for name in (*positions, value_names[0])]


def _example_header(positions: tuple[str, ...], values: tuple[str, ...]) -> str:
    """Return an example of a valid header."""
    return ", ".join([*(f"{name} [mm]" for name in positions), f"{values[0]} [um]"])


def check_positions(name: str, positions: FloatArray, min_count: int = 2) -> None:
    """Raise unless positions are finite, increasing, and without gaps."""
    checks.coordinates(name, positions)
    if positions.size < min_count:
        raise InvalidInputError(name, f"{positions.size} positions", f"at least {min_count} positions")
    steps = np.diff(positions)
    decreases = np.flatnonzero(steps <= 0)
    if decreases.size:
        index = int(decreases[0]) + 1
        hint = "it is a duplicate" if steps[index - 1] == 0 else f"{positions[index - 1]:g} m is before it"
        raise InvalidInputError(name, f"{positions[index]:g} m at entry {index + 1}", "increasing", hint)
    padded_steps = np.concatenate([[0.0], steps, [0.0]])
    neighbours = np.maximum(padded_steps[:-2], padded_steps[2:])
    gaps = np.flatnonzero(steps > MAX_STEP_RATIO * neighbours) if steps.size > 1 else np.array([], dtype=int)
    if gaps.size:
        intervals = ", ".join(f"{positions[index]:g} to {positions[index + 1]:g} m" for index in gaps[:5])
        allowed = f"without steps over {MAX_STEP_RATIO:g} times as wide"
        raise InvalidInputError(name, f"{gaps.size} gaps: {intervals}", allowed)


def check_values(name: str, values: FloatArray, *positions: tuple[str, FloatArray]) -> None:
    """Raise with the first positions of values that are not finite; one pair of name and positions per axis."""
    bad_indices = np.argwhere(~np.isfinite(values))
    if not bad_indices.size:
        return
    places = []
    for indices in bad_indices[:5]:
        pairs = zip(positions, indices, strict=True)
        places.append(", ".join(f"{axis} = {points[index]:g} m" for (axis, points), index in pairs))
    hint = f"{len(bad_indices)} values are not: fill the gaps first, for example with the instrument's software"
    raise InvalidInputError(name, f"missing or not finite at {'; '.join(places)}", "given everywhere", hint)


# Endings of files without instrument formats: columns with units, and netCDF
TEXT_ENDINGS = ("", ".csv", ".txt", ".tsv", ".dat", ".nc")
ANGLES = (0, 90, 180, 270)  # Degrees by which heights can be turned. Limit.
MAX_XML = 100_000_000  # Largest XML entry of an x3p file, unpacked bytes: some million points as text. Limit.

# Without a handler the reader igor2 would print a foreign file on the screen.
logging.getLogger("igor2").addHandler(logging.NullHandler())

GRID_TOLERANCE = 1e-6  # Distance of points from the lines of a grid, over a step. Rounding.


class Heights(NamedTuple):
    """Measured heights, metres: positions along one axis or two, heights ``(x,)`` or ``(x, y)``, NaN if missing."""

    x: FloatArray
    y: FloatArray | None
    heights: FloatArray


def read_measurement(path: Path, positions: tuple[str, ...], values: tuple[str, ...]) -> tuple[Heights, str]:
    """Return positions along one axis or two, the values of a file in any readable format, and their name."""
    ending = path.suffix.lower()
    if ending not in TEXT_ENDINGS:
        return read_heights(path), "height"
    arrays = (read_netcdf if ending == ".nc" else read_columns)(path, positions, values)
    name = list(arrays)[-1]
    if len(positions) == 1:
        return Heights(arrays["x"], None, arrays[name]), name
    return Heights(*arrays.values()) if ending == ".nc" else _arrange_points(arrays), name


def _arrange_points(columns: dict[str, FloatArray]) -> Heights:
    """Positions along x and y and heights ``(x, y)`` from a table of points; NaN where the table lacks a point."""
    for name in ("x", "y"):
        checks.coordinates(name, columns[name])
    points = pd.DataFrame(columns)
    if (is_repeated := points.duplicated(["x", "y"])).any():
        x, y = points.loc[is_repeated, ["x", "y"]].iloc[0]
        count = ((points["x"] == x) & (points["y"] == y)).sum()
        raise InvalidInputError("height", f"{count} values at x = {x:g} m, y = {y:g} m", "one value at every point")
    heights = points.pivot(index="x", columns="y", values="height")
    return Heights(heights.index.to_numpy(), heights.columns.to_numpy(), heights.to_numpy())


def read_heights(path: Path) -> Heights:
    """Read positions and heights of an x3p file or a format of SurfaceTopography."""
    is_x3p = path.suffix.lower() == ".x3p"
    package = "x3pio" if is_x3p else "SurfaceTopography"
    if find_spec(package) is None:
        if not is_x3p and (description := describe_foreign_file(path)):
            raise _path_error(path, READABLE_FILES, f"it is {description}")
        raise ContactStudyError(
            f"reading {path} needs {package}, from the extra `measured`: "
            'pip install "contactstudy[measured]"; files with columns end with .csv, .txt, .tsv or .dat'
        )
    check_regular_file(path, "measured")
    heights = _read_x3p(path) if is_x3p else _read_topography(path)
    if heights.y is not None and heights.y.size == 1:
        return Heights(heights.x, None, heights.heights[:, 0])
    return heights


def rotate_heights(measured: Heights, angle: int, mirror: bool = False) -> Heights:
    """Rotate heights by 0, 90, 180 or 270 degrees about their axis, then mirror the y axis."""
    checks.instance("mirror", mirror, (bool, np.bool_), "True or False")
    allowed = ANGLES if measured.y is not None else ANGLES[::2]
    if isinstance(angle, bool) or angle not in allowed:
        degrees = ", ".join(map(str, allowed))
        raise InvalidInputError("turn", angle, f"one of {degrees} (degrees)" + (" for a line" * (measured.y is None)))
    x, y, heights = measured
    if y is None:
        return measured if angle == 0 else Heights(_reverse(x), None, heights[::-1])
    for _ in range(angle // 90):  # (x, y) moves to (-y, x)
        x, y, heights = _reverse(y), x, heights.T[::-1]
    if mirror:
        y, heights = _reverse(y), heights[:, ::-1]
    return Heights(x, y, heights)


def _reverse(positions: FloatArray) -> FloatArray:
    """Positions along the opposite axis, over the same range."""
    return np.asarray(positions[0] + positions[-1] - positions[::-1])


def _path_error(path: Path, allowed: str, hint: str = "") -> InvalidInputError:
    return InvalidInputError("path", str(path), allowed, hint)


def _read_x3p(path: Path) -> Heights:
    """Profile or surface of an x3p file; its lengths are metres by the standard."""
    import x3pio

    try:
        with ZipFile(path) as archive:
            sizes = {entry.filename: entry.file_size for entry in archive.infolist()}
    except (BadZipFile, OSError, ValueError, NotImplementedError) as error:  # NotImplementedError: a later version
        raise _path_error(path, "a readable x3p file", str(error)) from None
    for name, size in sizes.items():
        max_size = MAX_XML if name.endswith(".xml") else MAX_BYTES
        if size > max_size:
            raise _path_error(path, f"an x3p file with at most {max_size:.0e} bytes in {name}", f"it has {size}")
    try:
        file = x3pio.read(path)
    except (x3pio.X3pError, OSError) as error:
        raise _path_error(path, "a readable x3p file", str(error)) from None
    if isinstance(file, x3pio.PointCloud):
        raise _path_error(path, "a profile or a surface", "it is a cloud of points: bring it onto a grid")
    if len(file.layers) != 1:
        raise _path_error(path, "a file with one layer", f"it has {len(file.layers)}: write the required layer alone")
    points = file.layers[0].points(coordinate_system=x3pio.CoordinateSystem.VIEW)
    if isinstance(file, x3pio.Profile):
        return Heights(points[:, 0], None, points[:, 2])
    x, y = points[0, :, 0], points[:, 0, 1]
    deviations = np.abs(points[:, :, 0] - x).max(), np.abs(points[:, :, 1] - y[:, None]).max()
    steps = (np.abs(np.diff(lines)).min(initial=np.inf) for lines in (x, y))
    if not all(deviation <= GRID_TOLERANCE * step for deviation, step in zip(deviations, steps, strict=True)):
        raise _path_error(path, "a surface whose points are the crossings of lines along x and y")
    return Heights(x, y, points[:, :, 2].T)


def _read_topography(path: Path) -> Heights:
    """Line scan or topography in a format of SurfaceTopography."""
    from SurfaceTopography import read_topography
    from SurfaceTopography.Exceptions import CannotDetectFileFormat

    try:
        topography: Any = read_topography(str(path))
        unit, positions, heights = topography.unit, topography.positions(), np.ma.filled(topography.heights(), np.nan)
    except CannotDetectFileFormat:
        kind = describe_foreign_file(path)
        hint = f"it is {kind}" if kind else "its format is unknown: export it as x3p, or as columns in a .csv file"
        raise _path_error(path, READABLE_FILES, hint) from None
    except Exception as error:  # the readers raise any class on a damaged file
        raise _path_error(path, "a readable file", str(error)[:200]) from error
    from SurfaceTopography.Support.UnitConversion import get_unit_conversion_factor, is_length_unit

    if unit is None or not is_length_unit(unit):
        raise InvalidInputError(f"unit of {path}", unit, "a unit of length", "or columns with units, in a .csv file")
    scale = float(get_unit_conversion_factor(unit, "m"))
    if heights.ndim == 1:
        return Heights(scale * np.asarray(positions), None, scale * heights)
    return Heights(scale * positions[0][:, 0], scale * positions[1][0, :], scale * heights)
