"""Stresses of the half-space, alone or with all mirrored loads, under a cell-wise uniform load."""

from __future__ import annotations

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.field import half_space_field
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch import STRESS_CORNERS
from contactstudy.kernels.smooth_field import smooth_field

UNDER_PRESSURE = ((1, 1, 1, -1, -1, 1), (1, 1, 1, -1, 1, -1))
"""Parities along x and along y of the components xx, yy, zz, xy, xz, yz under a pressure."""


def half_space_stress(
    load: Load,
    cells: FloatArray,
    poisson: float,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
    smooth: bool = True,
) -> FloatArray:
    """Stresses of the half-space under a load and all its mirror images in the ends of `extent`.

    Parameters
    ----------
    load : Load
        Direction of the load.
    cells : array (cell_x, cell_y)
        Load per area, Pa.
    poisson : float
        Poisson's ratio.
    grid : Grid
        Cells.
    x, y, z : array
        Points, as a tensor product, metres.
    extent : tuple of float
        Where the mirrors stand; infinite for none.
    smooth : bool
        Whether the load is smooth where a step of it would be seen; else it is uniform in each cell.

    Returns
    -------
    array (6, x, y, z)
        xx, yy, zz, xy, xz, yz in Pa.
    """
    influence = Influence.of(STRESS_CORNERS[load], poisson, load, UNDER_PRESSURE)
    return (smooth_field if smooth else half_space_field)(cells, influence, grid, x, y, z, extent=extent)
