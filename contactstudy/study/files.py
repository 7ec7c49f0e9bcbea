"""Files that appear complete or not at all, and one door to the netCDF library, which is not safe in threads."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import stat
import uuid
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from threading import RLock

import xarray as xr

from contactstudy.errors import InvalidInputError, StoreError

NETCDF_LOCK = RLock()  # One netCDF operation at a time in this process
PART = ".part"  # Suffix of an unfinished file
UNFINISHED = re.compile(r".+\.[0-9a-f]{12}\.part")  # Names of unfinished files
ALMOST_FULL = 2**20
"""Bytes of free disk below which a failed write is attributed to a full disk: the netCDF library gives no reason."""


@contextlib.contextmanager
def netcdf_access(path: Path, verb: str) -> Iterator[None]:
    """Hold the netCDF lock; errors of disk and format become :class:`StoreError`."""
    try:
        with NETCDF_LOCK:
            yield
    except StoreError:
        raise
    except (OSError, RuntimeError, ValueError, TypeError, KeyError, IndexError, AttributeError) as error:
        full = verb == "write" and shutil.disk_usage(path.parent).free < ALMOST_FULL
        raise StoreError(f"cannot {verb} {path}: {'the disk is full; ' if full else ''}{error}") from error


def write_atomically(path: Path, write: Callable[[Path], object], name: Callable[[Path], str] | None = None) -> Path:
    """Call ``write(part)`` for a file beside `path`, flush it, rename it to `path` or ``name(part)``, and return that.

    The existing file remains if writing fails, which raises :class:`StoreError`. A link is replaced, not followed.
    """
    if path.is_dir():
        raise StoreError(f"cannot write {path}: it is a folder")
    part = path.with_name(f"{path.name}.{uuid.uuid4().hex[:12]}{PART}")
    try:
        write(part)
        with open(part, "rb+") as handle:
            os.fsync(handle.fileno())
        target = path if name is None else path.with_name(name(part))
        os.replace(part, target)
    except OSError as error:
        raise StoreError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
    return target


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    write_atomically(path, lambda part: part.write_text(text, encoding="utf-8"))


def write_dataset(path: Path, dataset: xr.Dataset) -> None:
    """Write any Dataset, such as the numbers of a study, atomically."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    described = dataset.assign_attrs(history=f"{now} written by contactstudy")
    # CF: coordinates lack a fill value.
    encoding = {name: {"_FillValue": None} for name in dataset.coords if name in dataset.dims}

    def write(part: Path) -> None:
        with netcdf_access(path, "write"):
            described.to_netcdf(part, engine="netcdf4", encoding=encoding)

    write_atomically(path, write)


def load_result(path: Path, argument: str) -> xr.Dataset:
    """Load the result in a netCDF file; an error names the argument with the path."""
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
