"""Gap of a roller on cells."""

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Grid, Material, Roller
from contactstudy.case.roller import snap_to_ends


def test_centre_within_rounding_snaps_to_roller_end():
    assert snap_to_ends(np.array([0.1 + 0.2]), 0.3, 0.1) == 0.3


def test_gap_of_tilted_roller_is_linear():
    body = FiniteLengthSpace(length=4.0, material=Material(1e9, 0.3))
    case = Case(body=body, roller=Roller(radius=10.0, length=2.0), max_pressure=1e7, tilt=0.01)
    gap = case.gap(Grid(x_range=(0.0, 4.0), y_range=(-2.0, 2.0), cells_x=4, cells_y=2))
    assert gap[1] == pytest.approx(0.05 + 0.01 * 0.5)
    assert gap[2] == pytest.approx(0.05 - 0.01 * 0.5)
    assert np.isinf(gap[[0, 3]]).all()
