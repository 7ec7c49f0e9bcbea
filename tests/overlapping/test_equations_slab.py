"""The factors of the slab against closed forms, also at small arguments."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest

from contactstudy.overlapping.equations import slab_factors

KAPPA = np.array([1e-3, 0.05, 0.2, 0.4, 0.49, 0.51, 1.0, 3.0, 12.0])


@pytest.mark.parametrize("length", [1.0, 0.7])
def test_slab_factors_match_closed_forms(length: float) -> None:
    t = 0.5 * KAPPA * length
    even_factor, tau_even = slab_factors(KAPPA, length, 1)
    assert even_factor == pytest.approx(2 * np.sinh(t) ** 2 / (np.sinh(2 * t) + 2 * t))
    assert tau_even == pytest.approx(t * (1 / np.tanh(t) - 1))
    odd_factor, tau_odd = slab_factors(KAPPA, length, -1)
    # sinh(2 t) - 2 t without cancellation
    difference = sum((2 * t) ** (2 * n + 1) / factorial(2 * n + 1) for n in range(1, 40))
    assert odd_factor == pytest.approx(2 * np.cosh(t) ** 2 / difference, rel=1e-11)
    assert tau_odd == pytest.approx(t * (np.tanh(t) - 1))


def test_single_end_factors_equal_half_space() -> None:
    factor, tau = slab_factors(KAPPA, np.inf, 0)
    assert (factor == 1).all()
    assert (tau == 0).all()
