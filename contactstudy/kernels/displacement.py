"""Displacements in the half-space, alone or with all mirrored loads, under a cell-wise uniform load."""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray
from contactstudy.kernels.field import half_space_field
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.patch_displacement import DISPLACEMENT_CORNERS
from contactstudy.kernels.smooth_field import smooth_field
from contactstudy.kernels.surface import row_level

UNDER_PRESSURE = ((-1, 1, 1), (1, -1, 1))
"""Parities along x and along y of the components x, y, z under a pressure."""


def half_space_displacement(
    load: Load,
    cells: FloatArray,
    material: Material,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
    reference: float,
    smooth: bool = True,
) -> FloatArray:
    """Displacements of the half-space under a load and all its mirror images in the ends of `extent`.

    Parameters
    ----------
    load : Load
        Direction of the load.
    cells : array (cell_x, cell_y)
        Load per area, Pa.
    material : Material
        Elastic constants.
    grid : Grid
        Cells.
    x, y, z : array
        Points, as a tensor product, metres.
    extent : tuple of float
        Where the mirrors stand; infinite for none.
    reference : float
        With two mirrors the displacement in the direction of the load grows like a logarithm; it is taken relative to
        the top at this distance along y, metres.
    smooth : bool
        Whether the load is smooth where a step of it would be seen; else it is uniform in each cell.

    Returns
    -------
    array (3, x, y, z)
        Along x, y, z in metres.
    """
    nu, length = material.poisson, extent[1] - extent[0]
    influence = displacement_influence(load, nu, length, reference)
    field = (smooth_field if smooth else half_space_field)(cells, influence, grid, x, y, z, extent=extent)
    return field / (4 * np.pi * material.shear_modulus)


def displacement_influence(load: Load, poisson: float, length: float, reference: float) -> Influence:
    """Displacements times ``4 pi G`` of a unit load, relative to the top at the reference between two mirrors."""
    level = None
    if np.isfinite(length):
        along = (Load.ALONG_X, Load.ALONG_Y, Load.NORMAL)
        level = tuple(row_level(Response(direction, load), poisson, length, reference) for direction in along)
    return Influence.of(DISPLACEMENT_CORNERS[load], poisson, load, UNDER_PRESSURE, level)
