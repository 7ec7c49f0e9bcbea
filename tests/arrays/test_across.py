"""The largest pressure of each cross-section between its cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy.arrays.across import largest_across


@given(offset=st.floats(-0.5, 0.5), cells=st.integers(8, 40))
def test_top_of_an_ellipse_wherever_the_cells_lie(offset: float, cells: int) -> None:
    step = 3.0 / cells
    y = step * (np.arange(cells) - 0.5 * cells + 0.5 + offset)
    pressure = np.sqrt(np.maximum(1 - y**2, 0.0))[None, :]
    assert largest_across(pressure)[0] == pytest.approx(1.0, abs=1e-9)


def test_columns_without_a_parabola_keep_their_largest_cell() -> None:
    pressure = np.array([[0.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [2.0, 1.0, 0.0, 0.0]])
    found = largest_across(pressure)
    assert found[0] == 0
    assert (found[1:] >= [3.0, 2.0]).all()
    assert (found[1:] <= 1.25 * np.array([3.0, 2.0])).all()
