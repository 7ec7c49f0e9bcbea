"""Operators of the overlapping bodies: transposes, sums of loads, and the iteration against the direct solution."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator, gmres

from contactstudy import Grid
from contactstudy.arrays.grid import Points
from contactstudy.kernels.load import Load
from contactstudy.overlapping.operators import OverlappingOperators
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution

UNIFORM_GRID = Grid(x_range=(0.0, 2.0), y_range=(-1.5, 1.5), cells_x=8, cells_y=6)
COLUMNS = Grid.from_edges([0.0, 0.1, 0.3, 0.7, 1.2, 1.7, 2.0], (-1.5, 1.5), 6)
DEPTHS = np.array([0.1, 0.5])


def make_operators(grid: Grid, length: float, load: Load, *, mirrored_once: bool = False) -> OverlappingOperators:
    resolution = Resolution().for_loads((load,))
    problem = EndProblem(
        length=length,
        poisson=0.3,
        cell_loads=np.zeros(grid.shape),
        loads=(load,),
        grid=grid,
        resolution=resolution,
        mirrored_once=mirrored_once,
    )
    reference_depth = 10 * length if np.isfinite(length) else None
    return OverlappingOperators.of(problem, Points(grid.x, grid.y, DEPTHS), reference=reference_depth)


def check_transpose(operator: LinearOperator) -> None:
    generator = np.random.default_rng(0)
    column_vector, row_vector = (
        generator.standard_normal(operator.shape[1]),
        generator.standard_normal(operator.shape[0]),
    )
    product, transposed_product = operator @ column_vector, operator.T @ row_vector
    scale = max(
        np.linalg.norm(product) * np.linalg.norm(row_vector),
        np.linalg.norm(transposed_product) * np.linalg.norm(column_vector),
    )
    assert row_vector @ product == pytest.approx(column_vector @ transposed_product, abs=1e-12 * scale)


@pytest.mark.parametrize(
    ("grid", "length", "mirrored_once"),
    [(COLUMNS, 2.0, False), (UNIFORM_GRID, 2.0, True), (UNIFORM_GRID, np.inf, False)],
    ids=["slab", "single", "quarter"],
)
@pytest.mark.parametrize("load", list(Load))
def test_operators_match_their_transposes(grid: Grid, length: float, load: Load, *, mirrored_once: bool) -> None:
    operators = make_operators(grid, length, load, mirrored_once=mirrored_once)
    equivalent = operators.equivalent(load)
    for operator in (
        operators.modes(load),
        operators.to_faces(load),
        operators.to_top,
        operators.solution,
        operators.top_values,
        operators.face_values(load, 0),
        equivalent.top_load,
        *equivalent.faces,
    ):
        check_transpose(operator)


def test_problem_of_several_loads_sums_single_loads() -> None:
    top_load, faces = make_operators(COLUMNS, 2.0, Load.NORMAL).equivalent(Load.NORMAL)
    loads = np.random.default_rng(1).random((COLUMNS.cells_x * COLUMNS.cells_y, 3))
    for operator in (top_load, *faces):
        assert (operator @ loads).sum(axis=1) == pytest.approx(operator @ loads.sum(axis=1), abs=1e-12)


@pytest.mark.parametrize("load", [Load.NORMAL, Load.ALONG_X])
def test_iteration_from_both_ends_equals_the_direct_solution(load: Load) -> None:
    """The alternation between H and V converges to the solution of the equation set in a quarter space."""
    operators = make_operators(UNIFORM_GRID, np.inf, load)
    cell_loads = np.random.default_rng(2).random(UNIFORM_GRID.cells_x * UNIFORM_GRID.cells_y)
    source = operators.to_faces(load) @ (operators.modes(load) @ cell_loads)
    faces, to_faces = source, operators.to_faces(Load.NORMAL)
    for _ in range(40):
        faces = source + to_faces @ (operators.to_top @ faces)
    direct_solution = operators.equivalent(load).top_load @ cell_loads
    assert operators.top_values @ faces == pytest.approx(direct_solution, abs=1e-10)
    assert np.abs(direct_solution).max() > 0.1


def test_long_waves_stall_the_iteration_and_gmres_converges() -> None:
    operators = make_operators(UNIFORM_GRID, 2.0, Load.NORMAL)
    cell_loads = (np.linspace(1.5, 0.5, UNIFORM_GRID.cells_x)[:, None] * np.ones(UNIFORM_GRID.cells_y)).ravel()
    to_faces, to_top = operators.to_faces(Load.NORMAL), operators.to_top
    source = to_faces @ (operators.modes(Load.NORMAL) @ cell_loads)
    direct_solution = operators.equivalent(Load.NORMAL).top_load @ cell_loads
    faces = source
    for _ in range(50):
        faces = source + to_faces @ (to_top @ faces)
    assert np.abs(operators.top_values @ faces - direct_solution).max() > 1e-2
    system = LinearOperator((source.size, source.size), lambda stress: stress - to_faces @ (to_top @ stress))
    faces, exit_code = gmres(system, source, rtol=1e-13, restart=100)
    assert not exit_code
    assert operators.top_values @ faces == pytest.approx(direct_solution, abs=1e-10)
