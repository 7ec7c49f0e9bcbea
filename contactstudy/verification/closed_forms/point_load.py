"""Point loads on a half-space: Boussinesq and Cerruti."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contactstudy.verification.closed_forms.components import COMPONENTS, Stress


def potential_stresses(
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
    by_p, by_q = potential_stresses(xs, ys, zs, zs, poisson)
    return {c: np.asarray(normal * p + tangential * q) for c, p, q in zip(COMPONENTS, by_p, by_q, strict=True)}
