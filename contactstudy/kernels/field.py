"""A field in the half-space, with or without mirrored loads, under a load on cells.

Points with equal offsets from uniform cells share one kernel and one fast convolution; the field at other points and
under columns is a sum over the corners of cells. Deep points and far columns need only the moments of the cells.
"""

from __future__ import annotations

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid, Points
from contactstudy.checks import FloatArray
from contactstudy.kernels.column_fields import columns_field
from contactstudy.kernels.convolution import centred_field
from contactstudy.kernels.corner_sums import AlignedPoints, aligned_points, fold_offsets
from contactstudy.kernels.fine_cells import FineCells, mirror_edges
from contactstudy.kernels.images import CHEBYSHEV_X, FarImages, Influence, snap_offsets
from contactstudy.kernels.load import DISPLACEMENT_CORNERS, STRESS_CORNERS, Load, Response
from contactstudy.kernels.strips import row_level, strips_of
from contactstudy.threads import one_blas_thread

ALIGNED_GROUPS = 2  # largest number of offsets along x with convolutions instead of corner sums. Speed.

CELLS_PER_POSITION = 32
"""Least number of uniform cells along x per position for corner sums: a convolution yields all cells. Speed."""


def half_space_field(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    points: Points,
    *,
    extent: tuple[float, float],
    shape: FloatArray | None = None,
) -> FloatArray:
    """Field (component, x, y, z) of the half-space under a load and all its mirror images in the ends of `extent`."""
    # The pressure `shape` determines the distribution of the load inside the cells; None: uniform.
    # In memory the depth precedes y, as in all fields.
    x, y, z = points
    field = np.zeros((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    if not load.any():
        return field
    rows = aligned_points(x, float(grid.x[0]), grid.dx)
    is_aligned = np.zeros(x.size, bool)
    if grid.uniform and (shape is None or CELLS_PER_POSITION * x.size > grid.cells_x):
        if shape is not None:
            rows = [row for row in rows if row.offset == 0]
        if len(rows) <= ALIGNED_GROUPS:
            for row in rows:
                is_aligned[row.points] = True
    if not is_aligned.all():
        with one_blas_thread():
            points = Points(x[~is_aligned], y, z)
            field[:, ~is_aligned] = columns_field(load, shape, influence, grid, points, extent=extent)
    if not is_aligned.any():
        return field
    if shape is None:
        field[:, is_aligned] = _uniform_field(load, influence, grid, Points(x[is_aligned], y, z), extent)
        return field
    fine_cells = FineCells(load=load, shape=shape, grid=grid, extent=extent, image_sign=influence.load.sign_x)
    components = np.arange(influence.components)
    is_near_y, is_near_x = fine_cells.is_refined_along_y(z), fine_cells.is_refined_along_x(z)
    for fine_x in (True, False):
        is_deep = ~is_near_y & (is_near_x == fine_x)
        if is_deep.any():
            cell_loads, coarse_grid = fine_cells.coarse_load(fine_x=fine_x)
            field[np.ix_(components, is_aligned, np.arange(y.size), is_deep)] = _uniform_field(
                cell_loads, influence, coarse_grid, Points(x[is_aligned], y, z[is_deep]), extent
            )
        is_shallow = is_near_y & (is_near_x == fine_x)
        for column in aligned_points(y, float(grid.y[0]), grid.dy) if is_shallow.any() else ():
            cell_loads, refined_grid = fine_cells.fine_load(column.offset)
            if not fine_x:
                cell_loads, refined_grid = fine_cells.coarsen_x(cell_loads, refined_grid)
            field[np.ix_(components, is_aligned, column.points, is_shallow)] = _uniform_field(
                cell_loads, influence, refined_grid, Points(x[is_aligned], y[column.points], z[is_shallow]), extent
            )
    return field


def _uniform_field(
    load: FloatArray, influence: Influence, grid: Grid, points: Points, extent: tuple[float, float]
) -> FloatArray:
    """Field at points with equal offsets from uniform cells, by fast convolution."""
    x, y, z = points
    has_first_mirror, has_second_mirror = bool(np.isfinite(extent[0])), bool(np.isfinite(extent[1]))
    loaded_rows = np.flatnonzero(load.any(axis=0))
    first_row, stop_row = int(loaded_rows[0]), int(loaded_rows[-1]) + 1
    load = load[:, first_row:stop_row]
    columns = aligned_points(y, float(grid.y[first_row]), grid.dy)
    rows = aligned_points(x, float(grid.x[0]), grid.dx)
    is_on_centres = len(rows) == len(columns) == 1 and rows[0].offset == columns[0].offset == 0
    image_sign = influence.load.sign_x
    if is_on_centres and (has_first_mirror or not has_second_mirror) and (image_sign > 0 or not has_first_mirror):
        cell = (grid.dx, grid.dy)
        return centred_field(load, influence, cell, rows[0].cells, columns[0].cells, z=z, extent=extent)
    first_centre = grid.x[0]
    if has_first_mirror:  # the mirrored load precedes the load
        load = np.concatenate([image_sign * load[::-1], load])
        first_centre -= grid.cells_x * grid.dx
    elif has_second_mirror:
        load = np.concatenate([load, image_sign * load[::-1]])
    length = extent[1] if has_first_mirror and has_second_mirror else np.inf
    field = np.empty((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    for column in columns:
        for row in aligned_points(x, float(first_centre), grid.dx):
            field[:, row.points[:, None], column.points] = _aligned_field(
                load, influence, grid, row, column, z=z, length=length
            )
    return field


def half_space_influence(
    influence: Influence, grid: Grid, points: Points, *, extent: tuple[float, float]
) -> FloatArray:
    """Field (component, x, cell, y, z) of a unit load on each cell along x, with all images, at distances y from it."""
    image_sign, columns, half_width = influence.load.sign_x, grid.cells_x, 0.5 * grid.dy
    distances = snap_offsets(points.x[:, None] - mirror_edges(grid.x_edges, extent), float(grid.widths.min()))[
        ..., None
    ]
    far_images = FarImages(extent[1] - extent[0], image_sign, CHEBYSHEV_X)
    first_cell = columns if np.isfinite(extent[0]) else 0
    depth_fields = []
    for depth in points.z.tolist():
        corner = influence.corner_at(depth)
        edge_rows = corner(distances, points.y + half_width) - corner(distances, points.y - half_width)
        cell_fields = edge_rows[:, :, :-1] - edge_rows[:, :, 1:]
        field = cell_fields[:, :, first_cell : first_cell + columns].copy()
        for start in range(0, cell_fields.shape[2], columns):
            if start != first_cell:
                field += image_sign * cell_fields[:, :, start : start + columns][:, :, ::-1]
        if np.isfinite(extent).all():
            kernel = far_images.influence(corner, points.y, grid.dy, np.array(influence.image_level))
            mean_weights = far_images.means(grid.x_edges - extent[0]) * grid.widths
            field += np.einsum(
                "xp,cpqy,qi->cxiy", far_images.interpolation(points.x - extent[0]), kernel, mean_weights, optimize=True
            )
        depth_fields.append(field)
    return np.stack(depth_fields, axis=-1)


def _aligned_field(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    row: AlignedPoints,
    column: AlignedPoints,
    *,
    z: FloatArray,
    length: float,
) -> FloatArray:
    """Field (component, row, column, z) of a load and its mirror image; the period is twice the `length`."""
    count, cells_y = load.shape
    first_y = int(column.cells.min()) - cells_y + 1
    y = grid.dy * np.arange(first_y, int(column.cells.max()) + 1) + column.offset
    if np.isfinite(length):
        # One period holds the load and its mirror image; offsets are wrapped into -length .. length.
        first_x, offset_count = -(count // 2), count
        shape = (offset_count, fft.next_fast_len(y.size, real=True))
    else:
        first_x = int(row.cells.min()) - count + 1
        offset_count = int(row.cells.max()) - first_x + 1
        shape = (fft.next_fast_len(offset_count, real=True), fft.next_fast_len(y.size, real=True))
    x = grid.dx * np.arange(first_x, first_x + offset_count) + row.offset
    spectrum = fft.rfft2(load, shape)
    row_indices, column_indices = (row.cells - first_x) % shape[0], column.cells - first_y

    # Where the offsets are symmetric, the kernel is evaluated on one side of 0.
    x, x_indices, signs = fold_offsets(x, grid.dx)
    factors = np.where(signs < 0, np.array(influence.sign_along_x)[:, None], 1)[:, :, None]

    def evaluate_layer(depth: float) -> FloatArray:
        kernel = influence.kernel(x, y, grid.dx, grid.dy, length=length, depth=depth)[:, x_indices] * factors
        layer = fft.irfft2(fft.rfft2(kernel, shape, axes=(1, 2)) * spectrum, shape, axes=(1, 2))
        return np.asarray(layer[:, row_indices[:, None], column_indices[None, :]])

    return np.stack([evaluate_layer(depth) for depth in z.tolist()], axis=-1)


def stress_influence(load: Load, poisson: float) -> Influence:
    """Stresses xx, yy, zz, xy, xz, yz of a unit load."""
    parities = (1, 1, 1, -1, -1, 1), (1, 1, 1, -1, 1, -1)
    corner, levels = STRESS_CORNERS[load], (0.0,) * 6
    return Influence(corner=corner, poisson=poisson, load=load, parities=parities, image_level=levels)


def displacement_influence(load: Load, poisson: float, length: float, reference: float) -> Influence:
    """Displacements times ``4 pi G`` of a unit load, relative to the top at the reference between two mirrors."""
    levels = tuple(
        row_level(strips_of(Response(direction, load), poisson), load.sign_x, length, reference)
        for direction in (Load.ALONG_X, Load.ALONG_Y, Load.NORMAL)
    )
    corner, parities = DISPLACEMENT_CORNERS[load], ((-1, 1, 1), (1, -1, 1))
    return Influence(corner=corner, poisson=poisson, load=load, parities=parities, image_level=levels)
