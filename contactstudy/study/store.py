"""All netCDF input and output of the study layer: one file per case, whole or not there at all.

The netCDF library is not safe to use from several threads, so everything here runs under one lock of the process,
and dask is told not to add threads or locks of its own.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import sys
from collections.abc import Collection, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from threading import RLock
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy.analysis.provenance import RUN_ATTRIBUTE
from contactstudy.arrays.old_names import with_present_names
from contactstudy.arrays.variables import describe
from contactstudy.errors import InvalidInputError
from contactstudy.study.errors import StoreError
from contactstudy.study.identity import case_id
from contactstudy.study.process import alive, process_name, system

NETCDF_LOCK = RLock()
ALMOST_FULL = 2**20
"""Bytes left on a disk below which a failed write is put down to that."""
PART = re.compile(r"(?P<name>.+)\.part-(?P<system>.+)-(?P<pid>\d+)")
CASE_ATTRIBUTE = "contactstudy_case"
ID_ATTRIBUTE = "contactstudy_case_id"


class Header(NamedTuple):
    """What a file says about itself, and its scalars."""

    id: str
    parameters: dict[str, Any]
    run: dict[str, Any]
    scalars: dict[str, float]


class Specification(NamedTuple):
    """Dimensions, type and attributes of a variable."""

    dims: tuple[str, ...]
    dtype: np.dtype[Any]
    attributes: dict[str, Any]


Specifications = dict[str, Specification]

Raw = tuple[tuple[str, tuple[str, ...], str], ...]
"""Names, dimensions and types of all variables in a file, as they are stored."""


class Structure(NamedTuple):
    """Variables of a file that are not scalars, and positions and widths along their dimensions."""

    variables: Specifications
    positions: dict[str, npt.NDArray[Any]]


@contextlib.contextmanager
def _netcdf(path: Path, doing: str) -> Iterator[None]:
    """One netCDF operation at a time; failures of disk and file as :class:`StoreError`."""
    try:
        with NETCDF_LOCK, _without_threads(doing):
            yield
    except (OSError, RuntimeError, ValueError, TypeError, KeyError, IndexError, AttributeError) as error:
        # The netCDF library does not say so itself.
        full = doing == "write" and shutil.disk_usage(path.parent).free < ALMOST_FULL
        raise StoreError(f"cannot {doing} {path}: {'the disk is full; ' if full else ''}{error}") from error


def _without_threads(doing: str) -> contextlib.AbstractContextManager[object]:
    """Let dask compute in this thread; it takes long to import, and what is read without it needs nothing of it."""
    if doing == "read" and sys.modules.get("dask") is None:
        return contextlib.nullcontext()
    import dask
    from dask.local import get_sync  # named by a word, it lets dask import all that speaks with clusters

    return dask.config.set(scheduler=get_sync)


def write_atomically(path: Path, write: Any) -> None:
    """Call ``write(part)`` for a file beside `path`, flush it to disk and give it the name `path`.

    Raises
    ------
    StoreError
        If the disk is full, permission is missing, ...; a file that was there before stays as it was.
    """
    if path.is_dir():
        raise StoreError(f"cannot write {path}: it is a folder, and a file is to be written")
    part = path.with_name(f"{path.name}.part-{process_name()}")
    try:
        write(part)
        with open(part, "rb+") as handle:
            os.fsync(handle.fileno())
        os.replace(part, path)
    except OSError as error:
        raise StoreError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    write_atomically(path, lambda part: part.write_text(text, encoding="utf-8"))


def kept_variables(dataset: xr.Dataset, level: str) -> list[str]:
    """Names of the variables that a level keeps: scalars, those without depth, or all."""
    kept = []
    for name, variable in dataset.data_vars.items():
        depth = any(str(dim).startswith("z") for dim in variable.dims)
        if variable.ndim == 0 or level == "fields" or (level == "surface" and not depth):
            kept.append(str(name))
    return kept


def _attributes(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    """Attributes that netCDF can hold; others as JSON."""
    return {
        str(name): value
        if isinstance(value, (str, int, float, np.number)) and not isinstance(value, bool)
        else json.dumps(value, default=str)
        for name, value in attributes.items()
    }


def write_case(path: Path, dataset: xr.Dataset, level: str, header: Header) -> None:
    """Write the file of one case.

    Fields are kept in single precision, everything else in double; the compression is one that every reader of
    netCDF-4 knows, and a checksum stands beside every chunk.

    Parameters
    ----------
    path : Path
        The file; it appears complete or not at all.
    dataset : Dataset
        Result of the solver with the summary added.
    level : str
        What to keep.
    header : Header
        Identity, parameters and circumstances, which let the case be repeated from the file alone.

    Raises
    ------
    StoreError
        If it cannot be written.
    """
    kept = dataset[kept_variables(dataset, level)].copy()
    used = {dim for variable in kept.data_vars.values() for dim in variable.dims}
    kept = kept.drop_vars([name for name in kept.coords if not set(kept[name].dims) <= used])
    flags = {name: entry.astype(np.int8) for name, entry in kept.data_vars.items() if entry.dtype == bool}
    kept = describe(kept.assign(flags))
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in kept.variables.items():
        variable.attrs = _attributes(variable.attrs)
        variable.encoding = {}
        depth = any(str(dim).startswith("z") for dim in variable.dims)
        if variable.ndim >= 2:
            encoding[str(name)] = {
                "zlib": True,
                "complevel": 1,
                "shuffle": True,
                "fletcher32": True,
                "dtype": "float32" if depth else "float64",
                "_FillValue": np.nan,
                "chunksizes": variable.shape,
            }
        elif variable.dtype.kind == "f":
            encoding[str(name)] = {"_FillValue": None}
    kept.attrs = _attributes(dataset.attrs) | {
        ID_ATTRIBUTE: header.id,
        CASE_ATTRIBUTE: json.dumps(header.parameters),
        RUN_ATTRIBUTE: json.dumps({**header.run, "level": level}),
        "history": f"{header.run.get('time', '')} written by contactstudy",
    }

    def write(part: Path) -> None:
        with _netcdf(path, "write"):
            kept.to_netcdf(part, engine="netcdf4", encoding=encoding)

    write_atomically(path, write)


def read_header(path: Path, *, verify: bool = False) -> Header:
    """Read what a case's file says about itself.

    Parameters
    ----------
    path : Path
        The file.
    verify : bool
        Also read every value, so that the checksums are compared.

    Raises
    ------
    StoreError
        If the file is damaged or not of this package.
    """
    with _opened(path) as dataset:
        if ID_ATTRIBUTE not in dataset.attrs or CASE_ATTRIBUTE not in dataset.attrs:
            raise StoreError(f"{path} is not a case of a contactstudy study")
        if verify:
            dataset.load()
        parameters, run = (json.loads(dataset.attrs.get(name, "{}")) for name in (CASE_ATTRIBUTE, RUN_ATTRIBUTE))
        if not isinstance(parameters, dict) or not isinstance(run, dict):
            raise StoreError(f"{path}: its attributes are no tables of parameters and circumstances")
        header = Header(
            str(dataset.attrs[ID_ATTRIBUTE]),
            parameters,
            run,
            {str(name): float(variable) for name, variable in dataset.data_vars.items() if variable.ndim == 0},
        )
    try:
        identity = case_id(parameters)
    except InvalidInputError as error:
        raise StoreError(f"{path}: its parameters are none of this version: {error}") from error
    if identity != header.id:
        raise StoreError(f"{path}: its parameters do not belong to its identity {header.id[:16]}")
    return header


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[xr.Dataset]:
    """Open a file; an error of its format becomes our own, old names of variables those of today."""
    with _netcdf(path, "read"), xr.open_dataset(path, engine="netcdf4", cache=False) as dataset:
        yield with_present_names(dataset)


def load_case(path: Path) -> xr.Dataset:
    """Everything in a case's file, in memory.

    Raises
    ------
    StoreError
        If the file is damaged.
    """
    with _opened(path) as dataset:
        return dataset.load()


def load_variables(path: Path, wanted: Collection[str]) -> xr.Dataset:
    """Scalars of a case's file, and those of the wanted variables that it has, in memory.

    Raises
    ------
    StoreError
        If the file is damaged.
    """
    with _opened(path) as dataset:
        names = [name for name, entry in dataset.data_vars.items() if entry.ndim == 0 or name in wanted]
        return dataset[names].load()


def load_variable(path: Path, name: str) -> npt.NDArray[Any]:
    """Values of one variable of a case's file.

    Raises
    ------
    StoreError
        If the file is damaged or has no such variable.
    """
    with _opened(path) as dataset:
        return np.asarray(dataset[name].values)


def read_structure(path: Path, alike: dict[Raw, Specifications]) -> Structure:
    """Return what the variables of a case's file are, and where their values lie.

    Parameters
    ----------
    path : Path
        The file.
    alike : dict
        Variables of files that were read before, by what is stored of them; what is new is entered. To ask xarray
        for them takes ten times longer than to read positions.

    Raises
    ------
    StoreError
        If the file is damaged.
    """
    with _netcdf(path, "read"), contextlib.closing(xr.backends.NetCDF4DataStore.open(str(path))) as opened:
        file = opened.ds
        with opened.lock:  # what else xarray reads meanwhile waits
            stored = file.variables
            raw = tuple((name, entry.dimensions, str(entry.dtype)) for name, entry in stored.items())
            axes = {dim: f"{dim}_width" for _, dims, _ in raw for dim in dims}
            positions = {name: np.asarray(stored[name][:]) for name in (*axes, *axes.values()) if name in stored}
            positions |= {dim: np.arange(file.dimensions[dim].size) for dim in axes if dim not in positions}
    if raw not in alike:
        with _opened(path) as dataset:
            alike[raw] = {
                str(name): Specification(tuple(map(str, entry.dims)), entry.dtype, dict(entry.attrs))
                for name, entry in dataset.data_vars.items()
                if entry.ndim
            }
    return Structure(alike[raw], positions)


def scalar_attributes(path: Path) -> dict[str, dict[str, Any]]:
    """Attributes of each scalar variable of a case's file."""
    with _opened(path) as dataset:
        return {str(name): dict(entry.attrs) for name, entry in dataset.data_vars.items() if entry.ndim == 0}


def write_dataset(path: Path, dataset: xr.Dataset) -> None:
    """Write any Dataset, such as a merged summary, atomically."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    described = dataset.assign_attrs(history=f"{now} written by contactstudy")
    # By CF a coordinate has no missing values, and so no mark for them.
    encoding = {name: {"_FillValue": None} for name in dataset.coords if name in dataset.dims}

    def write(part: Path) -> None:
        with _netcdf(path, "write"):
            described.to_netcdf(part, engine="netcdf4", encoding=encoding)

    write_atomically(path, write)


def remove_dead_parts(folder: Path) -> int:
    """Remove unfinished files of processes of this system that are gone; return how many."""
    removed = 0
    for part in folder.glob("*.part-*"):
        match = PART.fullmatch(part.name)
        if match and match["system"] == system() and not alive(int(match["pid"])):
            part.unlink(missing_ok=True)
            removed += 1
    return removed
