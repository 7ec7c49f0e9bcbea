"""Rejection of contacts at one end of a roller only."""

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
from tests.crowned_case import HALF_WIDTH, LENGTH, make_crowned_case


@pytest.mark.parametrize("window", [2.0, 16.0])
def test_roller_tilted_onto_its_end_is_rejected(window: float):
    case = make_crowned_case(tilt=0.1)
    with pytest.raises((InvalidInputError, WindowError), match=r"tilt = 0\.1"):
        solve(case, choose_grid(case, cells_y=8, window=window), stresses=False)


def test_load_at_the_end_is_rejected():
    case = make_crowned_case(load_position=17.95 * HALF_WIDTH)
    with pytest.raises(InvalidInputError, match=r"load_position = .* the contact reaches further"):
        solve(case, choose_grid(case, cells_y=8, window=24), stresses=False)


@pytest.mark.parametrize("distance_over_a", [0.2, 0.3])
def test_load_needs_a_minimum_distance_from_the_end(distance_over_a: float) -> None:
    untilted_case = make_crowned_case()
    start, stop = untilted_case.contact_range
    for position in (
        start + distance_over_a * untilted_case.hertz_half_width,
        stop - distance_over_a * untilted_case.hertz_half_width,
    ):
        eccentric_case = make_crowned_case(load_position=position)
        if distance_over_a < 0.25:
            with pytest.raises(InvalidInputError, match=r"load_position = .* is not balanced"):
                check_balanced(eccentric_case)
        else:
            check_balanced(eccentric_case)


@pytest.mark.parametrize("loaded_columns", [slice(0, 3), slice(-3, None)])
def test_short_contact_at_a_tilted_end_is_rejected(loaded_columns: slice) -> None:
    tilted_case, untilted_case = make_crowned_case(tilt=1e-3), make_crowned_case()
    grid = Grid(x_range=(0.0, LENGTH), y_range=(-4e-4, 4e-4), cells_x=100, cells_y=8)
    gap, pressure = np.full(grid.shape, np.inf), np.zeros(grid.shape)
    gap[10:90] = 0.0
    pressure[10:90][loaded_columns] = 1.0
    with pytest.raises(InvalidInputError, match=r"tilt = 0\.001: .* reaches further"):
        check_contact_length(tilted_case, grid, gap, pressure)
    # Accepted: any contact without tilt, a contact over the whole length, a short contact inside.
    check_contact_length(untilted_case, grid, gap, pressure)
    check_contact_length(tilted_case, grid, gap, np.where(np.isfinite(gap), 1.0, 0.0))
    check_contact_length(tilted_case, grid, gap, np.roll(pressure, 40, axis=0))
