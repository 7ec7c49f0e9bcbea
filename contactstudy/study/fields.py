"""Surfaces and stresses of a study: axes of all cases, and lazy reading from the batches."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from contactstudy.arrays.grid import centres_of
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED
from contactstudy.checks import FloatArray, IntArray
from contactstudy.study.batches import read_batch, read_slices
from contactstudy.study.common_cells import (
    Resampling,
    centre_cells_on,
    common_columns,
    common_rows,
    resample,
    resampling_comment,
    split_cells,
)
from contactstudy.study.folder import States

CELL_DIMS = ("x", "y")  # Dimensions of cells; positions along other dimensions are points


class Positions(NamedTuple):
    """Positions of a case along one dimension of its arrays."""

    values: FloatArray  # metres
    widths: FloatArray  # widths of the cells, metres; empty for uniform cells and points
    scale: float  # half-width, metres

    @property
    def over_a(self) -> FloatArray:
        """Positions over the half-width."""
        return self.values / self.scale

    @property
    def edges_over_a(self) -> FloatArray:
        """Edges of the cells over the half-width."""
        values = self.values
        if self.widths.size:
            low, high = values - 0.5 * self.widths, values + 0.5 * self.widths
            edges = np.concatenate([low[:1], 0.5 * (high[:-1] + low[1:]), high[-1:]])
        else:
            half_cell = 0.5 * (values[-1] - values[0]) / max(values.size - 1, 1)
            edges = np.linspace(values[0] - half_cell, values[-1] + half_cell, values.size + 1)
        return np.asarray(edges / self.scale)


def _all_equal(arrays: Sequence[FloatArray]) -> bool:
    """Whether all arrays equal the first, except for rounding."""
    first = arrays[0]
    scale = float(np.abs(first).max(initial=0.0))
    return all(row.size == first.size and np.allclose(row, first, rtol=1e-9, atol=1e-12 * scale) for row in arrays)


class StudyAxis(NamedTuple):
    """Dimension of a study that replaces a dimension of the cases, and each case's map onto a common axis."""

    name: str
    size: int
    resamplings: dict[int, Resampling] | None = None


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
    def _positions(self) -> dict[str, dict[int, Positions]]:
        """Positions along every dimension, by the number of the case."""
        batch_of, row_of = self._states.locations
        half_widths = self._states.numbers("hertz_half_width")
        result: dict[str, dict[int, Positions]] = {dim: {} for dim in self._dims}
        for batch_number, path in enumerate(self._states.results.paths):
            if not self._batches[batch_number].arrays:
                continue
            batch = read_batch(path, arrays=[name for dim in self._dims for name in (dim, f"{dim}_width")])
            for dim in set(self._dims) & set(batch.sizes):
                starts = batch.offsets((dim,))
                values, widths = (batch.arrays.get(name) for name in (dim, f"{dim}_width"))
                for index in np.flatnonzero(batch_of == batch_number).tolist():
                    span = slice(starts[row_of[index]], starts[row_of[index] + 1])
                    if span.start < span.stop:
                        row = np.arange(span.stop - span.start) if values is None else values.values[span]
                        row_widths = np.zeros(0) if widths is None else widths.values[span]
                        result[dim][index] = Positions(row.astype(np.float64), row_widths, float(half_widths[index]))
        return {dim: positions for dim, positions in result.items() if positions}

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
        has_half_widths = all(np.isfinite(row.scale) for rows in positions.values() for row in rows.values())
        for dim, rows in positions.items():
            if dim in axes:
                continue
            has_widths = any(row.widths.size for row in rows.values())
            equal_over_a = has_half_widths and not has_widths and _all_equal([row.over_a for row in rows.values()])
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
        rows = {dim: {index: row.values for index, row in positions.items()}}
        if any(row.widths.size for row in positions.values()):
            rows[f"{dim}_width"] = {index: row.widths for index, row in positions.items()}
        if all(np.isfinite(row.scale) for row in positions.values()):
            rows[f"{dim}_over_a"] = {index: row.over_a for index, row in positions.items()}
        first, *others = rows[dim].values()
        name = dim if all(np.array_equal(values, first) for values in others) else f"{dim}_index"
        size = max(values.size for values in rows[dim].values())
        coordinates: dict[str, Any] = {}
        for coordinate, entries in rows.items():
            values = list(entries.values())
            coordinates[coordinate] = (name, values[0]) if _all_equal(values) else self._pad_rows(name, entries, size)
        return {dim: StudyAxis(name, size)}, coordinates

    def _common_axis(self, dims: list[str]) -> tuple[dict[str, StudyAxis], dict[str, Any]]:
        """Axis, over the half-width, that all cases share along dimensions of one direction, and its coordinates."""
        first_dim, name = dims[0], f"{dims[0]}_over_a"
        sources: dict[str, dict[int, FloatArray]] = {}
        for dim in dims:
            positions = self._positions[dim].items()
            sources[dim] = {index: row.edges_over_a if dim in CELL_DIMS else row.over_a for index, row in positions}
        rows = list(sources[first_dim].values())
        union = common_rows if first_dim == "y" else common_columns
        axis = borders = rows[0] if _all_equal(rows) else union(rows)
        if first_dim not in CELL_DIMS:
            borders = np.concatenate([axis[:1], centres_of(axis), axis[-1:]])
        elif "x_field" in sources:
            points = common_columns([np.sort(row) for row in sources["x_field"].values()])
            plan = self._states.plan
            parameters = [plan.base, *(steps[0] for steps in plan.axes), *plan.explicit]
            # Stress points that the study gives are positions of the common axis.
            has_stated_points = any("field_x_over_a" in entry for entry in parameters)
            borders = centre_cells_on(borders, points) if has_stated_points else split_cells(borders, points)
        if first_dim in CELL_DIMS:
            axis = centres_of(borders)
        axes, maps = {}, {}
        for dim, source_rows in sources.items():
            has_points, fill = dim not in CELL_DIMS, 0.0 if dim == "y" else np.nan
            maps[dim] = {
                index: Resampling(source=source, axis=axis, borders=borders, fill=fill, has_points=has_points)
                for index, source in source_rows.items()
            }
            is_common_axis = _all_equal([axis if has_points else borders, *source_rows.values()])
            axes[dim] = StudyAxis(name, axis.size, None if is_common_axis else maps[dim])
        return axes, self._common_coordinates(maps, axis, borders)

    def _common_coordinates(
        self, maps: dict[str, dict[int, Resampling]], axis: FloatArray, borders: FloatArray
    ) -> dict[str, Any]:
        """Coordinates of a common axis: over the half-width, and in metres (NaN beyond the case's cells and points)."""
        first_dim = next(iter(maps))
        over_a = f"{first_dim}_over_a"
        coordinates: dict[str, Any] = {over_a: (over_a, axis)}
        for dim, resamplings in maps.items():
            positions = self._positions[dim]
            rows = {
                index: positions[index].scale * np.where(resampling.is_outside, np.nan, axis)
                for index, resampling in resamplings.items()
            }
            coordinates[dim] = self._pad_rows(over_a, rows, axis.size)
        positions, sources = self._positions[first_dim], [resampling.source for resampling in maps[first_dim].values()]
        has_widths = any(row.widths.size for row in positions.values())
        uniform = not has_widths and _all_equal([borders, *sources]) and np.ptp(np.diff(borders)) == 0
        if first_dim == "x" and not uniform:
            rows = {index: np.diff(borders) * row.scale for index, row in positions.items()}
            coordinates["x_width"] = self._pad_rows(over_a, rows, axis.size)
        return coordinates

    def _pad_rows(self, name: str, rows: Mapping[int, FloatArray], size: int) -> tuple[tuple[str, ...], FloatArray]:
        """Dimensions and values of a coordinate of every case along the dimension `name`, padded with NaN."""
        plan = self._states.plan
        padded = np.full((len(plan), size), np.nan)
        for index, row in rows.items():
            padded[index, : row.size] = row
        return (*plan.cube.dims, name), plan.spread(padded, np.nan)


class CaseArray(BackendArray):
    """One variable over all cases of a study; indexing reads the values from the batches."""

    def __init__(self, states: States, name: str, axes: Mapping[str, StudyAxis], dtype: np.dtype[Any]) -> None:
        self._states, self._name, self._dims, self._axes = states, name, tuple(axes), tuple(axes.values())
        self.shape = (*states.plan.cube.shape, *(axis.size for axis in self._axes))
        resampling = any(axis.resamplings for axis in self._axes)
        self.dtype = np.dtype(np.float64) if resampling and dtype.kind != "f" else dtype

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
        empty = _index_axes(np.full(shape, fill, dtype=self.dtype), field_key)
        result = np.broadcast_to(empty, (selected.size, *empty.shape)).copy()
        for index, values in self._values(selected.ravel()):
            padded = np.full(shape, fill, dtype=self.dtype)
            padded[tuple(slice(size) for size in values.shape)] = values
            result[index] = _index_axes(padded, field_key)
        return result.reshape((*selected.shape, *empty.shape))

    def _values(self, cases: IntArray) -> Iterable[tuple[int, npt.NDArray[Any]]]:
        """Yield the values of cases on the study's axes, each with its number among `cases`; batch by batch."""
        batch_of, row_of = self._states.locations
        for batch_index in np.unique(batch_of[cases[cases >= 0]]).tolist():
            batch = self._states.results.batches[batch_index] if batch_index >= 0 else None
            if batch is None or self._name not in batch.arrays:
                continue
            starts = batch.offsets(self._dims)
            indices = [i for i, case in enumerate(cases.tolist()) if case >= 0 and batch_of[case] == batch_index]
            rows = [int(row_of[cases[index]]) for index in indices]
            bounds = [(int(starts[row]), int(starts[row + 1])) for row in rows]
            flat = read_slices(self._states.results.paths[batch_index], {self._name: bounds})[self._name]
            for index, row, values in zip(indices, rows, flat, strict=True):
                if values.size:
                    case_values = values.reshape([int(batch.sizes[dim][row]) for dim in self._dims])
                    maps = [axis.resamplings[cases[index]] if axis.resamplings else None for axis in self._axes]
                    yield index, resample(self._name, case_values, maps) if any(maps) else case_values


def _index_axes(values: npt.NDArray[Any], key: Sequence[Any]) -> npt.NDArray[Any]:
    """Index every axis independently."""
    for axis in range(len(key) - 1, -1, -1):
        values = values[(slice(None),) * axis + (key[axis],)]
    return values
