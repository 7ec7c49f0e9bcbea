"""A field of the half-space under columns of cells of any width: a sum over the corners of the loaded cells.

The influence of a cell is the mixed difference of a corner function over its corners. Summed over cells it becomes a
sum over corners, each weighted with the corner's mixed jump of the load. Around a point the columns are split. Columns
farther away than the refined depth are merged, and the field of columns far away is interpolated from few depths. The
columns do not depend on the field or on the direction of the load: all stresses under a pressure and its friction share
the columns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.peaks import lagrange_weights
from contactstudy.arrays.points import Points
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
)
from contactstudy.kernels.images import Influence, far_images, interpolation_points
from contactstudy.kernels.smooth_load import MomentLoads

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

MIRROR_ROUNDING = 1e-14  # rounding of a reflected position over the window. Accuracy.
POSITION_ROUNDING = 1e-9  # rounding of positions on an end or an edge, over a column. Accuracy.


@dataclass(frozen=True, eq=False)
class LateralAxis:
    """Positions along y, and `count` cells along y, beginning with the cell `first` of the grid."""

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


class Lattice(NamedTuple):
    """Positions along y at which the field at some of the depths is evaluated, and interpolated from."""

    y: FloatArray
    matrix: FloatArray | None  # (position, y): interpolation; None if the positions are the given ones
    depth_indices: IntArray

    @classmethod
    def of(cls, lateral: LateralAxis, step: float, depth_indices: IntArray) -> Lattice:
        """Positions at whole steps from the centre of a cell."""
        numbers = (lateral.y - lateral.grid.y[0]) / step
        first_numbers = np.floor(numbers).astype(np.int64) - (LATTICE_POINTS // 2 - 1)
        weights = lagrange_weights(np.arange(float(LATTICE_POINTS)), numbers - first_numbers)
        lattice, indices = np.unique(first_numbers[:, None] + np.arange(LATTICE_POINTS), return_inverse=True)
        matrix = np.zeros((lattice.size, lateral.y.size))
        matrix[indices.reshape(weights.shape), np.arange(lateral.y.size)[:, None]] = weights
        return cls(lateral.grid.y[0] + step * lattice, matrix, depth_indices)

    def interpolate(self, field: FloatArray) -> FloatArray:
        """Field (component, x, y, z) at the given positions."""
        return field if self.matrix is None else np.asarray(self.matrix.T @ field)


def _lattices(lateral: LateralAxis, z: FloatArray, is_refined: BoolArray) -> list[Lattice]:
    """Return the lattices of all depths: with at most half as many offsets from the cells as the positions have."""
    # The refined cells are centred about each position: their field is not interpolated.
    steps_per_cell = np.divide(lateral.grid.dy, LATTICE_STEP * z, out=np.full(z.shape, np.inf), where=z > 0)
    offset_counts = np.exp2(np.ceil(np.log2(np.maximum(steps_per_cell, 1.0))))
    offset_counts[is_refined | (2 * offset_counts > lateral.offset_count)] = np.inf
    lattices = []
    for count in np.unique(offset_counts).tolist():
        depth_indices = np.flatnonzero(offset_counts == count)
        if np.isfinite(count):
            lattices.append(Lattice.of(lateral, lateral.grid.dy / count, depth_indices))
        else:
            lattices.append(Lattice(lateral.y, None, depth_indices))
    return lattices


def _odd_count(ratio: float) -> int:
    """Least odd number of equal parts of a length `ratio` with no part larger than 1."""
    return 2 * max(0, int(np.ceil(0.5 * (ratio - 1) - OFFSET_TOLERANCE))) + 1


class Ring(NamedTuple):
    """Merged columns beyond a distance along x, on cells of the grid's size along y."""

    radius: float  # distance, metres
    lattice: Lattice  # positions along y
    layers: list[Layer]
    interpolation_z: FloatArray | None  # (z, depth): interpolation from the layers' depths; None without one


class SplitColumns(NamedTuple):
    """Columns around each point, and rings of merged columns farther away."""

    lattices: list[Lattice]  # positions along y of the near columns' field
    layers: list[list[Layer]]  # of each lattice
    rings: list[Ring]  # from the innermost one
    jumps: list[tuple[list[Jumps], list[list[list[Jumps]]]]]
    """For each position along x the jumps of near columns in all `layers`, and for each ring and either side the jumps
    of its columns in its layers."""
    first: int  # first loaded row of the grid, and the load (cell_x, y) on the rows from this row on
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
        first, load = int(loaded_rows[0]), cell_loads.values[:, loaded_rows[0] : loaded_rows[-1] + 1]
        fine_cells, is_refined = None, np.zeros(z.size, bool)
    else:
        fine_cells = FineCells(
            load=cell_loads.values, shape=shape.values, grid=grid, extent=extent, image_sign=image_sign
        )
        first, load, is_refined = fine_cells.first, fine_cells.cell_loads, fine_cells.is_refined_along_y(z)
    lateral = LateralAxis(grid, y, first, fine_cells.count if fine_cells else load.shape[1])
    lattices = _lattices(lateral, z, is_refined)

    def layers_of(lattice: Lattice, z: FloatArray, depth_indices: IntArray, *, fine: bool = False) -> list[Layer]:
        axis = replace(lateral, y=lattice.y)
        if fine_cells is None:
            return axis.uniform_layers(z, depth_indices)
        return axis.shaped_layers(z, depth_indices, fine=fine)

    layers = [
        layers_of(lattice, z, lattice.depth_indices[~is_refined[lattice.depth_indices]])
        + layers_of(lattice, z, lattice.depth_indices[is_refined[lattice.depth_indices]], fine=True)
        for lattice in lattices
    ]

    def ring_beyond(radius: float) -> Ring:
        (lattice,) = _lattices(lateral, np.array([radius]), np.array([False]))
        depths, interpolation_z = interpolation_points(z, radius, FAR_ERROR)
        return Ring(radius, lattice, layers_of(lattice, depths, np.arange(depths.size)), interpolation_z)

    far_radius = FAR_DISTANCE * (grid.y_range[1] - grid.y_range[0])
    refined_radius = MAX_REFINED_DEPTH * grid.dy
    radii = [refined_radius, far_radius] if is_refined.any() and refined_radius < far_radius else [far_radius]
    rings = [ring_beyond(radius) for radius in radii]
    near_layers = list(chain.from_iterable(layers))
    if fine_cells is None:
        edges, loads = mirror_edges(grid.x_edges, extent), add_images(load, image_sign, extent)
        jumps = [_uniform_jumps(position, near_layers, rings, edges, loads) for position in x.tolist()]
    else:
        jumps = list(_shaped_jumps(x, near_layers, rings, fine_cells, MAX_UNSPLIT_WIDTH * float(z.min())))
    return SplitColumns(lattices, layers, rings, jumps=jumps, first=first, load=load)


def _uniform_jumps(
    x: float, layers: list[Layer], rings: list[Ring], edges: FloatArray, loads: FloatArray
) -> tuple[list[Jumps], list[list[list[Jumps]]]]:
    """Jumps of columns with uniform loads (column, y) near a position, and of the rings."""
    column = int(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, edges.size - 2))
    borders = _SplitRange(edges[column : column + 1], column, column).borders(edges, x, rings)
    low, high = borders[0]
    near_jumps = [Jumps(edges[low : high + 1], loads[low:high], layer) for layer in layers]
    return near_jumps, _ring_jumps(edges, [[loads] * len(ring.layers) for ring in rings], rings, x, borders)


def _ring_jumps(
    edges: FloatArray, loads: list[list[FloatArray]], rings: list[Ring], x: float, borders: list[tuple[int, int]]
) -> list[list[list[Jumps]]]:
    """Jumps of the columns of each ring, on either side between successive `borders`, merged where they are narrow."""
    jumps = []
    for ring, ring_loads, (low, high), (first, stop) in zip(rings, loads, borders[:-1], borders[1:], strict=True):
        sections = [(start, end) for start, end in ((first, low), (high, stop)) if start < end]
        jumps.append(
            [
                [
                    Jumps(*merge_columns(edges[start : end + 1], load[start:end], x), layer)
                    for load, layer in zip(ring_loads, ring.layers, strict=True)
                ]
                for start, end in sections
            ]
        )
    return jumps


def _shaped_jumps(
    x: FloatArray, layers: list[Layer], rings: list[Ring], fine: FineCells, max_width: float
) -> Iterator[tuple[list[Jumps], list[list[list[Jumps]]]]]:
    """Jumps of the columns around each position, split unless they are narrow, and of the rings."""
    edges, shape = fine.edges, fine.shape_cells
    load = fine.shape_along_y(fine.far_load, shape.far_load)
    layer_loads, *ring_loads = (
        [add_images(layer.loads(load), fine.image_sign, fine.extent) for layer in group]
        for group in (layers, *(ring.layers for ring in rings))
    )
    for start in range(0, x.size, POSITIONS_PER_BATCH):
        positions = x[start : start + POSITIONS_PER_BATCH].tolist()
        split_ranges = [_split_around(position, fine, max_width) for position in positions]
        shape_means = _means_of_inserted(split_ranges, shape)
        load = fine.shape_along_y(shape_means if fine is shape else _means_of_inserted(split_ranges, fine), shape_means)
        inserted_loads = [layer.loads(load) for layer in layers]
        stop = 0
        for position, split_range in zip(positions, split_ranges, strict=True):
            first, stop = stop, stop + split_range.inserted.size - 1
            borders = split_range.borders(edges, position, rings)
            low, high = borders[0]
            near_jumps = [
                split_range.jumps(edges[low : high + 1], low, column_loads[low:high], fine_loads[first:stop], layer)
                for column_loads, fine_loads, layer in zip(layer_loads, inserted_loads, layers, strict=True)
            ]
            yield near_jumps, _ring_jumps(edges, ring_loads, rings, position, borders)


class _SplitRange(NamedTuple):
    """Split columns around a point, and one more on either side, without the moments of the split columns."""

    inserted: FloatArray  # edges of the new columns; one edge without any
    start: int  # first replaced column, and the column behind the last
    stop: int

    def range_within(self, edges: FloatArray, x: float, radius: float) -> tuple[int, int]:
        """First column within `radius` of `x`, nearest to `x` or replaced, and the column behind the last."""
        distances = np.maximum(edges[:-1] - x, x - edges[1:])
        columns = np.flatnonzero(distances <= max(radius, float(distances.min())))
        return min(int(columns[0]), self.start), max(int(columns[-1]) + 1, self.stop)

    def borders(self, edges: FloatArray, x: float, rings: list[Ring]) -> list[tuple[int, int]]:
        """Ranges of columns (first, stop) inside each ring; the last range is all columns."""
        return [*(self.range_within(edges, x, ring.radius) for ring in rings), (0, edges.size - 1)]

    def moment_loads(self, fine: FineCells) -> FloatArray:
        """Return loads on the inserted columns with the moments of the other columns: array (column, y)."""
        if self.start == self.stop:
            return np.zeros((0, fine.count))
        replaced_columns = slice(self.start + 1, self.stop - 1)
        is_summed = np.ones(fine.edges.size - 1, bool)
        is_summed[replaced_columns] = fine.is_unsplit[replaced_columns]
        total = MomentLoads(*(np.where(is_summed, loads, 0.0) for loads in fine.x_moments)).total.T
        midpoints = 0.5 * (self.inserted[1:] + self.inserted[:-1])
        return total[np.searchsorted(fine.edges, midpoints) - 1]

    def jumps(
        self, edges: FloatArray, first: int, loads: FloatArray, inserted_loads: FloatArray, layer: Layer
    ) -> Jumps:
        """Jumps of columns from the `first` on, with the `inserted_loads` loads instead of the replaced ones."""
        start, stop = self.start - first, self.stop - first
        return Jumps(
            np.concatenate([edges[:start], self.inserted, edges[stop + 1 :]]),
            np.concatenate([loads[:start], inserted_loads, loads[stop:]]),
            layer,
        )


def _means_of_inserted(split_ranges: list[_SplitRange], cells: FineCells) -> FloatArray:
    """Mean loads on the inserted columns around all points, with the moments of neighbouring columns: (column, y)."""
    moments = np.concatenate([split_range.moment_loads(cells) for split_range in split_ranges])
    return np.asarray(cells.column_means([split_range.inserted for split_range in split_ranges]) + moments)


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
        # A column across a step of the load would move its force.
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
    in_second_half = points.x > 0.5 * (low + high)
    x = np.where(in_second_half, low + high - points.x, points.x)
    arrays = [load] if shape is None else [load, shape]
    is_symmetric = all(np.array_equal(values, values[::-1]) for values in arrays)
    field = np.empty((influence.components, x.size, points.z.size, points.y.size)).swapaxes(2, 3)
    whole = np.full(x.size, True)
    # The step -1 reflects the load.
    for step, half in ((1, whole),) if is_symmetric else ((1, ~in_second_half), (-1, in_second_half)):
        if half.any():
            distinct_x, indices = _distinct_positions(x[half], MIRROR_ROUNDING * (high - low))
            half_points, half_shape = points._replace(x=distinct_x), None if shape is None else shape[::step]
            half_field = _sum_columns(load[::step], half_shape, influence, grid, points=half_points, extent=extent)
            field[:, half] = half_field[:, indices]
    field[:, in_second_half] *= np.array(influence.sign_along_x)[:, None, None, None]
    return field


def _distinct_positions(x: FloatArray, rounding: float) -> tuple[FloatArray, IntArray]:
    """Positions that differ by more than `rounding`, and the index of each position among them."""
    _, first_indices, indices = np.unique(np.round(x / rounding), return_index=True, return_inverse=True)
    return x[first_indices], indices


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
    shape_of = (influence.components, x.size)
    near_fields = [np.zeros((*shape_of, lattice.y.size, z.size)) for lattice in columns.lattices]
    ring_fields = [
        np.zeros((*shape_of, ring.lattice.y.size, ring.layers[0].depth_indices.size)) for ring in columns.rings
    ]
    for i, (position, (near_jumps, ring_jumps)) in enumerate(zip(x.tolist(), columns.jumps, strict=True)):
        start = 0
        for near_field, layers in zip(near_fields, columns.layers, strict=True):
            _add_fields(near_field[:, i], influence, layers, near_jumps[start : start + len(layers)], position)
            start += len(layers)
        for ring_field, ring, jumps_of_sides in zip(ring_fields, columns.rings, ring_jumps, strict=True):
            for side_jumps in jumps_of_sides:
                _add_fields(ring_field[:, i], influence, ring.layers, side_jumps, position)
    for near_field, lattice in zip(near_fields, columns.lattices, strict=True):
        field[..., lattice.depth_indices] = lattice.interpolate(near_field[..., lattice.depth_indices])
    for ring_field, ring in zip(ring_fields, columns.rings, strict=True):
        ring_field = ring.lattice.interpolate(ring_field)
        field += ring_field if ring.interpolation_z is None else ring_field @ ring.interpolation_z.T
    if np.isfinite(extent).all():
        field += far_images(columns.load, influence, grid, columns.first, points, extent=extent)
    return field


def _add_fields(field: FloatArray, influence: Influence, layers: list[Layer], jumps: list[Jumps], x: float) -> None:
    """Add the fields of the jumps in each layer to a field (component, y, depth) at one position."""
    for layer, layer_jumps in zip(layers, jumps, strict=True):
        layer_field = layer_jumps.field(influence, layer.corners, x, layer.offset_indices)
        field[:, layer.points[:, None], layer.depth_indices] += layer_field.swapaxes(1, 2)
