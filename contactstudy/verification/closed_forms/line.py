"""Hertz pressure on a long strip, with and without sliding: the line contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from contactstudy.verification.closed_forms.components import COMPONENTS, Stress


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
