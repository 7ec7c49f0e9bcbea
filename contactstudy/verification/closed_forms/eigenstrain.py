"""Eigenstrain in a rectangle of a half-plane: forces on the rectangle's sides, and their images in the free face."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from contactstudy.checks import FloatArray

SIDE_NODES = 400
"""Gauss nodes along a side; points have to stay a tenth of a side away from it."""


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

    The eigenstrain acts like forces on the sides and leaves its own stress inside (J. D. Eshelby, Proc. R. Soc. A 241
    (1957) 376). A force in a half-plane with a free face: N. I. Muskhelishvili, Some Basic Problems of the
    Mathematical Theory of Elasticity, chapter 19; with the potentials phi, psi of the force in the whole plane those of
    its images are ``-w phibar'(w) - psibar(w)`` and ``-phibar(w)`` less w times the first one's derivative.
    """
    xs, zs = (np.asarray(c, dtype=float) for c in np.broadcast_arrays(x, z))
    e_xx, e_yy, e_zz, e_xz = eigenstrain
    shear, lame = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    trace = lame * (e_xx + e_yy + e_zz)
    own = np.array([trace + 2 * shear * e_xx, trace + 2 * shear * e_yy, trace + 2 * shear * e_zz, 2 * shear * e_xz])
    node, weight = np.polynomial.legendre.leggauss(SIDE_NODES)
    kappa = 3 - 4 * poisson
    point = (xs + 1j * zs).ravel()[:, None]
    slope, curved, second = (np.zeros(point.size, np.complex128) for _ in range(3))
    for normal, fixed in (((1, 0), x_range[1]), ((-1, 0), x_range[0]), ((0, 1), z_range[1]), ((0, -1), z_range[0])):
        low, high = z_range if normal[0] else x_range
        along = low + 0.5 * (high - low) * (1 + node)
        source = fixed + 1j * along if normal[0] else along + 1j * fixed
        pull = (own[0] * normal[0] + own[3] * normal[1]) + 1j * (own[3] * normal[0] + own[2] * normal[1])
        force = pull / (2 * np.pi * (1 + kappa)) * 0.5 * (high - low) * weight
        other, mirror = np.conj(force), np.conj(source)
        # In the whole plane phi = -F ln(w - w0), psi = kappa F* ln(w - w0) + F w0* / (w - w0).
        near, far = point - source, point - mirror
        slope += (-force / near).sum(axis=1)
        curved += (force / near**2).sum(axis=1)
        second += (kappa * other / near - force * mirror / near**2).sum(axis=1)
        # Their images; bar of a function conjugates its constants.
        of_phi = -other / far, other / far**2, -2 * other / far**3
        of_psi = (
            kappa * force / far - other * source / far**2,
            -kappa * force / far**2 + 2 * other * source / far**3,
        )
        image = -(of_phi[0] + point * of_phi[1]) - of_psi[0]
        image_curved = -(2 * of_phi[1] + point * of_phi[2]) - of_psi[1]
        slope += image.sum(axis=1)
        curved += image_curved.sum(axis=1)
        second += (-of_phi[0] - image - point * image_curved).sum(axis=1)
    total = 4 * slope.real
    difference = 2 * (np.conj(point[:, 0]) * curved + second)
    xx, zz, xz = 0.5 * (total - difference.real), 0.5 * (total + difference.real), 0.5 * difference.imag
    inside = (xs > x_range[0]) & (xs < x_range[1]) & (zs > z_range[0]) & (zs < z_range[1])
    stress = np.stack([xx, poisson * (xx + zz), zz, xz]).reshape(4, *xs.shape)
    return np.asarray(stress - own.reshape(4, *(1,) * xs.ndim) * inside)
