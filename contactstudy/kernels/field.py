"""A field in the half-space, alone or with all mirrored loads, under a cell-wise uniform load.

Points that lie alike relative to their cells share one kernel and one fast convolution. Where the points along x lie
in many different ways, the field is interpolated from the cell centres and the nearest cells are put right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray, IntArray
from contactstudy.kernels.aligned import OFFSET_TOLERANCE, Aligned, aligned_points
from contactstudy.kernels.centred import centred_field
from contactstudy.kernels.columns_field import columns_field
from contactstudy.kernels.images import cell_kernel, snapped
from contactstudy.kernels.influence import Influence

ALIGNED_GROUPS = 2
"""Different offsets along x up to which each has a convolution; more are interpolated. Speed."""

INTERPOLATION_POINTS = 8
"""Cell centres from which a position along x is interpolated. Accuracy."""

NEAR_CELLS = 14
"""Cells on either side of a position whose influence is put right after interpolation. Accuracy."""


def half_space_field(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
) -> FloatArray:
    """Field in the half-space under a load and all its mirror images in the ends of `extent`.

    Parameters
    ----------
    load : array (cell_x, cell_y)
        Load on the cells of `grid`.
    influence : Influence
        What a unit load does.
    grid : Grid
        Cells.
    x, y, z : array
        Points, as a tensor product, metres.
    extent : tuple of float
        Where the mirrors stand; infinite for none.

    Returns
    -------
    array (component, x, y, z)
    """
    if not grid.uniform:
        return columns_field(load, influence, grid, x, y, z, extent=extent)
    in_first, in_second = bool(np.isfinite(extent[0])), bool(np.isfinite(extent[1]))
    periodic = in_first and in_second
    loaded = np.flatnonzero(load.any(axis=0))
    # In memory the depth comes before y, as in all fields.
    result = np.zeros((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    if not loaded.size:
        return result
    first, last = int(loaded[0]), int(loaded[-1]) + 1
    load = load[:, first:last]
    columns = aligned_points(y, float(grid.y[first]), grid.dy)
    rows = aligned_points(x, float(grid.x[0]), grid.dx)
    on_centres = len(rows) == len(columns) == 1 and rows[0].offset == columns[0].offset == 0
    image = influence.load.sign_x
    # A load that its image reverses, or that is mirrored in its second end alone, takes the general way.
    if on_centres and (in_first or not in_second) and (image > 0 or not in_first):
        return centred_field(
            load,
            influence,
            (grid.dx, grid.dy),
            rows[0].cells,
            columns[0].cells,
            z,
            mirrored=in_first,
            length=extent[1] if periodic else np.inf,
        )
    start = grid.x[0]
    if in_first:  # cells of the mirrored load lie before those of the load
        load = np.concatenate([image * load[::-1], load])
        start -= grid.cells_x * grid.dx
    elif in_second:
        load = np.concatenate([load, image * load[::-1]])
    cells = _LoadedCells(load, influence, grid.dx, grid.dy, extent[1] if periodic else np.inf)
    rows = aligned_points(x, float(start), grid.dx)
    for column in columns:
        if len(rows) > ALIGNED_GROUPS:
            result[:, :, column.points] = _unaligned_field(cells, (x - start) / grid.dx, column, z)
            continue
        for row in rows:
            result[:, row.points[:, None], column.points] = _aligned_field(cells, row.cells, row.offset, column, z)
    return result


@dataclass(frozen=True, eq=False)
class _LoadedCells:
    """A load on uniform cells, with its mirror image beside it if it has one; its period is twice the length."""

    load: FloatArray
    influence: Influence
    dx: float
    dy: float
    length: float

    @property
    def periodic(self) -> bool:
        return bool(np.isfinite(self.length))

    def lateral_offsets(self, column: Aligned) -> tuple[FloatArray, IntArray]:
        """Offsets along y from any cell to any point of the column, and where among them the points lie."""
        first = int(column.cells.min()) - self.load.shape[1] + 1
        steps = np.arange(first, int(column.cells.max()) + 1)
        return self.dy * steps + column.offset, column.cells - first


def _aligned_field(cells: _LoadedCells, rows: IntArray, offset: float, column: Aligned, z: FloatArray) -> FloatArray:
    """Field (component, row, column, z) at one offset along x from the centres of the cells `rows`."""
    count = cells.load.shape[0]
    y, at_y = cells.lateral_offsets(column)
    if cells.periodic:
        # One period holds the load and its mirror image; offsets are wrapped into -length .. length.
        first, size = -(count // 2), count
        shape = (size, fft.next_fast_len(y.size, real=True))
    else:
        first = int(rows.min()) - count + 1
        size = int(rows.max()) - first + 1
        shape = (fft.next_fast_len(size, real=True), fft.next_fast_len(y.size, real=True))
    x = cells.dx * np.arange(first, first + size) + offset
    spectrum = fft.rfft2(cells.load, shape)
    at_x = (rows - first) % shape[0]

    def layer(depth: float) -> FloatArray:
        kernel = _kernel_by_symmetry(cells, depth, x, y)
        values = fft.irfft2(fft.rfft2(kernel, shape, axes=(1, 2)) * spectrum, shape, axes=(1, 2))
        return np.asarray(values[:, at_x[:, None], at_y[None, :]])

    return np.stack([layer(depth) for depth in z.tolist()], axis=-1)


def _unaligned_field(cells: _LoadedCells, position: FloatArray, column: Aligned, z: FloatArray) -> FloatArray:
    """Field (component, position, column, z) at any positions along x, counted in cells from the first centre.

    The influence of all but the nearest cells is smooth enough to be interpolated from the cell centres around each
    position; the nearest cells are interpolated with them, and the difference to their exact influence is added.
    """
    base = np.floor(position).astype(np.int64)
    fraction = position - base
    steps = np.arange(-INTERPOLATION_POINTS // 2 + 1, INTERPOLATION_POINTS // 2 + 1)
    weights = np.ones((position.size, steps.size))
    for i, step in enumerate(steps):
        for other in steps[steps != step]:
            weights[:, i] *= (fraction - other) / (step - other)
    centres, where = np.unique(base[:, None] + steps, return_inverse=True)
    at_centres = _aligned_field(cells, centres, 0.0, column, z)
    interpolated = np.einsum("ti,ctiyz->ctyz", weights, at_centres[:, where.reshape(weights.shape)])

    near = np.arange(-NEAR_CELLS, NEAR_CELLS + 1)
    sources = base[:, None] - near
    if cells.periodic:
        load = cells.load[sources % cells.load.shape[0]]
    else:
        inside = (sources >= 0) & (sources < cells.load.shape[0])
        load = np.where(inside[..., None], cells.load[np.where(inside, sources, 0)], 0.0)
    y, at_y = cells.lateral_offsets(column)
    size = fft.next_fast_len(y.size, real=True)
    spectrum = fft.rfft(load, size, axis=2)
    around = np.arange(near[0] + steps[0], near[-1] + steps[-1] + 1)
    interpolation = np.zeros((position.size, near.size, around.size))
    for i in range(steps.size):
        interpolation[:, np.arange(near.size), np.arange(near.size) + i] = weights[:, i, None]
    x_edges = snapped(cells.dx * (fraction[:, None] + np.append(near, near[-1] + 1) - 0.5), cells.dx)
    y_edges = np.append(y - 0.5 * cells.dy, y[-1] + 0.5 * cells.dy)

    def correction(depth: float) -> FloatArray:
        corner = cells.influence.corner_at(depth)
        exact = np.diff(np.diff(corner(x_edges[..., None], y_edges), axis=-1), axis=-2)
        aligned = cell_kernel(corner, cells.dx * around, y, cells.dx, cells.dy)
        difference = exact - np.einsum("tka,cay->ctky", interpolation, aligned)
        summed = np.einsum("ctkw,tkw->ctw", fft.rfft(difference, size, axis=3), spectrum)
        return np.asarray(fft.irfft(summed, size, axis=2)[..., at_y])

    return np.asarray(interpolated + np.stack([correction(depth) for depth in z.tolist()], axis=-1))


def _kernel_by_symmetry(cells: _LoadedCells, depth: float, x: FloatArray, y: FloatArray) -> FloatArray:
    """Kernel at uniform offsets `x`; when they include 0 it is evaluated on one side and reflected to the other."""

    def evaluate(offsets: FloatArray) -> FloatArray:
        return cells.influence.kernel(offsets, y, cells.dx, cells.dy, cells.length, depth)

    steps = x / cells.dx
    before = round(-float(steps[0]))
    after = x.size - 1 - before
    if abs(steps[0] + before) > OFFSET_TOLERANCE or min(before, after) < 1:
        return evaluate(x)
    ahead = evaluate(cells.dx * np.arange(max(before, after) + 1.0))
    behind = ahead[:, before:0:-1] * np.array(cells.influence.sign_along_x)[:, None, None]
    return np.concatenate([behind, ahead[:, : after + 1]], axis=1)
