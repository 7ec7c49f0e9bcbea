"""Fields at cell centres against the same fields among points that lie otherwise."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.kernels import centred, displacement, field, stress
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch import STRESS_CORNERS
from contactstudy.kernels.stress import half_space_stress

GRID = Grid((0.0, 2.0), (-1.0, 1.0), 20, 16)
Z = np.array([0.0, 0.05, 0.4])


def stresses(load: np.ndarray, x: np.ndarray, y: np.ndarray, extent: tuple[float, float]) -> np.ndarray:
    """Stresses under steps of a load in each direction."""
    influences = [Influence.of(STRESS_CORNERS[each], 0.3, each, stress.UNDER_PRESSURE) for each in Load]
    return np.stack([field.half_space_field(load, each, GRID, x, y, Z, extent=extent) for each in influences])


def displacements(load: np.ndarray, x: np.ndarray, y: np.ndarray, extent: tuple[float, float]) -> np.ndarray:
    """Displacements likewise."""
    length = extent[1] - extent[0]
    fields = []
    for each in Load:
        influence = displacement.displacement_influence(each, 0.3, length, 20.0)
        fields.append(field.half_space_field(load, influence, GRID, x, y, Z, extent=extent))
    return np.stack(fields)


@pytest.fixture
def load() -> np.ndarray:
    load = np.random.default_rng(0).random(GRID.shape)
    load[:, :3] = 0.0
    return load


@pytest.mark.parametrize("compute", [stresses, displacements])
@pytest.mark.parametrize(
    ("extent", "cells_x"),
    [
        ((-np.inf, np.inf), range(-3, 25)),
        ((-np.inf, np.inf), range(-7, 2)),
        ((0.0, np.inf), range(25)),
        ((0.0, np.inf), range(30)),
        ((0.0, 2.0), range(20)),
    ],
)
@pytest.mark.parametrize("cells_y", [range(-2, 20), range(-7, 3)])
def test_symmetry_changes_nothing(
    monkeypatch, compute, load: np.ndarray, extent: tuple[float, float], cells_x: range, cells_y: range
):
    x, y = GRID.x[0] + GRID.dx * np.array(cells_x), GRID.y[0] + GRID.dy * np.array(cells_y)
    calls = []
    real = centred.centred_field
    monkeypatch.setattr(field, "centred_field", lambda *a, **k: calls.append(1) or real(*a, **k))
    by_symmetry = compute(load, x, y, extent)
    # One more position along y that lies otherwise: all are convolved with the whole kernel.
    whole = compute(load, x, np.append(y, y[0] + 0.3 * GRID.dy), extent)[:, :, :, :-1]
    # Mirrored tractions along x take the general way.
    assert len(calls) == (3 if np.isinf(extent[0]) else 2)
    # Images are interpolated over another span along y.
    tolerance = 1e-13 if np.isinf(extent[1]) else 2e-8
    np.testing.assert_allclose(by_symmetry, whole, atol=tolerance * np.abs(whole).max())


@pytest.mark.parametrize("each", [Load.NORMAL, Load.ALONG_Y])
@pytest.mark.parametrize("cells_x", [20, 21])
@pytest.mark.parametrize("rows", [slice(None), [1, 4, 12], [17]])
@pytest.mark.parametrize("other_half", [1.0, 1 + 1e-6, -1.0])
def test_a_load_symmetric_about_mid_length_is_the_sum_of_its_halves(
    each: Load, cells_x: int, rows: slice | list[int], other_half: float
) -> None:
    """Of the halves alone no wavenumber is zero."""
    grid = Grid((0.0, 2.0), (-1.0, 1.0), cells_x, 16)
    half = np.random.default_rng(0).random(grid.shape)
    half[(cells_x + 1) // 2 :] = 0.0
    x = np.atleast_1d(grid.x[rows])
    influence = Influence.of(STRESS_CORNERS[each], 0.3, each, stress.UNDER_PRESSURE)
    parts = (half, other_half * half[::-1], half + other_half * half[::-1])
    one, other, both = (
        field.half_space_field(cells, influence, grid, x, grid.y, Z, extent=(0.0, 2.0)) for cells in parts
    )
    np.testing.assert_allclose(both, one + other, atol=1e-13 * np.abs(one).max())


@pytest.mark.parametrize("unit", [1e-20, 1e20])
def test_no_unit_makes_a_load_symmetric_about_mid_length(load: np.ndarray, unit: float) -> None:
    """A field is that of the load in any unit."""
    found, plain = (stresses(each, GRID.x, GRID.y, (0.0, 2.0)) for each in (unit * load, load))
    np.testing.assert_allclose(found / unit, plain, atol=1e-12 * np.abs(plain).max())


def test_kept_kernels_belong_to_their_material_and_quantity(load: np.ndarray):
    y, extent = GRID.y, (0.0, 2.0)
    first = stresses(load, GRID.x, y, extent)
    softer = half_space_stress(Load.NORMAL, load, 0.1, GRID, GRID.x, y, Z, extent=extent)
    assert np.abs(softer - first[0]).max() > 1e-2
    displacements(load, GRID.x, y, extent)
    np.testing.assert_array_equal(stresses(load, GRID.x, y, extent), first)


@pytest.mark.parametrize("extent", [(-np.inf, np.inf), (0.0, np.inf), (0.0, 2.0)])
@pytest.mark.parametrize("loaded", [(5, slice(None)), (slice(None), 5), (slice(None), slice(None)), (5, 5)])
@pytest.mark.parametrize("whole", [False, True])
def test_every_cell_counts_at_every_other(extent: tuple[float, float], loaded: tuple, whole: bool) -> None:
    """At periods of a fast length the farthest cells were left out of components odd in y.

    Where a contact is one cell wide, and looked at there, a transform of no points was asked for.
    """
    load = np.zeros(GRID.shape)
    load[loaded] = 1.0
    x, y = (GRID.x, GRID.y) if whole else (np.atleast_1d(GRID.x[loaded[0]]), np.atleast_1d(GRID.y[loaded[1]]))
    # With a position that lies otherwise beside each, nothing is taken by symmetry.
    beside = [(values[:, None] + 0.013 * np.arange(2)).ravel() for values in (x, y)]
    apart = stresses(load, *beside, extent)[:, :, ::2, ::2]
    np.testing.assert_allclose(stresses(load, x, y, extent), apart, atol=1e-8)
