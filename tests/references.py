"""Closed-form contact solutions that share nothing with the solver.

Sources, by the names used below:

* Johnson, *Contact Mechanics* (1985): sections 3.2 (potentials of a loaded half-space), 3.4 (Hertz pressure
  on a circle), 4.2 (line contact), appendix 3;
* Hamilton and Goodman, *J. Appl. Mech.* 33 (1966) 371; Hamilton, *Proc. IMechE* 197C (1983) 53: circular
  sliding contact;
* McEwen, *Phil. Mag.* 48 (1949) 454 and Smith and Liu, *J. Appl. Mech.* 20 (1953) 157: sliding line contact.

Axes and signs are the package's: `z` into the body, stress positive in tension, pressure positive in
compression, traction `q = f p` drags the body's surface along `+y`. Stresses are returned as a dictionary
with the keys of `COMPONENTS`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Stress = dict[str, Array]

COMPONENTS = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xy", "tau_xz", "tau_yz")


def von_mises(stress: Mapping[str, Array]) -> Array:
    """Equivalent stress of von Mises."""
    xx, yy, zz, xy, xz, yz = (np.asarray(stress[name]) for name in COMPONENTS)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3 * (xy**2 + xz**2 + yz**2))


# ---------------------------------------------------------------------------------------------- Hertz, dimensions


def composite_modulus(young: float, poisson: float, young_2: float = np.inf, poisson_2: float = 0.0) -> float:
    """`E*` of two bodies; the second one is rigid unless given."""
    return 1 / ((1 - poisson**2) / young + (1 - poisson_2**2) / young_2)


def hertz_point(load: float, radius: float, modulus: float) -> tuple[float, float, float]:
    """Contact radius, peak pressure and approach of a sphere (Johnson 4.22 to 4.24); `modulus` is `E*`."""
    a = float(np.cbrt(0.75 * load * radius / modulus))
    return a, 1.5 * load / (np.pi * a**2), a**2 / radius


def hertz_line(load_per_length: float, radius: float, modulus: float) -> tuple[float, float]:
    """Half-width and peak pressure of a line contact (Johnson 4.43, 4.45)."""
    a = float(np.sqrt(4 * load_per_length * radius / (np.pi * modulus)))
    return a, 2 * load_per_length / (np.pi * a)


def hertz_line_from_pressure(max_pressure: float, radius: float, modulus: float) -> tuple[float, float]:
    """Half-width and load per length of the line contact that has this peak pressure."""
    a = 2 * max_pressure * radius / modulus
    return a, 0.5 * np.pi * a * max_pressure


# ------------------------------------------------------------------------------------- half-space, concentrated loads


def _potential_stresses(
    x: NDArray[np.inexact], y: NDArray[np.inexact], z: NDArray[np.inexact], zeta: NDArray[np.inexact], nu: float
) -> tuple[list[NDArray[np.inexact]], list[NDArray[np.inexact]]]:
    """Stresses of a unit normal and a unit tangential (along y) load, from the potentials of Johnson, section 3.2.

    With `rho^2 = x^2 + y^2 + zeta^2` the potentials are `V = 1/rho`, `L = ln(rho + zeta)` and
    `W = zeta L - rho`. They are harmonic in `(x, y, zeta)`, while the depth `z` that multiplies them stays apart:
    for a real source `zeta = z`. Derivatives across the axis follow from those by `s = x^2 + y^2`:
    `f_xy = 4 x y f''` and so on.
    """
    rho = np.sqrt(x**2 + y**2 + zeta**2)
    d = rho + zeta
    l1, l2 = 1 / (2 * rho * d), -(2 * rho + zeta) / (4 * rho**3 * d**2)
    l3 = (2 - (2 * rho + zeta) * (3 / rho + 2 / d)) / (-8 * rho**4 * d**2)
    w2, w3 = 1 / (4 * rho * d**2), -(3 * rho + zeta) / (8 * rho**3 * d**3)
    v1, v2 = -1 / (2 * rho**3), 3 / (4 * rho**5)
    v_z, v_zz = -zeta / rho**3, 3 * zeta**2 / rho**5 - 1 / rho**3
    v_xz, v_yz, v_xy = 3 * x * zeta / rho**5, 3 * y * zeta / rho**5, 4 * x * y * v2
    v_xx, v_yy = 2 * v1 + 4 * x**2 * v2, 2 * v1 + 4 * y**2 * v2
    l_xx, l_yy, l_xy = 2 * l1 + 4 * x**2 * l2, 2 * l1 + 4 * y**2 * l2, 4 * x * y * l2
    normal = [
        -(1 - 2 * nu) * l_xx - z * v_xx + 2 * nu * v_z,
        -(1 - 2 * nu) * l_yy - z * v_yy + 2 * nu * v_z,
        v_z - z * v_zz,
        -(1 - 2 * nu) * l_xy - z * v_xy,
        -z * v_xz,
        -z * v_yz,
    ]

    def third(f2: NDArray[np.inexact], f3: NDArray[np.inexact]) -> tuple[NDArray[np.inexact], ...]:
        return 4 * y * f2 + 8 * x**2 * y * f3, 12 * y * f2 + 8 * y**3 * f3, 4 * x * f2 + 8 * x * y**2 * f3

    (l_xxy, l_yyy, l_xyy), (w_xxy, w_yyy, w_xyy) = third(l2, l3), third(w2, w3)
    tangential = [
        2 * nu * w_xxy - z * l_xxy + 4 * nu * y * v1,
        2 * nu * w_yyy - z * l_yyy + 4 * (1 + nu) * y * v1,
        -z * v_yz,
        2 * x * v1 + 2 * nu * w_xyy - z * l_xyy,
        -z * v_xy,
        v_z - z * v_yy,
    ]
    return [f / (2 * np.pi) for f in normal], [f / (2 * np.pi) for f in tangential]


def point_load(
    x: ArrayLike, y: ArrayLike, z: ArrayLike, poisson: float, normal: float = 1.0, tangential: float = 0.0
) -> Stress:
    """Stresses under a point load on a half-space: Boussinesq (`normal`) and Cerruti (`tangential`, along y)."""
    xs, ys, zs = (np.asarray(c, dtype=float) for c in np.broadcast_arrays(x, y, z))
    by_p, by_q = _potential_stresses(xs, ys, zs, zs, poisson)
    return {c: np.asarray(normal * p + tangential * q) for c, p, q in zip(COMPONENTS, by_p, by_q, strict=True)}


# ------------------------------------------------------------------------------------------ half-space, Hertz circle


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
    by_p, by_q = _potential_stresses(xs, ys, zs, zs + 1j * t, poisson)
    return {c: np.asarray(((p + friction * q) @ source).real) for c, p, q in zip(COMPONENTS, by_p, by_q, strict=True)}


def hertz_circle_axis(z: ArrayLike, radius: float, max_pressure: float, poisson: float) -> tuple[Array, Array]:
    """`sigma_zz` and `sigma_rr` below the centre of a frictionless Hertz circle (Johnson 3.45)."""
    depth = np.asarray(z, dtype=float) / radius
    decay = 1 / (1 + depth**2)
    return -max_pressure * decay, max_pressure * (0.5 * decay - (1 + poisson) * (1 - depth * np.arctan2(1.0, depth)))


def hertz_circle_surface(r: ArrayLike, radius: float, max_pressure: float, poisson: float) -> tuple[Array, Array]:
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


# --------------------------------------------------------------------------------------------- line contact


def hertz_strip(
    y: ArrayLike, z: ArrayLike, half_width: float, max_pressure: float, poisson: float, friction: float = 0.0
) -> Stress:
    """Plane-strain stresses under `p0 sqrt(1 - y^2/a^2)` and `q = f p` along `+y` (McEwen 1949; Smith and Liu 1953).

    Written with the function `w = sqrt(a^2 - (y + i z)^2) = m - i n`, which holds McEwen's `m` and `n`.
    """
    a, p0 = half_width, max_pressure
    ys, zs = (np.asarray(c, dtype=float) for c in np.broadcast_arrays(y, z))
    inner = a**2 - ys**2 + zs**2
    size = np.hypot(inner, 2 * ys * zs)
    m = np.sqrt(np.clip(0.5 * (size + inner), 0, None))
    n = np.copysign(np.sqrt(np.clip(0.5 * (size - inner), 0, None)), ys)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(size > 0, (zs**2 + n**2) / size, 1.0)
        cross = np.where(size > 0, (m**2 - zs**2) / size, 0.0)
    p_yy, p_zz, p_yz = -(m * (1 + ratio) - 2 * zs), -m * (1 - ratio), -n * cross
    q_yy, q_zz, q_yz = n * (2 + cross) - 2 * ys, p_yz, p_yy
    yy, zz, yz = (p0 / a * (p + friction * q) for p, q in ((p_yy, q_yy), (p_zz, q_zz), (p_yz, q_yz)))
    zero = np.zeros_like(yy)
    return dict(zip(COMPONENTS, (poisson * (yy + zz), yy, zz, zero, zero.copy(), yz), strict=True))
