"""Uniformly loaded rectangle on a half-space: the stresses below, in closed form.

Every quantity is a second mixed difference, over the rectangle's corners, of a corner function of the offset
``(X, Y, z)`` from corner to observer. The corner functions follow from the Boussinesq and Cerruti potentials

    V = int int dA / r,   chi = int int ln(r + z) dA,   Theta = int int [z ln(r + z) - r] dA

(A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929); K. L. Johnson, Contact Mechanics (1985), section 3.2). Terms that
depend on one of X and Y alone cancel in the difference and are left out, which also avoids loss of digits.
"""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load

TINY = 1e-150
"""Least denominator. Its square is still a number, and offsets in metres are never so small unless they vanish."""


def _inverse_sinh_ratio(numerator: FloatArray, other: FloatArray, z: FloatArray | float) -> FloatArray:
    """``asinh(numerator / hypot(other, z))``, finite where the denominator vanishes (a corner's edge)."""
    return np.asarray(np.arcsinh(numerator / np.maximum(np.hypot(other, z), 1e-30)))


def _together(*components: FloatArray) -> FloatArray:
    """Components over ``2 pi`` as one array (component, ...)."""
    together = np.empty((len(components), *components[0].shape))
    for one, own in zip(together, components, strict=True):
        np.multiply(own, 1 / (2 * np.pi), out=one)
    return together


def normal_corner(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of the six stresses under unit pressure, in the order xx, yy, zz, xy, xz, yz.

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
    array of shape (6, ...)
        With ``p`` on a rectangle the stress is ``p`` times the second mixed difference of these.

    Examples
    --------
    >>> edge = np.array([-1.0, 1.0])
    >>> corner = normal_corner(edge[:, None], edge[None, :], 0.0, 0.3)
    >>> (np.diff(np.diff(corner, axis=1), axis=2)[:3, 0, 0]).round(6).tolist()
    [-0.8, -0.8, -1.0]
    """
    xx, yy = x * x, y * y
    r = np.sqrt(xx + yy + z * z)
    xy = x * y
    v_z = -np.arctan2(xy, z * r)
    chi_xx = np.arctan2(xy * (xx + yy), (r + z) * (r * xx + z * yy))
    chi_yy = -v_z - chi_xx
    along_x = 1.0 / np.maximum(r * (xx + z * z), TINY)
    along_y = 1.0 / np.maximum(r * (yy + z * z), TINY)
    v_xx, v_yy = -xy * along_x, -xy * along_y
    free = 1 - 2 * poisson
    return _together(
        2 * poisson * v_z - free * chi_xx - z * v_xx,
        2 * poisson * v_z - free * chi_yy - z * v_yy,
        v_z + z * (v_xx + v_yy),
        -free * np.log(np.maximum(r + z, TINY)) - z / np.maximum(r, TINY),
        z * z * y * along_x,
        z * z * x * along_y,
    )


def tangential_corner(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of the six stresses under unit shear traction along +y; otherwise as :func:`normal_corner`.

    Examples
    --------
    >>> edge = np.array([-1.0, 1.0])
    >>> corner = tangential_corner(edge[:, None], edge[None, :], 0.0, 0.3)
    >>> round(float(np.diff(np.diff(corner, axis=1), axis=2)[5, 0, 0]), 6)
    -1.0
    """
    xx, yy = x * x, y * y
    r = np.sqrt(xx + yy + z * z)
    safe_r, r_z = np.maximum(r, TINY), np.maximum(r + z, TINY)
    v_y = _inverse_sinh_ratio(x, y, z)
    along_y = 1.0 / np.maximum(r * (yy + z * z), TINY)
    x_r, y_r, last = x / r_z, y / r_z, z * x * along_y
    return _together(
        2 * poisson * (v_y - x_r) - z / safe_r * x_r,
        2 * v_y + 2 * poisson * x_r + z / safe_r * x_r - z * last,
        z * last,
        _inverse_sinh_ratio(y, x, z) - 2 * poisson * y_r - z / safe_r * y_r,
        -z / safe_r,
        -np.arctan2(x * y, z * r) + y * last,
    )


def axial_corner(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of the six stresses under unit shear traction along +x: those along +y with x and y exchanged.

    Examples
    --------
    >>> edge = np.array([-1.0, 1.0])
    >>> corner = axial_corner(edge[:, None], edge[None, :], 0.0, 0.3)
    >>> round(float(np.diff(np.diff(corner, axis=1), axis=2)[4, 0, 0]), 6)
    -1.0
    """
    return tangential_corner(y, x, z, poisson)[[1, 0, 2, 3, 5, 4]]


STRESS_CORNERS = {Load.NORMAL: normal_corner, Load.ALONG_X: axial_corner, Load.ALONG_Y: tangential_corner}
"""Corner functions of the six stresses, by the direction of the load."""
