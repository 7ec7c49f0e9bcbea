"""Equivalent loads: alike at both ends under a load that is, and never on a corner itself."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equivalent import equivalent_loads_of
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution

GRID = Grid((0.0, 2.4), (-1.0, 1.0), 8, 8)


@pytest.mark.parametrize("mirrored_once", [False, True])
def test_a_symmetric_load_has_the_same_at_both_ends(*, mirrored_once: bool) -> None:
    cells = np.where(np.abs(GRID.y) < 0.5, 1.0, 0.0) * np.ones(GRID.shape)
    problem = EndProblem(2.4, 0.3, cells, (Load.NORMAL,), GRID, Resolution(), mirrored_once=mirrored_once)
    offset = problem.corner_offset
    x = np.array([0.0, 0.5 * offset, offset, 0.3, 1.2, 2.1, 2.4 - offset, 2.4 - 0.5 * offset, 2.4])
    y, z = np.array([0.0, 0.6]), np.array([0.0, 0.5 * offset, offset, 0.4])
    found = equivalent_loads_of(problem, x, y, z, reference=24.0)[Load.NORMAL]
    assert found.added == pytest.approx(found.added[::-1], abs=1e-6)
    assert found.first == pytest.approx(found.second, abs=1e-6)
    # Nearer to a corner than a part of a cell it is that at this distance.
    assert found.added[:3] == pytest.approx(np.stack([found.added[2]] * 3))
    assert found.first[:, :3] == pytest.approx(np.stack([found.first[:, 2]] * 3, axis=1))
    assert np.abs(found.added[3] - found.added[2]).max() > 0.05 * np.abs(found.added).max()
