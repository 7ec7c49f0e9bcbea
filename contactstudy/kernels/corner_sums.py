"""Sums over the corners of cells in columns of any width, at points with equal offsets from the cells along y."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft

from contactstudy.checks import BoolArray, ComplexArray, FloatArray, IntArray
from contactstudy.kernels.fine_cells import NEIGHBOURS, coarsen
from contactstudy.kernels.images import Influence, snap_offsets
from contactstudy.kernels.smooth_load import ShapedLoad

OFFSET_TOLERANCE = 1e-6  # largest difference of equal offsets from the cell centre, over a cell. Rounding.


@dataclass(frozen=True, eq=False)
class AlignedPoints:
    """Points of one axis that share their offset from the nearest cell centre."""

    offset: float  # distance from the cell centre, metres
    points: IntArray  # indices of the points on the axis
    cells: IntArray  # cell of each point, possibly outside the grid


def aligned_points(positions: FloatArray, first_centre: float, step: float) -> list[AlignedPoints]:
    """Group the points of one axis by their offset from the cell centres."""
    cell_position = (positions - first_centre) / step
    cells = np.floor(cell_position + 0.5 - OFFSET_TOLERANCE).astype(np.int64)
    offset = np.round((cell_position - cells) / OFFSET_TOLERANCE).astype(np.int64)
    return [
        AlignedPoints(float(rounded_offset) * OFFSET_TOLERANCE * step, indices, cells[indices])
        for rounded_offset in np.unique(offset)
        for indices in [np.flatnonzero(offset == rounded_offset)]
    ]


def fold_offsets(offsets: FloatArray, step: float) -> tuple[FloatArray, IntArray, FloatArray]:
    """Distances from 0 of symmetric offsets, each offset's index among them and its sign; other offsets unchanged."""
    half_steps = np.round(2 * offsets / step).astype(np.int64)
    if np.abs(2 * offsets / step - half_steps).max() >= OFFSET_TOLERANCE:
        return offsets, np.arange(offsets.size), np.ones(offsets.size)
    distances, indices = np.unique(np.abs(half_steps), return_inverse=True)
    return 0.5 * step * distances, indices, np.where(half_steps < 0, -1.0, 1.0)


MAX_DIRECT_POINTS = 8  # largest number of points along y with direct sums instead of a convolution. Speed.
BLOCK_SIZE = 16_384  # corners and depths per evaluation. Speed: the values fit into the processor's cache.
MERGED_WIDTH = 0.04  # width of merged columns over their distance. Accuracy: 1e-5 of the pressure.


class Layer:
    """Points at some depths with equal offsets from the corners of cells of size `step` along y, and these cells."""

    def __init__(
        self,
        aligned: AlignedPoints,
        z: FloatArray,
        depth_indices: IntArray,
        *,
        step: float,
        edges: FloatArray | None,
        fine_per_cell: int,
    ) -> None:
        # The cells of the points are counted from the first of the `edges`, or of the grid's cells without `edges`.
        count = fine_per_cell if edges is None else (edges.size - 1) // fine_per_cell
        cells = aligned.cells
        if edges is None:
            fine_per_cell = 1
        elif fine_per_cell > 1:
            count, cells = count + 2 * NEIGHBOURS, cells + NEIGHBOURS
        lowest = int(cells.min()) - count
        offsets: FloatArray = aligned.offset + step * np.arange(lowest, int(cells.max()) + 1.0)
        # Indices of the positions along y, of the offsets between position and first corner, and of the depths.
        self.points, self.offset_indices, self.depth_indices = aligned.points, cells - int(cells.min()), depth_indices
        self.z = z
        # Distances at which corner functions are evaluated, and the distance and the sign of each offset.
        self.distances, self._indices, self._signs = fold_offsets(offsets, offsets[1] - offsets[0])
        self.edges = edges  # edges along y of fine cells; None for the grid's cells
        self.fine_per_cell = fine_per_cell  # fine cells per cell of the layer; the cell carries their moments

    def loads(self, load: ShapedLoad) -> FloatArray:
        """Return loads of columns (column, y) on the cells of the layer."""
        assert self.edges is not None
        fine_loads = load.equivalent_means(self.edges)
        return (
            fine_loads if self.fine_per_cell == 1 else np.ascontiguousarray(coarsen(fine_loads.T, self.fine_per_cell).T)
        )

    def unfold(self, values: FloatArray, is_odd: BoolArray, size: int) -> FloatArray:
        """Values (component, depth, edge, offset) from the evaluated offsets, padded with zeros to `size` offsets."""
        unfolded_values = np.zeros((*values.shape[:-1], size))
        negative_count, offset_count = int((self._signs < 0).sum()), self._indices.size
        # Copies of contiguous ranges are several times faster than an index array.
        if negative_count:
            mirrored_values = values[..., self._indices[negative_count - 1] : self._indices[0] + 1][..., ::-1]
            sign = np.where(is_odd, -1.0, 1.0)[:, None, None, None]
            np.multiply(mirrored_values, sign, out=unfolded_values[..., :negative_count])
        if negative_count < offset_count:
            unfolded_values[..., negative_count:offset_count] = values[
                ..., self._indices[negative_count] : self._indices[-1] + 1
            ]
        return unfolded_values

    def fold_jumps(self, jumps: FloatArray) -> FloatArray:
        """Sum jumps (edge, corner) over both sides of 0: array (edge and distance, point and parity)."""
        count, starts = jumps.shape[1], self.offset_indices
        folded = np.zeros((starts.size, 2, jumps.shape[0], self.distances.size))
        for (even, odd), start in zip(folded, starts.tolist(), strict=True):
            indices = self._indices[start : start + count]
            negative_count = int((self._signs[start : start + count] < 0).sum())
            if negative_count:
                negative = slice(indices[negative_count - 1], indices[0] + 1)
                even[:, negative] = jumps[:, negative_count - 1 :: -1]
                odd[:, negative] = -even[:, negative]
            if negative_count < count:
                positive = slice(indices[negative_count], indices[-1] + 1)
                even[:, positive] += jumps[:, negative_count:]
                odd[:, positive] += jumps[:, negative_count:]
        return folded.reshape(2 * starts.size, -1).T


def midpoint_cells(aligned: AlignedPoints, start: float, span: float, step: float) -> tuple[AlignedPoints, FloatArray]:
    """Points ``start + offset + step * cells`` in the middle of cells, and the edges of these cells over a `span`."""
    cells_before = int(np.floor(-aligned.offset / step - 0.5))
    first_edge = aligned.offset + step * (cells_before + 0.5)
    cell_count = int(np.ceil((span - first_edge) / step - 1e-9))
    edges = np.asarray(start + first_edge + step * np.arange(cell_count + 1.0))
    return AlignedPoints(0.5 * step, aligned.points, aligned.cells - cells_before - 1), edges


class Jumps:
    """Nonzero mixed jumps of `loads` (column, cell) at the edges along x, for the points of a layer."""

    def __init__(self, edges: FloatArray, loads: FloatArray, layer: Layer) -> None:
        self.layer, self.min_width = layer, float(np.diff(edges).min())
        padded = np.zeros((loads.shape[0] + 2, loads.shape[1] + 2))
        padded[1:-1, 1:-1] = loads
        jumps = np.diff(np.diff(padded, axis=0), axis=1)
        is_loaded = jumps.any(axis=1)
        self.edges, values = edges[is_loaded], jumps[is_loaded, ::-1]  # (edge, corner), backwards along y
        starts = layer.offset_indices
        self.size = fft.next_fast_len(jumps.shape[1] + int(starts.max()), real=True)
        self.is_folded = starts.size <= MAX_DIRECT_POINTS
        if self.is_folded:
            self.weights: FloatArray | ComplexArray = layer.fold_jumps(values)
        else:  # (edge, wavenumber)
            self.weights = fft.rfft(values, self.size, axis=1).conj()

    def field(self, influence: Influence, x: float) -> FloatArray:
        """Field (component, depth, point) at `x` of the corners."""
        layer, offsets_x = self.layer, snap_offsets(x - self.edges, self.min_width)
        # A primitive is even where its kernel is odd, and odd where it is even.
        is_odd = np.array(influence.sign_along_y) > 0
        step = max(1, BLOCK_SIZE // max(1, offsets_x.size * layer.distances.size))
        fields = []
        for start in range(0, layer.z.size, step):
            z = layer.z[start : start + step, None, None]
            corner_values = influence.corner(offsets_x[:, None], layer.distances, z, influence.poisson)
            if self.is_folded:
                sums = corner_values.reshape(*corner_values.shape[:2], -1) @ self.weights
                fields.append(np.where(is_odd[:, None, None], sums[..., 1::2], sums[..., ::2]))
                continue
            unfolded_values = layer.unfold(corner_values, is_odd, self.size)
            field_spectrum = np.einsum("czek,ek->czk", fft.rfft(unfolded_values, axis=3), self.weights)
            fields.append(fft.irfft(field_spectrum, self.size, axis=2)[..., layer.offset_indices])
        return np.concatenate(fields, axis=1)


def merge_columns(edges: FloatArray, loads: FloatArray, x: float) -> tuple[FloatArray, FloatArray]:
    """Merge columns (column, y) that are narrow over their distance from `x` into pairs of equal force and moment."""
    midpoints, widths = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    distances = np.abs(midpoints - x)
    rings = np.log(distances / distances.min()) // np.log1p(MERGED_WIDTH)
    starts = np.flatnonzero(np.append(True, np.diff(rings) != 0))
    if starts.size == loads.shape[0]:
        return edges, loads
    stops = np.append(starts[1:], loads.shape[0])
    first_edges, group_widths = edges[starts], (edges[stops] - edges[starts])[:, None]
    centres = first_edges + 0.5 * group_widths[:, 0]
    group = np.repeat(np.arange(starts.size), stops - starts)
    force = np.add.reduceat(loads * widths[:, None], starts, axis=0) / group_widths
    moment = np.add.reduceat(loads * (widths * (midpoints - centres[group]))[:, None], starts, axis=0) / group_widths**2
    is_halved = np.stack([np.ones(starts.size, bool), stops - starts > 1], axis=1)
    difference = np.where(is_halved[:, 1:], 4 * moment, 0.0)
    merged_loads = np.stack([force - difference, force + difference], axis=1)[is_halved]
    return np.append(np.stack([first_edges, centres], axis=1)[is_halved], edges[-1]), merged_loads
