"""Atomic writes of files, and exclusive access to the netCDF library, which is not safe in threads."""

from __future__ import annotations

import contextlib
import re
import shutil
import stat
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from threading import RLock

import xarray as xr

from contactstudy.checks import writing
from contactstudy.errors import InvalidInputError, StoreError

NETCDF_LOCK = RLock()  # One netCDF operation at a time in this process
UNFINISHED = re.compile(r".+\.[0-9a-f]{12}\.part")  # Names of unfinished files
ALMOST_FULL = 2**20  # Free bytes below which a failed write is attributed to a full disk: netCDF gives no reason


@contextlib.contextmanager
def netcdf_access(path: Path, verb: str) -> Iterator[None]:
    """Hold the netCDF lock; errors of disk and format become :class:`StoreError`."""
    try:
        with NETCDF_LOCK:
            yield
    except (OSError, RuntimeError, ValueError, TypeError, KeyError, IndexError, AttributeError) as error:
        disk_is_full = verb == "write" and shutil.disk_usage(path.parent).free < ALMOST_FULL
        raise StoreError(f"cannot {verb} {path}: {'the disk is full; ' if disk_is_full else ''}{error}") from error


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    with writing(path) as temporary_path:
        temporary_path.write_text(text, encoding="utf-8")


def write_dataset(path: Path, dataset: xr.Dataset) -> None:
    """Write any Dataset, such as the numbers of a study, atomically."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    described = dataset.assign_attrs(history=f"{now} written by contactstudy")
    # The CF conventions forbid a fill value of coordinates.
    encoding = {name: {"_FillValue": None} for name in dataset.coords if name in dataset.dims}
    with writing(path) as temporary_path, netcdf_access(path, "write"):
        described.to_netcdf(temporary_path, engine="netcdf4", encoding=encoding)


def load_result(path: Path, argument: str) -> xr.Dataset:
    """Load the result in a netCDF file; an error message contains the name of the `argument` that gave the path."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return dataset.load()
    except (OSError, ValueError) as error:
        reason = "there is no such file" if isinstance(error, FileNotFoundError) else "this file is not netCDF"
        raise InvalidInputError(argument, str(path), "a netCDF file or a study's folder", reason) from None


def is_regular(path: Path) -> bool:
    """Whether a path is a file, and not a link, pipe, device or folder."""
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except OSError:
        return False
