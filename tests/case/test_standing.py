"""Rollers that would stand on an end: refused, before the contact or after it."""

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
from contactstudy.case.magnitudes import check_balanced, check_on_its_length
from tests.crowned_case import HALF_WIDTH, LENGTH, case_with


@pytest.mark.parametrize("window", [2.0, 16.0])
def test_a_roller_tilted_on_its_end_is_refused(window: float):
    case = case_with(tilt=0.1)
    with pytest.raises((InvalidInputError, WindowError), match=r"tilt = 0\.1"):
        solve(case, choose_grid(case, cells_y=8, window=window), stresses=False)


def test_a_load_at_the_very_end_is_refused():
    case = case_with(load_position=17.95 * HALF_WIDTH)
    with pytest.raises(InvalidInputError, match=r"load_position = .* the contact reaches further"):
        solve(case, choose_grid(case, cells_y=8, window=24), stresses=False)


@pytest.mark.parametrize("from_end", [0.2, 0.3])
def test_a_load_needs_an_arm_of_a_quarter_of_the_half_width(from_end: float) -> None:
    level = case_with()
    start, stop = level.contact_range
    for position in (start + from_end * level.hertz_half_width, stop - from_end * level.hertz_half_width):
        balanced = case_with(load_position=position)
        if from_end < 0.25:
            with pytest.raises(InvalidInputError, match=r"load_position = .* is not balanced"):
                check_balanced(balanced)
        else:
            check_balanced(balanced)


@pytest.mark.parametrize("columns", [slice(0, 3), slice(-3, None)])
def test_a_contact_shorter_than_a_half_width_is_refused_at_an_end_of_a_tilted_roller(columns: slice) -> None:
    tilted, level = case_with(tilt=1e-3), case_with()
    grid = Grid(x_range=(0.0, LENGTH), y_range=(-4e-4, 4e-4), cells_x=100, cells_y=8)
    gap, pressure = np.full(grid.shape, np.inf), np.zeros(grid.shape)
    gap[10:90] = 0.0
    pressure[10:90][columns] = 1.0
    with pytest.raises(InvalidInputError, match=r"tilt = 0\.001: .* reaches further"):
        check_on_its_length(tilted, grid, gap, pressure)
    # What is held level may touch anywhere, a longer contact may reach the end, and a short one lie inside.
    check_on_its_length(level, grid, gap, pressure)
    check_on_its_length(tilted, grid, gap, np.where(np.isfinite(gap), 1.0, 0.0))
    check_on_its_length(tilted, grid, gap, np.roll(pressure, 40, axis=0))
