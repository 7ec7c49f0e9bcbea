"""The direction along the rolling: panels, poles, and loads written in few columns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, special

from contactstudy import Grid
from contactstudy.kernels.load import Load
from contactstudy.overlapping.lateral import LateralPanel, cosine_moments, lateral_columns, lateral_panels
from contactstudy.overlapping.quadrature import Resolution

GRID = Grid((0.0, 4.0), (-1.0, 1.0), 12, 40)
Y = np.array([-1.5, -0.2, 0.0, 0.7])


def answered(panel: LateralPanel, parts: dict[int, np.ndarray]) -> np.ndarray:
    """Sums over the panel of ``exp(-0.3 k)`` times each load: array (load, part of y, parity, cell, y)."""
    total = np.zeros((2, 2, len(parts), GRID.cells_x, Y.size))
    loads = lateral_columns(panel, parts, GRID, Y)
    assert loads is not None
    for batch in loads.batches():
        for place, parity in enumerate(parts):
            own = batch.along_x[..., batch.parities == parity] * np.exp(-0.3 * batch.nodes)[:, None]
            flat = own.reshape(GRID.cells_x, -1)
            for number, load in enumerate((Load.NORMAL, Load.ALONG_Y)):
                for kind, synthesis in enumerate(batch.synthesis(load, parity)):
                    total[number, kind, place] += flat @ synthesis
    return total


@given(seed=st.integers(0, 10**6), rank=st.sampled_from([1, 2, 40]), split=st.booleans())
def test_few_columns_say_what_every_wavenumber_says(seed: int, rank: int, split: bool):
    rng = np.random.default_rng(seed)
    pressure = rng.random((GRID.cells_x, rank)) @ rng.random((rank, GRID.cells_y))
    mirrored = pressure[::-1]
    parts = {1: pressure + mirrored, -1: pressure - mirrored} if split else {0: pressure}
    # With so many nodes the answer is interpolated exactly, but for rounding: what is left is the load's columns.
    for panel in lateral_panels(0.05, 2.5, 60.0, replace(Resolution(), lateral_nodes=20)):
        direct = replace(panel, nodes=panel.fine, interpolation=None)
        np.testing.assert_allclose(answered(panel, parts), answered(direct, parts), atol=1e-8 * rank)


def test_a_product_of_x_and_y_is_asked_for_at_few_wavenumbers():
    pressure = np.outer(np.arange(1.0, 13.0), (1 - GRID.y**2) * (2 + GRID.y))
    panels = lateral_panels(0.05, 2.5, 60.0, Resolution())
    loads = [lateral_columns(panel, {0: pressure}, GRID, Y) for panel in panels]
    columns = [each.nodes.size * each.parities.size for each in loads if each is not None]
    assert sum(columns) < 0.4 * sum(2 * panel.fine.size for panel in panels)
    assert columns[-1] == Resolution().lateral_nodes


def test_a_load_that_is_even_in_y_has_no_odd_columns():
    pressure = np.ones(GRID.shape)
    loads = lateral_columns(lateral_panels(0.05, 2.5, 60.0, Resolution())[1], {0: pressure}, GRID, Y)
    assert loads is not None
    assert loads.parities.size == 1


def test_no_load_has_no_columns():
    panel = lateral_panels(0.05, 2.5, 60.0, Resolution())[1]
    assert lateral_columns(panel, {}, GRID, Y) is None


@pytest.mark.parametrize("y", [0.0, 0.3, -2.0])
def test_moments_of_the_poles(y: float):
    first, reference = 0.7, 10.0

    def integral(function: Callable[[float], float]) -> float:
        return float(integrate.quad(function, 1e-9, first, limit=400)[0])

    expected = [
        # int (cos(k y) - 1) / k**2 up to `first`, less that of all wavenumbers at the reference
        integral(lambda k: (np.cos(k * y) - 1) / k**2) + 0.5 * np.pi * reference,
        # int (cos(k y) - cos(k reference)) / k up to `first`, less the reference's beyond: a cosine integral
        integral(lambda k: (np.cos(k * y) - np.cos(k * reference)) / k) + special.sici(first * reference)[1],
        integral(lambda k: np.cos(k * y)),
    ]
    np.testing.assert_allclose(cosine_moments(first, np.array([y]), reference)[:, 0], expected, atol=1e-7)
