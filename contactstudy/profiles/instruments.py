"""Heights in the files of measuring instruments: x3p, and the formats of profilometers.

Two libraries of the extra ``measured`` read them: x3pio x3p (ISO 25178-72), profiles included; SurfaceTopography the
formats of instruments. This module converts lengths to metres and turns the axes.
"""

from __future__ import annotations

import logging
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import BadZipFile, ZipFile

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.profiles.measurements import MOST_BYTES, READ, known_otherwise, regular_file

X3P = ".x3p"

# Endings of files that need no other library: columns with units, and netCDF
TEXT = ("", ".csv", ".txt", ".tsv", ".dat", ".nc")
TURNS = (0, 90, 180, 270)

MOST_XML = 100_000_000  # Largest XML entry of an x3p file, bytes unpacked: a surface as text of some million points

# Where no one listens, a reader that is tried on a foreign file would print that file on the screen.
logging.getLogger("igor2").addHandler(logging.NullHandler())

REGULAR = 1e-6  # Distance of points from the lines of a grid, over a step


class Heights(NamedTuple):
    """Measured heights, metres: positions along one axis or two, heights ``(x,)`` or ``(x, y)``, NaN if missing."""

    x: FloatArray
    y: FloatArray | None
    heights: FloatArray


def of_instrument(path: Path) -> bool:
    """Whether a file is an instrument's, by its ending."""
    return path.suffix.lower() not in TEXT


def read_heights(path: Path) -> Heights:
    """Read positions and heights of an x3p file or a format of SurfaceTopography."""
    x3p = path.suffix.lower() == X3P
    package = "x3pio" if x3p else "SurfaceTopography"
    if find_spec(package) is None:
        if not x3p and (words := known_otherwise(path)):
            raise _refused(path, READ, f"it is {words}")
        raise ContactStudyError(
            f"reading {path} needs {package}, which the extra `measured` brings: "
            'pip install "contactstudy[measured]"; files with columns end with .csv, .txt, .tsv or .dat'
        )
    regular_file(path, "measured")
    heights = _x3p(path) if x3p else _topography(path)
    if heights.y is not None and heights.y.size == 1:
        return Heights(heights.x, None, heights.heights[:, 0])
    return heights


def turned(measured: Heights, turn: int, mirror: bool = False) -> Heights:
    """Return heights after a turn by 0, 90, 180 or 270 degrees about their axis, then a mirrored y axis."""
    checks.instance("mirror", mirror, (bool, np.bool_), "True or False")
    allowed = TURNS if measured.y is not None else TURNS[::2]
    if isinstance(turn, bool) or turn not in allowed:
        degrees = ", ".join(map(str, allowed))
        raise InvalidInputError("turn", turn, f"one of {degrees} (degrees)" + (" for a line" * (measured.y is None)))
    x, y, heights = measured
    if y is None:
        return measured if turn == 0 else Heights(_backwards(x), None, heights[::-1])
    if turn in (90, 270):  # (x, y) moves to (-y, x)
        x, y, heights = _backwards(y), x, heights.T[::-1]
    if turn in (180, 270):
        x, y, heights = _backwards(x), _backwards(y), heights[::-1, ::-1]
    if mirror:
        y, heights = _backwards(y), heights[:, ::-1]
    return Heights(x, y, heights)


def _backwards(positions: FloatArray) -> FloatArray:
    """Positions along the opposite axis, over the same range."""
    return np.asarray(positions[0] + positions[-1] - positions[::-1])


def _refused(path: Path, allowed: str, hint: str = "") -> InvalidInputError:
    return InvalidInputError("path", str(path), allowed, hint)


def _x3p(path: Path) -> Heights:
    """Profile or surface of an x3p file; its lengths are metres by the standard."""
    import x3pio

    try:
        with ZipFile(path) as archive:
            sizes = {entry.filename: entry.file_size for entry in archive.infolist()}
    except (BadZipFile, OSError, ValueError) as error:
        raise _refused(path, "an x3p file that can be read", str(error)) from None
    for name, size in sizes.items():
        most = MOST_XML if name.endswith(".xml") else MOST_BYTES
        if size > most:
            raise _refused(path, f"an x3p file with at most {most:.0e} bytes in {name}", f"it has {size}")
    try:
        file = x3pio.read(path)
    except (x3pio.X3pError, OSError) as error:
        raise _refused(path, "an x3p file that can be read", str(error)) from None
    if isinstance(file, x3pio.PointCloud):
        raise _refused(path, "a profile or a surface", "it is a cloud of points: bring it onto a grid")
    if len(file.layers) != 1:
        raise _refused(path, "a file with one layer", f"it has {len(file.layers)}: write the one you want alone")
    points = file.layers[0].points(coordinate_system=x3pio.CoordinateSystem.VIEW)
    if isinstance(file, x3pio.Profile):
        return Heights(points[:, 0], None, points[:, 2])
    x, y = points[0, :, 0], points[:, 0, 1]
    off = max(_off_lines(points[:, :, 0], x[None, :]), _off_lines(points[:, :, 1], y[:, None]))
    if not off <= REGULAR:
        raise _refused(path, "a surface whose points are the crossings of lines along x and y")
    return Heights(x, y, points[:, :, 2].T)


def _off_lines(positions: FloatArray, lines: FloatArray) -> float:
    """How far points are off the lines they should be on, over the least step between these."""
    steps = np.abs(np.diff(lines.ravel()))
    return float(np.abs(positions - lines).max() / steps.min()) if steps.size and steps.min() > 0 else 0.0


def _topography(path: Path) -> Heights:
    """Line scan or topography in a format of SurfaceTopography."""
    from SurfaceTopography import read_topography
    from SurfaceTopography.Exceptions import CannotDetectFileFormat

    try:
        read: Any = read_topography(str(path))
        unit, positions, heights = read.unit, read.positions(), np.ma.filled(read.heights(), np.nan)
    except CannotDetectFileFormat:
        words = known_otherwise(path)
        hint = f"it is {words}" if words else "none of these knows it: export it as x3p, or as columns in a .csv file"
        raise _refused(path, READ, hint) from None
    except Exception as error:  # its forty readers raise any class on a damaged file
        raise _refused(path, "a file that can be read", str(error)[:200]) from error
    from SurfaceTopography.Support.UnitConversion import get_unit_conversion_factor, is_length_unit

    if unit is None or not is_length_unit(unit):
        raise InvalidInputError(f"unit of {path}", unit, "a unit of length", "or columns with units, in a .csv file")
    metres = float(get_unit_conversion_factor(unit, "m"))
    if heights.ndim == 1:
        return Heights(metres * np.asarray(positions), None, metres * heights)
    return Heights(metres * positions[0][:, 0], metres * positions[1][0, :], metres * heights)
