"""Cells joined in twos."""

from __future__ import annotations

import numpy as np
import pytest

import contactstudy as cs


def test_cells_that_grow_steeply_can_be_joined() -> None:
    grid = cs.Grid.from_edges(np.cumsum([0.0, 1.0, 1.0, 3.9, 12.0]), (-1.0, 1.0), 8)
    coarse = grid.coarsened()
    assert coarse.widths == pytest.approx([2.0, 15.9])
    assert coarse.shape == (2, 4)


def test_a_small_fillet_is_solved_to_three_thousandths() -> None:
    steel = cs.Material(young=210e9, poisson=0.3)
    roller = cs.Roller(radius=5e-3, length=10e-3, profile=cs.profiles.Cylinder(fillet_radius=0.2e-3))
    case = cs.Case(body=cs.HalfSpace(material=steel), roller=roller, max_pressure=1.5e9)
    result = cs.solve(case, accuracy=0.003, stresses=False)
    assert float(result.peak_pressure / result.hertz_max_pressure) == pytest.approx(3.644, rel=0.003)
