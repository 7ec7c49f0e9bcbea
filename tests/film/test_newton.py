"""Steps of Newton's method for films."""

import numpy as np
import pytest

from contactstudy.film.line_contact import BARUS
from contactstudy.film.newton import SETTINGS, FilmProblem, _Iteration, initial_state
from contactstudy.film.reynolds import FilmCells, Fluid


@pytest.mark.parametrize("largest_pressure", [1.0, 20.0])
def test_step_is_bounded_relative_to_largest_pressure(largest_pressure):
    """At a sharp end the pressure exceeds Hertz' by powers of ten."""
    cells = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.linspace(-2.0, 1.5, 9), open_ends=False)
    problem = FilmProblem(
        cells=cells,
        fluid=Fluid.of(BARUS, 1e9, 1.0),
        gap=0.5 * cells.y[None] ** 2,
        displace=np.zeros_like,
        column_stiffness=np.zeros((1, 8, 8), dtype=np.float32),
        load=1.0,
        lever=None,
        central_film=1.0,
    )
    pressure = np.linspace(0.0, largest_pressure, 8)[None]
    state = initial_state(problem, pressure, np.ones(1), problem.gap + 1.0)
    change = np.append(0.6 * pressure.ravel(), 0.0)
    next_state, fraction, _ = _Iteration(problem, SETTINGS).apply_step(state, change)
    assert fraction == pytest.approx(0.5)
    assert next_state.pressure.max() == pytest.approx(1.3 * largest_pressure)
