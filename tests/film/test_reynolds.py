"""Film on the faces between cells, and flow through them."""

import numpy as np
import pytest

from contactstudy.bodies.lubricant import Lubricant
from contactstudy.film.reynolds import FilmCells, Fluid, Law

CELLS = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.linspace(-1.0, 1.0, 21), open_ends=False)


def test_faces_of_a_smooth_film_follow_parabolas():
    height = 1 + CELLS.y**2
    film = CELLS.upwind(height) @ height
    assert film[2:-1] == pytest.approx(1 + CELLS.y_edges[2:-1] ** 2)


@pytest.mark.parametrize("seed", range(3))
def test_faces_of_a_steep_film_are_positive_and_bounded(seed):
    height = np.exp(np.random.default_rng(seed).uniform(-8, 8, CELLS.y.size))
    film = (CELLS.upwind(height) @ height)[1:]
    assert (film > 0).all()
    assert (film <= 2 * height * (1 + 1e-12)).all()


def test_flow_between_films_equals_linear_film_flow():
    faces = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.array([0.0, 1.0, 3.0]), open_ends=False).faces_y
    height, reduced_pressure = np.array([0.1, 2.0]), Law(np.array([1.0, 0.0]), np.ones(2))
    nodes, weights = np.polynomial.legendre.leggauss(100)
    linear_film = height.mean() + 0.5 * nodes * np.diff(height)
    resistance = 1.5 * 0.5 * float(weights @ linear_film**-3)
    assert faces.conduct_flow(4.0, reduced_pressure, height).flow[1] == pytest.approx(1 / (4.0 * resistance), rel=1e-8)


def test_flow_derivatives_agree_with_differences():
    faces = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.linspace(0.0, 1.0, 6), open_ends=False).faces_y
    height, pressure, step = np.array([0.1, 2.0, 1.0, 0.3, 0.7]), np.array([0.1, 0.4, 0.2, 0.5, 0.3]), 1e-6

    def flow(height, pressure):
        return faces.conduct_flow(2.0, Law(pressure**2, 2 * pressure), height)

    derivatives = flow(height, pressure)
    for cell in range(5):
        change = step * (np.arange(5) == cell)
        film_difference = (flow(height + change, pressure).flow - flow(height - change, pressure).flow) / (2 * step)
        pressure_difference = (flow(height, pressure + change).flow - flow(height, pressure - change).flow) / (2 * step)
        assert derivatives.film_jacobian.toarray()[:, cell] == pytest.approx(film_difference, rel=1e-6, abs=1e-9)
        assert derivatives.pressure_jacobian.toarray()[:, cell] == pytest.approx(
            pressure_difference, rel=1e-6, abs=1e-9
        )


@pytest.mark.parametrize("law", ["barus", "roelands"])
def test_flow_rises_with_the_pressure_step(law):
    coefficient = 2e-8
    oil = Lubricant(viscosity=0.02, pressure_viscosity=coefficient, viscosity_law=law, density_law="constant")
    fluid = Fluid.of(oil, 1e9, 1.0)
    faces = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.array([0.0, 1.0, 2.0]), open_ends=False).faces_y
    height = np.ones(2)

    def flow(pressure):
        reduced_pressure = fluid.reduced_pressure(np.array([pressure, 0.0]))
        pressure_flow = faces.conduct_flow(fluid.flow_number, reduced_pressure, height)
        assert pressure_flow.pressure_jacobian.toarray()[1, 0] >= 0
        return float(pressure_flow.flow[1])

    flows = [flow(pressure) for pressure in (0.1, 0.5, 1.0, 2.0, 5.0)]
    assert np.all(np.diff(flows) >= 0)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    viscosity = oil.viscosity_at(2.5e9 * (nodes + 1)) / oil.viscosity
    assert flows[-1] == pytest.approx(2.5 * float(weights @ (1 / viscosity)), rel=1e-6)
