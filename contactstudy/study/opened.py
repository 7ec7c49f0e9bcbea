"""A finished, or half finished, study as one labelled Dataset."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import dask.array as da
import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy.arrays.variables import describe, labels
from contactstudy.study.cube import Cube
from contactstudy.study.errors import StoreError
from contactstudy.study.folder import Entry, Folder
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.plan import Plan
from contactstudy.study.store import load_variable, read_structure, scalar_attributes

Structure = tuple[dict[str, tuple[tuple[str, ...], np.dtype[Any], dict[str, Any]]], xr.Dataset]


def open_study(folder: str | Path) -> xr.Dataset:
    """Open the results of a study as one Dataset whose dimensions are the swept parameters.

    Parameters
    ----------
    folder : str or Path
        The study's folder; the study may still run or be incomplete.

    Returns
    -------
    Dataset
        * `status` ("ok", "failed", "skipped", "stale", "missing", or "excluded" for what the study leaves out),
          `message` and `case_id` of every case;
        * every scalar of the cases, in memory, NaN where there is none;
        * surfaces and fields as dask arrays with one chunk per case. Where all cases have the same positions,
          these are coordinates ``x``, ``y``, ...; where they differ the dimension is ``x_index``, and the
          coordinates ``x`` and ``x_over_a`` (distance from the free end over the Hertz half-width, and likewise
          for y and z) hold each case's own, padded with NaN.

    Raises
    ------
    StudyFileError
        If the folder holds no study.

    Examples
    --------
    >>> import tempfile
    >>> from contactstudy.study import Study, run_study
    >>> study = Study(
    ...     name="small",
    ...     base={"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.2e-3, "e_over_a": 0,
    ...           "body": "half-space", "cells_x": 4, "cells_y": 8, "stresses": False},
    ...     sweep={"max_pressure": [1.0e9, 1.5e9]},
    ... )
    >>> folder = tempfile.mkdtemp()
    >>> report = run_study(study, folder, workers=0, progress=False)
    >>> results = open_study(folder)
    >>> results.status.values.tolist(), results.pressure.dims
    (['ok', 'ok'], ('max_pressure', 'x_index', 'y_index'))
    """
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
    for position, path in usable.items():
        try:
            structures[position] = read_structure(path)
        except StoreError:  # removed or replaced this very moment by a run that goes on
            continue
    dataset = _with_fields(dataset, plan.cube, {key: usable[key] for key in structures}, structures)
    dataset.attrs = {"contactstudy_study": study.to_json()}
    return describe(dataset, study.description or f"study {study.name}")


def _label_coordinate(name: str, dim: str, values: Sequence[Any]) -> tuple[str, npt.NDArray[Any], dict[str, str]]:
    """Coordinate of a swept parameter; a value that some cases do not have is NaN or an empty text."""
    if any(isinstance(value, str) for value in values):
        array = np.asarray(["" if value is None else str(value) for value in values], dtype=np.str_)
    else:
        array = np.asarray([np.nan if value is None else value for value in values])
    parameter = PARAMETERS.get(name)
    attributes = {"long_name": parameter.meaning} if parameter else labels("case", coordinate=True)
    if parameter and parameter.units:
        attributes["units"] = parameter.units
    return dim, array, attributes


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
    return xr.Dataset(variables, coords=coordinates)


def _with_fields(
    dataset: xr.Dataset,
    cube: Cube,
    paths: dict[tuple[int, ...], Path],
    structures: dict[tuple[int, ...], Structure],
) -> xr.Dataset:
    """Add the variables that are not scalars, lazily, and their coordinates."""
    if not structures:
        return dataset
    positions: dict[str, dict[tuple[int, ...], npt.NDArray[np.float64]]] = {}
    specifications: dict[str, tuple[tuple[str, ...], np.dtype[Any], dict[str, Any]]] = {}
    for place, (variables, coordinates) in structures.items():
        for name, specification in variables.items():
            specifications.setdefault(name, specification)
            for dim in specification[0]:
                values = np.asarray(coordinates[dim].values, dtype=np.float64)
                positions.setdefault(dim, {})[place] = values
    renamed: dict[str, str] = {}
    added: dict[str, Any] = {}
    for dim, by_case in positions.items():
        renamed[dim], coordinates_of_dim = _positions(dim, by_case, cube, dataset)
        added |= coordinates_of_dim
    sizes = {dim: max(values.size for values in by_case.values()) for dim, by_case in positions.items()}
    fields = {}
    for name, (dims, dtype, attributes) in specifications.items():
        files = np.full(cube.shape, "", dtype=object)
        for place, (variables, _) in structures.items():
            if name in variables:
                files[place] = str(paths[place])
        array = _lazy(files, name, tuple(sizes[dim] for dim in dims), dtype)
        fields[name] = ((*cube.dims, *(renamed[dim] for dim in dims)), array, attributes)
    return dataset.assign_coords(added).assign(fields)


def _positions(
    dim: str, by_case: dict[tuple[int, ...], npt.NDArray[np.float64]], cube: Cube, dataset: xr.Dataset
) -> tuple[str, dict[str, Any]]:
    """Name that a dimension of the cases gets, and the coordinates along it."""
    attributes, over = (labels(name, coordinate=True) for name in (dim, f"{dim}_over_a"))
    size = max(values.size for values in by_case.values())
    table = np.full((*cube.shape, size), np.nan)
    for place, values in by_case.items():
        table[place][: values.size] = values
    first = next(iter(by_case.values()))
    same = all(values.size == first.size and np.array_equal(values, first) for values in by_case.values())
    name = dim if same else f"{dim}_index"
    coordinates: dict[str, Any] = {dim: (dim, first, attributes) if same else ((*cube.dims, name), table, attributes)}
    if "hertz_half_width" in dataset:
        scaled = table / dataset["hertz_half_width"].values[..., None]
        rows = np.array([scaled[place] for place in by_case])
        common = not np.isnan(rows).any() and np.allclose(rows, rows[0], rtol=1e-9, atol=1e-12)
        # Positions given over a are the same for all cases up to rounding: one coordinate for all.
        coordinates[f"{dim}_over_a"] = (name, rows[0], over) if common else ((*cube.dims, name), scaled, over)
    return name, coordinates


def _load_block(block: npt.NDArray[Any], name: str, shape: tuple[int, ...], dtype: Any) -> npt.NDArray[Any]:
    """Values of one case, padded with NaN to the largest case's shape."""
    (path,) = block.ravel().tolist()
    result = np.full(shape, np.nan if np.dtype(dtype).kind == "f" else 0, dtype=dtype)
    if path:
        values = load_variable(Path(path), name)
        result[tuple(slice(size) for size in values.shape)] = values
    return result.reshape(block.shape + shape)


def _lazy(paths: npt.NDArray[Any], name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> da.Array:
    """Dask array of a variable over all cases, one chunk per case."""
    cases = da.from_array(paths, chunks=1)
    result: da.Array = da.map_blocks(
        _load_block,
        cases,
        name,
        shape,
        dtype,
        dtype=dtype,
        new_axis=list(range(paths.ndim, paths.ndim + len(shape))),
        chunks=(*cases.chunks, *((size,) for size in shape)),
        meta=np.empty((0,) * (paths.ndim + len(shape)), dtype),
    )
    return result


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
