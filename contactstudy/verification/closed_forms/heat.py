"""Temperatures under heat sources that move over a half-space, or rest on it: Blok, Jaeger, Carslaw and Jaeger."""

from __future__ import annotations

import numpy as np
from scipy import integrate, optimize, special

from contactstudy.checks import FloatArray


def moving_band(y: FloatArray, drift: float) -> FloatArray:
    """Rise of the surface under a uniform band ``|y| < 1`` past which it moves along +y, times ``lambda / q``.

    Jaeger (1942): the integral of ``exp(v (y - y')) K0(v |y - y'|) / pi`` over the band, ``v = V a / (2 kappa)``.

    Examples
    --------
    >>> bool(moving_band(np.array([0.9]), 5.0) > moving_band(np.array([-0.9]), 5.0))
    True
    """
    far = drift * (np.asarray(y, dtype=np.float64) + 1)
    near = far - 2 * drift
    return np.asarray((_primitive(far) - _primitive(near)) / (np.pi * drift))


def _primitive(u: FloatArray) -> FloatArray:
    """Primitive of ``exp(u) K0(|u|)``, zero at 0."""
    size = np.maximum(np.abs(u), np.finfo(np.float64).tiny)
    return np.asarray(u * (special.k0e(size) + np.sign(u) * special.k1e(size)) * np.exp(u - np.abs(u)))


def fast_line() -> tuple[float, float]:
    """Largest rise of a fast surface under Hertz' pressure on a line, and how far behind the middle, over a.

    The rise is over ``q0 sqrt(kappa a / (pi V)) / lambda``: heat flows into the depth only (Blok 1937, Jaeger 1942).

    Examples
    --------
    >>> [round(value, 4) for value in fast_line()]
    [2.1883, 0.6522]
    """

    def rise(behind: float) -> float:
        # s = behind - t**2 takes the root away
        inside = integrate.quad(lambda t: 2 * np.sqrt(max(1 - (behind - t**2) ** 2, 0.0)), 0.0, np.sqrt(1 + behind))
        return float(inside[0])

    found = optimize.minimize_scalar(lambda behind: -rise(behind), bounds=(0.3, 0.95), method="bounded")
    return -float(found.fun), float(found.x)


def resting_square() -> float:
    """Rise in the middle of uniform heat on a square of side 2, times ``lambda / q`` (Carslaw and Jaeger 10.5).

    Examples
    --------
    >>> round(resting_square(), 4)
    1.1222
    """
    return 4 * float(np.arcsinh(1.0)) / np.pi


def resting_hertz_circle() -> float:
    """Rise in the middle of heat ``q sqrt(1 - r**2)`` on a circle of radius 1, times ``lambda / q``.

    Examples
    --------
    >>> round(resting_hertz_circle(), 4)
    0.7854
    """
    return 0.25 * np.pi
