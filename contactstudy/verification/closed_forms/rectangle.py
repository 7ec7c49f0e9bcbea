"""Uniform pressure on a rectangle of a half-space: Love's problem."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from contactstudy.checks import FloatArray
from contactstudy.verification.closed_forms.components import COMPONENTS, Stress
from contactstudy.verification.closed_forms.point_load import point_load


def rectangle_displacement(x: ArrayLike, y: ArrayLike, half_x: float, half_y: float, modulus: float) -> FloatArray:
    """Return the normal displacement of the surface under a unit pressure (Johnson 3.25).

    The pressure covers ``|x| < half_x``, ``|y| < half_y``.

    Each of the four corners gives ``u ln(v + r) + v ln(u + r)`` with its distances `u`, `v` and ``r = hypot(u, v)``,
    over ``pi E*``; `modulus` is ``E*``. Not on the lines through an edge.

    Examples
    --------
    >>> round(float(rectangle_displacement(0.0, 0.0, 1.0, 1.0, 1.0)), 3)  # 8 ln(1 + sqrt(2)) / pi
    2.244
    """
    xs, ys = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    total = np.zeros(xs.shape)
    for side_x in (-1, 1):
        for side_y in (-1, 1):
            u, v = side_x * xs + half_x, side_y * ys + half_y
            # ln(v + r) by asinh, which does not cancel for negative v; the rest, ln |u|, goes out with its opposite.
            total += u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v))
    return np.asarray(total / (np.pi * modulus))


def below_rectangle_corner(z: ArrayLike, side_x: float, side_y: float) -> FloatArray:
    """`sigma_zz` below the corner of a rectangle under a unit pressure (Love 1929; Newmark 1935; Steinbrenner 1934).

    Examples
    --------
    >>> round(float(below_rectangle_corner(1.0, 1.0, 1.0)), 4)
    -0.1752
    """
    zs, a, b = np.asarray(z, dtype=float), side_x, side_y
    r = np.sqrt(a**2 + b**2 + zs**2)
    shear = a * b * zs / r * (1 / (a**2 + zs**2) + 1 / (b**2 + zs**2))
    return np.asarray(-(np.arctan2(a * b, zs * r) + shear) / (2 * np.pi))


def rectangle(
    x: ArrayLike,
    y: ArrayLike,
    z: ArrayLike,
    half_x: float,
    half_y: float,
    poisson: float,
    friction: float = 0.0,
    nodes: int = 64,
) -> Stress:
    """Stresses below a unit pressure and `friction` times it along +y: point loads, summed by Gauss quadrature.

    Accurate from depths of about ten times ``half / nodes`` on.
    """
    node, weight = np.polynomial.legendre.leggauss(nodes)
    xs, ys, zs = (np.asarray(c, dtype=float)[..., None, None] for c in np.broadcast_arrays(x, y, z))
    loads = half_x * half_y * np.multiply.outer(weight, weight)
    stress = point_load(xs - half_x * node[:, None], ys - half_y * node, zs, poisson, 1.0, friction)
    return {name: np.asarray((stress[name] * loads).sum(axis=(-2, -1))) for name in COMPONENTS}
