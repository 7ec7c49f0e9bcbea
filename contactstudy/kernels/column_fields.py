"""A field of the half-space under columns of cells of any width: a sum over the corners of the loaded cells.

The influence of a cell is the mixed difference of a corner function over its corners. Summed over cells it becomes a
sum over corners, each weighted with the corner's mixed jump of the load. Around a point the columns are split. Columns
farther away than the refined depth are merged, and the field of columns far away is interpolated from few depths. The
columns do not depend on the field or on the direction of the load: all stresses under a pressure and its friction share
the columns.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.peaks import lagrange_weights
from contactstudy.cache import ArrayKey, cached
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.kernels.corner_sums import (
    OFFSET_TOLERANCE,
    AlignedPoints,
    Jumps,
    Layer,
    aligned_points,
    merge_columns,
    midpoint_cells,
)
from contactstudy.kernels.fine_cells import (
    MAX_REFINED_DEPTH,
    PARTS_Y,
    FineCells,
    add_images,
    mirror_edges,
    resolved_columns,
    share_fine_cells,
)
from contactstudy.kernels.images import Influence, far_images, interpolation_points

MAX_UNSPLIT_WIDTH = 0.15  # largest width of an unsplit column over the least depth. Accuracy.
MAX_DIVISOR = 6  # largest number of common steps in the shortest distance between positions along y. Speed.
POSITIONS_PER_BATCH = 16  # positions along x per evaluation of smooth loads. Speed.

LATTICE_POINTS, LATTICE_STEP = 8, 0.125
"""Number of positions along y of an interpolating polynomial, and their largest step over the depth. Accuracy: 1e-6 of
the largest difference of the loads of adjacent cells."""

FAR_DISTANCE, FAR_ERROR = 2.0, 1e-6
"""Distance along x of columns that are interpolated over the depth, over the width of the window, and the relative
error of this interpolation. Accuracy."""

CENTRED_WIDTH = 0.25  # width of the fine column about a point, over the original fine column. Accuracy.

MIN_CENTRED_WIDTH = 1e-3
"""Least width of the fine column about a point next to a step of the load, over the original fine column. Accuracy: on
the top a step has infinite stresses."""

MIRROR_ROUNDING = 1e-14  # rounding of a reflected position over the window. Rounding.
POSITION_ROUNDING = 1e-9  # rounding of positions on an end or an edge, over a column. Rounding.
GroupJumps = list[list[Jumps]]  # of each group and layer, about one position


@dataclass(frozen=True, eq=False)
class LateralAxis:
    """Positions along y, and `count` cells along y from the cell `first` of the grid."""

    grid: Grid
    y: FloatArray
    first: int
    count: int

    @property
    def first_edge(self) -> float:
        """First edge along y, metres."""
        return self.grid.y_range[0] + self.grid.dy * self.first

    @cached_property
    def aligned_groups(self) -> list[AlignedPoints]:
        """Groups of positions with equal offsets from the cells."""
        return aligned_points(self.y, self.first_edge, self.grid.dy)

    @cached_property
    def offset_count(self) -> float:
        """Number of sets of cells of the grid's size that have every position at an equal offset from their cells."""
        group_count, step = len(self.aligned_groups), common_step(self.y)
        return group_count if step is None else min(group_count, _odd_count(step / self.grid.dy) * self.grid.dy / step)

    def uniform_layers(self, z: FloatArray, depth_indices: IntArray) -> list[Layer]:
        """Layers at some of the depths, of uniform loads on the grid's cells."""
        return [
            Layer(aligned, z[depth_indices], depth_indices, step=self.grid.dy, edges=None, fine_per_cell=self.count)
            for aligned in self.aligned_groups
            if depth_indices.size
        ]

    def shaped_layers(self, z: FloatArray, depth_indices: IntArray, *, fine: bool) -> list[Layer]:
        """Layers at some of the depths: fine cells, or cells of the grid's size with the moments of the fine cells."""
        if not depth_indices.size:
            return []
        dy, depths, span = self.grid.dy, z[depth_indices], self.count * self.grid.dy
        step = common_step(self.y) if len(self.aligned_groups) > 1 else None
        # The time is proportional to the total number of cells, in one layer or in separate layers.
        if step is not None and dy <= step * len(self.aligned_groups) * PARTS_Y:
            # One set of cells, with every point in the middle of a cell.
            cell_count = _odd_count(step / dy)
            fine_per_cell = _odd_count(step / cell_count * PARTS_Y / dy)
            count = cell_count * fine_per_cell if fine else cell_count
            lowest_y = float(self.y.min())
            indices = np.round((self.y - lowest_y) / step).astype(np.int64) * count
            aligned = AlignedPoints(lowest_y - self.first_edge, np.arange(self.y.size), indices)
            centred, edges = midpoint_cells(aligned, self.first_edge, span, step / count)
            fine_per_cell = 1 if fine else fine_per_cell
            if not fine:
                edges = np.linspace(edges[0], edges[-1], fine_per_cell * (edges.size - 1) + 1)
            return [Layer(centred, depths, depth_indices, step=step / count, edges=edges, fine_per_cell=fine_per_cell)]
        if not fine:
            edges = self.first_edge + dy / PARTS_Y * np.arange(PARTS_Y * self.count + 1.0)
            return [
                Layer(aligned, depths, depth_indices, step=dy, edges=edges, fine_per_cell=PARTS_Y)
                for aligned in self.aligned_groups
            ]
        layers = []
        for aligned in self.aligned_groups:
            aligned = AlignedPoints(aligned.offset, aligned.points, PARTS_Y * aligned.cells)
            centred, edges = midpoint_cells(aligned, self.first_edge, span, dy / PARTS_Y)
            layers.append(Layer(centred, depths, depth_indices, step=dy / PARTS_Y, edges=edges, fine_per_cell=1))
        return layers


class ColumnGroup(NamedTuple):
    """Near columns, or a ring of merged columns, at some depths, and the positions that interpolate their field."""

    y: FloatArray
    interpolation_y: FloatArray | None  # (y, position): None if the positions are the given ones
    depth_indices: IntArray  # depths of the field; if depths are interpolated, all depths of the layers
    interpolation_z: FloatArray | None = None  # (z, depth): None if the depths are the given ones
    radius: float = 0.0  # for a ring of merged columns, its distance along x from the point, metres
    layers: Sequence[Layer] = ()

    @classmethod
    def on_lattice(cls, lateral: LateralAxis, step: float, depth_indices: IntArray) -> ColumnGroup:
        """Positions along y at whole steps from the centre of a cell."""
        steps_from_cell = (lateral.y - lateral.grid.y[0]) / step
        first_steps = np.floor(steps_from_cell).astype(np.int64) - (LATTICE_POINTS // 2 - 1)
        weights = lagrange_weights(np.arange(float(LATTICE_POINTS)), steps_from_cell - first_steps)
        lattice, indices = np.unique(first_steps[:, None] + np.arange(LATTICE_POINTS), return_inverse=True)
        matrix = np.zeros((lattice.size, lateral.y.size))
        matrix[indices.reshape(weights.shape), np.arange(lateral.y.size)[:, None]] = weights
        return cls(lateral.grid.y[0] + step * lattice, matrix, depth_indices)

    def add_to(self, field: FloatArray, group_field: FloatArray) -> None:
        """Add the group's field (component, x, y, z) at its positions to the field at the given positions."""
        group_field = group_field[..., self.depth_indices]
        if self.interpolation_y is not None:
            group_field = self.interpolation_y.T @ group_field
        if self.interpolation_z is not None:
            field += group_field @ self.interpolation_z.T
        else:
            field[..., self.depth_indices] += group_field


def _groups_by_depth(lateral: LateralAxis, z: FloatArray, is_refined: BoolArray) -> list[ColumnGroup]:
    """Return groups without layers: on lattices with at most half as many offsets from the cells as the positions."""
    # The refined cells are centred about each position: their field is not interpolated.
    steps_per_cell = np.divide(lateral.grid.dy, LATTICE_STEP * z, out=np.full(z.shape, np.inf), where=z > 0)
    offset_counts = np.exp2(np.ceil(np.log2(np.maximum(steps_per_cell, 1.0))))
    offset_counts[is_refined | (2 * offset_counts > lateral.offset_count)] = np.inf
    groups = []
    for count in np.unique(offset_counts).tolist():
        depth_indices = np.flatnonzero(offset_counts == count)
        if np.isfinite(count):
            groups.append(ColumnGroup.on_lattice(lateral, lateral.grid.dy / count, depth_indices))
        else:
            groups.append(ColumnGroup(lateral.y, None, depth_indices))
    return groups


def _odd_count(ratio: float) -> int:
    """Least odd number of equal parts of a length `ratio` with no part larger than 1."""
    return 2 * max(0, int(np.ceil(0.5 * (ratio - 1) - OFFSET_TOLERANCE))) + 1


class SplitColumns(NamedTuple):
    """Columns around each point, and rings of merged columns farther away."""

    groups: list[ColumnGroup]  # near columns, then rings from the innermost one
    jumps: list[GroupJumps]  # for each position along x and each group
    first_row: int  # first loaded row of the grid, and load (cell_x, y) on the rows from this row on
    load: FloatArray


@cached("split columns")
def split_columns(
    cell_loads: ArrayKey,
    shape: ArrayKey | None,
    grid: Grid,
    extent: tuple[float, float],
    image_sign: int,
    keys: tuple[ArrayKey, ArrayKey, ArrayKey],
) -> SplitColumns:
    """Split columns around points (x, y, z); `shape` distributes the loads inside cells, mirrors lie at `extent`."""
    x, y, z = (key.values for key in keys)
    if shape is None:
        loaded_rows = np.flatnonzero(cell_loads.values.any(axis=0))
        first_row, load = int(loaded_rows[0]), cell_loads.values[:, loaded_rows[0] : loaded_rows[-1] + 1]
        fine_cells, is_refined = None, np.zeros(z.size, bool)
    else:
        fine_cells = share_fine_cells(cell_loads, shape, grid, extent, image_sign)
        first_row, load, is_refined = fine_cells.first, fine_cells.cell_loads, fine_cells.is_refined_along_y(z)
    lateral = LateralAxis(grid, y, first_row, fine_cells.count if fine_cells else load.shape[1])

    def add_layers(group: ColumnGroup, z: FloatArray, is_refined: BoolArray) -> ColumnGroup:
        axis, indices = replace(lateral, y=group.y), group.depth_indices
        if fine_cells is None:
            return group._replace(layers=axis.uniform_layers(z, indices))
        coarse_layers = axis.shaped_layers(z, indices[~is_refined[indices]], fine=False)
        return group._replace(layers=coarse_layers + axis.shaped_layers(z, indices[is_refined[indices]], fine=True))

    groups = [add_layers(group, z, is_refined) for group in _groups_by_depth(lateral, z, is_refined)]
    far_radius = FAR_DISTANCE * (grid.y_range[1] - grid.y_range[0])
    refined_radius = MAX_REFINED_DEPTH * grid.dy
    for radius in [refined_radius, far_radius] if is_refined.any() and refined_radius < far_radius else [far_radius]:
        (ring,) = _groups_by_depth(lateral, np.array([radius]), np.array([False]))
        depths, interpolation_z = interpolation_points(z, radius, FAR_ERROR)
        ring = ring._replace(depth_indices=np.arange(depths.size), interpolation_z=interpolation_z, radius=radius)
        groups.append(add_layers(ring, depths, np.zeros(depths.size, bool)))
    if fine_cells is None:
        edges, loads = mirror_edges(grid.x_edges, extent), add_images(load, image_sign, extent)
        jumps = [_uniform_jumps(position, groups, edges, loads) for position in x.tolist()]
    else:
        jumps = list(_shaped_jumps(x, groups, fine_cells, MAX_UNSPLIT_WIDTH * float(z.min())))
    return SplitColumns(groups, jumps, first_row, load)


def _uniform_jumps(x: float, groups: list[ColumnGroup], edges: FloatArray, loads: FloatArray) -> GroupJumps:
    """Jumps of columns with uniform loads (column, y) about a position, of each group."""
    column = int(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, edges.size - 2))
    split_range = _SplitRange(edges[column : column + 1], column, column)
    layer_loads, inserted_loads = ([[values] * len(group.layers) for group in groups] for values in (loads, loads[:0]))
    return _jumps_around(x, groups, edges, split_range, loads=layer_loads, inserted_loads=inserted_loads)


def _jumps_around(
    x: float,
    groups: list[ColumnGroup],
    edges: FloatArray,
    split_range: _SplitRange,
    *,
    loads: list[list[FloatArray]],
    inserted_loads: list[list[FloatArray]],
) -> GroupJumps:
    """Jumps of each group about a position, from loads (column, y) per group and layer; merged in rings."""
    borders = split_range.borders(edges, x, [group.radius for group in groups if group.radius])
    (low, high), ring_borders, jumps = borders[0], pairwise(borders), []
    for group, group_loads, group_inserted in zip(groups, loads, inserted_loads, strict=True):
        if not group.radius:
            jumps.append(
                [
                    split_range.jumps(edges[low : high + 1], low, column_loads[low:high], fine_loads, layer)
                    for column_loads, fine_loads, layer in zip(group_loads, group_inserted, group.layers, strict=True)
                ]
            )
            continue
        (inner_first, inner_stop), (first, stop) = next(ring_borders)
        sections = [(start, end) for start, end in ((first, inner_first), (inner_stop, stop)) if start < end]
        jumps.append(
            [
                Jumps(*merge_columns(edges[start : end + 1], load[start:end], x), layer)
                for start, end in sections
                for load, layer in zip(group_loads, group.layers, strict=True)
            ]
        )
    return jumps


def _shaped_jumps(x: FloatArray, groups: list[ColumnGroup], fine: FineCells, max_width: float) -> Iterator[GroupJumps]:
    """Jumps of each group about each position; columns around the position are split unless they are narrow."""
    shape = fine.shape_cells
    load = fine.shape_along_y(fine.far_load, shape.far_load)
    images = fine.image_sign, fine.extent
    loads = [[add_images(layer.loads(load), *images) for layer in group.layers] for group in groups]
    for first_position in range(0, x.size, POSITIONS_PER_BATCH):
        positions = x[first_position : first_position + POSITIONS_PER_BATCH].tolist()
        split_ranges = [_split_around(position, fine, max_width) for position in positions]
        shape_means = _means_of_inserted(split_ranges, shape)
        means = shape_means if fine is shape else _means_of_inserted(split_ranges, fine)
        # Neighbouring positions have equal columns.
        _, first, column = np.unique(np.hstack([means, shape_means]), axis=0, return_index=True, return_inverse=True)
        load = fine.shape_along_y(means[first], shape_means[first])
        inserted_loads = [[] if group.radius else [layer.loads(load) for layer in group.layers] for group in groups]
        stop = 0
        for position, split_range in zip(positions, split_ranges, strict=True):
            start, stop = stop, stop + split_range.inserted_edges.size - 1
            rows = column.ravel()[start:stop]
            split_loads = [[layer_loads[rows] for layer_loads in group_loads] for group_loads in inserted_loads]
            yield _jumps_around(position, groups, fine.edges, split_range, loads=loads, inserted_loads=split_loads)


class _SplitRange(NamedTuple):
    """Columns that replace the columns around a point, and one column more on either side."""

    inserted_edges: FloatArray  # edges of the new columns; a single edge without new columns
    start: int  # first replaced column, and the column behind the last
    stop: int

    def range_within(self, edges: FloatArray, x: float, radius: float) -> tuple[int, int]:
        """First column within `radius` of `x`, nearest to `x` or replaced, and the column behind the last."""
        distances = np.maximum(edges[:-1] - x, x - edges[1:])
        columns = np.flatnonzero(distances <= max(radius, float(distances.min())))
        return min(int(columns[0]), self.start), max(int(columns[-1]) + 1, self.stop)

    def borders(self, edges: FloatArray, x: float, radii: list[float]) -> list[tuple[int, int]]:
        """Ranges of columns (first, stop) inside each ring; the last range is all columns."""
        return [*(self.range_within(edges, x, radius) for radius in radii), (0, edges.size - 1)]

    def moment_loads(self, fine: FineCells) -> FloatArray:
        """Return loads on the inserted columns with the moments of the other columns: array (column, y)."""
        if self.start == self.stop:
            return np.zeros((0, fine.count))
        is_unsplit = np.diff(np.searchsorted(self.inserted_edges, fine.edges)) < 2
        midpoints = 0.5 * (self.inserted_edges[1:] + self.inserted_edges[:-1])
        return fine.moment_loads(is_unsplit)[np.searchsorted(fine.edges, midpoints) - 1]

    def jumps(
        self, edges: FloatArray, first: int, loads: FloatArray, inserted_loads: FloatArray, layer: Layer
    ) -> Jumps:
        """Jumps of columns from the `first` on, with the `inserted_loads` loads instead of the replaced ones."""
        start, stop = self.start - first, self.stop - first
        return Jumps(
            np.concatenate([edges[:start], self.inserted_edges, edges[stop + 1 :]]),
            np.concatenate([loads[:start], inserted_loads, loads[stop:]]),
            layer,
        )


def _means_of_inserted(split_ranges: list[_SplitRange], cells: FineCells) -> FloatArray:
    """Mean loads on the inserted columns around all points, with the moments of neighbouring columns: (column, y)."""
    moments = np.concatenate([split_range.moment_loads(cells) for split_range in split_ranges])
    return np.asarray(cells.column_means([split_range.inserted_edges for split_range in split_ranges]) + moments)


def _split_around(x: float, fine: FineCells, max_width: float) -> _SplitRange:
    """Split columns around a point, which lies in the middle of a new column; split none if all are narrow."""
    edges, count = fine.edges, fine.edges.size - 1
    column = int(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, count - 1))
    is_on_end = min(abs(x - end) for end in fine.extent) < POSITION_ROUNDING * (edges[column + 1] - edges[column])
    start, stop = resolved_columns(edges, x, max_width)
    if start == stop:
        return _SplitRange(edges[start : start + 1], start, start)
    low, high = edges[start], edges[stop]
    new_edges = fine.x_edges[(fine.x_edges >= low) & (fine.x_edges <= high)]
    if not is_on_end and low < x < high:
        # On an edge the narrower column determines the width: the mirrored load has the same columns.
        rounding = POSITION_ROUNDING * (high - low)
        columns = np.searchsorted(new_edges, [x - rounding, x + rounding]) - 1
        # A point beyond the outermost edge by rounding belongs to the outermost column.
        width = float(np.diff(new_edges)[np.clip(columns, 0, new_edges.size - 2)].min())
        # A column across a step of the load would shift the load.
        step_distance = float(np.abs(fine.step_edges - x).min(initial=np.inf)) / 2
        step = min(CENTRED_WIDTH * width, max(step_distance, MIN_CENTRED_WIDTH * width))
        central_edges = x + step * np.array([-1.5, -0.5, 0.5, 1.5])
        if low < central_edges[0] and central_edges[-1] < high:
            is_retained = np.abs(new_edges - x) > 1.9 * step
            is_retained[[0, -1]] = True
            new_edges = np.sort(np.concatenate([new_edges[is_retained], central_edges]))
    first_column, stop_column = max(start - 1, 0), min(stop + 1, count)
    return _SplitRange(
        np.concatenate([edges[first_column:start], new_edges, edges[stop + 1 : stop_column + 1]]),
        first_column,
        stop_column,
    )


def common_step(y: FloatArray) -> float | None:
    """Largest common divisor of the distances between positions; None if the shortest distance has many such parts."""
    distances = np.diff(np.unique(y))
    for divisor in range(1, MAX_DIVISOR + 1):
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
    # Between two ends the window is the whole body. The splitting of columns is not symmetric: in a symmetric window
    # the second half is the reflected field of the reflected load, for every load, so that fields add up.
    if not grid.is_symmetric or np.isinf(extent[0]) != np.isinf(extent[1]):
        return _sum_columns(load, shape, influence, grid, points=points, extent=extent)
    low, high = grid.x_range
    is_in_second_half = points.x > 0.5 * (low + high)
    x = np.where(is_in_second_half, low + high - points.x, points.x)
    arrays = [load] if shape is None else [load, shape]
    is_symmetric = all(np.array_equal(values, values[::-1]) for values in arrays)
    field = np.empty((influence.components, x.size, points.z.size, points.y.size)).swapaxes(2, 3)
    all_points = np.full(x.size, True)
    # The step -1 reflects the load.
    for step, is_in_half in ((1, all_points),) if is_symmetric else ((1, ~is_in_second_half), (-1, is_in_second_half)):
        if is_in_half.any():
            rounded_x = np.round(x[is_in_half] / (MIRROR_ROUNDING * (high - low)))
            _, first_indices, indices = np.unique(rounded_x, return_index=True, return_inverse=True)
            half_points = points._replace(x=x[is_in_half][first_indices])
            half_shape = None if shape is None else shape[::step]
            half_field = _sum_columns(load[::step], half_shape, influence, grid, points=half_points, extent=extent)
            field[:, is_in_half] = half_field[:, indices]
    field[:, is_in_second_half] *= np.array(influence.sign_along_x)[:, None, None, None]
    return field


def _sum_columns(
    load: FloatArray,
    shape: FloatArray | None,
    influence: Influence,
    grid: Grid,
    *,
    points: Points,
    extent: tuple[float, float],
) -> FloatArray:
    """Field of all columns and of the far images."""
    x, y, z = points
    axes = (ArrayKey(x), ArrayKey(y), ArrayKey(z))
    shape_key = None if shape is None else ArrayKey(shape)
    columns = split_columns(ArrayKey(load), shape_key, grid, extent, influence.load.sign_x, keys=axes)
    field = np.zeros((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    group_fields = [
        np.zeros(
            (
                influence.components,
                x.size,
                group.y.size,
                z.size if group.interpolation_z is None else group.depth_indices.size,
            )
        )
        for group in columns.groups
    ]
    for i, (position, jumps_of_groups) in enumerate(zip(x.tolist(), columns.jumps, strict=True)):
        for group_field, jumps in zip(group_fields, jumps_of_groups, strict=True):
            for layer_jumps in jumps:
                layer, layer_field = layer_jumps.layer, layer_jumps.field(influence, position)
                group_field[:, i][:, layer.points[:, None], layer.depth_indices] += layer_field.swapaxes(1, 2)
    for group, group_field in zip(columns.groups, group_fields, strict=True):
        group.add_to(field, group_field)
    if np.isfinite(extent).all():
        field += far_images(columns.load, influence, grid, columns.first_row, points, extent=extent)
    return field
