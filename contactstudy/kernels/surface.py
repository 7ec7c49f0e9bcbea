"""Uniformly loaded rectangle on a half-space: the three displacements of the surface under a load in any direction.

Corner functions as in patch.py, of ``4 pi G u`` under a unit load, from the potentials of patch_displacement.py

    u_z[p] = 2 (1 - nu) V,              u_x[p] = -(1 - 2 nu) chi_x,          u_z[q_x] = (1 - 2 nu) chi_x,
    u_x[q_x] = 2 V + 2 nu Theta_xx,     u_y[q_x] = u_x[q_y] = 2 nu Theta_xy

and those with x and y exchanged (Cerruti's solution; K. L. Johnson, Contact Mechanics (1985), section 3.6).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.kernels.images import FAR_LIMIT, CornerFunction, cell_kernel, mirrored_kernel
from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.patch import TINY

LEAST_RATIO = TINY ** (1 / 5)
"""Least divisor of a ratio, so that the ratio is a number even where it does not matter."""


def _inverse_sinh(numerator: FloatArray, other: FloatArray) -> FloatArray:
    """``asinh(numerator / |other|)``, finite where the divisor vanishes (a corner's edge)."""
    return np.asarray(np.arcsinh(numerator / np.maximum(np.abs(other), LEAST_RATIO)))


def _newton(x: FloatArray, y: FloatArray) -> FloatArray:
    """Potential V, whose density is 1 / R."""
    return np.asarray(x * _inverse_sinh(y, x) + y * _inverse_sinh(x, y))


def _chi_x(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the derivative of chi along x, whose density is x / R**2."""
    log = 0.5 * np.log(np.maximum(x * x + y * y, TINY))
    return np.asarray(y * log + x * np.arctan2(y, np.abs(x)) * np.sign(x))


def _along(x: FloatArray, y: FloatArray, poisson: float) -> FloatArray:
    """Displacement along x of a traction along x."""
    return np.asarray(2 * _newton(x, y) - 2 * poisson * x * _inverse_sinh(y, x))


SurfaceCorner = Callable[[FloatArray, FloatArray, float], FloatArray]

P, X, Y = Load.NORMAL, Load.ALONG_X, Load.ALONG_Y

SURFACE_CORNERS: dict[Response, SurfaceCorner] = {
    Response(P, P): lambda x, y, nu: 2 * (1 - nu) * _newton(x, y),
    Response(P, X): lambda x, y, nu: (1 - 2 * nu) * _chi_x(x, y),
    Response(P, Y): lambda x, y, nu: (1 - 2 * nu) * _chi_x(y, x),
    Response(X, P): lambda x, y, nu: -(1 - 2 * nu) * _chi_x(x, y),
    Response(Y, P): lambda x, y, nu: -(1 - 2 * nu) * _chi_x(y, x),
    Response(X, X): _along,
    Response(Y, Y): lambda x, y, nu: _along(y, x, nu),
    Response(X, Y): lambda x, y, nu: -2 * nu * np.hypot(x, y),
    Response(Y, X): lambda x, y, nu: -2 * nu * np.hypot(x, y),
}
"""Corner functions of ``4 pi G u`` of the surface, by what is displaced and what is loaded."""


def row_level(response: Response, poisson: float, length: float, reference: float) -> float:
    """Return ``4 pi G u`` that a row of unit loads without end is relieved of, so that it is 0 at the reference.

    Beside a row of loads ``4 pi G u`` is ``2 (1 - nu) / r`` in their direction, and for a traction along y the term
    ``y**2 / r**3`` adds a constant. Images of a traction along x alternate in sign, so their row has no net load.

    Parameters
    ----------
    response : Response
        What is displaced and what is loaded.
    poisson : float
        Poisson's ratio.
    length : float
        Distance between the ends, of whose images there is one per two lengths, metres.
    reference : float
        Distance along y, metres.
    """
    row = 2 * (1 - poisson) * np.log(2 * FAR_LIMIT * length / reference)
    if response == Response(P, P):
        return float(-row / length)
    return float(-(row + 2 * poisson) / length) if response == Response(Y, Y) else 0.0


def surface_kernel(
    response: Response,
    poisson: float,
    x: FloatArray,
    y: FloatArray,
    cell: tuple[float, float],
    length: float,
    reference: float,
) -> FloatArray:
    """Displacement times ``4 pi G`` of the surface from a unit load on one cell, at uniform offsets: array (x, y).

    Parameters
    ----------
    response : Response
        What is displaced and what is loaded.
    poisson : float
        Poisson's ratio.
    x, y : array
        Offsets from cell to observer, metres.
    cell : tuple of float
        Cell size along x and y, metres.
    length : float
        Distance between two ends: the load has an image of the same sign at every ``2 length``; infinite for none.
    reference : float
        With images: distance along y at which the displacement is zero, metres.

    Examples
    --------
    >>> at = np.array([0.0])
    >>> sunk = surface_kernel(Response(P, P), 0.5, at, at, (1.0, 1.0), np.inf, np.inf)
    >>> round(float(sunk[0, 0]), 6)
    3.525494
    """

    def corner(along_x: FloatArray, along_y: FloatArray) -> FloatArray:
        return SURFACE_CORNERS[response](along_x, along_y, poisson)

    function: CornerFunction = corner
    if np.isinf(length):
        return cell_kernel(function, x, y, *cell)
    level = row_level(response, poisson, length, reference)
    return mirrored_kernel(function, x, y, *cell, length) + cell[0] * cell[1] * level
