"""Displacements in the half-space, alone or with all mirrored loads, under a cell-wise uniform load."""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray
from contactstudy.kernels.images import FAR_LIMIT
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch_displacement import DISPLACEMENT_CORNERS
from contactstudy.kernels.smooth_field import smooth_field

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

    Returns
    -------
    array (3, x, y, z)
        Along x, y, z in metres.
    """
    nu, length = material.poisson, extent[1] - extent[0]
    level = _row_level(load, nu, length, reference) if np.isfinite(length) else None
    influence = Influence.of(DISPLACEMENT_CORNERS[load], nu, load, UNDER_PRESSURE, level)
    field = smooth_field(cells, influence, grid, x, y, z, extent=extent)
    return field / (4 * np.pi * material.shear_modulus)


def _row_level(load: Load, poisson: float, length: float, reference: float) -> tuple[float, ...]:
    """Displacement times ``4 pi G`` that a row of unit loads without end is relieved of, so that it is 0 far away."""
    # Beside a row of loads 4 pi G u is 2 (1 - nu) / r in their direction, and for a traction along y the term
    # y**2 / r**3 adds a constant. Images of a traction along x alternate in sign, so their row has no net load.
    row = 2 * (1 - poisson) * np.log(2 * FAR_LIMIT * length / reference)
    return {
        Load.NORMAL: (0.0, 0.0, float(-row / length)),
        Load.ALONG_X: (0.0, 0.0, 0.0),
        Load.ALONG_Y: (0.0, float(-(row + 2 * poisson) / length), 0.0),
    }[load]
