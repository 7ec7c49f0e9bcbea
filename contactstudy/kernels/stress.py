"""Stresses of the half-space, alone or with all mirrored loads, under cell-wise uniform pressure and traction."""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.field import half_space_field
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.patch import normal_corner, tangential_corner

# Signs of the components xx, yy, zz, xy, xz, yz on the other side of a pressure along x and along y. On that of a
# traction along y the second ones are reversed.
SIGN_ALONG_X = np.array([1.0, 1.0, 1.0, -1.0, -1.0, 1.0])
SIGN_ALONG_Y = np.array([1.0, 1.0, 1.0, -1.0, 1.0, -1.0])


def stress_influence(poisson: float, *, tangential: bool) -> Influence:
    """Six stresses under unit pressure and, if wanted, six more under unit traction along +y."""

    def corner(x: FloatArray, y: FloatArray, z: float) -> FloatArray:
        normal = normal_corner(x, y, z, poisson)
        if not tangential:
            return normal
        return np.concatenate([normal, tangential_corner(x, y, z, poisson)])

    along_x = np.tile(SIGN_ALONG_X, 1 + tangential)
    along_y = np.concatenate([SIGN_ALONG_Y, -SIGN_ALONG_Y]) if tangential else SIGN_ALONG_Y
    return Influence(("stress", poisson, tangential), corner, along_x, along_y, np.zeros(along_x.size))


def half_space_stress(
    pressure: FloatArray,
    poisson: float,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
    tangential: bool,
) -> FloatArray:
    """Stresses of the half-space under a pressure and all its mirror images in the ends of `extent`.

    Parameters
    ----------
    pressure : array (cell_x, cell_y)
        Pressure, Pa.
    poisson : float
        Poisson's ratio.
    grid : Grid
        Cells.
    x, y, z : array
        Points, as a tensor product, metres.
    extent : tuple of float
        Where the mirrors stand; infinite for none.
    tangential : bool
        Whether the stresses under a traction along +y, equal to the pressure, are wanted as well.

    Returns
    -------
    array (load, 6, x, y, z)
        Under the pressure and, if wanted, under the traction: xx, yy, zz, xy, xz, yz in Pa.
    """
    influence = stress_influence(poisson, tangential=tangential)
    stress = half_space_field(pressure, influence, grid, x, y, z, extent=extent)
    return stress.reshape(-1, 6, *stress.shape[1:])
