"""What tells the slab V, loaded on both faces, from a half-space."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray


def slab_factors(kappa: ComplexArray | FloatArray, length: float, parity: int) -> tuple[ComplexArray, ComplexArray]:
    """Factors ``T`` and ``tau`` that tell a slab from a half-space, for which they are 1 and 0.

    With ``t = kappa length / 2``: ``T = 2 sinh(t)**2 / (sinh(2t) + 2t)`` and ``tau = t (coth(t) - 1)`` for even parity,
    ``T = 2 cosh(t)**2 / (sinh(2t) - 2t)`` and ``tau = t (tanh(t) - 1)`` for odd.
    """
    if not parity:
        return np.ones(kappa.shape, np.complex128), np.zeros(kappa.shape, np.complex128)
    doubled = np.asarray(kappa * length, dtype=np.complex128)
    decay = np.exp(-doubled)
    denominator = 1 - decay**2 + parity * 2 * doubled * decay
    if parity < 0:  # bending: sinh(2t) - 2t would cancel
        square = doubled**2
        series = 1 + square / 20 * (1 + square / 42 * (1 + square / 72 * (1 + square / 110)))
        denominator = np.where(np.abs(doubled) < 0.5, decay * doubled**3 / 3 * series, denominator)
    factor = (1 - parity * decay) ** 2 / denominator
    return factor, parity * doubled * decay / (1 - parity * decay)
