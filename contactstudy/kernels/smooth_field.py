"""A field of the half-space under a load that is smooth where it lies near to a point, on any cells."""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.aligned import aligned_points
from contactstudy.kernels.columns_field import smooth_columns_field
from contactstudy.kernels.field import half_space_field
from contactstudy.kernels.fine_cells import FineCells, ends_in_steps
from contactstudy.kernels.influence import Influence

CELLS_PER_POSITION = 32
"""Uniform cells along x per position from which on each position sums over them as over columns: a convolution has
the field at all of them. Speed."""


def smooth_field(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
) -> FloatArray:
    """Field in the half-space as by `half_space_field`, the load smooth where a step of it would be seen.

    A load that ends in steps is uniform in each cell.
    """
    if not load.any() or ends_in_steps(load):
        return half_space_field(load, influence, grid, x, y, z, extent=extent)
    if not grid.uniform or CELLS_PER_POSITION * x.size <= grid.cells_x:
        return smooth_columns_field(load, influence, grid, x, y, z, extent=extent)
    fine = FineCells(load, grid, extent, influence.load.sign_x)
    near = fine.near(z)
    field = np.empty((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    if not near.all():
        field[..., ~near] = half_space_field(fine.far(), influence, grid, x, y, z[~near], extent=extent)
    if not near.any():
        return field
    on_centres = np.zeros(x.size, bool)
    for row in aligned_points(x, float(grid.x[0]), grid.dx):
        on_centres[row.points] = row.offset == 0
    # Cells split along x have their middles where those of the whole cells are.
    centred = on_centres | (not fine.split.any())
    for column in aligned_points(y, float(grid.y[0]), grid.dy):
        for rows, split in ((np.flatnonzero(centred), True), (np.flatnonzero(~centred), False)):
            if not rows.size:
                continue
            cells, grid_near = fine.near_top(column.offset, split=split)
            found = half_space_field(cells, influence, grid_near, x[rows], y[column.points], z[near], extent=extent)
            if not split:
                found += smooth_columns_field(
                    load, influence, grid, x[rows], y[column.points], z[near], extent=extent, added=True
                )
            every = np.arange(influence.components)
            field[np.ix_(every, rows, column.points, np.flatnonzero(near))] = found
    return field
