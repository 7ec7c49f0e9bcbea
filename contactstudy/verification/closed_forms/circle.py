"""Hertz pressure on a circle, with and without sliding."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from contactstudy.checks import FloatArray
from contactstudy.verification.closed_forms.components import COMPONENTS, Stress
from contactstudy.verification.closed_forms.point_load import potential_stresses


def hertz_circle(
    x: ArrayLike,
    y: ArrayLike,
    z: ArrayLike,
    radius: float,
    max_pressure: float,
    poisson: float,
    friction: float = 0.0,
    nodes: int = 160,
) -> Stress:
    """Stresses under `p0 sqrt(1 - r^2/a^2)` and `q = f p` along `+y`: the problem of Hamilton (1983).

    Hamilton and Goodman's device: the potential of the Hertz pressure is that of point sources of strength
    `pi p0 (a^2 - t^2) / (2 a) dt` at the complex depths `-i t`, `-a < t < a`. Their explicit formulae are
    this integral; here it is done by Gauss quadrature on the half circle through `t = -i a`, on which nothing
    is singular (`z >= 0`, also on the surface and the axis) except close to the ring `r = a, z = 0`. Twelve
    digits and more away from there.
    """
    a = radius
    angle, weight = np.polynomial.legendre.leggauss(nodes)
    angle, weight = 0.5 * np.pi * (angle + 1), 0.5 * np.pi * weight
    t = -a * np.exp(1j * angle)
    source = np.pi * max_pressure / (2 * a) * (a**2 - t**2) * (1j * t) * weight
    xs, ys, zs = (np.asarray(c, dtype=float)[..., None] for c in np.broadcast_arrays(x, y, z))
    by_p, by_q = potential_stresses(xs, ys, zs, zs + 1j * t, poisson)
    return {c: np.asarray(((p + friction * q) @ source).real) for c, p, q in zip(COMPONENTS, by_p, by_q, strict=True)}


def hertz_circle_axis(
    z: ArrayLike, radius: float, max_pressure: float, poisson: float
) -> tuple[FloatArray, FloatArray]:
    """`sigma_zz` and `sigma_rr` below the centre of a frictionless Hertz circle (Johnson 3.45)."""
    depth = np.asarray(z, dtype=float) / radius
    decay = 1 / (1 + depth**2)
    return -max_pressure * decay, max_pressure * (0.5 * decay - (1 + poisson) * (1 - depth * np.arctan2(1.0, depth)))


def hertz_circle_surface(
    r: ArrayLike, radius: float, max_pressure: float, poisson: float
) -> tuple[FloatArray, FloatArray]:
    """`sigma_rr` and `sigma_tt` on the surface around a frictionless Hertz circle (Johnson 3.42, 3.43)."""
    s = np.asarray(r, dtype=float) / radius
    height = np.sqrt(np.clip(1 - s**2, 0, None))
    with np.errstate(divide="ignore", invalid="ignore"):
        term = np.where(s > 1e-4, (1 - height**3) / s**2, 1.5) * (1 - 2 * poisson) / 3
    return max_pressure * (term - height), max_pressure * (-term - 2 * poisson * height)


def sliding_circle_surface(x: ArrayLike, y: ArrayLike, radius: float, max_traction: float, poisson: float) -> Stress:
    """In-plane stresses on the surface inside the circle, from the traction `q` alone (Johnson section 7.1)."""
    scale = -np.pi * max_traction / (8 * radius)
    xs, ys = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    return {
        "sigma_yy": scale * (4 + poisson) * ys,
        "sigma_xx": scale * 3 * poisson * ys,
        "tau_xy": scale * (2 - poisson) * xs,
    }
