"""Equivalent loads: symmetry, corners, and the free end in real space."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.arrays.grid import Points
from contactstudy.kernels.field import half_space_field, stress_influence
from contactstudy.kernels.load import Load
from contactstudy.overlapping.operators import OverlappingOperators
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution

GRID = Grid(x_range=(0.0, 2.4), y_range=(-1.0, 1.0), cells_x=8, cells_y=8)


def compute_equivalent_loads(
    problem: EndProblem, x: np.ndarray, y: np.ndarray, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Load added on the top (x, y) and loads on the faces (end, y, z) under the pressure of a problem."""
    operators = OverlappingOperators.of(problem, Points(x, y, z), reference=24.0).equivalent(Load.NORMAL)
    cell_loads = problem.cell_loads.ravel()
    return (operators.top_load @ cell_loads).reshape(x.size, y.size), np.array(
        [(face @ cell_loads).reshape(y.size, z.size) for face in operators.faces]
    )


@pytest.mark.parametrize("mirrored_once", [False, True])
def test_symmetric_load_has_equal_end_loads(*, mirrored_once: bool) -> None:
    cell_loads = np.where(np.abs(GRID.y) < 0.5, 1.0, 0.0) * np.ones(GRID.shape)
    problem = EndProblem(
        length=2.4,
        poisson=0.3,
        cell_loads=cell_loads,
        loads=(Load.NORMAL,),
        grid=GRID,
        resolution=Resolution(),
        mirrored_once=mirrored_once,
    )
    offset = problem.corner_offset
    x = np.array([0.0, 0.5 * offset, offset, 0.3, 1.2, 2.1, 2.4 - offset, 2.4 - 0.5 * offset, 2.4])
    y, z = np.array([0.0, 0.6]), np.array([0.0, 0.5 * offset, offset, 0.4])
    top_load, (first_face, second_face) = compute_equivalent_loads(problem, x, y, z)
    assert top_load == pytest.approx(top_load[::-1], abs=1e-6)
    assert first_face == pytest.approx(second_face, abs=1e-6)
    # Within the corner offset the load is constant.
    assert top_load[:3] == pytest.approx(np.stack([top_load[2]] * 3))
    assert first_face[:, :3] == pytest.approx(np.stack([first_face[:, 2]] * 3, axis=1))
    assert np.abs(top_load[3] - top_load[2]).max() > 0.05 * np.abs(top_load).max()


def test_equivalent_load_is_continuous_at_corners() -> None:
    """The load at each corner equals the load at the offset from this corner."""
    cell_loads = np.where(np.abs(GRID.y) < 0.5, 1.0, 0.0) * np.linspace(2.0, 0.5, GRID.cells_x)[:, None]
    problem = EndProblem(
        length=2.4, poisson=0.3, cell_loads=cell_loads, loads=(Load.NORMAL,), grid=GRID, resolution=Resolution()
    )
    offset = problem.corner_offset
    x = np.array([0.0, offset, 2.4 - offset, 2.4])
    top_load, _ = compute_equivalent_loads(problem, x, np.array([0.0]), np.array([0.4]))
    first_corner, near_first_corner, near_second_corner, second_corner = top_load[:, 0]
    assert (first_corner, second_corner) == pytest.approx((near_first_corner, near_second_corner))
    assert first_corner != pytest.approx(second_corner, rel=0.1)


def test_single_mirror_face_load_frees_end() -> None:
    """The sum of stresses on the end in real space, under the load and its two images, equals the face load."""
    length, top_grid, face_grid = (
        2.4,
        Grid(x_range=(0.0, 2.4), y_range=(-4.0, 4.0), cells_x=12, cells_y=32),
        Grid(x_range=(0.0, 6.0), y_range=(-4.0, 4.0), cells_x=24, cells_y=32),
    )
    cell_loads = np.maximum(1 - top_grid.y**2, 0.0) ** 2 * np.ones(top_grid.shape)
    problem = EndProblem(
        length=length,
        poisson=0.3,
        cell_loads=cell_loads,
        loads=(Load.NORMAL,),
        grid=top_grid,
        resolution=Resolution(),
        mirrored_once=True,
    )
    top_load, (first_face, second_face) = compute_equivalent_loads(problem, top_grid.x, top_grid.y, face_grid.x)
    y, z = top_grid.y[16:24:3], face_grid.x[2:20:4]
    mirrored_loads, mirrored_grid = (
        np.concatenate([cell_loads + top_load] * 3),
        Grid(x_range=(-2.4, 4.8), y_range=(-4.0, 4.0), cells_x=36, cells_y=32),
    )
    end_stress = half_space_field(
        mirrored_loads,
        stress_influence(Load.NORMAL, 0.3),
        mirrored_grid,
        Points(np.zeros(1), y, z),
        extent=(-np.inf, np.inf),
    )[0, 0]
    opposite_depth = np.array([length])
    opposite_stress = half_space_field(
        second_face.T, stress_influence(Load.NORMAL, 0.3), face_grid, Points(z, y, opposite_depth), extent=(0.0, np.inf)
    )[2, :, :, 0]
    assert first_face[16:24:3, 2:20:4] == pytest.approx(end_stress + opposite_stress.T, abs=1e-2)
    assert np.abs(opposite_stress).max() > 0.05
