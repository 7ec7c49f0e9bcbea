"""The generatrix of a roller from a map of its surface."""

import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.profiles.measured_profile import extract_ridge

X, Y = np.linspace(0.0, 10e-3, 201), np.linspace(0.0, 0.6e-3, 61)
CROWN = -((X - 5e-3) ** 2) / 2.5


def roller(shift: float = 0.3e-3, turn: float = 0.0, radius: float = 6e-3) -> np.ndarray:
    """Heights of a roller whose axis is turned in the plane of the map."""
    lateral = Y - shift - turn * (X[:, None] - 5e-3)
    return CROWN[:, None] + np.sqrt(radius**2 - lateral**2) - radius


@pytest.mark.parametrize(("shift", "turn"), [(0.3e-3, 0.0), (0.2e-3, 0.0), (0.3e-3, 0.01), (0.28e-3, -0.02)])
def test_ridge_follows_the_highest_line(shift: float, turn: float) -> None:
    """The tolerance is the difference of circle and parabola at this width."""
    np.testing.assert_allclose(extract_ridge(X, Y, roller(shift, turn)), CROWN, atol=2e-9)


def test_ridge_with_missing_points_and_noise() -> None:
    rng = np.random.default_rng(0)
    noisy = roller(0.25e-3, 0.01) + 0.1e-6 * rng.standard_normal((X.size, Y.size))
    noisy[rng.random(noisy.shape) < 0.2] = np.nan
    noisy[7, 10:] = np.nan
    line = extract_ridge(X, Y, noisy)
    assert np.flatnonzero(np.isnan(line)).tolist() == [7]
    finite = np.isfinite(line)
    assert np.std((line - CROWN)[finite]) < 1.3 * 0.1e-6 / np.sqrt(0.8 * Y.size)


@pytest.mark.parametrize("heights", [np.zeros((201, 61)), -roller(), roller(shift=1.5e-3), np.full((201, 61), np.nan)])
def test_map_without_a_roller_is_rejected(heights: np.ndarray) -> None:
    with pytest.raises(InvalidInputError, match="highest line of a roller"):
        extract_ridge(X, Y, heights)
