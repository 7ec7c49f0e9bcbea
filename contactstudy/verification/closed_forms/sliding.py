"""Sliding line contact of two elastic bodies whose materials differ: friction moves it off the centre."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contactstudy.bodies.material import Material


class SlidingLine(NamedTuple):
    """Line contact with friction coupled into its geometry.

    Attributes
    ----------
    half_width : float
        Half-width of the contact, metres.
    centre : float
        Position y of its middle, metres.
    exponent : float
        ``gamma``, by which the exponents of the pressure at the two edges differ from 1/2.
    peak_scale : float
        ``E* cos(pi gamma) / (2 R)``, Pa per metre.
    """

    half_width: float
    centre: float
    exponent: float
    peak_scale: float

    def pressure(self, y: ArrayLike) -> NDArray[np.float64]:
        """Pressure at `y`, Pa."""
        along = np.clip((np.asarray(y, dtype=float) - self.centre) / self.half_width, -1.0, 1.0)
        shape = (1 + along) ** (0.5 + self.exponent) * (1 - along) ** (0.5 - self.exponent)
        return np.asarray(self.peak_scale * self.half_width * shape)


def sliding_line(
    load_per_length: float, radius: float, friction: float, first: Material, second: Material | None = None
) -> SlidingLine:
    """Cylinder that slides on a plane, in plane strain, with the displacement from friction (Bufler 1959; Johnson 7.2).

    Where the bodies touch their slopes add up to

        (2 / (pi E*)) PV int p(s) / (s - y) ds + (2 / E*) f beta p(y) = -y / R,

    with Dundurs' ``beta = [(1 - 2 nu1) / G1 - (1 - 2 nu2) / G2] / 2 / [(1 - nu1) / G1 + (1 - nu2) / G2]``. The
    function ``(c + t)**(1/2 + gamma) (c - t)**(1/2 - gamma)`` of ``t = y - centre`` solves it for
    ``tan(pi gamma) = -f beta`` and ``centre = 2 gamma c``; the load is ``pi E* c**2 (1/4 - gamma**2) / R``.

    Parameters
    ----------
    load_per_length : float
        Normal load per length, N/m.
    radius : float
        Radius of the cylinder, metres.
    friction : float
        Coefficient ``f``: the traction on the first body is ``f p`` along +y.
    first : Material
        The plane.
    second : Material, optional
        The cylinder; default: it is rigid.

    Returns
    -------
    SlidingLine

    Examples
    --------
    >>> equal = sliding_line(1.0, 1.0, 0.5, Material(1.0, 0.3), Material(1.0, 0.3))
    >>> equal.centre == 0.0
    True
    """
    bodies = [first] if second is None else [first, second]
    shear = [(1 - 2 * each.poisson) / each.shear_modulus for each in bodies]
    normal = sum((1 - each.poisson) / each.shear_modulus for each in bodies)
    beta = (shear[0] - (shear[1] if second is not None else 0.0)) / (2 * normal)
    modulus = 2 / normal
    gamma = float(-np.arctan(friction * beta) / np.pi)
    half_width = float(np.sqrt(load_per_length * radius / (np.pi * modulus * (0.25 - gamma**2))))
    return SlidingLine(half_width, 2 * gamma * half_width, gamma, float(modulus * np.cos(np.pi * gamma) / (2 * radius)))
