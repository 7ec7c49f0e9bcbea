"""Heights in the files of measuring instruments: x3p, and the formats of profilometers.

Two libraries of the extra ``measured`` read these files: x3pio reads x3p (ISO 25178-72), profiles included;
SurfaceTopography reads the formats of instruments. This module converts lengths to metres and turns the axes.
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
from contactstudy.profiles.column_files import MAX_BYTES, READABLE_FILES, check_regular_file, describe_foreign_file

# Endings of files without instrument formats: columns with units, and netCDF
TEXT_ENDINGS = ("", ".csv", ".txt", ".tsv", ".dat", ".nc")
ANGLES = (0, 90, 180, 270)

MAX_XML = 100_000_000  # Largest XML entry of an x3p file, bytes unpacked: a surface as text of some million points

# Without a handler the reader igor2 would print a foreign file on the screen.
logging.getLogger("igor2").addHandler(logging.NullHandler())

GRID_TOLERANCE = 1e-6  # Distance of points from the lines of a grid, over a step


class Heights(NamedTuple):
    """Measured heights, metres: positions along one axis or two, heights ``(x,)`` or ``(x, y)``, NaN if missing."""

    x: FloatArray
    y: FloatArray | None
    heights: FloatArray


def is_instrument_file(path: Path) -> bool:
    """Whether a file has the ending of an instrument's format."""
    return path.suffix.lower() not in TEXT_ENDINGS


def read_heights(path: Path) -> Heights:
    """Read positions and heights of an x3p file or a format of SurfaceTopography."""
    x3p = path.suffix.lower() == ".x3p"
    package = "x3pio" if x3p else "SurfaceTopography"
    if find_spec(package) is None:
        if not x3p and (description := describe_foreign_file(path)):
            raise _path_error(path, READABLE_FILES, f"it is {description}")
        raise ContactStudyError(
            f"reading {path} needs {package}, from the extra `measured`: "
            'pip install "contactstudy[measured]"; files with columns end with .csv, .txt, .tsv or .dat'
        )
    check_regular_file(path, "measured")
    heights = _read_x3p(path) if x3p else _read_topography(path)
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
    except (BadZipFile, OSError, ValueError) as error:
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
