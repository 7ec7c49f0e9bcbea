"""Stresses of the half-space, alone or with all mirrored loads, under cell-wise uniform pressure and traction.

Points that lie alike relative to their cells share one kernel and one fast convolution; the others are summed directly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft

from contactstudy.checks import FloatArray, IntArray
from contactstudy.grid import Grid
from contactstudy.kernels.images import CornerFunction, cell_kernel, mirrored_kernel
from contactstudy.kernels.patch import normal_corner, tangential_corner
from contactstudy.threads import in_threads

# Offsets from the cell centre that differ by less than this part of a cell are one.
OFFSET_TOLERANCE = 1e-6
# Sign of the components xx, yy, zz, xy, xz, yz on the other side of the load along x.
ODD_ALONG_X = np.array([1.0, 1.0, 1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Aligned:
    """Points of one axis that share their offset from the nearest cell centre.

    Attributes
    ----------
    offset : float
        Distance from the cell centre, metres.
    points : array of int
        Which points of the axis they are.
    cells : array of int
        Cell of each (also outside the grid).
    """

    offset: float
    points: IntArray
    cells: IntArray


def aligned_points(values: FloatArray, first_centre: float, step: float) -> list[Aligned]:
    """Group the points of one axis by their offset from the cell centres."""
    position = (values - first_centre) / step
    cells = np.floor(position + 0.5 - OFFSET_TOLERANCE).astype(np.int64)
    offset = np.round((position - cells) / OFFSET_TOLERANCE).astype(np.int64)
    return [
        Aligned(float(value) * OFFSET_TOLERANCE * step, members, cells[members])
        for value in np.unique(offset)
        for members in [np.flatnonzero(offset == value)]
    ]


def half_space_stress(
    pressure: FloatArray,
    friction: float,
    poisson: float,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
) -> FloatArray:
    """Stresses of the half-space under the pressure and all its mirror images in the ends of `extent`.

    Parameters
    ----------
    pressure : array (cell_x, cell_y)
        Pressure, Pa.
    friction : float
        Coefficient of the traction along +y.
    poisson : float
        Poisson's ratio.
    grid : Grid
        Cells.
    x, y, z : array
        Points, as a tensor product, metres.
    extent : tuple of float
        Where the mirrors stand; infinite for none.

    Returns
    -------
    array (6, x, y, z)
        xx, yy, zz, xy, xz, yz in Pa.
    """
    mirrored, periodic = bool(np.isfinite(extent[0])), bool(np.isfinite(extent[1]))
    loaded = np.flatnonzero(pressure.any(axis=0))
    result = np.zeros((6, x.size, y.size, z.size))
    if not loaded.size:
        return result
    first, last = int(loaded[0]), int(loaded[-1]) + 1
    load = pressure[:, first:last]
    start = grid.x[0]
    if mirrored:  # cells of the mirrored load lie before those of the load
        load = np.concatenate([load[::-1], load])
        start -= grid.cells_x * grid.dx
    columns = aligned_points(y, float(grid.y[first]), grid.dy)
    for rows in aligned_points(x, float(start), grid.dx):
        for column in columns:
            values = _aligned_stress(load, friction, poisson, grid, rows, column, z, extent[1] if periodic else np.inf)
            result[:, rows.points[:, None], column.points] = values
    return result


def _aligned_stress(
    load: FloatArray,
    friction: float,
    poisson: float,
    grid: Grid,
    rows: Aligned,
    column: Aligned,
    z: FloatArray,
    length: float,
) -> FloatArray:
    """Stresses (6, row, column, z) at points that share their offsets from the cells."""
    count_x, count_y = load.shape
    y_from, y_to = int(column.cells.min()) - count_y + 1, int(column.cells.max())
    y = grid.dy * np.arange(y_from, y_to + 1) + column.offset
    if np.isfinite(length):
        # One period holds the load and its mirror image; offsets are wrapped into -length .. length.
        x_from, size_x = -(count_x // 2), count_x
    else:
        x_from = int(rows.cells.min()) - count_x + 1
        size_x = int(rows.cells.max()) - x_from + 1
    x = grid.dx * np.arange(x_from, x_from + size_x) + rows.offset
    shape = (
        size_x if np.isfinite(length) else fft.next_fast_len(size_x, real=True),
        fft.next_fast_len(y.size, real=True),
    )
    spectrum = fft.rfft2(load, shape)
    at_x = (rows.cells - x_from) % shape[0]
    at_y = column.cells - y_from

    def layer(depth: float) -> FloatArray:
        """Stresses (6, row, column) at one depth."""

        def corner(from_x: FloatArray, from_y: FloatArray) -> FloatArray:
            stress = normal_corner(from_x, from_y, depth, poisson)
            if friction:
                stress += friction * tangential_corner(from_x, from_y, depth, poisson)
            return stress

        kernel = _kernel_by_symmetry(corner, x, y, grid, length)
        stress = fft.irfft2(fft.rfft2(kernel, shape, axes=(1, 2)) * spectrum, shape, axes=(1, 2))
        return np.asarray(stress[:, at_x[:, None], at_y[None, :]])

    return np.stack(list(in_threads(layer, z.tolist())), axis=-1)


def _kernel_by_symmetry(corner: CornerFunction, x: FloatArray, y: FloatArray, grid: Grid, length: float) -> FloatArray:
    """Kernel at uniform offsets `x`; when they include 0 it is evaluated on one side and reflected to the other."""

    def evaluate(offsets: FloatArray) -> FloatArray:
        if np.isfinite(length):
            return mirrored_kernel(corner, offsets, y, grid.dx, grid.dy, length)
        return cell_kernel(corner, offsets, y, grid.dx, grid.dy)

    steps = x / grid.dx
    before = round(-float(steps[0]))
    after = x.size - 1 - before
    if abs(steps[0] + before) > OFFSET_TOLERANCE or min(before, after) < 1:
        return evaluate(x)
    ahead = evaluate(grid.dx * np.arange(max(before, after) + 1.0))
    behind = ahead[:, before:0:-1] * ODD_ALONG_X[:, None, None]
    return np.concatenate([behind, ahead[:, : after + 1]], axis=1)
