"""Closed-form contact solutions that share nothing with the solver.

Sources, by the names used in the docstrings:

* Johnson, *Contact Mechanics* (1985): sections 3.2 (potentials of a loaded half-space), 3.3 (uniform pressure on a
  rectangle), 3.4 (Hertz pressure on a circle), 4.2 (line and elliptic contact), appendix 3;
* Love, *Phil. Trans. R. Soc. A* 228 (1929) 377: uniform pressure on a rectangle;
* Hamilton and Goodman, *J. Appl. Mech.* 33 (1966) 371; Hamilton, *Proc. IMechE* 197C (1983) 53: circular sliding
  contact;
* McEwen, *Phil. Mag.* 40 (1949) 454 and Smith and Liu, *J. Appl. Mech.* 20 (1953) 157: sliding line contact;
* Carter, *Proc. R. Soc. Lond.* A 112 (1926) 151 and Mindlin, *J. Appl. Mech.* 16 (1949) 259: stick and slip in rolling
  and shifting contact, by Johnson, sections 7.2 and 8.3;
* Blok, *Proc. IMechE General Discussion on Lubrication* 2 (1937) 222, Jaeger, *Proc. R. Soc. N.S.W.* 76 (1942) 203, and
  Carslaw and Jaeger, *Conduction of Heat in Solids* (1959): moving and resting sources of heat;
* Eshelby, *Proc. R. Soc.* A 241 (1957) 376 and Muskhelishvili, *Some Basic Problems of the Mathematical Theory of
  Elasticity*, chapter 19: eigenstrain in a half-plane;

Names and formulas repeat the package's on purpose: a reference must not call the code under test. Axes and signs are
the package's: `z` into the body, stress positive in tension, pressure positive in compression,
traction ``q = f p`` drags the body's surface along ``+y``. Stresses are dictionaries with the keys `COMPONENTS`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import integrate, optimize, special

from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

Values = NDArray[np.inexact]  # Real or complex numbers
Stress = dict[str, FloatArray]
COMPONENTS = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xy", "tau_xz", "tau_yz")  # Keys of a stress


def hertz_point(load: float, radius: float, modulus: float) -> tuple[float, float, float]:
    """Contact radius, peak pressure and approach of a sphere (Johnson 4.22 to 4.24); `modulus` is `E*`."""
    a = float(np.cbrt(0.75 * load * radius / modulus))
    return a, 1.5 * load / (np.pi * a**2), a**2 / radius


def hertz_line(load_per_length: float, radius: float, modulus: float) -> tuple[float, float]:
    """Half-width and peak pressure of a line contact (Johnson 4.43, 4.45)."""
    a = float(np.sqrt(4 * load_per_length * radius / (np.pi * modulus)))
    return a, 2 * load_per_length / (np.pi * a)


class EllipticContact(NamedTuple):
    """Semi-axes, peak pressure and approach of an elliptic contact."""

    long: float
    short: float
    max_pressure: float
    approach: float


def hertz_ellipse(load: float, long_radius: float, short_radius: float, modulus: float) -> EllipticContact:
    """Elliptic contact of a body with two radii of curvature and a plane (Johnson 4.26 to 4.32).

    With ``e`` the eccentricity of the ellipse and the complete elliptic integrals ``K`` and ``E`` of ``e**2`` the ratio
    of the curvatures is ``[E / (1 - e**2) - K] / (K - E)``; the ellipse's long axis lies along the long radius.
    """
    if not long_radius >= short_radius:
        raise InvalidInputError("long_radius", long_radius, f"at least short_radius, {short_radius:g}", "exchange them")
    if np.isclose(long_radius, short_radius, rtol=1e-9):
        a, peak, approach = hertz_point(load, long_radius, modulus)
        return EllipticContact(a, a, peak, approach)

    def radius_ratio(e_squared: float) -> float:
        k, e = special.ellipk(e_squared), special.ellipe(e_squared)
        return float((e / (1 - e_squared) - k) / (k - e))

    e_squared = optimize.brentq(lambda m: radius_ratio(m) - long_radius / short_radius, 1e-9, 1 - 1e-12, xtol=1e-15)
    k, e = special.ellipk(e_squared), special.ellipe(e_squared)
    # Curvature along the long axis: 1 / (2 R') = p0 b / (E* e**2 a**2) (K - E).
    axis_ratio = np.sqrt(1 - e_squared)
    long_axis = float(np.cbrt(3 * load * long_radius * (k - e) / (np.pi * modulus * e_squared)))
    short_axis = float(axis_ratio * long_axis)
    peak = 1.5 * load / (np.pi * long_axis * short_axis)
    return EllipticContact(long_axis, short_axis, float(peak), float(peak * short_axis * k / modulus))


def carter_traction(y: FloatArray, stick_width: float) -> FloatArray:
    """Traction over ``f p0`` at distances from the middle over the half-width, rolling along +y (Johnson 8.45)."""
    stick_centre = 1 - stick_width
    sliding = np.sqrt(np.maximum(1 - y**2, 0))
    return np.asarray(sliding - stick_width * np.sqrt(np.maximum(1 - ((y - stick_centre) / stick_width) ** 2, 0)))


def mindlin_shift(fraction: float, load: float, friction: float, radius: float, shear: float, poisson: float) -> float:
    """Shift of two like spheres under a `fraction` of the force of full sliding (Mindlin; Johnson 7.42)."""
    gross_slip_shift = 3 * friction * load / (16 * radius) * 2 * (2 - poisson) / shear
    return float(gross_slip_shift * (1 - (1 - fraction) ** (2 / 3)))


def von_mises(stress: Mapping[str, FloatArray]) -> FloatArray:
    """Equivalent stress of von Mises."""
    xx, yy, zz, xy, xz, yz = (np.asarray(stress[name]) for name in COMPONENTS)
    normal_squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * normal_squares + 3 * (xy**2 + xz**2 + yz**2)))


def potential_stresses(x: Values, y: Values, z: Values, zeta: Values, nu: float) -> tuple[list[Values], list[Values]]:
    """Stresses of a unit normal and a unit tangential (along y) load, from the potentials of Johnson, section 3.2.

    With `rho^2 = x^2 + y^2 + zeta^2` the potentials are `V = 1/rho`, `L = ln(rho + zeta)` and `W = zeta L - rho`; for a
    real source `zeta = z`. Derivatives along x and y follow from derivatives by `s = x^2 + y^2`: `f_xy = 4 x y f''`.
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

    def third_derivatives(f2: Values, f3: Values) -> tuple[Values, ...]:
        return 4 * y * f2 + 8 * x**2 * y * f3, 12 * y * f2 + 8 * y**3 * f3, 4 * x * f2 + 8 * x * y**2 * f3

    (l_xxy, l_yyy, l_xyy), (w_xxy, w_yyy, w_xyy) = third_derivatives(l2, l3), third_derivatives(w2, w3)
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
    xs, ys, zs = (np.asarray(component, dtype=float) for component in np.broadcast_arrays(x, y, z))
    unit_p, unit_q = potential_stresses(xs, ys, zs, zs, poisson)
    return {
        component: np.asarray(normal * p + tangential * q)
        for component, p, q in zip(COMPONENTS, unit_p, unit_q, strict=True)
    }


def rectangle_displacement(x: ArrayLike, y: ArrayLike, half_x: float, half_y: float, modulus: float) -> FloatArray:
    """Return the surface's displacement under a unit pressure on ``|x| < half_x``, ``|y| < half_y`` (Johnson 3.25).

    Each of the four corners gives ``u ln(v + r) + v ln(u + r)``, with the corner's distances `u`, `v` and
    ``r = hypot(u, v)``, over ``pi E*``; `modulus` is ``E*``. The formula fails on the lines through an edge.
    """
    xs, ys = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    displacement = np.zeros(xs.shape)
    for side_x in (-1, 1):
        for side_y in (-1, 1):
            u, v = side_x * xs + half_x, side_y * ys + half_y
            # asinh(v / |u|) replaces ln(v + r), without cancellation for v < 0; the sum of the terms ln |u| is zero.
            displacement += u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v))
    return np.asarray(displacement / (np.pi * modulus))


def below_rectangle_corner(z: ArrayLike, side_x: float, side_y: float) -> FloatArray:
    """`sigma_zz` below the corner of a rectangle under a unit pressure (Love 1929; Newmark 1935; Steinbrenner 1934)."""
    zs, a, b = np.asarray(z, dtype=float), side_x, side_y
    r = np.sqrt(a**2 + b**2 + zs**2)
    shear = a * b * zs / r * (1 / (a**2 + zs**2) + 1 / (b**2 + zs**2))
    return np.asarray(-(np.arctan2(a * b, zs * r) + shear) / (2 * np.pi))


def rectangle(
    x: ArrayLike, y: ArrayLike, z: ArrayLike, half_x: float, half_y: float, poisson: float, friction: float
) -> Stress:
    """Stresses below a unit pressure and `friction` times it along +y: Gauss quadrature of point loads."""
    # The quadrature is accurate at depths above about a sixth of the half-widths.
    node, weight = np.polynomial.legendre.leggauss(64)
    xs, ys, zs = (np.asarray(c, dtype=float)[..., None, None] for c in np.broadcast_arrays(x, y, z))
    loads = half_x * half_y * np.multiply.outer(weight, weight)
    stress = point_load(xs - half_x * node[:, None], ys - half_y * node, zs, poisson, 1.0, tangential=friction)
    return {name: np.asarray((stress[name] * loads).sum(axis=(-2, -1))) for name in COMPONENTS}


def hertz_circle(
    x: ArrayLike, y: ArrayLike, z: ArrayLike, radius: float, max_pressure: float, poisson: float, friction: float = 0.0
) -> Stress:
    """Stresses under `p0 sqrt(1 - r^2/a^2)` and `q = f p` along `+y`: the problem of Hamilton (1983).

    Hamilton and Goodman's device: the Hertz pressure has the potential of point sources of strength
    `pi p0 (a^2 - t^2) / (2 a) dt` at the complex depths `-i t`, `-a < t < a`. Gauss quadrature on the half circle
    through `t = -i a` gives twelve digits and more except close to the ring `r = a, z = 0`.
    """
    a = radius
    angle, weight = np.polynomial.legendre.leggauss(160)
    angle, weight = 0.5 * np.pi * (angle + 1), 0.5 * np.pi * weight
    t = -a * np.exp(1j * angle)
    source = np.pi * max_pressure / (2 * a) * (a**2 - t**2) * (1j * t) * weight
    xs, ys, zs = (np.asarray(component, dtype=float)[..., None] for component in np.broadcast_arrays(x, y, z))
    unit_p, unit_q = potential_stresses(xs, ys, zs, zs + 1j * t, poisson)
    return {
        component: np.asarray(((p + friction * q) @ source).real)
        for component, p, q in zip(COMPONENTS, unit_p, unit_q, strict=True)
    }


def hertz_circle_axis(
    z: ArrayLike, radius: float, max_pressure: float, poisson: float
) -> tuple[FloatArray, FloatArray]:
    """`sigma_zz` and `sigma_rr` below the centre of a frictionless Hertz circle (Johnson 3.45)."""
    depth = np.asarray(z, dtype=float) / radius
    decay = 1 / (1 + depth**2)
    return -max_pressure * decay, max_pressure * (0.5 * decay - (1 + poisson) * (1 - depth * np.arctan2(1.0, depth)))


def hertz_strip(
    y: ArrayLike, z: ArrayLike, half_width: float, max_pressure: float, poisson: float, friction: float = 0.0
) -> Stress:
    """Plane-strain stresses under `p0 sqrt(1 - y^2/a^2)` and `q = f p` along `+y` (McEwen 1949; Smith and Liu 1953).

    The formulas use the function `w = sqrt(a^2 - (y + i z)^2) = m - i n` with McEwen's `m` and `n`.
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


def rectangle_in_half_plane(
    x: ArrayLike,
    z: ArrayLike,
    x_range: tuple[float, float],
    z_range: tuple[float, float],
    eigenstrain: tuple[float, float, float, float],
    young: float,
    poisson: float,
) -> FloatArray:
    """Stresses xx, yy, zz, xz of plane strain outside or inside a rectangle with eigenstrains xx, yy, zz, xz.

    The eigenstrain acts like forces on the sides; inside, its elastic stress is subtracted (Eshelby). With potentials
    phi, psi of a force in the whole plane its images have the first potential ``-w phibar'(w) - psibar(w)`` and the
    second potential ``-phibar(w)`` minus w times the derivative of the first (Muskhelishvili).
    """
    xs, zs = (np.asarray(c, dtype=float) for c in np.broadcast_arrays(x, z))
    e_xx, e_yy, e_zz, e_xz = eigenstrain
    shear, lame = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    trace = lame * (e_xx + e_yy + e_zz)
    misfit = np.array([trace + 2 * shear * e_xx, trace + 2 * shear * e_yy, trace + 2 * shear * e_zz, 2 * shear * e_xz])
    # Gauss nodes along a side; points must be at least a tenth of a side away
    node, weight = np.polynomial.legendre.leggauss(400)
    kappa = 3 - 4 * poisson
    point = (xs + 1j * zs).ravel()[:, None]
    slope, curvature, second_slope = (np.zeros(point.size, np.complex128) for _ in range(3))
    for normal, edge in (((1, 0), x_range[1]), ((-1, 0), x_range[0]), ((0, 1), z_range[1]), ((0, -1), z_range[0])):
        low, high = z_range if normal[0] else x_range
        position = low + 0.5 * (high - low) * (1 + node)
        source = edge + 1j * position if normal[0] else position + 1j * edge
        density = (misfit[0] * normal[0] + misfit[3] * normal[1]) + 1j * (misfit[3] * normal[0] + misfit[2] * normal[1])
        force = density / (2 * np.pi * (1 + kappa)) * 0.5 * (high - low) * weight
        conjugate, mirror = np.conj(force), np.conj(source)
        # In the whole plane phi = -F ln(w - w0), psi = kappa F* ln(w - w0) + F w0* / (w - w0).
        source_offset, mirror_offset = point - source, point - mirror
        slope += (-force / source_offset).sum(axis=1)
        curvature += (force / source_offset**2).sum(axis=1)
        second_slope += (kappa * conjugate / source_offset - force * mirror / source_offset**2).sum(axis=1)
        # Potentials of the images; the bar conjugates the constants of a function.
        phi_terms = -conjugate / mirror_offset, conjugate / mirror_offset**2, -2 * conjugate / mirror_offset**3
        psi_terms = (
            kappa * force / mirror_offset - conjugate * source / mirror_offset**2,
            -kappa * force / mirror_offset**2 + 2 * conjugate * source / mirror_offset**3,
        )
        image = -(phi_terms[0] + point * phi_terms[1]) - psi_terms[0]
        image_curvature = -(2 * phi_terms[1] + point * phi_terms[2]) - psi_terms[1]
        slope += image.sum(axis=1)
        curvature += image_curvature.sum(axis=1)
        second_slope += (-phi_terms[0] - image - point * image_curvature).sum(axis=1)
    normal_sum = 4 * slope.real
    difference = 2 * (np.conj(point[:, 0]) * curvature + second_slope)
    xx, zz, xz = 0.5 * (normal_sum - difference.real), 0.5 * (normal_sum + difference.real), 0.5 * difference.imag
    is_inside = (xs > x_range[0]) & (xs < x_range[1]) & (zs > z_range[0]) & (zs < z_range[1])
    stress = np.stack([xx, poisson * (xx + zz), zz, xz]).reshape(4, *xs.shape)
    return np.asarray(stress - misfit.reshape(4, *(1,) * xs.ndim) * is_inside)


def moving_band(y: FloatArray, drift: float) -> FloatArray:
    """Rise of a surface that moves along +y under a band of uniform heat ``|y| < 1``, times ``lambda / q``.

    Jaeger (1942): the integral of ``exp(v (y - y')) K0(v |y - y'|) / pi`` over the band, ``v = V a / (2 kappa)``.
    """
    distance_from_start = drift * (np.asarray(y, dtype=np.float64) + 1)
    distance_from_end = distance_from_start - 2 * drift
    return np.asarray((_primitive(distance_from_start) - _primitive(distance_from_end)) / (np.pi * drift))


def _primitive(u: FloatArray) -> FloatArray:
    """Primitive of ``exp(u) K0(|u|)``, zero at 0."""
    size = np.maximum(np.abs(u), np.finfo(np.float64).tiny)
    return np.asarray(u * (special.k0e(size) + np.sign(u) * special.k1e(size)) * np.exp(u - np.abs(u)))


def fast_line() -> tuple[float, float]:
    """Largest rise of a fast line over ``q0 sqrt(kappa a / (pi V)) / lambda``, and distance behind the middle over a.

    Heat flows into the depth only (Blok 1937, Jaeger 1942).
    """

    def compute_rise(lag: float) -> float:
        # The substitution s = lag - t**2 removes the singular root
        integral = integrate.quad(lambda t: 2 * np.sqrt(max(1 - (lag - t**2) ** 2, 0.0)), 0.0, np.sqrt(1 + lag))
        return float(integral[0])

    maximum = optimize.minimize_scalar(lambda lag: -compute_rise(lag), bounds=(0.3, 0.95), method="bounded")
    return -float(maximum.fun), float(maximum.x)
