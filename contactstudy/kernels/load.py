"""Directions of a load on the top, and a uniformly loaded rectangle: stresses and displacements in closed form.

Every quantity is a second mixed difference, over the rectangle's corners, of a corner function of the offset
``(X, Y, z)`` from corner to observer. The corner functions follow from the Boussinesq and Cerruti potentials

    V = int int dA / r,   chi = int int ln(r + z) dA,   Theta = int int [z ln(r + z) - r] dA

(A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929); K. L. Johnson, Contact Mechanics (1985), section 3.2). Terms that
depend on one of X and Y alone cancel in the difference and are left out, which also avoids loss of digits. The
displacements are

    pressure p:        4 pi G u_x = -(1 - 2 nu) chi_x - z V_x,   4 pi G u_z = 2 (1 - nu) V - z V_z
    traction q on y:   4 pi G u_x = 2 nu Theta_xy - z chi_xy,    4 pi G u_y = 2 V + 2 nu Theta_yy - z chi_yy,
                       4 pi G u_z = (1 - 2 nu) chi_y - z V_y
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray


class Load(Enum):
    """Direction of a load on the top; sign_x, sign_y: 1 if a reflection along x, along y keeps the load, -1 if not."""

    NORMAL = (1, 1)  # pressure, positive into the body
    ALONG_X = (-1, 1)  # traction on the body along +x
    ALONG_Y = (1, -1)  # traction on the body along +y

    def __init__(self, sign_x: int, sign_y: int) -> None:
        self.sign_x = sign_x
        self.sign_y = sign_y


class Response(NamedTuple):
    """Displacement in one direction under a load in one direction."""

    displacement: Load  # direction of the displacement: the load in this direction does work on it
    load: Load

    @property
    def sign_x(self) -> int:
        """1 if the kernel is even along x, -1 if it is odd."""
        return self.displacement.sign_x * self.load.sign_x

    @property
    def sign_y(self) -> int:
        """1 if the kernel is even along y, -1 if it is odd."""
        return self.displacement.sign_y * self.load.sign_y


NORMAL_RESPONSE = Response(Load.NORMAL, Load.NORMAL)  # normal displacement of the top under a pressure

Corner = Callable[[FloatArray, FloatArray, FloatArray | float, float], FloatArray]

TINY = 1e-150  # least denominator, with a representable square, far below any offset in metres. Rounding.


def _inverse_sinh_ratio(numerator: FloatArray, square: FloatArray, r: FloatArray) -> FloatArray:
    """``asinh(numerator / sqrt(square))`` with ``r**2 = numerator**2 + square``; finite where `square` vanishes."""
    ratio = (np.abs(numerator) + r) * (1.0 / np.sqrt(np.maximum(square, TINY)))
    return np.copysign(np.log(np.maximum(ratio, 1.0)), numerator)


def _angle(opposite: FloatArray, adjacent: FloatArray) -> FloatArray:
    """Angle whose tangent is ``opposite / adjacent``, for `adjacent` not negative."""
    return np.arctan(opposite / np.maximum(adjacent, TINY))


def _stack_components(*components: FloatArray) -> FloatArray:
    """Components over ``2 pi`` as one array (component, ...)."""
    stacked = np.empty((len(components), *components[0].shape))
    for scaled_component, component in zip(stacked, components, strict=True):
        np.multiply(component, 1 / (2 * np.pi), out=scaled_component)
    return stacked


def normal_corner(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions (6, ...) of xx, yy, zz, xy, xz, yz; unit pressure has their second mixed difference."""
    # Factors that depend on two variables are small arrays; factors of all three take most of the time.
    xx, yy, zz, xy = x * x, y * y, np.square(z), x * y
    squares = xx + yy
    r = np.sqrt(squares + zz)
    r_z, inverse_r = r + z, 1.0 / np.maximum(r, TINY)
    along_x, along_y = z / np.maximum(xx + zz, TINY), z / np.maximum(yy + zz, TINY)
    angle = np.arctan(xy * (1.0 / np.maximum(z, TINY)) * inverse_r)
    chi_xx = _angle(xy * squares, r_z * (r * xx + z * yy))
    xy_r = xy * inverse_r
    term_x, term_y = xy_r * along_x, xy_r * along_y
    compressibility, lateral_term = 1 - 2 * poisson, 2 * poisson * angle
    return _stack_components(
        term_x - lateral_term - compressibility * chi_xx,
        term_y - lateral_term - compressibility * (angle - chi_xx),
        -(angle + term_x + term_y),
        -compressibility * np.log(np.maximum(r_z, TINY)) - z * inverse_r,
        z * along_x * y * inverse_r,
        z * along_y * x * inverse_r,
    )


def tangential_corner(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of the six stresses under unit shear traction along +y; otherwise as :func:`normal_corner`."""
    xx, yy, zz = x * x, y * y, np.square(z)
    r = np.sqrt(xx + yy + zz)
    inverse_r, inverse_r_z = 1.0 / np.maximum(r, TINY), 1.0 / np.maximum(r + z, TINY)
    v_y, z_r = _inverse_sinh_ratio(x, yy + zz, r), z * inverse_r
    term = (x / np.maximum(yy + zz, TINY)) * z_r
    factor, z_term = (2 * poisson + z_r) * inverse_r_z, z * term
    x_factor = x * factor
    return _stack_components(
        2 * poisson * v_y - x_factor,
        2 * v_y + x_factor - z_term,
        z_term,
        _inverse_sinh_ratio(y, xx + zz, r) - y * factor,
        -z_r,
        y * term - np.arctan(x * y * (1.0 / np.maximum(z, TINY)) * inverse_r),
    )


class _Potentials:
    """Corner functions of the potentials' derivatives at offsets ``(X, Y, z)``."""

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray | float) -> None:
        xx, yy, zz = x * x, y * y, np.square(z)
        r = np.sqrt(xx + yy + zz)
        xy = x * y
        self.r, self.z = r, z
        self.log = np.log(np.maximum(r + z, TINY))
        self.asinh_x = _inverse_sinh_ratio(x, yy + zz, r)
        self.asinh_y = _inverse_sinh_ratio(y, xx + zz, r)
        self.v_z = -_angle(xy, z * r)
        self.chi_xx = _angle(xy * (r - z), x * x * r + y * y * z)
        self.chi_yy = _angle(xy * (r - z), y * y * r + x * x * z)
        self.v = x * self.asinh_y + y * self.asinh_x + z * self.v_z
        self.chi_x = y * self.log + z * self.asinh_y + x * self.chi_xx
        self.chi_y = x * self.log + z * self.asinh_x + y * self.chi_yy
        self.theta_yy = -y * self.asinh_x + z * self.chi_yy


def normal_displacement_inside(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of ``4 pi G (u_x, u_y, u_z)`` under unit pressure: array (3, ...)."""
    potentials = _Potentials(x, y, z)
    compressibility = 1 - 2 * poisson
    return np.stack(
        [
            -compressibility * potentials.chi_x - z * potentials.asinh_y,
            -compressibility * potentials.chi_y - z * potentials.asinh_x,
            2 * (1 - poisson) * potentials.v - z * potentials.v_z,
        ]
    )


def tangential_displacement_inside(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
    """Corner functions of ``4 pi G (u_x, u_y, u_z)`` under unit shear traction along +y; otherwise as for pressure."""
    potentials = _Potentials(x, y, z)
    return np.stack(
        [
            2 * poisson * (z * potentials.log - potentials.r) - z * potentials.log,
            2 * potentials.v + 2 * poisson * potentials.theta_yy - z * potentials.chi_yy,
            (1 - 2 * poisson) * potentials.chi_y - z * potentials.asinh_x,
        ]
    )


def _corners(normal: Corner, tangential: Corner, exchanged_order: list[int]) -> dict[Load, Corner]:
    """Corner functions by the direction of the load; along +x they are the functions of +y with x and y exchanged."""

    def axial(x: FloatArray, y: FloatArray, z: FloatArray | float, poisson: float) -> FloatArray:
        return tangential(y, x, z, poisson)[exchanged_order]

    return {Load.NORMAL: normal, Load.ALONG_X: axial, Load.ALONG_Y: tangential}


STRESS_CORNERS = _corners(normal_corner, tangential_corner, [1, 0, 2, 3, 5, 4])
DISPLACEMENT_CORNERS = _corners(normal_displacement_inside, tangential_displacement_inside, [1, 0, 2])
