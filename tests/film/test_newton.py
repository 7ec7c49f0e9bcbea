"""Steps of Newton's method for films."""

import numpy as np
import pytest

from contactstudy.film.line_contact import BARUS
from contactstudy.film.newton import SETTINGS, FilmProblem, _Iteration
from contactstudy.film.reynolds import FilmCells, Fluid


@pytest.mark.parametrize("end_pressure", [1.0, 20.0])
def test_step_is_bounded_relative_to_hertz_pressure_of_largest_column_load(end_pressure):
    """The bound on a step uses the Hertz pressure of the largest column load; a spike of the pressure does not raise
    it."""
    y_edges = 1.25 * end_pressure * np.linspace(-1.0, 1.0, 2001)
    cells = FilmCells(x_edges=np.array([0.0, 1.0, 2.0]), y_edges=y_edges, open_ends=False)
    problem = FilmProblem(
        cells=cells,
        fluid=Fluid.of(BARUS, 1e9, 1.0),
        gap=np.zeros(cells.shape),
        displace=np.zeros_like,
        column_stiffness=np.zeros((2, 2000, 2000), dtype=np.float32),
        load=1.0,
        lever=None,
        central_film=1.0,
    )
    # Hertz' half-width over a is Hertz' pressure over p0.
    pressure = np.array(
        [
            [max_pressure * np.sqrt(max(1 - (y / max_pressure) ** 2, 0.0)) for y in cells.y]
            for max_pressure in (1.0, end_pressure)
        ]
    )
    pressure[0, 1000] += 0.1 * end_pressure
    state = problem.create_state(pressure, np.ones(1), np.ones(cells.shape))
    change = np.append(np.where(pressure == pressure[1].max(), 0.6 * end_pressure, 0.0).ravel(), 0.0)
    next_state, fraction, largest_change = _Iteration(problem, SETTINGS).apply_step(state, change)
    assert largest_change == pytest.approx(0.6, rel=1e-3)
    assert fraction == pytest.approx(0.5, rel=1e-3)
    assert (next_state.pressure - pressure).max() == pytest.approx(0.3 * end_pressure, rel=1e-3)
