"""Measured data from files: columns with units, and the checks that every measurement must pass.

Files are CSV, with a header such as ``x [mm], drop [um]``, or netCDF, with the attribute `units` on every variable.
Nothing is guessed: a missing unit, a comma of two meanings, a gap or a value that is no number is an error that says
where.
"""

from __future__ import annotations

import csv
import re
from array import array
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contactstudy import checks
from contactstudy.arrays.decimal_marks import Numbers, quoted
from contactstudy.arrays.text_files import is_unread, lines_of, regular_file
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    import xarray as xr

METRES = {
    "m": 1.0,
    "metre": 1.0,
    "meter": 1.0,
    "mm": 1e-3,
    "um": 1e-6,
    "µm": 1e-6,  # micro sign
    "μm": 1e-6,  # Greek letter mu
    "micron": 1e-6,
    "nm": 1e-9,
}
"""Units of length that a file may use, and their size in metres."""

WIDEST_STEP = 3.0
"""A step between positions that is this many times as wide as the steps beside it is a gap. Accuracy."""

# What a message quotes of a file, which may be a foreign one: names of columns, and little else.
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
    """Size of a unit of length in metres.

    Parameters
    ----------
    name : str
        What has the unit, for the message.
    unit : str
        The unit as written in the file.

    Raises
    ------
    InvalidInputError
        If it is missing or no unit of length.

    Examples
    --------
    >>> unit_in_metres("x", "mm")
    0.001
    """
    text = str(unit).strip() if unit else ""
    if text not in METRES:
        hint = f"a header says it in brackets, such as {name} [mm]; netCDF in the attribute units"
        if is_unread(text):
            hint = "its encoding is not known: save the file as UTF-8 (in Excel 'CSV UTF-8'), or write um"
        raise InvalidInputError(f"unit of {name}", text or None, f"one of {', '.join(METRES)}", hint)
    return METRES[text]


def read_columns(path: str | Path, positions: tuple[str, ...], values: tuple[str, ...]) -> dict[str, FloatArray]:
    """Columns of a CSV file, in metres.

    Parameters
    ----------
    path : str or Path
        Text with one line for each point. The first line names the columns with their units, as ``x [mm]`` or
        ``x (mm)``. Commas, semicolons or tabs between them; lines that begin with ``#`` are left out. Between
        semicolons or tabs numbers may have decimal commas, where these cannot be anything else. UTF-8, UTF-16 with its
        mark, or Latin-1 and its kin.
    positions : tuple of str
        Names of columns that must be there.
    values : tuple of str
        Names of which exactly one must be there.

    Returns
    -------
    dict of str to array
        The columns by name. An empty field or ``nan`` is NaN.

    Raises
    ------
    InvalidInputError
        If the file cannot be read, a column or unit is missing or unknown, or a field is no number (with its line).
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
    places = [next(place for place, (known, _) in enumerate(header) if known == name) for name in names]
    columns, numbers = [array("d") for _ in names], Numbers(separator)
    for number, line in lines:
        row = _fields(number, line, separator)
        if len(row) != len(header):
            raise InvalidInputError(f"line {number}", f"{len(row)} fields", f"{len(header)} fields, as the header has")
        for name, place, column in zip(names, places, columns, strict=True):
            column.append(numbers.read(number, name, row[place]))
    numbers.check()
    return {
        name: unit_in_metres(name, header[place][1]) * np.array(column)
        for name, place, column in zip(names, places, columns, strict=True)
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


def _chosen(found: list[str], positions: tuple[str, ...], values: tuple[str, ...], path: Path) -> list[str]:
    """Names of the wanted columns, each once."""
    present = [name for name in values if name in found]
    if any(found.count(name) != 1 for name in positions) or len(present) != 1 or found.count(present[0]) != 1:
        wanted = f"{', '.join(positions)} and one of {', '.join(values)}"
        shown = [name if NAME.fullmatch(name) else "..." for name in found[:MOST_NAMES]]
        header = _wanted_header(positions, values)
        hint = f"the first line of {path} that is no comment names the columns, such as: {header}"
        raise InvalidInputError("columns", shown, f"{wanted}, each with its unit", hint)
    return [*positions, present[0]]


def _wanted_header(positions: tuple[str, ...], values: tuple[str, ...]) -> str:
    """Return an example of a header that would fit."""
    return ", ".join([*(f"{name} [mm]" for name in positions), f"{values[0]} [um]"])


def check_positions(name: str, positions: FloatArray, least: int = 2) -> None:
    """Raise unless positions are finite, increasing, and without gaps.

    Parameters
    ----------
    name : str
        What they are, for the message.
    positions : array
        Metres.
    least : int
        Smallest number of them.

    Raises
    ------
    InvalidInputError
        With the first place where a position is missing, repeated, out of order, or where a gap is.

    Examples
    --------
    >>> check_positions("x", np.array([0.0, 1.0, 2.0, 2.0]))
    Traceback (most recent call last):
    contactstudy.errors.InvalidInputError: x = '2 m at entry 4': must be increasing; it is a duplicate
    """
    checks.coordinates(name, positions)
    if positions.size < least:
        raise InvalidInputError(name, f"{positions.size} positions", f"at least {least} positions")
    steps = np.diff(positions)
    back = np.flatnonzero(steps <= 0)
    if back.size:
        at = int(back[0]) + 1
        hint = "it is a duplicate" if steps[at - 1] == 0 else f"{positions[at - 1]:g} m is before it"
        raise InvalidInputError(name, f"{positions[at]:g} m at entry {at + 1}", "increasing", hint)
    padded = np.concatenate([[0.0], steps, [0.0]])
    beside = np.maximum(padded[:-2], padded[2:])
    gaps = np.flatnonzero(steps > WIDEST_STEP * beside) if steps.size > 1 else np.array([], dtype=int)
    if gaps.size:
        shown = ", ".join(f"{positions[at]:g} to {positions[at + 1]:g} m" for at in gaps[:5])
        raise InvalidInputError(name, f"{gaps.size} gaps: {shown}", f"without steps over {WIDEST_STEP:g} times as wide")


def check_values(name: str, values: FloatArray, *positions: tuple[str, FloatArray]) -> None:
    """Raise if a value is missing or not finite, with the first places where that is so.

    Parameters
    ----------
    name : str
        What they are, for the message.
    values : array
        Of as many dimensions as there are `positions`.
    *positions : tuple of str and array
        Name and positions (m) of every dimension.

    Raises
    ------
    InvalidInputError
        With the places.
    """
    bad = np.argwhere(~np.isfinite(values))
    if not bad.size:
        return
    shown = "; ".join(
        ", ".join(f"{axis} = {where[index]:g} m" for (axis, where), index in zip(positions, entry, strict=True))
        for entry in bad[:5]
    )
    hint = f"{len(bad)} values are not: fill the gaps first, for example with the instrument's software"
    raise InvalidInputError(name, f"missing or not finite at {shown}", "given everywhere", hint)
