"""Rollers in contact at an end only are rejected."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import (
    Grid,
    InvalidInputError,
    WindowError,
    choose_grid,
    solve,
)
from contactstudy.case.magnitudes import check_balanced, check_contact_length
from tests.crowned_case import HALF_WIDTH, LENGTH, case_with


@pytest.mark.parametrize("window", [2.0, 16.0])
def test_roller_tilted_onto_its_end_is_rejected(window: float):
    case = case_with(tilt=0.1)
    with pytest.raises((InvalidInputError, WindowError), match=r"tilt = 0\.1"):
        solve(case, choose_grid(case, cells_y=8, window=window), stresses=False)


def test_load_at_the_end_is_rejected():
    case = case_with(load_position=17.95 * HALF_WIDTH)
    with pytest.raises(InvalidInputError, match=r"load_position = .* the contact reaches further"):
        solve(case, choose_grid(case, cells_y=8, window=24), stresses=False)


@pytest.mark.parametrize("from_end", [0.2, 0.3])
def test_load_needs_a_minimum_distance_from_the_end(from_end: float) -> None:
    untilted = case_with()
    start, stop = untilted.contact_range
    for position in (start + from_end * untilted.hertz_half_width, stop - from_end * untilted.hertz_half_width):
        eccentric = case_with(load_position=position)
        if from_end < 0.25:
            with pytest.raises(InvalidInputError, match=r"load_position = .* is not balanced"):
                check_balanced(eccentric)
        else:
            check_balanced(eccentric)


@pytest.mark.parametrize("columns", [slice(0, 3), slice(-3, None)])
def test_short_contact_at_a_tilted_end_is_rejected(columns: slice) -> None:
    tilted, untilted = case_with(tilt=1e-3), case_with()
    grid = Grid(x_range=(0.0, LENGTH), y_range=(-4e-4, 4e-4), cells_x=100, cells_y=8)
    gap, pressure = np.full(grid.shape, np.inf), np.zeros(grid.shape)
    gap[10:90] = 0.0
    pressure[10:90][columns] = 1.0
    with pytest.raises(InvalidInputError, match=r"tilt = 0\.001: .* reaches further"):
        check_contact_length(tilted, grid, gap, pressure)
    # Without tilt any contact is allowed: a long contact may reach the end, a short contact may lie inside.
    check_contact_length(untilted, grid, gap, pressure)
    check_contact_length(tilted, grid, gap, np.where(np.isfinite(gap), 1.0, 0.0))
    check_contact_length(tilted, grid, gap, np.roll(pressure, 40, axis=0))
