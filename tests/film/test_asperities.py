"""Rough surfaces: distances at given film heights, and states with NaN."""

import numpy as np
import pytest

from contactstudy.film import Asperities
from contactstudy.film.newton import SETTINGS, FilmProblem, StepFailedError, solve_newton
from contactstudy.film.reynolds import FilmCells, Fluid, Law

CELLS = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=np.linspace(-1.0, 1.0, 9), open_ends=False)
ROUGH = Asperities(rms=1e-7)


def make_problem(**changes):
    unit_law = Law(np.ones(8), np.zeros(8))
    attributes = {
        "cells": CELLS,
        "fluid": Fluid(
            density=lambda _: unit_law,
            reduced_pressure=lambda reduced: Law(reduced, np.ones_like(reduced)),
            flow_number=1.0,
        ),
        "gap": np.ones(CELLS.shape),
        "displace": lambda pressure: 0.1 * pressure,
        "column_stiffness": 0.1 * np.eye(8)[None],
        "load": 1.0,
        "lever": None,
        "central_film": 1.0,
        "mean_height": ROUGH.mean_height(1e-6),
    }
    return FilmProblem(**(attributes | changes))


@pytest.mark.parametrize("start", [-4.0, -1.0, 0.0, 3.0])
@pytest.mark.parametrize("height_ratio", [0.4, 1.0, 1e3, 1e6])
def test_distance_inverts_the_film_height(start, height_ratio):
    rough_problem = make_problem()
    distance = np.full(CELLS.shape, 0.1 * start)
    height = height_ratio * rough_problem.compute_film(distance).value
    assert rough_problem.compute_film(rough_problem.solve_distance(height, distance)).value == pytest.approx(
        height, rel=1e-6
    )


def test_distance_of_smooth_surfaces_equals_the_film():
    smooth_problem = make_problem(mean_height=None)
    height = np.linspace(0.1, 2.0, 8)[None]
    assert smooth_problem.solve_distance(height, 0 * height) == pytest.approx(height)


def test_nan_state_raises():
    rough_problem = make_problem()
    state = rough_problem.create_state(np.ones(CELLS.shape), np.zeros(1), np.full(CELLS.shape, np.nan))
    with pytest.raises(StepFailedError):
        solve_newton(rough_problem, None, SETTINGS, lambda: state)
