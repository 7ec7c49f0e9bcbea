"""Fields of the free ends at several sets of positions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.arrays.grid import Points
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import AuxiliaryLoads
from contactstudy.overlapping.field import DISPLACEMENT, STRESS, end_fields
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution

POINT_SETS = (
    Points(np.array([0.0, 0.1, 1.0, 4.0]), np.array([0.0, 0.5]), np.array([0.05, 0.5, 3.0])),
    Points(np.array([0.0, 8.0]), np.array([-0.3, 0.1, 0.9]), np.array([0.1, 0.2])),
    Points(np.array([7.5]), np.array([0.2]), np.array([0.4])),
)


@pytest.mark.parametrize("length", [8.0, np.inf])
def test_field_does_not_depend_on_further_positions(length: float) -> None:
    grid = Grid(x_range=(0.0, 8.0), y_range=(-1.0, 1.0), cells_x=16, cells_y=16)
    pressure = (1 - grid.y**2) ** 2 * np.linspace(0.5, 1.5, 16)[:, None]
    problem = EndProblem(
        length=length,
        poisson=0.3,
        cell_loads=pressure,
        loads=(Load.NORMAL, Load.ALONG_Y),
        grid=grid,
        resolution=Resolution(),
    )
    positions = POINT_SETS if np.isfinite(length) else POINT_SETS[:1] + POINT_SETS[2:]
    single_fields = [end_fields(problem, STRESS, [position])[0] for position in positions]
    for computed, expected in zip(end_fields(problem, STRESS, positions), single_fields, strict=True):
        for load in problem.loads:
            # The panels along y depend on the farthest and the nearest of all points.
            assert np.abs(computed[load] - expected[load]).max() < 2e-5, load


def count_evaluated_points(point_sets: list[Points]) -> int:
    """Total number of points over all evaluations of a field."""
    grid = Grid(x_range=(0.0, 8.0), y_range=(-1.0, 1.0), cells_x=4, cells_y=4)
    point_counts = []

    def count_points(loads: AuxiliaryLoads, x: FloatArray, z: FloatArray) -> FloatArray:
        point_counts.append(x.size * z.size)
        return STRESS.face_load_field(loads, x, z)

    problem = EndProblem(
        length=8.0,
        poisson=0.3,
        cell_loads=np.ones(grid.shape),
        loads=(Load.NORMAL,),
        grid=grid,
        resolution=Resolution(),
    )
    end_fields(problem, replace(STRESS, face_load_field=count_points), point_sets)
    return sum(point_counts)


def test_evaluation_excludes_points_of_other_sets() -> None:
    """A line along the top and a line along the depth are evaluated separately, not on their common rectangle."""
    y, x, z = np.zeros(1), np.linspace(0.1, 1.0, 60), np.linspace(0.1, 1.0, 60)
    lines = [Points(x, y, z[:1]), Points(x[:1], y, z)]
    assert count_evaluated_points(lines) < 1.5 * sum(count_evaluated_points([line]) for line in lines)


@pytest.mark.parametrize(
    ("length", "loads"),
    [(8.0, (Load.NORMAL, Load.ALONG_Y)), pytest.param(np.inf, (Load.ALONG_X,), marks=pytest.mark.slow)],
)
def test_fields_of_loads_add_up(length: float, loads: tuple[Load, ...]) -> None:
    """The quadratures depend on body, grid and positions, not on the load."""
    grid = Grid(x_range=(0.0, 8.0), y_range=(-1.5, 1.5), cells_x=16, cells_y=16)
    tilted_load = np.sqrt(np.clip(1 - grid.y**2, 0, None)) * np.linspace(0.5, 1.5, 16)[:, None]
    random_load = np.random.default_rng(1).random(grid.shape) * (np.abs(grid.y) < 1)
    single_cell_load = np.zeros(grid.shape)
    single_cell_load[2:5, 7:9] = 1.0
    position = Points(np.array([0.0, 0.05, 3.0]), np.array([-1.0, 0.1]), np.array([0.0, 0.02, 0.3]))

    def compute_fields(cell_loads: FloatArray) -> list[FloatArray]:
        problem = EndProblem(
            length=length, poisson=0.3, cell_loads=cell_loads, loads=loads, grid=grid, resolution=Resolution()
        )
        (stress,) = end_fields(problem, STRESS, [position], 80.0)
        (displacement,) = end_fields(problem, DISPLACEMENT, [position], 10 * length)
        return [field[load] for field in (stress, displacement) for load in loads]

    load_fields = [compute_fields(cell_loads) for cell_loads in (tilted_load, random_load, single_cell_load)]
    for *terms, sum_field in zip(
        *load_fields, compute_fields(tilted_load + random_load + single_cell_load), strict=True
    ):
        assert np.abs(sum(terms) - sum_field).max() < 1e-10 * np.abs(sum_field).max()
