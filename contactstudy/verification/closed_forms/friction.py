"""Stick and slip in closed form: a sphere that is shifted, and like cylinders in steady rolling."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray


def carter_force(stick: float) -> float:
    """Force over that of full sliding, from the stick zone's part of the contact (Johnson 8.46).

    Examples
    --------
    >>> round(carter_force(0.6), 12)
    0.64
    """
    return 1 - stick**2


def carter_traction(y: FloatArray, stick: float) -> FloatArray:
    """Traction over ``f p0`` at distances from the middle over the half-width, rolling along +y (Johnson 8.45).

    Examples
    --------
    >>> carter_traction(np.array([-1.0, 0.0, 1.0]), 0.5).round(6).tolist()
    [0.0, 1.0, 0.0]
    """
    middle = 1 - stick
    sliding = np.sqrt(np.maximum(1 - y**2, 0))
    return np.asarray(sliding - stick * np.sqrt(np.maximum(1 - ((y - middle) / stick) ** 2, 0)))


def carter_creepage(stick: float, friction: float, half_width: float, radius: float) -> float:
    """Longitudinal creepage that leaves this part of the contact sticking; `radius` is the pair's (Johnson 8.44)."""
    return friction * half_width * (1 - stick) / radius


def mindlin_shift(part: float, load: float, friction: float, radius: float, shear: float, poisson: float) -> float:
    """Shift of two like spheres under a part of full sliding's force (Mindlin; Johnson 7.42).

    Parameters
    ----------
    part : float
        Tangential force over ``f`` times the load.
    load, friction : float
        Load, N, and coefficient of friction.
    radius : float
        Of the contact, metres.
    shear, poisson : float
        Shear modulus, Pa, and Poisson's ratio of both.

    Examples
    --------
    >>> round(1e6 * mindlin_shift(0.875, 9.1954, 0.4, 1e-3, 200e6, 0.42), 4)
    8.1724
    """
    full = 3 * friction * load / (16 * radius) * 2 * (2 - poisson) / shear
    return float(full * (1 - (1 - part) ** (2 / 3)))


def mindlin_stick(part: float) -> float:
    """Radius of the stick zone over the contact's (Johnson 7.40).

    Examples
    --------
    >>> mindlin_stick(0.875)
    0.5
    """
    return float(np.cbrt(1 - part))
