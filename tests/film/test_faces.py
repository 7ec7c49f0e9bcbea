"""Film on the faces between cells, and least films between their centres."""

import numpy as np
import pytest

from contactstudy.bodies.lubricant import Lubricant
from contactstudy.film.reynolds import FilmCells, Fluid
from contactstudy.film.solve import _least

CELLS = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.linspace(-1.0, 1.0, 21), open_ends=False)


def test_faces_of_a_smooth_film_are_parabolas():
    height = 1 + CELLS.y**2
    film = CELLS.along_y.bounded(height) @ height
    assert film[2:-1] == pytest.approx(1 + CELLS.y_edges[2:-1] ** 2)


@pytest.mark.parametrize("seed", range(3))
def test_faces_of_a_steep_film_are_positive_and_bounded(seed):
    height = np.exp(np.random.default_rng(seed).uniform(-8, 8, CELLS.y.size))
    film = (CELLS.along_y.bounded(height) @ height)[1:]
    assert (film > 0).all()
    mean = CELLS.along_y.mean @ height
    assert (film <= np.maximum(2 * height, 0.2 * mean[1:]) * (1 + 1e-12)).all()


def test_least_film_between_cells_is_positive():
    least = _least(np.array([0.0, 1.0, 2.0]), np.array([0.5, 0.01, 1.0]))
    assert 0 < least.value < 0.01
    assert 0.5 < least.position < 1.0


@pytest.mark.parametrize("law", ["barus", "roelands"])
def test_flow_between_two_cells_rises_with_the_step_of_the_pressure(law):
    coefficient = 2e-8
    oil = Lubricant(viscosity=0.02, pressure_viscosity=coefficient, viscosity_law=law, density_law="constant")
    fluid = Fluid.of(oil, 1e9, 1.0)
    faces = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.array([0.0, 1.0, 2.0]), open_ends=False).along_y
    height = np.ones(2)

    def flow(pressure):
        reduced = fluid.reduced_pressure(np.array([pressure, 0.0]))
        conducted = faces.conducted(fluid.speed, reduced, height, faces.mean)
        assert conducted.by_pressure.toarray()[1, 0] <= 0
        return -float(conducted.flow[1])

    flows = [flow(pressure) for pressure in (0.1, 0.5, 1.0, 2.0, 5.0)]
    assert np.all(np.diff(flows) >= 0)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    viscosity = oil.viscosity_at(2.5e9 * (nodes + 1)) / oil.viscosity
    assert flows[-1] == pytest.approx(2.5 * float(weights @ (1 / viscosity)), rel=1e-6)
