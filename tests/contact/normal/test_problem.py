"""One contact problem: transfer between coarse and fine cells, and number of operator applications."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Grid, HalfSpace, Material
from contactstudy.arrays.grid import interpolate_columns
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.problem import (
    ContactOperator,
    ContactProblem,
    Resultants,
    _continue_square,
    _initial_guess,
    _remove_mean_slope,
    halve_cells,
    solve_normal,
    solve_problem,
)
from contactstudy.fields.surface import surface_operator
from contactstudy.kernels.load import Load

BODY = HalfSpace(material=Material(0.91, 0.3))
LOADS = (Load.NORMAL, Load.ALONG_Y)


class CountingOperator:
    """An operator that counts its applications."""

    def __init__(self, grid: Grid) -> None:
        self.compute_displacement, self.application_count = surface_operator(BODY, grid, LOADS), 0

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        self.application_count += 1
        return self.compute_displacement(loads)

    def precondition(self, gap: FloatArray) -> FloatArray:
        return self.compute_displacement.precondition(gap)

    @property
    def coarse(self) -> ContactOperator:
        return self.compute_displacement.coarse


def make_ball_problem(
    grid: Grid, load: float | None = 0.05, *, friction: float = 0.0, approach: float = 0.0
) -> ContactProblem:
    gap = 0.05 * ((grid.x[:, None] - 0.1) ** 2 + grid.y**2) - approach
    total_pressure = None if load is None else load / grid.cell_area
    return ContactProblem(
        grid=grid, gap=gap, resultants=Resultants(total_pressure), friction=friction, tolerance=1e-6, max_iterations=500
    )


GRID = Grid(x_range=(-1.5, 1.5), y_range=(-1.5, 1.5), cells_x=24, cells_y=20)
UNEQUAL_COLUMNS = Grid.between(np.cumsum([-1.5, 0.1, 0.3, 0.4, 0.2, 0.1, 0.3, 0.6, 1.0]), (-1.5, 1.5), 20)
GRADED_GRID = Grid.between(np.concatenate([np.linspace(-1.5, 0.3, 11), np.linspace(0.4, 1.5, 12)]), (-1.5, 1.5), 20)


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("grid", [GRID, GRADED_GRID], ids=["uniform", "graded"])
def test_applications_are_counted(grid: Grid, friction: float) -> None:
    operator = CountingOperator(grid)
    computed = solve_problem(operator, make_ball_problem(grid, friction=friction))
    assert computed.converged
    assert computed.applications == operator.application_count


def test_overflow_in_first_round_is_not_converged() -> None:
    """No pressure has these two resultants, so the iteration overflows."""
    lever = np.where(GRID.x[:, None] > 0.4, 1.0, 1e-300)
    problem = make_ball_problem(GRID, friction=0.4)
    with np.errstate(all="ignore"):
        computed = solve_problem(CountingOperator(GRID), replace(problem, resultants=Resultants(1e300, lever)))
    assert not computed.converged


def test_coupled_pressure_equals_next_round() -> None:
    """The pressure under its own friction equals the pressure of the next round, within the tolerance."""
    request = make_ball_problem(GRID, friction=0.4)
    operator = CountingOperator(GRID)
    computed = solve_problem(operator, request)
    friction_displacement = operator({Load.ALONG_Y: request.friction * computed.pressure})
    repeated_solution = solve_normal(
        operator, replace(request, gap=request.gap + friction_displacement, tolerance=1e-10)
    )
    assert computed.pressure == pytest.approx(repeated_solution.pressure, abs=3e-6 * repeated_solution.pressure.max())
    uncoupled_iterate = solve_normal(operator, request)
    assert (
        np.abs(uncoupled_iterate.pressure - repeated_solution.pressure).max() > 1e-2 * repeated_solution.pressure.max()
    )


def test_halved_cells_are_linear_between_centres() -> None:
    cell_values = np.random.default_rng(0).standard_normal((5, 3))
    fine_positions = (np.arange(10) + 0.5) / 2 - 0.5
    assert halve_cells(cell_values, 0) == pytest.approx(
        interpolate_columns(cell_values, np.arange(5.0), fine_positions), abs=1e-12
    )


def compute_lever(grid: Grid, position: float) -> tuple[FloatArray, float]:
    """Lever about a position, over the largest arm, and the largest arm."""
    arm = grid.x[:, None] - position
    return arm / np.abs(arm).max(), float(np.abs(arm).max())


@pytest.mark.parametrize("grid", [GRID, GRADED_GRID, UNEQUAL_COLUMNS], ids=["uniform", "graded", "unlike neighbours"])
def test_merged_cells_keep_areas_heights_and_levers(grid: Grid) -> None:
    lever, _ = compute_lever(grid, 0.2)
    plane = 0.3 + 0.1 * grid.x[:, None] + 0.0 * grid.y
    coarse_problem = ContactProblem(
        grid=grid, gap=plane, resultants=Resultants(2.0, lever), friction=0.0, tolerance=1e-6, max_iterations=500
    ).coarsen()
    coarse_grid = coarse_problem.grid
    assert coarse_grid.shape == (grid.cells_x // 2, grid.cells_y // 2)
    middles = 0.5 * (grid.x_edges[2::2] + grid.x_edges[:-2:2])
    assert coarse_problem.gap == pytest.approx(np.broadcast_to(0.3 + 0.1 * middles[:, None], coarse_grid.shape))
    assert coarse_problem.resultants.lever is not None
    assert coarse_problem.resultants.lever[:, 0] == pytest.approx(
        (middles - 0.2) / np.abs(grid.x - 0.2).max(), abs=1e-12
    )
    # The force is equal: the coarse cells are four times as large.
    assert coarse_problem.resultants.total == pytest.approx(2.0 * grid.cell_area / coarse_grid.cell_area)


def test_merged_cells_ignore_infinite_gaps() -> None:
    gap = np.broadcast_to(GRADED_GRID.x[:, None], GRADED_GRID.shape).copy()
    gap[:3] = np.inf
    coarse_problem = ContactProblem(
        grid=GRADED_GRID, gap=gap, resultants=Resultants(1.0), friction=0.0, tolerance=1e-6, max_iterations=500
    ).coarsen()
    assert np.isinf(coarse_problem.gap[0]).all()
    assert coarse_problem.gap[1] == pytest.approx(GRADED_GRID.x[3])
    mid_x = 0.5 * (GRADED_GRID.x_edges[4] + GRADED_GRID.x_edges[6])
    assert coarse_problem.gap[2] == pytest.approx(mid_x)


@pytest.mark.parametrize("grid", [GRID, GRADED_GRID], ids=["uniform", "graded"])
def test_free_tilt_removes_mean_slope(grid: Grid) -> None:
    lever, arm = compute_lever(grid, 0.2)
    level_gap = np.where(grid.x[:, None] > 1.2, np.inf, 0.05 * grid.y**2 + 0.0 * grid.x[:, None])
    sloping_gap = level_gap + 0.3 * (grid.x[:, None] - 0.2)
    request = ContactProblem(
        grid=grid, gap=sloping_gap, resultants=Resultants(1.0, lever), friction=0.0, tolerance=1e-6, max_iterations=500
    )
    is_under_shape = np.isfinite(level_gap)
    assert _remove_mean_slope(request)[is_under_shape] == pytest.approx(level_gap[is_under_shape], abs=1e-12)
    assert _remove_mean_slope(replace(request, resultants=Resultants(1.0))) is request.gap
    assert request.rigid_height((0.5, 0.3 * arm)) == pytest.approx(0.5 + 0.3 * (grid.x[:, None] - 0.2))


def test_initial_guess_follows_gap_below_level() -> None:
    """The guess on few cells is positive on 40 percent of the cells, those with the smallest gap."""
    request = make_ball_problem(GRID)
    guess = _initial_guess(CountingOperator(GRID), request)
    is_loaded = guess > 0
    assert is_loaded.mean() == pytest.approx(0.4, abs=0.02)
    assert request.gap[is_loaded].max() < request.gap[~is_loaded].min()
    assert np.ptp(request.gap[is_loaded] + guess[is_loaded] ** 2) < 1e-12
    # The level lies above the gap of a flat shape, so the whole flat shape is loaded.
    stepped_problem = replace(request, gap=np.where(GRID.x[:, None] < 0, 0.0, 1.0) + 0 * request.gap)
    assert (_initial_guess(CountingOperator(GRID), stepped_problem) > 0).tolist() == (stepped_problem.gap == 0).tolist()
    # A prescribed approach determines the cells that overlap.
    approach_problem = make_ball_problem(GRID, None, approach=0.02)
    assert ((_initial_guess(CountingOperator(GRID), approach_problem) > 0) == (approach_problem.gap < 0)).all()


def test_squared_pressure_continues_outside_hertz_contact() -> None:
    """The square is ``p0**2 (1 - r**2 / a**2)`` inside; just outside the contact it decreases with about this slope."""
    grid = Grid(x_range=(-1.5, 1.5), y_range=(-1.5, 1.5), cells_x=60, cells_y=60)
    request = make_ball_problem(grid)
    operator = CountingOperator(grid)
    computed = solve_normal(operator, request)
    squared_pressure = _continue_square(operator, request, computed)
    modulus, radius = BODY.material.plane_strain_modulus, 10.0
    half_width = (0.75 * 0.05 * radius / modulus) ** (1 / 3)
    peak = 1.5 * 0.05 / (np.pi * half_width**2)
    position = np.hypot(grid.x[:, None] - 0.1, grid.y) / half_width
    hertz_square = peak**2 * (1 - position**2)
    is_inside, is_adjacent = position < 0.9, (position > 1.03) & (position < 1.15)
    assert squared_pressure[is_inside] == pytest.approx(hertz_square[is_inside], abs=0.02 * peak**2)
    assert (squared_pressure[position > 1.1] < 0).all()
    assert squared_pressure[is_adjacent] / hertz_square[is_adjacent] == pytest.approx(
        np.ones(is_adjacent.sum()), abs=0.5
    )
    assert np.median(squared_pressure[is_adjacent] / hertz_square[is_adjacent]) == pytest.approx(0.65, abs=0.1)


@pytest.mark.parametrize("approach", [False, True])
@pytest.mark.parametrize("graded", [False, True])
def test_initial_guess_from_coarse_cells_approximates_solution(*, graded: bool, approach: bool) -> None:
    edges = np.linspace(-1.5, 1.5, 65) + (0.1 * np.linspace(-1, 1, 65) ** 2 if graded else 0.0)
    grid = Grid.between(edges, (-1.5, 1.5), 64)
    operator = CountingOperator(grid)
    request = make_ball_problem(grid, None, approach=0.04) if approach else make_ball_problem(grid)
    guess, computed = _initial_guess(operator, request), solve_normal(operator, request).pressure
    relative_difference = (grid.weights * np.abs(guess - computed)).sum() / (grid.weights * computed).sum()
    assert relative_difference < 0.03
    assert ((guess > 0) != (computed > 0)).sum() < 0.05 * (computed > 0).sum()


@pytest.mark.parametrize("unit", [2.0**-17, 1.0])
@pytest.mark.parametrize("friction", [0.4, 1.0, 1.5])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_last_round_changes_surface_within_tolerance(tolerance: float, friction: float, unit: float) -> None:
    """The last round changes the displacement by less than the tolerance times its variation, in any unit."""
    grid = Grid(x_range=(-1.5 * unit, 1.5 * unit), y_range=(-1.5 * unit, 1.5 * unit), cells_x=16, cells_y=16)
    body = HalfSpace(material=Material(0.91, 0.0))
    expected = surface_operator(body, grid, LOADS)
    friction_displacements: list[FloatArray] = []

    class RecordingOperator(CountingOperator):
        def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
            computed = expected(loads)
            if Load.ALONG_Y in loads:
                friction_displacements.append(computed)
            return computed

    operator = RecordingOperator(grid)
    operator.compute_displacement = expected
    gap = 0.05 * (grid.x[:, None] ** 2 + grid.y**2) / unit
    request = ContactProblem(
        grid=grid,
        gap=gap,
        resultants=Resultants(0.05 * unit**2 / grid.cell_area),
        friction=friction,
        tolerance=tolerance,
        max_iterations=500,
    )
    computed = solve_problem(operator, request)
    assert computed.converged
    displacement_change = float(
        np.ptp((friction_displacements[-1] - friction_displacements[-2])[computed.pressure > 0])
    )
    assert displacement_change <= 0.55 * tolerance * float(np.ptp(expected({Load.NORMAL: computed.pressure})))
