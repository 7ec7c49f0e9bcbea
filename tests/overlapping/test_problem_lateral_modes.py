"""Modes along y: panels of wavenumbers, poles, and loads as low-rank products."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate

from contactstudy import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.problem import (
    BENDING_POLES,
    POLES,
    LateralPanel,
    cosine_moments,
    lateral_columns,
    lateral_panels,
    sine_moments,
)
from contactstudy.overlapping.quadrature import Resolution

GRID = Grid(x_range=(0.0, 4.0), y_range=(-1.0, 1.0), cells_x=12, cells_y=40)
Y = np.array([-1.5, -0.2, 0.0, 0.7])


def integrate_kernel(panel: LateralPanel, parity_loads: dict[int, np.ndarray], y: np.ndarray = Y) -> np.ndarray:
    """Integrals over the panel of ``exp(-0.3 k)`` times each load: array (load, part of y, parity, cell, y)."""
    displacement = np.zeros((2, 2, len(parity_loads), GRID.cells_x, y.size))
    columns = lateral_columns(panel, parity_loads, GRID)
    assert columns is not None
    for index, parity in enumerate(parity_loads):
        amplitudes = columns.along_x[..., columns.parities == parity] * np.exp(-0.3 * columns.nodes)[:, None]
        amplitude_columns = amplitudes.reshape(GRID.cells_x, -1)
        for load_index, load in enumerate((Load.NORMAL, Load.ALONG_Y)):
            for symmetry_index, synthesis in enumerate(columns.synthesis(load, parity, panel.waves(y))):
                displacement[load_index, symmetry_index, index] += amplitude_columns @ synthesis
    return displacement


@given(seed=st.integers(0, 10**6), rank=st.sampled_from([1, 2, 40]), is_split=st.booleans())
def test_columns_equal_the_load_at_every_wavenumber(seed: int, rank: int, is_split: bool):
    rng = np.random.default_rng(seed)
    pressure = rng.random((GRID.cells_x, rank)) @ rng.random((rank, GRID.cells_y))
    mirrored_pressure = pressure[::-1]
    parity_loads = {1: pressure + mirrored_pressure, -1: pressure - mirrored_pressure} if is_split else {0: pressure}
    # The interpolation with 20 nodes is exact to rounding.
    for panel in lateral_panels(0.05, 2.5, 60.0, replace(Resolution(), lateral_nodes=20)):
        fine_panel = replace(panel, nodes=panel.fine_nodes, interpolation=None)
        np.testing.assert_allclose(
            integrate_kernel(panel, parity_loads), integrate_kernel(fine_panel, parity_loads), atol=1e-9 * rank
        )


def test_product_of_x_and_y_has_one_column_per_node():
    pressure = np.outer(np.arange(1.0, 13.0), (1 - GRID.y**2) * (2 + GRID.y))
    panels = lateral_panels(0.05, 2.5, 60.0, Resolution())
    loads = [lateral_columns(panel, {0: pressure}, GRID) for panel in panels]
    columns = [load.nodes.size * load.parities.size for load in loads if load is not None]
    assert sum(columns) < 0.4 * sum(2 * panel.fine_nodes.size for panel in panels)
    assert columns[-1] == Resolution().lateral_nodes


def test_even_load_has_no_odd_columns():
    pressure = np.ones(GRID.shape)
    loads = lateral_columns(lateral_panels(0.05, 2.5, 60.0, Resolution())[1], {0: pressure}, GRID)
    assert loads is not None
    assert loads.parities.size == 1


def test_no_load_has_no_columns():
    panel = lateral_panels(0.05, 2.5, 60.0, Resolution())[1]
    assert lateral_columns(panel, {}, GRID) is None


@pytest.mark.parametrize("y", [0.0, 0.3, -2.0])
@pytest.mark.parametrize("moments", [cosine_moments, sine_moments])
def test_moments_of_poles_equal_integral(moments: Callable[..., FloatArray], y: float):
    """The difference between the moments from two wavenumbers equals the integral between them."""
    reference_depth, positions = 10.0, np.array([y])
    wave_function = np.cos if moments is cosine_moments else np.sin
    moments_from_low, moments_from_high = (
        moments(0.7, positions, reference_depth, 3)[:, 0],
        moments(2.5, positions, reference_depth, 3)[:, 0],
    )
    expected = [integrate.quad(lambda k, n=n: wave_function(k * y) * k**n, 0.7, 2.5)[0] for n in range(-3, 3)]
    np.testing.assert_allclose(moments_from_high - moments_from_low, expected, atol=1e-12)


def test_pole_integrals_vanish_at_reference():
    """The integrals of the cosine poles over all wavenumbers vanish at the reference; the first has no curvature
    there."""
    step, reference_depth = 1e-3, 10.0
    y = reference_depth + step * np.arange(-1.0, 2.0)
    displacement = cosine_moments(400.0, y, reference_depth, 0)
    np.testing.assert_allclose(displacement[:, 1], 0.0, atol=5e-4)
    assert abs(displacement[0] @ [1, -2, 1]) / step**2 < 1e-2
    sine_integrals = sine_moments(400.0, y, reference_depth, 0)
    # The sine's poles are the derivatives of the cosine's poles of the next order, with reversed sign.
    np.testing.assert_allclose(sine_integrals[1, 1], -(displacement[0, 2] - displacement[0, 0]) / (2 * step), rtol=1e-4)


@pytest.mark.parametrize("y", [0.02, 0.3, -2.0])
def test_sine_moments_integrate_cosine_moments(y: float):
    """The derivative of ``sin(k y) / k**n`` along y is ``cos(k y) / k**(n - 1)``, rigid motions included."""
    step, reference_depth = 1e-4, 3.0
    moments_ahead, moments_behind = (
        sine_moments(0.7, np.array([y + sign * step]), reference_depth)[:, 0] for sign in (1, -1)
    )
    cosine_values = cosine_moments(0.7, np.array([y]), reference_depth)[:, 0]
    np.testing.assert_allclose(
        (moments_ahead - moments_behind)[:3] / (2 * step),
        [cosine_values[1], cosine_values[2], cosine_values[3]],
        atol=1e-6,
    )


@pytest.mark.parametrize("poles", [POLES, BENDING_POLES])
def test_pole_integral_does_not_depend_on_first_panel(poles: int):
    y, totals = np.array([0.0, 0.4, 2.0]), []
    for panel_end in (0.02, 0.1, 0.6):
        displacement = np.zeros((2, y.size))
        for panel in lateral_panels(panel_end, 3.0, 60.0, Resolution(), 30.0, poles):
            response = np.exp(-panel.nodes) / panel.nodes**poles
            if panel.interpolation is not None:
                response = panel.interpolation @ response
            displacement += [response @ waves for waves in panel.waves(y)]
        totals.append(displacement[0] - displacement[0, :1] if poles == BENDING_POLES else displacement[0])
    np.testing.assert_allclose(totals[0], totals[1], atol=2e-4 if poles == POLES else 1e-5)
    if poles == BENDING_POLES:
        np.testing.assert_allclose(totals[2], totals[1], atol=1e-5)
