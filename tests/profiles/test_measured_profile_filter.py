"""The filter of measured profiles: transmission, and values at free ends."""

import numpy as np
import pytest

from contactstudy.profiles.measured_profile import filter_gaussian

CUTOFF = 0.8e-3
X = np.linspace(0.0, 12e-3, 2401)


@pytest.mark.parametrize("wavelength_ratio", [0.25, 0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("is_uneven", [False, True])
def test_transmission_equals_the_standard(wavelength_ratio: float, is_uneven: bool) -> None:
    """The transmission is ``2**-(cutoff / wavelength)**2``, half at the cut-off."""
    x = X + (2e-6 * np.sin(40 * X / X[-1]) if is_uneven else 0.0)
    inner_slice = slice(180, -180)  # the slice excludes 0.9 mm on either side
    for phase in (0.0, 1.0):
        sine = np.sin(2 * np.pi * x / (wavelength_ratio * CUTOFF) + phase)
        filtered_noise = filter_gaussian(x, sine, CUTOFF)
        np.testing.assert_allclose(
            filtered_noise[inner_slice], 0.5 ** (1 / wavelength_ratio**2) * sine[inner_slice], atol=5e-6
        )


def test_filter_preserves_straight_lines() -> None:
    straight_line = 3e-6 + 2e-3 * X
    np.testing.assert_allclose(filter_gaussian(X, straight_line, CUTOFF), straight_line, rtol=1e-12)


def test_filtered_parabola_shifts_by_the_closed_form() -> None:
    """The inner shift is the mean of ``s**2``, ``log(2) (cutoff / pi)**2 / 2``; a plain mean would lift the ends."""
    crown = (X - 6e-3) ** 2 / 2
    shift = filter_gaussian(X, crown, CUTOFF) - crown
    expected = 0.5 * (np.log(2) / (2 * np.pi**2)) * CUTOFF**2
    inner_slice = slice(180, -180)
    np.testing.assert_allclose(shift[inner_slice], expected, rtol=1e-4)
    assert np.abs(shift).max() < 1.001 * expected
    shift_of_mean = 0.5 * 6e-3 * CUTOFF * np.sqrt(np.log(2)) / np.pi**1.5  # half a weight extends beyond the end
    assert abs(shift[0]) < 0.03 * shift_of_mean


def test_noise_decreases_by_the_closed_form() -> None:
    """The variance of a weighted mean of independent values is ``step / (alpha cutoff sqrt(2))`` inside."""
    noise = np.random.default_rng(0).standard_normal((40, X.size))
    filtered_noise = np.array([filter_gaussian(X, row, CUTOFF) for row in noise])[:, 300:-300]
    expected = np.sqrt((X[1] - X[0]) / (np.sqrt(np.log(2) / np.pi) * CUTOFF * np.sqrt(2)))
    assert filtered_noise.std() == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("cutoff", [0.05e-3, 0.8e-3, 11e-3])
def test_even_and_uneven_points_agree(cutoff: float) -> None:
    """The sums by Fourier transforms equal the sums at the points."""
    values = np.cos(2 * np.pi * X / 1e-3) + X / X[-1]
    uneven_x = X + 2e-3 * (X[1] - X[0]) * np.sin(1e4 * X)  # the deviation exceeds the tolerance of even points
    np.testing.assert_allclose(filter_gaussian(X, values, cutoff), filter_gaussian(uneven_x, values, cutoff), atol=2e-4)


def test_filter_of_long_dense_line_is_exact() -> None:
    x = np.linspace(0.0, 14e-3, 50_000)
    straight_line = 1e-6 + 1e-3 * x
    np.testing.assert_allclose(filter_gaussian(x, straight_line, 8e-3), straight_line, rtol=1e-9)
