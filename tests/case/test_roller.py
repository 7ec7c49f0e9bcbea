"""Gap of a roller on cells."""

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.case.roller import gap_on_cells, snap_to_ends


def test_cell_centre_within_rounding_is_under_the_roller():
    assert snap_to_ends(np.array([0.1 + 0.2]), 0.3, 0.1) == 0.3


def test_gap_at_centres_of_uniform_cells():
    grid = Grid(x_range=(0.0, 4.0), y_range=(-1.0, 1.0), cells_x=4, cells_y=1)
    gap = gap_on_cells(lambda x, y: x[:, None] ** 2 + 0 * y, grid, 2.0, 2.0)
    assert gap[:, 0].tolist() == [2.25, 0.25, 0.25, 2.25]
