"""The filter of measured profiles: its transmission, and what it does at free ends."""

import numpy as np
import pytest

from contactstudy.profiles.measured import gaussian_filtered

CUTOFF = 0.8e-3
X = np.linspace(0.0, 12e-3, 2401)


@pytest.mark.parametrize("over_cutoff", [0.25, 0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("uneven", [False, True])
def test_transmission_is_that_of_the_standard(over_cutoff: float, uneven: bool) -> None:
    """Half at the cut-off, and ``2**-(cutoff / wavelength)**2`` elsewhere."""
    x = X + (2e-6 * np.sin(40 * X / X[-1]) if uneven else 0.0)
    inner = slice(180, -180)  # 0.9 mm
    for phase in (0.0, 1.0):
        wave = np.sin(2 * np.pi * x / (over_cutoff * CUTOFF) + phase)
        left = gaussian_filtered(x, wave, CUTOFF)
        np.testing.assert_allclose(left[inner], 0.5 ** (1 / over_cutoff**2) * wave[inner], atol=5e-6)


def test_lines_stay_up_to_their_ends() -> None:
    line = 3e-6 + 2e-3 * X
    np.testing.assert_allclose(gaussian_filtered(X, line, CUTOFF), line, rtol=1e-12)


def test_a_parabola_moves_by_the_closed_form_inside_and_less_at_the_ends() -> None:
    """Inside, the mean of ``s**2`` under the weight, ``log(2) (cutoff / pi)**2 / 2``; a mean would lift the ends."""
    crown = (X - 6e-3) ** 2 / 2
    moved = gaussian_filtered(X, crown, CUTOFF) - crown
    expected = 0.5 * (np.log(2) / (2 * np.pi**2)) * CUTOFF**2
    inner = slice(180, -180)
    np.testing.assert_allclose(moved[inner], expected, rtol=1e-4)
    assert np.abs(moved).max() < 1.001 * expected
    plain_mean = 0.5 * 6e-3 * CUTOFF * np.sqrt(np.log(2)) / np.pi**1.5  # half a weight hangs over the end
    assert abs(moved[0]) < 0.03 * plain_mean


def test_noise_gets_smaller_by_what_the_weight_says() -> None:
    """The variance of a weighted mean of independent values: ``step / (alpha cutoff sqrt(2))`` inside."""
    noise = np.random.default_rng(0).standard_normal((40, X.size))
    left = np.array([gaussian_filtered(X, row, CUTOFF) for row in noise])[:, 300:-300]
    expected = np.sqrt((X[1] - X[0]) / (np.sqrt(np.log(2) / np.pi) * CUTOFF * np.sqrt(2)))
    assert left.std() == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("cutoff", [0.05e-3, 0.8e-3, 11e-3])
def test_even_and_uneven_points_are_filtered_alike(cutoff: float) -> None:
    """The sums by Fourier transforms are those at the points one by one."""
    values = np.cos(2 * np.pi * X / 1e-3) + X / X[-1]
    moved = X + 2e-3 * (X[1] - X[0]) * np.sin(1e4 * X)  # beyond what counts as even
    np.testing.assert_allclose(
        gaussian_filtered(X, values, cutoff), gaussian_filtered(moved, values, cutoff), atol=2e-4
    )


def test_a_long_trace_of_dense_points_takes_no_time_to_speak_of() -> None:
    x = np.linspace(0.0, 14e-3, 50_000)
    line = 1e-6 + 1e-3 * x
    np.testing.assert_allclose(gaussian_filtered(x, line, 8e-3), line, rtol=1e-9)
