"""A finished, or half finished, study as one labelled Dataset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE
from contactstudy.arrays.variables import DERIVED, describe, labels
from contactstudy.study.errors import StoreError
from contactstudy.study.folder import Entry, Folder
from contactstudy.study.lazy_fields import CELLS, Fields, Place
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.plan import Plan, PlannedCase
from contactstudy.study.store import Raw, Specifications, read_structure, scalar_attributes


def open_study(folder: str | Path, *, cells: str = "common") -> xr.Dataset:
    """Open the results of a study as one Dataset whose dimensions are the swept parameters.

    Parameters
    ----------
    folder : str or Path
        The study's folder; the study may still run or be incomplete.
    cells : {"common", "own"}
        Whether surfaces are brought onto cells that all cases share, or stay on each case's own.

    Returns
    -------
    Dataset
        * `status` ("ok", "failed", "skipped", "stale", "missing", or "excluded" for what the study leaves out),
          `message` and `case_id` of every case;
        * `e_over_a`, `friction`, `gamma` and `profile` of every case, as dimension or as coordinate;
        * every scalar of the cases, in memory, NaN where there is none. Those that are settled, with their errors,
          come from the case's own cells;
        * surfaces and fields as dask arrays with one chunk per case. Where all cases have the same positions, these are
          coordinates ``x``, ``y``, ... Where they are the same over the Hertz half-width, the dimension is
          ``x_over_a`` (distance from the free end over the half-width), and ``x`` holds each case's metres. Surfaces on
          different cells are brought onto common ones along ``x_over_a`` and ``y_over_a``: pressure and traction are
          averaged, so that loads are kept, and all else is interpolated, as the attribute `comment` says. With
          ``cells="own"``, and for stresses at different points, the dimension is ``x_index``, and ``x`` and
          ``x_over_a`` hold each case's own positions, padded with NaN.

    Raises
    ------
    StudyFileError
        If the folder holds no study.
    InvalidInputError
        If `cells` is neither of the two.

    Examples
    --------
    >>> import tempfile
    >>> from contactstudy.study import Study, run_study
    >>> study = Study(
    ...     name="small",
    ...     base={"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.2e-3, "e_over_a": 0,
    ...           "body": "half-space", "stresses": False},
    ...     sweep={"max_pressure": [1.0e9, 1.5e9]},
    ... )
    >>> folder = tempfile.mkdtemp()
    >>> report = run_study(study, folder, workers=0, progress=False)
    >>> results = open_study(folder)
    >>> results.status.values.tolist(), results.pressure.dims
    (['ok', 'ok'], ('max_pressure', 'x_over_a', 'y_over_a'))
    >>> own = open_study(folder, cells="own")
    >>> own.pressure.dims, round(float(own.gamma), 3), str(own.profile.item())
    (('max_pressure', 'x_index', 'y_index'), 0.04, 'cylinder')
    """
    checks.known_name("cells", cells, CELLS)
    place = Folder(folder)
    study = place.read_study()
    plan = study.plan()
    entries = place.entries(plan)
    dataset = _summaries(plan, entries, place)
    usable = {
        case.position: place.path / entry.path
        for case, entry in zip(plan.cases, entries, strict=True)
        if entry.path and entry.run.get("level") != "summary"
    }
    structures = {}
    alike: dict[Raw, Specifications] = {}
    for position, path in usable.items():
        try:
            structures[position] = read_structure(path, alike)
        except StoreError:  # removed or replaced this very moment by a run that goes on
            continue
    if structures:
        dataset = Fields(dataset, plan.cube, usable, structures, cells).added()
    dataset.attrs = {STUDY_ATTRIBUTE: study.to_json()}
    return describe(dataset, study.description or f"study {study.name}")


def _label_coordinate(name: str, dim: str, values: Sequence[Any]) -> tuple[str, npt.NDArray[Any], dict[str, str]]:
    """Coordinate of a swept parameter; a value that some cases do not have is NaN or an empty text."""
    if any(isinstance(value, str) for value in values):
        array = np.asarray(["" if value is None else str(value) for value in values], dtype=np.str_)
    else:
        array = np.asarray([np.nan if value is None else value for value in values])
    parameter = PARAMETERS.get(name)
    return dim, array, parameter.attrs if parameter else labels("case", coordinate=True)


def _summaries(plan: Plan, entries: list[Entry], place: Folder) -> xr.Dataset:
    """Status, message and scalars of all cases along the study's dimensions."""
    cube = plan.cube
    coordinates = {name: _label_coordinate(name, dim, values) for name, (dim, values) in cube.labels.items()}
    names = sorted({name for entry in entries for name in entry.scalars} - set(coordinates))
    status = np.full(cube.shape, "excluded", dtype=object)
    message, identity = (np.full(cube.shape, "", dtype=object) for _ in range(2))
    scalars = {name: np.full(cube.shape, np.nan) for name in names}
    for case, entry in zip(plan.cases, entries, strict=True):
        status[case.position], message[case.position], identity[case.position] = entry.status, entry.reason, case.id
        for name in names:
            scalars[name][case.position] = entry.scalars.get(name, np.nan)
    attributes: dict[str, dict[str, Any]] = {}
    for entry in entries:
        if set(names) - set(attributes) and set(entry.scalars) - set(attributes):
            attributes |= scalar_attributes(place.path / entry.path)
    variables: dict[str, Any] = {name: (cube.dims, array, attributes.get(name, {})) for name, array in scalars.items()}
    for name, text in (("status", status), ("message", message), ("case_id", identity)):
        variables[name] = (cube.dims, text.astype(np.str_))
    return xr.Dataset(variables, coords={**_described(plan, entries), **coordinates})


def _described(plan: Plan, entries: list[Entry]) -> dict[str, Any]:
    """End distance, friction, gamma and profile of the cases, along the dimensions that they change with."""
    cube, found = plan.cube, {}
    for name in ("e_over_a", "friction", "gamma", "profile"):
        pairs = zip(plan.cases, entries, strict=True)
        known = {case.position: _said(case, entry, name) for case, entry in pairs if case.described}
        known = {position: value for position, value in known.items() if isinstance(value, str) or value == value}
        if not known:
            continue
        words = isinstance(next(iter(known.values())), str)
        table = np.full(cube.shape, "" if words else np.nan, dtype=object if words else np.float64)
        for position, value in known.items():
            table[position] = value
        dims, table = _reduced(cube.dims, table, known)
        attributes = PARAMETERS[name].attrs | {"comment": DERIVED}
        found[name] = (dims, table.astype(np.str_) if words else table, attributes)
    return found


def _said(case: PlannedCase, entry: Entry, name: str) -> float | str:
    """Return what describes a case; NaN for e over a half-width that follows from the solution, until it is known."""
    value = case.described[name]
    if name == "e_over_a" and "approach" in case.parameters:
        return float(case.parameters["end_distance"]) / entry.scalars.get("hertz_half_width", np.nan)
    return value


def _reduced(
    dims: tuple[str, ...], table: npt.NDArray[Any], known: Mapping[Place, object]
) -> tuple[tuple[str, ...], npt.NDArray[Any]]:
    """Drop dimensions along which a table does not change, where it is known."""
    present: npt.NDArray[np.bool_] = np.zeros(table.shape, dtype=bool)
    for position in known:
        present[position] = True
    for axis in range(len(dims) - 1, -1, -1):
        at = np.expand_dims(present.argmax(axis=axis), axis)
        first = np.take_along_axis(table, at, axis)
        same = _alike(table, first)
        if (same | ~present).all():
            table, present = first.squeeze(axis), np.asarray(present.any(axis=axis))
            dims = (*dims[:axis], *dims[axis + 1 :])
    return dims, table


def _alike(table: npt.NDArray[Any], first: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Whether values are the same, numbers up to rounding."""
    if table.dtype == object:
        return np.asarray(table == first)
    return np.asarray(np.isclose(table, first, rtol=1e-12, atol=1e-15))


def summaries(folder: str | Path) -> tuple[xr.Dataset, dict[Place, Path]]:
    """Scalars of a study's cases, and the files of those that have fields, by their place in the study.

    It opens no file that the study's cache knows, and so is fast for many cases.
    """
    place = Folder(folder)
    study = place.read_study()
    plan = study.plan()
    entries = place.entries(plan)
    dataset = _summaries(plan, entries, place)
    dataset.attrs = {STUDY_ATTRIBUTE: study.to_json()}
    pairs = zip(plan.cases, entries, strict=True)
    files = {case.position: place.path / entry.path for case, entry in pairs if entry.path}
    return describe(dataset, study.description or f"study {study.name}"), files


def collect(folder: str | Path) -> xr.Dataset:
    """Summaries of a study as one Dataset in memory: :func:`open_study` without surfaces and fields.

    Parameters
    ----------
    folder : str or Path
        The study's folder.

    Returns
    -------
    Dataset

    Raises
    ------
    StudyFileError
        If the folder holds no study.
    """
    opened = open_study(folder)
    own = opened["status"].dims
    return opened.drop_dims([dim for dim in opened.dims if dim not in own])
