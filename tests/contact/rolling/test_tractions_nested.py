"""Initial guesses of stick and slip: from coarser cells, and from almost equal bounds."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.checks import FloatArray
from contactstudy.contact.rolling.surfaces import Tractions
from contactstudy.contact.rolling.tractions import (
    MAX_STICKING_RATIO,
    RollingCells,
    cell_means,
    guess_from_coarse,
    guess_from_last,
)

COARSE_GRID = Grid(x_range=(0.0, 6.0), y_range=(0.0, 4.0), cells_x=6, cells_y=4)
FINE_GRID = Grid(x_range=(0.0, 6.0), y_range=(0.0, 4.0), cells_x=12, cells_y=8)
ALONG_Y_ONLY = Grid(x_range=(0.0, 6.0), y_range=(0.0, 4.0), cells_x=6, cells_y=8)


def make_tractions(bound: FloatArray, traction: FloatArray, sticks: FloatArray) -> Tractions:
    rigid_motion = {"x": 0.5, "y": -0.25, "spin": 3.0}
    slip = np.zeros_like(traction)
    return Tractions(
        traction=traction, slip=slip, sticks=sticks, bound=bound, amplitudes=rigid_motion, resultants={}, work=0.0
    )


def find_unknown_cells(bound: FloatArray) -> RollingCells:
    return RollingCells(
        bound=bound, is_unknown=np.ones(bound.shape, bool), offset=np.zeros(bound.size), ratio=np.ones(bound.shape)
    )


def compute_linear_fractions(grid: Grid) -> FloatArray:
    """Fractions of the bound, in two components, that are linear on the grid."""
    x, y = grid.x[:, None], grid.y
    return np.stack([0.02 * x + 0.03 * y + 0.05, 0.3 - 0.04 * x - 0.01 * y + 0 * y])


@pytest.mark.parametrize("grid", [FINE_GRID, ALONG_Y_ONLY])
def test_sticking_guess_is_linear_in_bound(grid: Grid) -> None:
    bound, fine_bound = 2.0 + COARSE_GRID.x[:, None] * COARSE_GRID.y, 3.0 + grid.x[:, None] + grid.y
    coarse_tractions = make_tractions(
        bound, bound * compute_linear_fractions(COARSE_GRID), np.ones(COARSE_GRID.shape, bool)
    )
    guess = guess_from_coarse(coarse_tractions, find_unknown_cells(fine_bound), ("y", "spin"))
    computed = guess.traction.reshape(2, *grid.shape) / fine_bound
    inner_cells = slice(2, -2) if grid is FINE_GRID else slice(None)
    assert computed[:, inner_cells, 1:-1] == pytest.approx(
        compute_linear_fractions(grid)[:, inner_cells, 1:-1], rel=1e-12
    )
    assert guess.amplitudes.tolist() == [-0.25, 3.0]


def test_slipping_guess_keeps_bound() -> None:
    """Sticking cells approach the bound towards slipping cells; cells without a bound carry no traction."""
    sticks = np.broadcast_to(COARSE_GRID.x[:, None] < 3, COARSE_GRID.shape)
    bound = np.where(COARSE_GRID.y > 1, 2.0, 0.0) * np.ones(COARSE_GRID.shape)
    direction = np.array([0.6, 0.8])[:, None, None]
    traction = direction * bound * np.where(sticks, 0.9 + 0.05 * COARSE_GRID.x[:, None], 1.0)
    fine_bound = np.full(FINE_GRID.shape, 5.0)
    coarse_tractions = make_tractions(bound, traction, sticks)
    computed = guess_from_coarse(coarse_tractions, find_unknown_cells(fine_bound), ()).traction.reshape(
        2, *FINE_GRID.shape
    )
    bound_ratio = np.hypot(*computed) / fine_bound
    is_slipping, is_frictionless = FINE_GRID.x > 3, FINE_GRID.y < 0.9
    assert bound_ratio[is_slipping][:, ~is_frictionless] == pytest.approx(1.0)
    assert (bound_ratio[is_slipping][:, is_frictionless] == 0).all()
    assert bound_ratio[~is_slipping][:, ~is_frictionless].max() == pytest.approx(MAX_STICKING_RATIO)
    assert bound_ratio[2:4, 4:] == pytest.approx(0.9 + 0.05 * np.array([1.25, 1.75])[:, None] * np.ones(4))
    assert (bound_ratio[~is_slipping][:, :1] == 0).all()
    is_loaded = bound_ratio > 0
    assert (computed[1] / computed[0].clip(1e-9))[is_loaded] == pytest.approx(4 / 3)


def test_guess_keeps_slip_direction_under_similar_bound() -> None:
    rng = np.random.default_rng(0)
    last_traction = rng.standard_normal((2, *FINE_GRID.shape))
    last_traction[:, 0] = 0.0
    sticks = FINE_GRID.x[:, None] < 3 + 0 * FINE_GRID.y
    bound = np.hypot(*last_traction) * rng.uniform(0.9, 1.1, FINE_GRID.shape) + np.where(
        FINE_GRID.x[:, None] < 0.5, 1.0, 0.0
    )
    guess = guess_from_last(make_tractions(bound, last_traction, sticks), find_unknown_cells(bound), ("x",))
    computed = guess.traction.reshape(2, *FINE_GRID.shape)
    assert guess.amplitudes.tolist() == [0.5]
    size, previous_size = np.hypot(*computed), np.hypot(*last_traction)
    assert computed[0] * last_traction[1] == pytest.approx(computed[1] * last_traction[0])
    assert size[~sticks] == pytest.approx(bound[~sticks])
    assert size[sticks] == pytest.approx(np.minimum(previous_size, MAX_STICKING_RATIO * bound)[sticks])
    assert (computed[:, 0] == 0).all()
    assert ((computed * last_traction).sum(axis=0)[1:] > 0).all()


def test_coarse_cells_have_mean_values() -> None:
    assert cell_means(np.arange(8.0).reshape(2, 4)).tolist() == [[2.5, 4.5]]
