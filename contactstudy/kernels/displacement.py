"""Displacements in the half-space, alone or with all mirrored loads, under cell-wise uniform pressure and traction."""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray
from contactstudy.kernels.field import half_space_field
from contactstudy.kernels.images import FAR_LIMIT
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.patch_displacement import normal_displacement_inside, tangential_displacement_inside

# Signs of the components x, y, z on the other side of a pressure along x and along y. On that of a traction along y the
# second ones are reversed.
SIGN_ALONG_X = np.array([-1.0, 1.0, 1.0])
SIGN_ALONG_Y = np.array([1.0, -1.0, 1.0])


def half_space_displacement(
    pressure: FloatArray,
    material: Material,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
    reference: float,
    tangential: bool,
) -> FloatArray:
    """Displacements of the half-space under a pressure and all its mirror images in the ends of `extent`.

    Parameters
    ----------
    pressure : array (cell_x, cell_y)
        Pressure, Pa.
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
    tangential : bool
        Whether the displacements under a traction along +y, equal to the pressure, are wanted as well.

    Returns
    -------
    array (load, 3, x, y, z)
        Under the pressure and, if wanted, under the traction: along x, y, z in metres.
    """
    nu = material.poisson

    def corner(at_x: FloatArray, at_y: FloatArray, depth: float) -> FloatArray:
        normal = normal_displacement_inside(at_x, at_y, depth, nu)
        if not tangential:
            return normal
        return np.concatenate([normal, tangential_displacement_inside(at_x, at_y, depth, nu)])

    along_x = np.tile(SIGN_ALONG_X, 1 + tangential)
    along_y = np.concatenate([SIGN_ALONG_Y, -SIGN_ALONG_Y]) if tangential else SIGN_ALONG_Y
    level = np.zeros(along_x.size)
    length = extent[1] - extent[0]
    if np.isfinite(length):
        # Beside a row of loads 4 pi G u is 2 (1 - nu) / r in their direction, and y**2 / r**3 adds a constant.
        row = 2 * (1 - nu) * np.log(2 * FAR_LIMIT * length / reference)
        level[2] = -row / length
        if tangential:
            level[4] = -(row + 2 * nu) / length
    influence = Influence(("displacement", nu, tangential, length, reference), corner, along_x, along_y, level)
    field = half_space_field(pressure, influence, grid, x, y, z, extent=extent)
    return field.reshape(-1, 3, *field.shape[1:]) / (4 * np.pi * material.shear_modulus)
