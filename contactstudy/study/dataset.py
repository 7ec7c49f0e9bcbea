"""A study as one labelled Dataset: numbers in memory, surfaces and fields read from the batches when needed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from contactstudy import checks
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE
from contactstudy.arrays.grid import centres_of
from contactstudy.arrays.variables import DERIVED, ERROR_KIND, NOT_ESTIMATED, describe, labels
from contactstudy.checks import FloatArray, IntArray
from contactstudy.study.batches import SIZE_SUFFIX, read_batch, read_slices
from contactstudy.study.common_cells import (
    Resampling,
    centre_cells,
    common_columns,
    common_rows,
    end_cells,
    resample,
    resampling_comment,
    split_cells,
)
from contactstudy.study.folder import Folder, States
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.plan import label

CELL_DIMS = ("x", "y")  # Dimensions of cells; positions along other dimensions are points


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
          case's metres. Pressure and traction are averaged over the common cells, other variables are interpolated.
          With ``cells="original"`` different positions are padded with NaN along ``x_index``, ``x_field_index``, ...

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
    return xr.open_dataset(Folder(folder).path, engine="contactstudy", chunks=chunks, cells=cells)


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
    study_folder = Folder(folder)
    study = study_folder.read_study()
    states = study_folder.states(study.plan())
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
        missing_value = "" if any(isinstance(value, str) for value in values) else np.nan
        column = np.asarray([missing_value if value is None else value for value in values])
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
        is_present = np.isfinite(table)
        first_values = np.take_along_axis(table, np.expand_dims(is_present.argmax(axis=axis), axis), axis)
        if (np.isclose(table, first_values, rtol=1e-12, atol=1e-15) | ~is_present).all():
            table = first_values.squeeze(axis)
            dims = (*dims[:axis], *dims[axis + 1 :])
    return dims, table


@dataclass(frozen=True, eq=False, kw_only=True)
class Positions:
    """Positions of all cases along one dimension of their arrays."""

    position_index: IntArray  # index of each case's position array in `values`; -1 if the case has none
    values: list[FloatArray] = field(default_factory=list)  # different positions, metres
    # widths of the cells; empty for uniform cells and points
    widths: list[FloatArray] = field(default_factory=list)
    scales: list[float] = field(default_factory=list)  # half-widths, metres

    @property
    def over_a(self) -> list[FloatArray]:
        """Different positions over the half-width."""
        return [values / scale for values, scale in zip(self.values, self.scales, strict=True)]

    @property
    def has_widths(self) -> bool:
        """Whether cells have different widths."""
        return any(widths.size for widths in self.widths)

    def sources(self, *, has_points: bool) -> list[FloatArray]:
        """Points, or edges of the cells, over the half-width."""
        if has_points:
            return self.over_a
        result = []
        for midpoints, widths, scale in zip(self.values, self.widths, self.scales, strict=True):
            if widths.size:
                low, high = midpoints - 0.5 * widths, midpoints + 0.5 * widths
                edges = np.concatenate([low[:1], 0.5 * (high[:-1] + low[1:]), high[-1:]])
            else:
                half_width = 0.5 * (midpoints[-1] - midpoints[0]) / max(midpoints.size - 1, 1)
                edges = np.linspace(midpoints[0] - half_width, midpoints[-1] + half_width, midpoints.size + 1)
            result.append(edges / scale)
        return result


def _all_equal(arrays: Sequence[FloatArray], first: FloatArray) -> bool:
    """Whether all arrays equal the array `first`, except for rounding."""
    scale = float(np.abs(first).max(initial=0.0))
    return all(row.size == first.size and np.allclose(row, first, rtol=1e-9, atol=1e-12 * scale) for row in arrays)


class StudyAxis(NamedTuple):
    """Dimension of a study that replaces a dimension of the cases, and the maps of positions onto a common axis."""

    name: str
    size: int
    position_index: IntArray  # index of each case's map
    resamplings: list[Resampling] | None = None


class Fields:
    """Lazy arrays of a study's cases: on common axes if `common`, else on the cells and points of each case."""

    def __init__(self, states: States, *, common: bool) -> None:
        self._states, self._common = states, common
        self._batches = states.results.batches
        coordinates = {name for batch in self._batches for name in batch.coordinates}
        self.names: dict[str, tuple[tuple[str, ...], np.dtype[Any]]] = {}
        for batch in self._batches:
            for name, (dims, values) in batch.arrays.items():
                if name not in coordinates:
                    self.names.setdefault(name, (dims, values.dtype))
        self._dims = list(dict.fromkeys(dim for dims, _ in self.names.values() for dim in dims))

    @cached_property
    def _positions(self) -> dict[str, Positions]:
        """Positions along every dimension."""
        case_count = len(self._states.plan)
        batch_of, row_of = self._states.batch, self._states.row
        half_widths = self._states.numbers("hertz_half_width")
        result = {dim: Positions(position_index=np.full(case_count, -1, dtype=np.int64)) for dim in self._dims}
        indices: dict[str, dict[Any, int]] = {dim: {} for dim in self._dims}
        coordinates = [name for dim in self._dims for name in (dim, f"{dim}_width")]
        for batch_number, path in enumerate(self._states.results.paths):
            if not self._batches[batch_number].arrays:
                continue
            batch = read_batch(path, arrays=coordinates)
            for dim in [dim for dim in self._dims if f"{dim}{SIZE_SUFFIX}" in batch.cases]:
                starts, positions = batch.offsets((dim,)), result[dim]
                cell_numbers = np.arange(starts[-1], dtype=np.float64) - np.repeat(starts[:-1], np.diff(starts))
                values = batch.arrays[dim].values if dim in batch.arrays else cell_numbers
                widths = batch.arrays[f"{dim}_width"].values if f"{dim}_width" in batch.arrays else np.zeros(0)
                for index in np.flatnonzero(batch_of == batch_number).tolist():
                    value_slice = slice(starts[row_of[index]], starts[row_of[index] + 1])
                    key = (values[value_slice].tobytes(), widths[value_slice].tobytes(), half_widths[index])
                    if value_slice.start == value_slice.stop:
                        continue
                    if key not in indices[dim]:
                        indices[dim][key] = len(positions.values)
                        positions.values.append(values[value_slice])
                        positions.widths.append(widths[value_slice])
                        positions.scales.append(float(half_widths[index]))
                    positions.position_index[index] = indices[dim][key]
        return {dim: positions for dim, positions in result.items() if positions.values}

    def add_to(self, dataset: xr.Dataset) -> xr.Dataset:
        """Return a Dataset of the study with the arrays."""
        axes, coordinates = self._axes()
        cube = self._states.plan.cube
        variables = {}
        for name, (dims, dtype) in self.names.items():
            if not all(dim in axes for dim in dims):
                continue
            attributes = self._states.attributes(name)
            if any(axes[dim].resamplings for dim in dims):
                attributes |= {"comment": resampling_comment(name), ERROR_KIND: NOT_ESTIMATED}
            array = CaseArray(self._states, name, {dim: axes[dim] for dim in dims}, dtype)
            variable_dims = (*cube.dims, *(axes[dim].name for dim in dims))
            variable = xr.Variable(variable_dims, indexing.LazilyIndexedArray(array), attributes)
            # A chunk of about 16 MiB contains whole arrays of several cases along the last swept dimensions.
            size = array.dtype.itemsize * int(np.prod(array.shape[len(cube.dims) :], dtype=np.int64))
            chunks = dict(zip(variable_dims, array.shape, strict=True))
            for dim in reversed(cube.dims):
                chunks[dim] = max(1, min(chunks[dim], 2**24 // max(size, 1)))
                size *= chunks[dim]
            variable.encoding = {"preferred_chunks": chunks}
            variables[name] = variable
        return dataset.assign_coords(coordinates).assign(variables)

    def _axes(self) -> tuple[dict[str, StudyAxis], dict[str, Any]]:
        """Axis of every dimension of the cases, and the coordinates of these axes."""
        axes: dict[str, StudyAxis] = {}
        coordinates: dict[str, Any] = {}
        positions = self._positions
        has_half_widths = all(np.isfinite(scale) for entry in positions.values() for scale in entry.scales)
        for dim, entry in positions.items():
            if dim in axes:
                continue
            equal_over_a = has_half_widths and _all_equal(entry.over_a, entry.over_a[0]) and not entry.has_widths
            if has_half_widths and (self._common or equal_over_a):
                includes_points = self._common and dim == "x" and "x_field" in positions
                dim_axes, dim_coordinates = self._common_axis(["x", "x_field"] if includes_points else [dim])
            else:
                dim_axes, dim_coordinates = self._original_axis(dim)
            axes |= dim_axes
            coordinates |= dim_coordinates
        return axes, coordinates

    def _original_axis(self, dim: str) -> tuple[dict[str, StudyAxis], dict[str, Any]]:
        """Axis of the cases' positions, padded with NaN to the largest case where they differ."""
        positions = self._positions[dim]
        name = dim if all(np.array_equal(row, positions.values[0]) for row in positions.values) else f"{dim}_index"
        size, index = max(values.size for values in positions.values), positions.position_index

        def create_coordinate(rows: list[FloatArray]) -> tuple[Any, ...]:
            return (name, rows[0]) if _all_equal(rows, rows[0]) else self._pad_rows(name, rows, index, size)

        coordinates = {dim: create_coordinate(positions.values)}
        if positions.has_widths:
            coordinates[f"{dim}_width"] = create_coordinate(positions.widths)
        if np.isfinite(positions.scales).all():
            coordinates[f"{dim}_over_a"] = create_coordinate(positions.over_a)
        return {dim: StudyAxis(name, size, index)}, coordinates

    def _common_axis(self, dims: list[str]) -> tuple[dict[str, StudyAxis], dict[str, Any]]:
        """Axis, over the half-width, that all cases share along dimensions of one direction, and its coordinates."""
        first_dim, name = dims[0], f"{dims[0]}_over_a"
        sources = {dim: self._positions[dim].sources(has_points=dim not in CELL_DIMS) for dim in dims}
        ends = end_cells(sources[first_dim], sources.get("x_field", []))
        rows = [*sources[first_dim], *np.sort(ends, axis=1)]
        join_edges = common_rows if first_dim == "y" else common_columns
        axis = borders = rows[0] if _all_equal(rows, rows[0]) else join_edges(rows)
        if first_dim not in CELL_DIMS:
            borders = np.concatenate([axis[:1], centres_of(axis), axis[-1:]])
        elif "x_field" in sources:
            points, plan = common_columns([np.sort(row) for row in sources["x_field"]]), self._states.plan
            parameters = [plan.base, *(steps[0] for steps in plan.axes), *plan.explicit]
            # Stress points that the study gives are positions of the common axis.
            has_stated_points = any("field_x_over_a" in entry for entry in parameters)
            borders = centre_cells(borders, points) if has_stated_points else split_cells(borders, points)
        if first_dim in CELL_DIMS:
            axis = centres_of(borders)
        for end in ends[:, 0]:
            axis[np.abs(axis - end).argmin()] = end
        axes, maps = {}, {}
        for dim, source_rows in sources.items():
            has_points, fill = dim not in CELL_DIMS, 0.0 if dim == "y" else np.nan
            positions, common_source = (axis, axis) if has_points else (centres_of(borders), borders)
            maps[dim] = [
                Resampling(source=source, axis=positions, borders=borders, fill=fill, has_points=has_points)
                for source in source_rows
            ]
            resamplings = None if _all_equal(source_rows, common_source) else maps[dim]
            axes[dim] = StudyAxis(name, axis.size, self._positions[dim].position_index, resamplings)
        return axes, self._common_coordinates(maps, axis, borders)

    def _common_coordinates(
        self, maps: dict[str, list[Resampling]], axis: FloatArray, borders: FloatArray
    ) -> dict[str, Any]:
        """Coordinates of a common axis: over the half-width, and in metres (NaN beyond the case's cells and points)."""
        first_dim = next(iter(maps))
        over_a = f"{first_dim}_over_a"
        coordinates: dict[str, Any] = {over_a: (over_a, axis)}
        for dim, resamplings in maps.items():
            positions = self._positions[dim]
            common_positions = [np.where(resampling.is_outside, np.nan, resampling.axis) for resampling in resamplings]
            rows = [scale * row for row, scale in zip(common_positions, positions.scales, strict=True)]
            coordinates[dim] = self._pad_rows(over_a, rows, positions.position_index, axis.size)
        positions, sources = self._positions[first_dim], [resampling.source for resampling in maps[first_dim]]
        is_uniform = not positions.has_widths and _all_equal(sources, borders) and np.ptp(np.diff(borders)) == 0
        if first_dim == "x" and not is_uniform:
            rows = [np.diff(borders) * scale for scale in positions.scales]
            coordinates["x_width"] = self._pad_rows(over_a, rows, positions.position_index, axis.size)
        return coordinates

    def _pad_rows(
        self, name: str, rows: Sequence[FloatArray], position_index: IntArray, size: int
    ) -> tuple[tuple[str, ...], FloatArray]:
        """Dimensions and values of a coordinate of every case along the dimension `name`, padded with NaN."""
        padded = np.full((len(rows) + 1, size), np.nan)
        for index, row in enumerate(rows):
            padded[index, : row.size] = row
        return (*self._states.plan.cube.dims, name), self._states.plan.spread(padded[position_index], np.nan)


class CaseArray(BackendArray):
    """One variable over all cases of a study; indexing reads the values from the batches."""

    def __init__(self, states: States, name: str, axes: Mapping[str, StudyAxis], dtype: np.dtype[Any]) -> None:
        self._states, self._name, self._dims, self._axes = states, name, tuple(axes), tuple(axes.values())
        self.shape = (*states.plan.cube.shape, *(axis.size for axis in self._axes))
        is_resampled = any(axis.resamplings for axis in self._axes)
        self.dtype = np.dtype(np.float64) if is_resampled and dtype.kind != "f" else dtype

    @cached_property
    def _cases(self) -> IntArray:
        """Number in the plan of each case of the cube; -1 for an excluded case."""
        return self._states.plan.spread(np.arange(len(self._states.plan)), -1)

    def __getitem__(self, key: Any) -> Any:
        """Return the values at an explicit index of xarray."""
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._read)

    def _read(self, key: tuple[Any, ...]) -> npt.NDArray[Any]:
        """Read the values at integers, slices and arrays of integers."""
        swept_count = len(self._states.plan.cube.shape)
        selected, field_key = _index_axes(self._cases, key[:swept_count]), key[swept_count:]
        shape = tuple(axis.size for axis in self._axes)
        fill = np.nan if self.dtype.kind == "f" else 0
        empty_values = _index_axes(np.full(shape, fill, dtype=self.dtype), field_key)
        result = np.broadcast_to(empty_values, (selected.size, *empty_values.shape)).copy()
        for index, values in self._read_cases(selected.ravel()):
            padded = np.full(shape, fill, dtype=self.dtype)
            padded[tuple(slice(size) for size in values.shape)] = values
            result[index] = _index_axes(padded, field_key)
        return result.reshape((*selected.shape, *empty_values.shape))

    def _read_cases(self, cases: IntArray) -> Iterable[tuple[int, npt.NDArray[Any]]]:
        """Yield the values of cases on the study's axes, each with its number among `cases`; batch by batch."""
        batch_of, row_of = self._states.batch, self._states.row
        for batch_index in np.unique(batch_of[cases[cases >= 0]]).tolist():
            batch = self._states.results.batches[batch_index] if batch_index >= 0 else None
            if batch is None or self._name not in batch.arrays:
                continue
            starts, sizes = batch.offsets(self._dims), batch.sizes(self._dims)
            indices = [i for i, case in enumerate(cases.tolist()) if case >= 0 and batch_of[case] == batch_index]
            rows = [int(row_of[cases[index]]) for index in indices]
            bounds = [(int(starts[row]), int(starts[row + 1])) for row in rows]
            slices_of_cases = read_slices(self._states.results.paths[batch_index], {self._name: bounds})[self._name]
            for index, row, values in zip(indices, rows, slices_of_cases, strict=True):
                if values.size:
                    case_values = values.reshape(sizes[row])
                    maps = [
                        axis.resamplings[axis.position_index[cases[index]]] if axis.resamplings else None
                        for axis in self._axes
                    ]
                    yield index, resample(self._name, case_values, maps) if any(maps) else case_values


def _index_axes(values: npt.NDArray[Any], key: Sequence[Any]) -> npt.NDArray[Any]:
    """Index every axis independently."""
    for axis in range(len(key) - 1, -1, -1):
        values = values[(slice(None),) * axis + (key[axis],)]
    return values
