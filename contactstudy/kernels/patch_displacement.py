"""Uniformly loaded rectangle on a half-space: the three displacements at any depth, in closed form.

As in patch.py every quantity is a second mixed difference of a corner function of the offset ``(X, Y, z)``, from the
potentials (A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929); K. L. Johnson, Contact Mechanics (1985), section 3.2)

    pressure p:        4 pi G u_x = -(1 - 2 nu) chi_x - z V_x,   4 pi G u_z = 2 (1 - nu) V - z V_z
    traction q on y:   4 pi G u_x = 2 nu Theta_xy - z chi_xy,    4 pi G u_y = 2 V + 2 nu Theta_yy - z chi_yy,
                       4 pi G u_z = (1 - 2 nu) chi_y - z V_y
"""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch import TINY


class _Potentials:
    """Corner functions of the potentials' derivatives at offsets ``(X, Y, z)``."""

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray | float) -> None:
        r = np.sqrt(x * x + y * y + z * z)
        xy = x * y
        self.r, self.z = r, z
        self.log = np.log(np.maximum(r + z, TINY))
        self.asinh_x = np.arcsinh(x / np.maximum(np.hypot(y, z), TINY ** (1 / 5)))
        self.asinh_y = np.arcsinh(y / np.maximum(np.hypot(x, z), TINY ** (1 / 5)))
        self.v_z = -np.arctan2(xy, z * r)
        self.chi_xx = np.arctan2(xy * (r - z), x * x * r + y * y * z)
        self.chi_yy = np.arctan2(xy * (r - z), y * y * r + x * x * z)
        self.v = x * self.asinh_y + y * self.asinh_x + z * self.v_z
        self.chi_x = y * self.log + z * self.asinh_y + x * self.chi_xx
        self.chi_y = x * self.log + z * self.asinh_x + y * self.chi_yy
        self.theta_yy = -y * self.asinh_x + z * self.chi_yy


def normal_displacement_inside(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of ``4 pi G (u_x, u_y, u_z)`` under unit pressure.

    Parameters
    ----------
    x, y : array
        Offsets from corner to observer, broadcastable to one shape.
    z : array or float
        Depths, not negative, broadcastable to the same.
    poisson : float
        Poisson's ratio.

    Returns
    -------
    array of shape (3, ...)

    Examples
    --------
    >>> edge = np.array([-0.5, 0.5])
    >>> corner = normal_displacement_inside(edge[:, None], edge[None, :], 0.0, 0.3)
    >>> (np.diff(np.diff(corner, axis=1), axis=2)[:, 0, 0] / (2 * 0.7)).round(6).tolist()
    [0.0, 0.0, 3.525494]
    """
    at = _Potentials(x, y, z)
    free = 1 - 2 * poisson
    return np.stack(
        [
            -free * at.chi_x - z * at.asinh_y,
            -free * at.chi_y - z * at.asinh_x,
            2 * (1 - poisson) * at.v - z * at.v_z,
        ]
    )


def tangential_displacement_inside(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of ``4 pi G (u_x, u_y, u_z)`` under unit shear traction along +y; otherwise as for pressure.

    Examples
    --------
    >>> edge = np.array([-0.5, 0.5])
    >>> corner = tangential_displacement_inside(edge[:, None], edge[None, :], 0.0, 0.0)
    >>> (np.diff(np.diff(corner, axis=1), axis=2)[:, 0, 0] / 2).round(6).tolist()
    [0.0, 3.525494, 0.0]
    """
    at = _Potentials(x, y, z)
    return np.stack(
        [
            2 * poisson * (z * at.log - at.r) - z * at.log,
            2 * at.v + 2 * poisson * at.theta_yy - z * at.chi_yy,
            (1 - 2 * poisson) * at.chi_y - z * at.asinh_x,
        ]
    )


def axial_displacement_inside(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions under unit shear traction along +x: those along +y with x and y exchanged.

    Examples
    --------
    >>> edge = np.array([-0.5, 0.5])
    >>> corner = axial_displacement_inside(edge[:, None], edge[None, :], 0.0, 0.0)
    >>> (np.diff(np.diff(corner, axis=1), axis=2)[:, 0, 0] / 2).round(6).tolist()
    [3.525494, 0.0, 0.0]
    """
    return tangential_displacement_inside(y, x, z, poisson)[[1, 0, 2]]


DISPLACEMENT_CORNERS = {
    Load.NORMAL: normal_displacement_inside,
    Load.ALONG_X: axial_displacement_inside,
    Load.ALONG_Y: tangential_displacement_inside,
}
"""Corner functions of the three displacements, by the direction of the load."""
