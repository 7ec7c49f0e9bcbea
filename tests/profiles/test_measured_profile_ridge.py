"""The generatrix of a roller from a map of its surface."""

import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.profiles.measured_profile import extract_ridge

X, Y = np.linspace(0.0, 10e-3, 201), np.linspace(0.0, 0.6e-3, 61)
CROWN = -((X - 5e-3) ** 2) / 2.5


def roller_heights(shift: float = 0.3e-3, angle: float = 0.0, radius: float = 6e-3) -> np.ndarray:
    """Heights of a roller; its axis is rotated in the plane of the map by `angle`."""
    lateral = Y - shift - angle * (X[:, None] - 5e-3)
    return CROWN[:, None] + np.sqrt(radius**2 - lateral**2) - radius


@pytest.mark.parametrize(("shift", "angle"), [(0.3e-3, 0.0), (0.2e-3, 0.0), (0.3e-3, 0.01), (0.28e-3, -0.02)])
def test_ridge_follows_the_highest_line(shift: float, angle: float) -> None:
    """The tolerance is the difference of circle and parabola at this width."""
    np.testing.assert_allclose(extract_ridge(X, Y, roller_heights(shift, angle)), CROWN, atol=2e-9)


def test_ridge_of_noisy_map_is_within_noise() -> None:
    rng = np.random.default_rng(0)
    noisy_heights = roller_heights(0.25e-3, 0.01) + 0.1e-6 * rng.standard_normal((X.size, Y.size))
    noisy_heights[rng.random(noisy_heights.shape) < 0.2] = np.nan
    noisy_heights[7, 10:] = np.nan
    line = extract_ridge(X, Y, noisy_heights)
    assert np.flatnonzero(np.isnan(line)).tolist() == [7]
    is_finite = np.isfinite(line)
    assert np.std((line - CROWN)[is_finite]) < 1.3 * 0.1e-6 / np.sqrt(0.8 * Y.size)


@pytest.mark.parametrize(
    "heights", [np.zeros((201, 61)), -roller_heights(), roller_heights(shift=1.5e-3), np.full((201, 61), np.nan)]
)
def test_map_without_a_roller_is_rejected(heights: np.ndarray) -> None:
    with pytest.raises(InvalidInputError, match="highest line of a roller"):
        extract_ridge(X, Y, heights)
