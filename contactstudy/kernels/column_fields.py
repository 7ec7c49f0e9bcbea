"""A field of the half-space under columns of cells of any width: a sum over the corners of the loaded cells.

The influence of a cell is the mixed difference of a corner function over its corners. Summed over cells it becomes a
sum over corners, each weighted with the mixed jump of the load there. Around a point the columns are split. Columns far
away are merged, and their field is interpolated from few depths. Neither depends on the field or on the direction of
the load: all stresses under a pressure and its friction share the columns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.points import Points
from contactstudy.cache import ArrayKey, cached
from contactstudy.checks import FloatArray, IntArray
from contactstudy.kernels.corner_sums import (
    OFFSET_TOLERANCE,
    AlignedPoints,
    Jumps,
    Layer,
    aligned_points,
    merge_columns,
    midpoint_cells,
)
from contactstudy.kernels.fine_cells import PARTS_Y, FineCells, mirrored, resolved_columns, with_images
from contactstudy.kernels.images import Influence, far_images, interpolation_points
from contactstudy.kernels.smooth_load import MomentLoads

NARROW = 0.15  # largest width of an unsplit column over the least depth. Accuracy.
DIVISORS = 6  # largest number of common steps in the shortest distance between positions along y. Speed.
BATCH = 16  # positions along x per evaluation of smooth loads. Speed.

FAR, FAR_ERROR = 2.0, 1e-6
"""Distance along x of merged columns over the width of the window, and the relative error of their interpolation over
the depth. Accuracy."""

CENTRED = 0.25  # width of the fine column about a point, over the original fine column. Accuracy.

LEAST = 1e-3
"""Least width of this column beside a step of the load, over the original one. Accuracy: on the top a step has infinite
stresses."""

ROUNDING = 1e-9  # rounding of positions on an end or an edge, over a column. Accuracy.


@dataclass(frozen=True, eq=False)
class AlongY:
    """Positions along y, and the cells along y: `count` from the `first` of the grid on."""

    grid: Grid
    y: FloatArray
    first: int
    count: int

    @property
    def begin(self) -> float:
        """First edge along y, metres."""
        return self.grid.y_range[0] + self.grid.dy * self.first

    @cached_property
    def aligned(self) -> list[AlignedPoints]:
        """Groups of positions with equal offsets from the cells."""
        return aligned_points(self.y, self.begin, self.grid.dy)

    def uniform(self, z: FloatArray, numbers: IntArray) -> list[Layer]:
        """Layers at some of the depths, of uniform loads on the grid's cells."""
        return [
            Layer.of(column, z[numbers], numbers, step=self.grid.dy, edges=None, parts=self.count)
            for column in self.aligned
            if numbers.size
        ]

    def layers(self, z: FloatArray, numbers: IntArray, *, fine: bool) -> list[Layer]:
        """Layers at some of the depths: fine cells, or cells of the grid's size with the moments of the fine cells."""
        if not numbers.size:
            return []
        dy, depths, span = self.grid.dy, z[numbers], self.count * self.grid.dy
        step = common_step(self.y) if len(self.aligned) > 1 else None
        # The time is proportional to the total number of cells, of one layer or of separate ones.
        if step is not None and dy <= step * len(self.aligned) * PARTS_Y:
            # One set of cells, with every point in the middle of a cell.
            cells = _odd_count(step / dy)
            parts = _odd_count(step / cells * PARTS_Y / dy)
            number = cells * parts if fine else cells
            low = float(self.y.min())
            indices = np.round((self.y - low) / step).astype(np.int64) * number
            column = AlignedPoints(low - self.begin, np.arange(self.y.size), indices)
            centred, edges = midpoint_cells(column, self.begin, span, step / number)
            if fine:
                return [Layer.of(centred, depths, numbers, step=step / number, edges=edges, parts=1)]
            split = np.linspace(edges[0], edges[-1], parts * (edges.size - 1) + 1)
            return [Layer.of(centred, depths, numbers, step=step / number, edges=split, parts=parts)]
        if not fine:
            edges = self.begin + dy / PARTS_Y * np.arange(PARTS_Y * self.count + 1.0)
            return [Layer.of(column, depths, numbers, step=dy, edges=edges, parts=PARTS_Y) for column in self.aligned]
        layers = []
        for column in self.aligned:
            column = AlignedPoints(column.offset, column.points, PARTS_Y * column.cells)
            centred, edges = midpoint_cells(column, self.begin, span, dy / PARTS_Y)
            layers.append(Layer.of(centred, depths, numbers, step=dy / PARTS_Y, edges=edges, parts=1))
        return layers


def _odd_count(ratio: float) -> int:
    """Least odd number of parts not larger than 1 of a length `ratio`."""
    return 2 * max(0, int(np.ceil(0.5 * (ratio - 1) - OFFSET_TOLERANCE))) + 1


class SplitColumns(NamedTuple):
    """Columns around each point, and merged columns far away."""

    layers: list[Layer]  # points at their depths, and at the few depths of the interpolation of far columns
    beyond: list[Layer]
    to_z: FloatArray | None  # (z, depth): matrix of this interpolation; None if the depths are equal
    jumps: list[tuple[list[Jumps], list[list[Jumps]]]]
    """For each position along x the jumps of near columns in the `layers`, and for either side the jumps of far
    columns in the layers `beyond`."""
    first: int  # (cell_x, cell_y): first column along y of the load, and the load
    load: FloatArray


@cached("split columns")
def split_columns(
    cells: ArrayKey,
    shape: ArrayKey | None,
    grid: Grid,
    extent: tuple[float, float],
    image: int,
    axes: tuple[ArrayKey, ArrayKey, ArrayKey],
) -> SplitColumns:
    """Columns around points (x, y, z) under loads on cells, of a `shape` inside them, with mirrors at an extent."""
    x, y, z = (axis.values for axis in axes)
    reach = FAR * (grid.y_range[1] - grid.y_range[0])
    depths, to_z = interpolation_points(z, reach, FAR_ERROR)
    depth_indices = np.arange(depths.size)
    if shape is None:
        loaded = np.flatnonzero(cells.values.any(axis=0))
        first, load = int(loaded[0]), cells.values[:, loaded[0] : loaded[-1] + 1]
        lateral = AlongY(grid, y, first, load.shape[1])
        layers, beyond = lateral.uniform(z, np.arange(z.size)), lateral.uniform(depths, depth_indices)
        edges, loads = mirrored(grid.x_edges, extent), with_images(load, image, extent)
        jumps = [_uniform_jumps(position, layers, beyond, edges, loads, reach=reach) for position in x.tolist()]
        return SplitColumns(layers=layers, beyond=beyond, to_z=to_z, jumps=jumps, first=first, load=load)
    fine = FineCells(load=cells.values, shape=shape.values, grid=grid, extent=extent, image=image)
    lateral = AlongY(grid, y, fine.first, fine.count)
    fine_depths = fine.fine_depths(z)
    layers = lateral.layers(z, np.flatnonzero(~fine_depths), fine=False)
    layers += lateral.layers(z, np.flatnonzero(fine_depths), fine=True)
    beyond = lateral.layers(depths, depth_indices, fine=False)
    jumps = list(_shaped_jumps(x, layers, beyond, fine, NARROW * float(z.min()), reach=reach))
    return SplitColumns(layers=layers, beyond=beyond, to_z=to_z, jumps=jumps, first=fine.first, load=fine.cells)


def _uniform_jumps(
    x: float, layers: list[Layer], beyond: list[Layer], edges: FloatArray, loads: FloatArray, *, reach: float
) -> tuple[list[Jumps], list[list[Jumps]]]:
    """Jumps of columns with uniform loads (column, y) within the distance `reach` of a position, and of far columns."""
    column = int(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, edges.size - 2))
    low, high = _Surroundings(edges[column : column + 1], column, column).within(edges, x, reach)
    near = [Jumps.of(edges[low : high + 1], loads[low:high], layer) for layer in layers]
    return near, _far_jumps(edges, [loads] * len(beyond), beyond, x, low=low, high=high)


def _far_jumps(
    edges: FloatArray, loads: list[FloatArray], beyond: list[Layer], x: float, low: int, high: int
) -> list[list[Jumps]]:
    """Jumps of the columns before `low` and from `high` on, merged where they are narrow."""
    sides = [(edges[: low + 1], slice(0, low)), (edges[high:], slice(high, None))]
    return [
        [Jumps.of(*merge_columns(far_edges, load[part], x), layer) for load, layer in zip(loads, beyond, strict=True)]
        for far_edges, part in sides
        if far_edges.size > 1
    ]


def _shaped_jumps(
    x: FloatArray, layers: list[Layer], beyond: list[Layer], fine: FineCells, narrow: float, reach: float
) -> Iterator[tuple[list[Jumps], list[list[Jumps]]]]:
    """Jumps of the columns around each position, split unless they are narrow, and of far columns."""
    edges, shape = fine.edges, fine.shape_cells
    load = fine.along_y(fine.far_load, shape.far_load)
    base, far = (
        [with_images(layer.loads(load), fine.image, fine.extent) for layer in group] for group in (layers, beyond)
    )
    for start in range(0, x.size, BATCH):
        positions = x[start : start + BATCH].tolist()
        surroundings = [_surroundings(position, fine, narrow) for position in positions]
        shape_means = _inserted_means(surroundings, shape)
        load = fine.along_y(shape_means if fine is shape else _inserted_means(surroundings, fine), shape_means)
        inserted = [layer.loads(load) for layer in layers]
        stop = 0
        for position, columns in zip(positions, surroundings, strict=True):
            first, stop = stop, stop + columns.inserted.size - 1
            low, high = columns.within(edges, position, reach)
            near = [
                columns.jumps(edges[low : high + 1], low, whole[low:high], fine_loads[first:stop], layer)
                for whole, fine_loads, layer in zip(base, inserted, layers, strict=True)
            ]
            yield near, _far_jumps(edges, far, beyond, position, low=low, high=high)


class _Surroundings(NamedTuple):
    """Split columns around a point, and one more on either side, without the moments of the split columns."""

    inserted: FloatArray  # edges of the new columns; one edge without any
    lowest: int  # first replaced column, and the column behind the last
    highest: int

    def within(self, edges: FloatArray, x: float, reach: float) -> tuple[int, int]:
        """First column within `reach` of `x`, nearest to `x` or replaced, and the column behind the last."""
        distances = np.maximum(edges[:-1] - x, x - edges[1:])
        near = np.flatnonzero(distances <= max(reach, float(distances.min())))
        return min(int(near[0]), self.lowest), max(int(near[-1]) + 1, self.highest)

    def moment_loads(self, fine: FineCells) -> FloatArray:
        """Return loads on the inserted columns with the moments of the other columns: array (column, y)."""
        if self.lowest == self.highest:
            return np.zeros((0, fine.count))
        replaced = slice(self.lowest + 1, self.highest - 1)
        retained = np.ones(fine.edges.size - 1, bool)
        retained[replaced] = fine.unsplit[replaced]
        total = MomentLoads(*(np.where(retained, loads, 0.0) for loads in fine.x_moments)).total.T
        middles = 0.5 * (self.inserted[1:] + self.inserted[:-1])
        return total[np.searchsorted(fine.edges, middles) - 1]

    def jumps(self, edges: FloatArray, first: int, loads: FloatArray, inserted: FloatArray, layer: Layer) -> Jumps:
        """Jumps of columns from the `first` on, with the `inserted` loads instead of the replaced ones."""
        start, stop = self.lowest - first, self.highest - first
        return Jumps.of(
            np.concatenate([edges[:start], self.inserted, edges[stop + 1 :]]),
            np.concatenate([loads[:start], inserted, loads[stop:]]),
            layer,
        )


def _inserted_means(surroundings: list[_Surroundings], cells: FineCells) -> FloatArray:
    """Means over the inserted columns of all surroundings, with the moments of their neighbours: (column, y)."""
    moments = np.concatenate([columns.moment_loads(cells) for columns in surroundings])
    return np.asarray(cells.columns([columns.inserted for columns in surroundings]) + moments)


def _surroundings(x: float, fine: FineCells, narrow: float) -> _Surroundings:
    """Split columns around a point in the middle of a column; none if all are narrow."""
    edges, count = fine.edges, fine.edges.size - 1
    column = int(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, count - 1))
    on_end = min(abs(x - end) for end in fine.extent) < ROUNDING * (edges[column + 1] - edges[column])
    lowest, highest = resolved_columns(edges, x, narrow)
    if lowest == highest:
        return _Surroundings(edges[lowest : lowest + 1], lowest, lowest)
    low, high = edges[lowest], edges[highest]
    inserted = fine.x_edges[(fine.x_edges >= low) & (fine.x_edges <= high)]
    if not on_end and low < x < high:
        # On an edge the narrower column determines the width: the mirrored load has the same columns.
        columns = np.searchsorted(inserted, [x - ROUNDING * (high - low), x + ROUNDING * (high - low)]) - 1
        # Beyond the outermost edge by rounding, the outermost column counts.
        width = float(np.diff(inserted)[np.clip(columns, 0, inserted.size - 2)].min())
        # A column across a step of the load would move its force.
        free = float(np.abs(fine.steps - x).min(initial=np.inf)) / 2
        step = min(CENTRED * width, max(free, LEAST * width))
        central = x + step * np.array([-1.5, -0.5, 0.5, 1.5])
        if low < central[0] and central[-1] < high:
            retained = np.abs(inserted - x) > 1.9 * step
            retained[[0, -1]] = True
            inserted = np.sort(np.concatenate([inserted[retained], central]))
    first, last = max(lowest - 1, 0), min(highest + 1, count)
    return _Surroundings(np.concatenate([edges[first:lowest], inserted, edges[highest + 1 : last + 1]]), first, last)


def common_step(y: FloatArray) -> float | None:
    """Largest common divisor of the distances between positions; None if the shortest distance has many parts."""
    distances = np.diff(np.unique(y))
    for divisor in range(1, DIVISORS + 1):
        step = float(distances.min(initial=np.inf)) / divisor
        if np.isfinite(step) and np.abs(distances / step - np.round(distances / step)).max() < OFFSET_TOLERANCE:
            return step
    return None


def columns_field(
    load: FloatArray,
    shape: FloatArray | None,
    influence: Influence,
    grid: Grid,
    points: Points,
    *,
    extent: tuple[float, float],
) -> FloatArray:
    """Field in the half-space under a load and all its mirror images, as `half_space_field`."""
    x, y, z = points
    axes = (ArrayKey(x), ArrayKey(y), ArrayKey(z))
    key = None if shape is None else ArrayKey(shape)
    columns = split_columns(ArrayKey(load), key, grid, extent, influence.load.sign_x, axes=axes)
    field = np.zeros((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    far_field = np.zeros((influence.components, x.size, y.size, columns.beyond[0].numbers.size))
    for i, (position, (near, sides)) in enumerate(zip(x.tolist(), columns.jumps, strict=True)):
        _add(field[:, i], influence, columns.layers, near, position)
        for side in sides:
            _add(far_field[:, i], influence, columns.beyond, side, position)
    field += far_field if columns.to_z is None else far_field @ columns.to_z.T
    if np.isfinite(extent).all():
        field += far_images(columns.load, influence, grid, columns.first, points, extent=extent)
    return field


def _add(field: FloatArray, influence: Influence, layers: list[Layer], jumps: list[Jumps], x: float) -> None:
    """Add the fields of the jumps in each layer to a field (component, y, depth) at one position."""
    for layer, layer_jumps in zip(layers, jumps, strict=True):
        values = layer_jumps.field(influence, layer.corners, x, layer.offset_indices)
        field[:, layer.points[:, None], layer.numbers] += values.swapaxes(1, 2)
