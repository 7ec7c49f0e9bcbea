"""Surfaces and fields of a study's cases as dask arrays, and the positions that they lie at."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy.arrays.variables import labels
from contactstudy.checks import FloatArray
from contactstudy.study.common_cells import OntoCommon, comment_of, common_columns, common_rows, resampled
from contactstudy.study.cube import Cube
from contactstudy.study.store import Specifications, Structure, load_variable

if TYPE_CHECKING:
    import dask.array as da

Place = tuple[int, ...]
"""Position of a case along the study's dimensions."""

CELLS = ("common", "own")
"""Cells that surfaces are opened on."""

CELL_AXES = ("x", "y")
"""Dimensions of the cells of the contact; stresses at points of their own have others."""


@dataclass(frozen=True, eq=False)
class _Source:
    """Where the values of one case are, and how they come onto the common cells."""

    path: str
    along: tuple[OntoCommon | None, ...] = ()


class Fields:
    """Specifications that are not scalars, lazily, and their coordinates.

    Parameters
    ----------
    dataset : Dataset
        Scalars of the cases.
    cube : Cube
        Dimensions of the study.
    paths, structures : dict
        File and structure of each case that has fields.
    cells : {"common", "own"}
        Cells of the surfaces.
    """

    def __init__(
        self, dataset: xr.Dataset, cube: Cube, paths: dict[Place, Path], structures: dict[Place, Structure], cells: str
    ) -> None:
        self._dataset, self._cube, self._paths, self._structures, self._cells = dataset, cube, paths, structures, cells
        self._positions: dict[str, dict[Place, FloatArray]] = {}
        self._specifications: Specifications = {}
        for place, (variables, positions) in structures.items():
            for name, specification in variables.items():
                self._specifications.setdefault(name, specification)
                for dim in specification.dims:
                    self._positions.setdefault(dim, {})[place] = np.asarray(positions[dim], dtype=np.float64)
        # Over the half-width of the case they are numbers near one.
        self._half_width = dataset["hertz_half_width"].values if "hertz_half_width" in dataset else None

    def added(self) -> xr.Dataset:
        """Return the Dataset with the fields."""
        renamed: dict[str, str] = {}
        sizes: dict[str, int] = {}
        ways: dict[str, dict[Place, OntoCommon]] = {}
        coordinates: dict[str, Any] = {}
        for dim, by_case in self._positions.items():
            renamed[dim], sizes[dim], ways[dim], own = self._axis(dim, by_case)
            coordinates |= own
        fields = {}
        for name, (dims, dtype, attributes) in self._specifications.items():
            files = np.full(self._cube.shape, None, dtype=object)
            for place, (variables, _) in self._structures.items():
                if name in variables:
                    along = tuple(ways[dim].get(place) for dim in dims)
                    files[place] = _Source(str(self._paths[place]), along if any(along) else ())
            array = _lazy(files, name, tuple(sizes[dim] for dim in dims), dtype)
            if any(ways[dim] for dim in dims):
                attributes = attributes | {"comment": comment_of(name)}
            fields[name] = ((*self._cube.dims, *(renamed[dim] for dim in dims)), array, attributes)
        return self._dataset.assign_coords(coordinates).assign(fields)

    def _axis(
        self, dim: str, by_case: dict[Place, FloatArray]
    ) -> tuple[str, int, dict[Place, OntoCommon], dict[str, Any]]:
        """Name and size of a dimension in the study, each case's way onto it, and its coordinates."""
        attributes, over = (labels(name, coordinate=True) for name in (dim, f"{dim}_over_a"))
        size = max(values.size for values in by_case.values())
        first = next(iter(by_case.values()))
        widths = self._widths(dim)
        if all(np.array_equal(values, first) for values in by_case.values()):
            own: dict[str, Any] = {dim: (dim, first, attributes)}
            if self._half_width is not None:
                own[f"{dim}_over_a"] = self._over_a(dim, by_case, size, dim, over)
            if widths:
                own[f"{dim}_width"] = (dim, next(iter(widths.values())), labels(f"{dim}_width", coordinate=True))
            return dim, size, {}, own
        if self._half_width is not None:
            scale = {place: float(self._half_width[place]) for place in by_case}
            rows = [values / scale[place] for place, values in by_case.items()]
            same = all(row.size == size and np.allclose(row, rows[0], rtol=1e-9, atol=1e-12) for row in rows)
            if same and not widths:
                # Positions that were given over a are the same for all cases up to rounding.
                return f"{dim}_over_a", size, {}, self._common(dim, rows[0], None, by_case, {})
            if dim in CELL_AXES and self._cells == "common":
                edges = {place: _edges(by_case[place], widths.get(place)) / scale[place] for place in by_case}
                common = (common_columns if dim == "x" else common_rows)(list(edges.values()))
                outside = np.nan if dim == "x" else 0.0
                onto = {place: OntoCommon(own_edges, common, outside) for place, own_edges in edges.items()}
                centres = 0.5 * (common[1:] + common[:-1])
                return f"{dim}_over_a", centres.size, onto, self._common(dim, centres, np.diff(common), by_case, onto)
        name = f"{dim}_index"
        own = {dim: ((*self._cube.dims, name), self._padded(by_case, size), attributes)}
        if self._half_width is not None:
            own[f"{dim}_over_a"] = self._over_a(dim, by_case, size, name, over)
        if widths:
            padded = self._padded(widths, size)
            own[f"{dim}_width"] = ((*self._cube.dims, name), padded, labels(f"{dim}_width", coordinate=True))
        return name, size, {}, own

    def _widths(self, dim: str) -> dict[Place, FloatArray]:
        """Widths of each case's cells along a dimension; empty if none has cells of different widths."""
        name = f"{dim}_width"
        return {
            place: np.asarray(structure.positions[name], dtype=np.float64)
            for place, structure in self._structures.items()
            if name in structure.positions
        }

    def _common(
        self,
        dim: str,
        over_a: FloatArray,
        widths: FloatArray | None,
        by_case: dict[Place, FloatArray],
        onto: dict[Place, OntoCommon],
    ) -> dict[str, Any]:
        """Coordinates of an axis that all cases share over a: that, and each case's metres, NaN beyond its cells."""
        name, own = f"{dim}_over_a", {place: over_a * self._scale(place) for place in by_case}
        for place, way in onto.items():
            own[place][way.beyond] = np.nan
        found: dict[str, Any] = {
            name: (name, over_a, labels(name, coordinate=True)),
            dim: ((*self._cube.dims, name), self._padded(own, over_a.size), labels(dim, coordinate=True)),
        }
        if widths is not None and dim == "x":
            metres = self._padded({place: widths * self._scale(place) for place in by_case}, widths.size)
            found["x_width"] = ((*self._cube.dims, name), metres, labels("x_width", coordinate=True))
        return found

    def _scale(self, place: Place) -> float:
        """Half-width of a case, metres."""
        assert self._half_width is not None
        return float(self._half_width[place])

    def _over_a(
        self, dim: str, by_case: dict[Place, FloatArray], size: int, name: str, attributes: dict[str, str]
    ) -> tuple[Any, ...]:
        """Coordinate of positions over a along a dimension that has the cases' own."""
        scaled = {place: values / self._scale(place) for place, values in by_case.items()}
        rows = list(scaled.values())
        if all(row.size == size and np.allclose(row, rows[0], rtol=1e-9, atol=1e-12) for row in rows):
            return (name, rows[0], attributes)
        return ((*self._cube.dims, name), self._padded(scaled, size), attributes)

    def _padded(self, by_case: dict[Place, FloatArray], size: int) -> FloatArray:
        """Values of every case, padded with NaN."""
        table = np.full((*self._cube.shape, size), np.nan)
        for place, values in by_case.items():
            table[place][: values.size] = values
        return table


def _edges(centres: FloatArray, widths: FloatArray | None) -> FloatArray:
    """Edges of cells with these centres; uniform unless widths are given."""
    if widths is None:
        half = 0.5 * (centres[-1] - centres[0]) / max(centres.size - 1, 1)
        return np.asarray(np.linspace(centres[0] - half, centres[-1] + half, centres.size + 1))
    low, high = centres - 0.5 * widths, centres + 0.5 * widths
    return np.concatenate([low[:1], 0.5 * (high[:-1] + low[1:]), high[-1:]])


def _load_block(block: npt.NDArray[Any], name: str, shape: tuple[int, ...], dtype: Any) -> npt.NDArray[Any]:
    """Values of one case, on the common cells or padded with NaN to the largest case's shape."""
    (source,) = block.ravel().tolist()
    result = np.full(shape, np.nan if np.dtype(dtype).kind == "f" else 0, dtype=dtype)
    if source is not None:
        values = load_variable(Path(source.path), name)
        if source.along:
            values = resampled(name, values, source.along)
        result[tuple(slice(size) for size in values.shape)] = values
    return result.reshape(block.shape + shape)


def _lazy(sources: npt.NDArray[Any], name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> da.Array:
    """Dask array of a variable over all cases, one chunk per case."""
    import dask.array as da

    cases = da.from_array(sources, chunks=1, name=False)
    result: da.Array = da.map_blocks(
        _load_block,
        cases,
        name,
        shape,
        dtype,
        dtype=dtype,
        new_axis=list(range(sources.ndim, sources.ndim + len(shape))),
        chunks=(*cases.chunks, *((size,) for size in shape)),
        meta=np.empty((0,) * (sources.ndim + len(shape)), dtype),
    )
    return result
