"""The contact iteration from bad first guesses, against non-negative least squares and its own conditions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize

from contactstudy import FiniteLengthSpace, Grid, Material
from contactstudy.contact.conjugate_gradients import Resultants, solve_complementarity
from contactstudy.fields.surface import OperatorRequest, surface_operator
from contactstudy.kernels.load import Load

GRID = Grid((0.0, 3.0), (-1.0, 1.0), 18, 12)
BODY_OPERATOR = surface_operator(OperatorRequest(FiniteLengthSpace(material=Material(1.0, 0.3), length=3.0), GRID))


def operator(pressure: np.ndarray) -> np.ndarray:
    return BODY_OPERATOR({Load.NORMAL: pressure})


SIZE = GRID.cells_x * GRID.cells_y
MATRIX = np.stack([operator(unit.reshape(GRID.shape)).ravel() for unit in np.eye(SIZE)], axis=1)
LEVER = GRID.x[:, None] - 1.7
TILTING = Resultants(50.0, LEVER)

random = st.integers(0, 10**6).map(np.random.default_rng)


def rough_gap(rng: np.random.Generator, sharp: bool) -> np.ndarray:
    """Return a crowned gap with waves of the size of a cell, or one with a sharp end of the shape."""
    gap = (GRID.x[:, None] - 1.5) ** 2 / 4 + GRID.y**2 / 2
    if sharp:
        return np.where(GRID.x[:, None] < 2.4, gap - 0.5 * GRID.x[:, None], np.inf)
    return gap + 0.05 * rng.standard_normal(GRID.shape)


def bad_guess(rng: np.random.Generator, gap: np.ndarray) -> np.ndarray:
    """Return pressures that have nothing to do with the contact, many of them zero."""
    return np.where(np.isfinite(gap) & (rng.random(GRID.shape) < 0.3), rng.random(GRID.shape) ** 4, 0.0)


@given(rng=random, sharp=st.booleans())
def test_a_prescribed_approach_against_non_negative_least_squares(rng: np.random.Generator, sharp: bool):
    gap = rough_gap(rng, sharp) - 0.5
    found = solve_complementarity(
        operator,
        BODY_OPERATOR.precondition,
        gap,
        Resultants(None),
        bad_guess(rng, gap) + np.where(gap < 0, 1e-3, 0.0),
        tolerance=1e-8,
        max_iterations=500,
    )
    assert found.converged
    free = np.isfinite(gap).ravel()
    root = np.linalg.cholesky(MATRIX[np.ix_(free, free)]).T
    expected, _ = optimize.nnls(root, -np.linalg.solve(root.T, gap.ravel()[free]))
    np.testing.assert_allclose(found.pressure.ravel()[free], expected, atol=1e-5 * expected.max())


@given(rng=random, sharp=st.booleans(), resultants=st.sampled_from([Resultants(50.0), TILTING]))
def test_a_prescribed_load_meets_the_conditions_of_contact(
    rng: np.random.Generator, sharp: bool, resultants: Resultants
):
    gap = rough_gap(rng, sharp)
    found = solve_complementarity(
        operator,
        BODY_OPERATOR.precondition,
        gap,
        resultants,
        bad_guess(rng, gap),
        tolerance=1e-8,
        max_iterations=500,
    )
    assert found.converged
    assert found.pressure.min() >= 0
    assert found.pressure.sum() == pytest.approx(50.0)
    sunk = operator(found.pressure)
    opening = gap + sunk - found.motion[0]
    if resultants.lever is not None:
        assert abs(float((found.pressure * LEVER).sum())) < 1e-9 * 50.0
        opening = opening - found.motion[1] * LEVER
    assert np.abs(opening[found.pressure > 0]).max() < 1e-6 * np.ptp(sunk)
    assert opening.min() > -1e-6 * np.ptp(sunk)
