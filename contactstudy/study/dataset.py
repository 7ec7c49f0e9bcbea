"""A study as one labelled Dataset: numbers in memory, surfaces and fields read from the batches when needed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE
from contactstudy.arrays.variables import DERIVED, describe, labels
from contactstudy.checks import FloatArray
from contactstudy.study.fields import Fields
from contactstudy.study.folder import Folder, States
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.plan import label


def open_study(folder: str | Path, *, cells: str = "common", chunks: Any = None) -> xr.Dataset:
    """Open the results of a study as one Dataset whose dimensions are the swept parameters.

    Parameters
    ----------
    folder : str or Path
        The study's folder; the study may still run or be incomplete.
    cells : {"common", "original"}
        Whether surfaces and stresses lie on axes that all cases share, or on each case's cells and points.
    chunks : optional
        As for `xarray.open_dataset`: ``{}`` returns dask arrays, for reductions that exceed the memory.

    Returns
    -------
    Dataset
        * `status` ("ok", "failed", "skipped", "stale", "missing" or, left out by the study, "excluded"), `message` and
          `case_id` of every case; `e_over_a`, `friction`, `gamma` and `profile`, as dimension or as coordinate;
        * every number of the cases, in memory, NaN where it is absent;
        * surfaces and stresses, read on demand, along ``x_over_a`` (distance from the free end over the half-width),
          ``y_over_a`` (``y_field_over_a`` of separate stress points) and ``z_over_a``; ``x``, ``y`` and ``z`` are each
          case's metres. Pressure and traction are averaged over the common cells, so that loads remain, other
          variables are interpolated. With ``cells="original"`` different positions are padded with NaN along
          ``x_index``, ``x_field_index``, ...

    Raises
    ------
    StudyFileError
        If the folder contains no study.
    InvalidInputError
        If `cells` is neither of the two.

    Examples
    --------
    >>> import tempfile
    >>> from contactstudy.study import Study, run_study
    >>> base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.2e-3, "e_over_a": 0,
    ...         "body": "half-space", "stresses": False}
    >>> study = Study(name="small", base=base, sweep={"max_pressure": [1.0e9, 1.5e9]}, level="surface")
    >>> folder = tempfile.mkdtemp()
    >>> report = run_study(study, folder, workers=0, progress=False)
    >>> open_study(folder).pressure.dims, open_study(folder, cells="original").pressure.dims
    (('max_pressure', 'x_over_a', 'y_over_a'), ('max_pressure', 'x_index', 'y_index'))
    """
    from contactstudy.study.xarray_backend import StudyBackend

    return xr.open_dataset(Folder(folder).path, engine=StudyBackend, chunks=chunks, cells=cells)


def collect(folder: str | Path) -> xr.Dataset:
    """Numbers of a study as one Dataset in memory: :func:`open_study` without surfaces and fields.

    Parameters
    ----------
    folder : str or Path
        The study's folder.

    Raises
    ------
    StudyFileError
        If the folder contains no study.
    """
    return study_dataset(folder, cells=None)


def load_case(folder: str | Path, case_id: str) -> xr.Dataset:
    """Load one solved case of a study on its cells, as :func:`contactstudy.solve` returned it.

    Parameters
    ----------
    folder : str or Path
        The study's folder.
    case_id : str
        Identity of the case, as the variable `case_id` of an opened study contains it.

    Returns
    -------
    Dataset
        Numbers, and the surfaces and fields that the study's level retains.

    Raises
    ------
    InvalidInputError
        If the folder contains no result of the case.
    """
    return Folder(folder).results().case(case_id)


def study_dataset(folder: str | Path, *, cells: str | None) -> xr.Dataset:
    """Dataset of a study with lazy surfaces and fields; without surfaces and fields if `cells` is None."""
    if cells is not None:
        checks.known_name("cells", cells, ("common", "original"))
    results = Folder(folder)
    study = results.read_study()
    states = results.states(study.plan())
    dataset = numbers_dataset(states)
    if cells is not None and (fields := Fields(states, common=cells == "common")).names:
        dataset = fields.add_to(dataset)
    dataset.attrs = {STUDY_ATTRIBUTE: study.to_json()}
    return describe(dataset, study.description or f"study {study.name}")


def numbers_dataset(states: States) -> xr.Dataset:
    """Status, message and numbers of all cases along the study's dimensions."""
    plan, cube = states.plan, states.plan.cube
    coordinates: dict[str, Any] = {}
    for name, (dim, values) in cube.labels.items():
        missing = "" if any(isinstance(value, str) for value in values) else np.nan
        column = np.asarray([missing if value is None else value for value in values])
        attributes = PARAMETERS[name].attrs if name in PARAMETERS else labels("case", coordinate=True)
        coordinates[name] = (dim, column, attributes)
    variables: dict[str, Any] = {
        "status": (cube.dims, plan.spread(states.status, "excluded")),
        "message": (cube.dims, plan.spread(np.array(states.reasons, dtype=np.str_), "")),
        "case_id": (cube.dims, plan.spread(plan.ids.astype(np.str_), "")),
    }
    for name in sorted({name for batch in states.results.batches for name in batch.numbers}):
        if name not in coordinates:
            array = plan.spread(states.numbers(name), np.nan)
            if name in ("e_over_a", "gamma"):
                if np.isfinite(array).any():
                    dims, array = _drop_constant_dims(cube.dims, array)
                    coordinates[name] = (dims, array, states.attributes(name))
            else:
                variables[name] = (cube.dims, array, states.attributes(name))
    for name in ("friction", "profile"):
        if name not in coordinates and len(plan):
            value = plan.values(0).get(name, PARAMETERS[name].default)
            attributes = PARAMETERS[name].attrs | {"comment": DERIVED}
            coordinates[name] = ((), label(value), attributes)
    return xr.Dataset(variables, coords=coordinates)


def _drop_constant_dims(dims: tuple[str, ...], table: FloatArray) -> tuple[tuple[str, ...], FloatArray]:
    """Drop dimensions along which a table is constant or NaN."""
    for axis in range(len(dims) - 1, -1, -1):
        present = np.isfinite(table)
        first = np.take_along_axis(table, np.expand_dims(present.argmax(axis=axis), axis), axis)
        if (np.isclose(table, first, rtol=1e-12, atol=1e-15) | ~present).all():
            table = first.squeeze(axis)
            dims = (*dims[:axis], *dims[axis + 1 :])
    return dims, table
