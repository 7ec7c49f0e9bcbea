"""Equivalent loads: alike at both ends under a load that is, and never on a corner itself."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.kernels.load import Load
from contactstudy.kernels.stress import half_space_stress
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


def test_an_eccentric_load_is_at_either_corner_what_it_is_nearby() -> None:
    """The corner is not taken for that of the other end."""
    cells = np.where(np.abs(GRID.y) < 0.5, 1.0, 0.0) * np.linspace(2.0, 0.5, GRID.cells_x)[:, None]
    problem = EndProblem(2.4, 0.3, cells, (Load.NORMAL,), GRID, Resolution())
    offset = problem.corner_offset
    x = np.array([0.0, offset, 2.4 - offset, 2.4])
    found = equivalent_loads_of(problem, x, np.array([0.0]), np.array([0.4]), reference=24.0)[Load.NORMAL]
    first, near_first, near_second, second = found.added[:, 0]
    assert (first, second) == pytest.approx((near_first, near_second))
    assert first != pytest.approx(second, rel=0.1)


def test_a_face_load_frees_its_end_of_what_the_opposite_half_space_leaves_there_too() -> None:
    """Where loads are mirrored once: in real space, with the load and its two images side by side, which are alike."""
    length, top, face = 2.4, Grid((0.0, 2.4), (-4.0, 4.0), 12, 32), Grid((0.0, 6.0), (-4.0, 4.0), 24, 32)
    cells = np.maximum(1 - top.y**2, 0.0) ** 2 * np.ones(top.shape)
    problem = EndProblem(length, 0.3, cells, (Load.NORMAL,), top, Resolution(), mirrored_once=True)
    found = equivalent_loads_of(problem, top.x, top.y, face.x, reference=24.0)[Load.NORMAL]
    y, z = top.y[16:24:3], face.x[2:20:4]
    copies, three = np.concatenate([cells + found.added] * 3), Grid((-2.4, 4.8), (-4.0, 4.0), 36, 32)
    left = half_space_stress(Load.NORMAL, copies, 0.3, three, np.zeros(1), y, z, extent=(-np.inf, np.inf))[0, 0]
    behind = np.array([length])
    opposite = half_space_stress(Load.NORMAL, found.second.T, 0.3, face, z, y, behind, extent=(0.0, np.inf))[2, :, :, 0]
    assert found.first[16:24:3, 2:20:4] == pytest.approx(left + opposite.T, abs=1e-2)
    assert np.abs(opposite).max() > 0.05
