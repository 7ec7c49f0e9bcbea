"""Film of the finite elements: compliance against a closed form, derivatives, and a coarse mesh."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import xlogy

from benchmarks.finite_elements.film import Reynolds, compute_compliance, solve
from benchmarks.finite_elements.film_file import COARSE_RESOLUTION
from contactstudy.film.levels import create_cells
from contactstudy.verification.film import coarse_film
from contactstudy.verification.problems import FILM_CASES, FILM_FILE, LubricatedCase, load_reference

X_EDGES, Y_EDGES = np.array([0.0, 0.2, 0.7, 1.3, 1.8, 2.0]), np.array([-2.0, -1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0])


@pytest.mark.slow
def test_compliance_without_lateral_contraction_equals_plane_strain() -> None:
    """Poisson's ratio 0: under equal columns ``-(2 / pi) ln|y|`` of plane strain, up to a constant."""
    case = LubricatedCase(length=2.0, amplitude=0.25, load_number=10.0, lubricant_number=5.0, poisson=0.0)
    column_sums = compute_compliance(case, X_EDGES, Y_EDGES, COARSE_RESOLUTION).sum(axis=2)
    y = 0.5 * (Y_EDGES[1:] + Y_EDGES[:-1])
    end_distances = y[:, None] - Y_EDGES
    exact_compliance = 2 / np.pi * np.diff(xlogy(end_distances, np.abs(end_distances)), axis=1)
    constants = (column_sums - exact_compliance) / np.diff(Y_EDGES)
    np.testing.assert_allclose(constants, constants[0, 0, 0], rtol=0, atol=2e-3)


def test_complex_step_derivatives_equal_differences() -> None:
    rng = np.random.default_rng(1)
    reynolds = Reynolds(X_EDGES, Y_EDGES, 0.1, 5.0)
    pressure, film = rng.uniform(0.1, 1.0, (2, 5, 7))
    step = 1e-7 * rng.uniform(-1, 1, (2, 5, 7))
    change = reynolds.outflow(pressure + step[0], film + step[1]) - reynolds.outflow(pressure - step[0], film - step[1])
    pressure_derivative, film_derivative = reynolds.derivatives(pressure, film)
    expected = 2 * (pressure_derivative @ step[0].ravel() + film_derivative @ step[1].ravel())
    np.testing.assert_allclose(change.ravel(), expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())


@pytest.mark.slow
@pytest.mark.parametrize("name", FILM_CASES)
def test_film_on_coarse_mesh_approximates_stored_film(name: str) -> None:
    case, stored_film, film = FILM_CASES[name], load_reference(FILM_FILE, name), coarse_film(name)
    cells = create_cells(film, film.coarsest_level)[0]
    edges = cells.x_edges, cells.y_edges
    pressure, height = solve(case, compute_compliance(case, *edges, COARSE_RESOLUTION), *edges)
    np.testing.assert_allclose(height, stored_film["film"], rtol=2e-3)
    np.testing.assert_allclose(pressure, stored_film["pressure"], atol=2e-3)
