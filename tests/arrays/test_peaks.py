"""The largest pressure of each cross-section between its cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy.arrays.peaks import interpolate_about, lagrange_weights, section_maxima, variation_lengths


@given(offset=st.floats(-0.5, 0.5), cells=st.integers(8, 40))
def test_section_maximum_of_shifted_ellipse_is_exact(offset: float, cells: int) -> None:
    step = 3.0 / cells
    y = step * (np.arange(cells) - 0.5 * cells + 0.5 + offset)
    pressure = np.sqrt(np.maximum(1 - y**2, 0.0))[None, :]
    assert section_maxima(pressure)[0] == pytest.approx(1.0, abs=1e-9)


def test_section_maximum_of_few_points_is_bounded() -> None:
    pressure = np.array([[0.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [2.0, 1.0, 0.0, 0.0]])
    maxima = section_maxima(pressure)
    assert maxima[0] == 0
    assert (maxima[1:] >= [3.0, 2.0]).all()
    assert (maxima[1:] <= 1.25 * np.array([3.0, 2.0])).all()


def test_interpolation_about_sample_is_exact_for_parabola() -> None:
    for x, centre in ((np.array([0.0, 1.0, 3.0, 4.0]), 1), (np.array([0.0, 1.0, 2.0, 3.0]), 2)):
        (points,), values = interpolate_about([x], [centre], (x**2)[None], 1)
        assert np.allclose(values[0], points**2)


def test_variation_length_of_crest_equals_half_width() -> None:
    x = np.linspace(-1.0, 1.0, 201)
    crest = np.sqrt(np.maximum(1 - (x / 0.5) ** 2, 0))[:, None] * np.ones(20)
    assert min(variation_lengths(crest, x, 0.1, 100, rising=False)) == pytest.approx(0.5, abs=0.05)


def test_interpolation_is_exact_for_polynomials() -> None:
    nodes, points = np.array([1.0, 1.3, 1.9, 2.2, 2.6, 3.0]), np.linspace(1.0, 3.0, 11)
    assert lagrange_weights(nodes, points) @ nodes**5 == pytest.approx(points**5, rel=1e-12)
