"""Axial wavenumbers: a few discrete wavenumbers and a ray equal the whole sum, a ray the whole integral."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import AxialModes, axial_modes
from contactstudy.overlapping.quadrature import Resolution

X = np.array([0.02, 0.6, 1.5, 2.7])


def sum_waves(modes: AxialModes, waves: np.ndarray, height: float) -> np.ndarray:
    """Sum of the waves times ``exp(-k height)``, with the weights of a load's spectrum."""
    return np.asarray(((modes.load_weights * np.exp(-modes.wavenumbers * height))[:, None] * waves).sum(axis=0).real)


@pytest.mark.parametrize("length", [3.0, 5.0])
@pytest.mark.parametrize("height", [0.15, 1.0])
def test_ray_and_discrete_modes_equal_full_sum(length: float, height: float) -> None:
    for modes, parity in zip(axial_modes(length, 0.5, 0.05, Resolution()), (1, -1), strict=True):
        mode_numbers = np.arange(0 if parity > 0 else 1, 4000, 2)
        k = np.pi * mode_numbers / length
        weights = np.where(mode_numbers == 0, 1.0, 2.0) / length * np.exp(-k * height)
        assert modes.parity == parity
        for waves, wave_function in ((modes.cosine, np.cos), (modes.sine, np.sin)):
            expected = weights @ wave_function(np.outer(k, X))
            assert sum_waves(modes, waves(X), height) == pytest.approx(expected, abs=4e-6)


@pytest.mark.parametrize("height", [0.15, 1.0])
def test_ray_equals_integral_of_single_end(height: float) -> None:
    (modes,) = axial_modes(np.inf, 0.05, 0.05, Resolution())
    load_on_x = 2 / np.pi / (height**2 + X**2)
    assert sum_waves(modes, modes.cosine(X), height) == pytest.approx(height * load_on_x, abs=1e-5)
    assert sum_waves(modes, modes.sine(X), height) == pytest.approx(X * load_on_x, abs=1e-5)


@pytest.mark.parametrize("length", [3.0, np.inf])
@pytest.mark.parametrize("load", [Load.NORMAL, Load.ALONG_X])
def test_cell_integrals_match_waves(load: Load, length: float) -> None:
    edges = np.array([0.0, 0.4, 1.7, 3.0])
    for modes in axial_modes(length, 0.5, 0.05, Resolution()):
        computed = modes.cell_integrals(load, edges)
        is_low = np.abs(modes.wavenumbers) < 20
        load_weights = np.abs(modes.load_weights)[is_low]  # near 0 both weights and integrals have rounding errors
        for cell, (low, high) in enumerate(pairwise(edges)):
            nodes, weights = np.polynomial.legendre.leggauss(60)
            positions = 0.5 * (high + low) + 0.5 * (high - low) * nodes
            expected = 0.5 * (high - low) * modes.wave(load, positions) @ weights
            np.testing.assert_allclose(
                load_weights * computed[is_low, cell], load_weights * expected[is_low], atol=1e-9
            )


def test_shortest_distance_bounds_wavenumbers() -> None:
    for lateral, shortest in ((0.5, 0.05), (0.5, 5.0), (60.0, 5.0)):
        max_wavenumber = max(Resolution().reach / shortest, 4 * lateral)
        for length in (0.4, np.inf):
            for modes in axial_modes(length, lateral, shortest, Resolution()):
                start = modes.ray[0].real - modes.ray[0].imag / np.tan(Resolution().angle)
                assert (
                    0.9 * max_wavenumber <= abs(modes.ray[-1] - start) <= np.exp(2 * Resolution().step) * max_wavenumber
                )
