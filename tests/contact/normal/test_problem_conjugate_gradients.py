"""The contact iteration from random initial guesses, against non-negative least squares and the conditions of
contact."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import optimize

from contactstudy import FiniteLengthSpace, Grid, Material
from contactstudy.contact.normal.problem import (
    Resultants,
    _descent_fraction,
    _IterationState,
    solve_complementarity,
)
from contactstudy.fields.surface import surface_operator
from contactstudy.kernels.load import Load

GRID = Grid(x_range=(0.0, 3.0), y_range=(-1.0, 1.0), cells_x=18, cells_y=12)
BODY_OPERATOR = surface_operator(FiniteLengthSpace(material=Material(1.0, 0.3), length=3.0), GRID)


def compute_displacement(pressure: np.ndarray) -> np.ndarray:
    return BODY_OPERATOR({Load.NORMAL: pressure})


SIZE = GRID.cells_x * GRID.cells_y
MATRIX = np.stack([compute_displacement(unit.reshape(GRID.shape)).ravel() for unit in np.eye(SIZE)], axis=1)
LEVER = GRID.x[:, None] - 1.7
BALANCED_LOAD = Resultants(50.0, LEVER)

generators = st.integers(0, 10**6).map(np.random.default_rng)


def make_rough_gap(rng: np.random.Generator, has_sharp_end: bool) -> np.ndarray:
    """Return a crowned gap with waves of the size of a cell, or a gap with a sharp end of the shape."""
    gap = (GRID.x[:, None] - 1.5) ** 2 / 4 + GRID.y**2 / 2
    if has_sharp_end:
        return np.where(GRID.x[:, None] < 2.4, gap - 0.5 * GRID.x[:, None], np.inf)
    return gap + 0.05 * rng.standard_normal(GRID.shape)


def make_random_guess(rng: np.random.Generator, gap: np.ndarray) -> np.ndarray:
    """Return pressures without relation to the contact; many of them are zero."""
    return np.where(np.isfinite(gap) & (rng.random(GRID.shape) < 0.3), rng.random(GRID.shape) ** 4, 0.0)


@given(rng=generators, has_sharp_end=st.booleans())
def test_prescribed_approach_matches_nonnegative_least_squares(rng: np.random.Generator, has_sharp_end: bool):
    gap = make_rough_gap(rng, has_sharp_end) - 0.5
    computed = solve_complementarity(
        compute_displacement,
        BODY_OPERATOR.precondition,
        gap,
        Resultants(None),
        make_random_guess(rng, gap) + np.where(gap < 0, 1e-3, 0.0),
        tolerance=1e-8,
        max_iterations=500,
    )
    assert computed.converged
    is_finite = np.isfinite(gap).ravel()
    factor = np.linalg.cholesky(MATRIX[np.ix_(is_finite, is_finite)]).T
    expected, _ = optimize.nnls(factor, -np.linalg.solve(factor.T, gap.ravel()[is_finite]))
    np.testing.assert_allclose(computed.pressure.ravel()[is_finite], expected, atol=1e-5 * expected.max())


@given(rng=generators, has_sharp_end=st.booleans(), resultants=st.sampled_from([Resultants(50.0), BALANCED_LOAD]))
def test_prescribed_load_satisfies_contact_conditions(
    rng: np.random.Generator, has_sharp_end: bool, resultants: Resultants
):
    gap = make_rough_gap(rng, has_sharp_end)
    computed = solve_complementarity(
        compute_displacement,
        BODY_OPERATOR.precondition,
        gap,
        resultants,
        make_random_guess(rng, gap),
        tolerance=1e-8,
        max_iterations=500,
    )
    assert computed.converged
    assert computed.pressure.min() >= 0
    assert computed.pressure.sum() == pytest.approx(50.0)
    displacement = compute_displacement(computed.pressure)
    gap_after = gap + displacement - computed.motion[0]
    if resultants.lever is not None:
        assert abs(float((computed.pressure * LEVER).sum())) < 1e-9 * 50.0
        gap_after = gap_after - computed.motion[1] * LEVER
    assert np.abs(gap_after[computed.pressure > 0]).max() < 1e-6 * np.ptp(displacement)
    assert gap_after.min() > -1e-6 * np.ptp(displacement)


def check_conditions(resultants: Resultants, pressure: np.ndarray) -> None:
    assert resultants.total is not None
    assert pressure.sum() == pytest.approx(resultants.total)
    if resultants.lever is not None:
        assert abs(float((pressure * resultants.lever).sum())) < 1e-9 * resultants.total


@given(rng=generators, lever_zero=st.floats(0.1, 2.9), unit=st.sampled_from([1e-12, 1.0, 1e9]))
def test_restored_pressure_is_positive_with_resultants(rng: np.random.Generator, lever_zero: float, unit: float):
    arm = GRID.x[:, None] - lever_zero
    resultants = Resultants(50.0 * unit, arm / np.abs(arm).max())
    pressure = unit * np.where(rng.random(GRID.shape) < 0.3, rng.random(GRID.shape) ** 4, 0.0)
    loaded_arms = arm[pressure.any(axis=1)]
    if not loaded_arms.min() < 0 < loaded_arms.max():
        return
    computed = resultants.restore(pressure)
    check_conditions(resultants, computed)
    assert ((computed > 0) == (pressure > 0)).all()
    # A pressure with the resultants is unchanged; a factor linear in the arm removes a small moment.
    assert resultants.restore(computed) == pytest.approx(computed, rel=1e-6)
    perturbed_pressure = 1e3 * computed * (1 + 0.1 * resultants.lever)
    repeated_pressure = resultants.restore(perturbed_pressure)
    check_conditions(resultants, repeated_pressure)
    factor = (repeated_pressure / np.where(computed > 0, perturbed_pressure, 1.0)).max(axis=1)
    is_loaded = factor > 0
    coefficients = np.polynomial.polynomial.polyfit(arm[is_loaded, 0], factor[is_loaded], 1)
    assert np.polynomial.polynomial.polyval(arm[is_loaded, 0], coefficients) == pytest.approx(
        factor[is_loaded], rel=1e-6
    )


def test_single_column_keeps_moment() -> None:
    pressure = np.zeros(GRID.shape)
    pressure[3] = 2.0
    computed = Resultants(50.0, LEVER / np.abs(LEVER).max()).restore(pressure)
    assert computed.sum() == pytest.approx(50.0)
    assert computed[3] == pytest.approx(50.0 / GRID.cells_y)
    # Without rounding the two equations for a factor linear in the arm are exactly equal.
    restored_pressure = Resultants(4.0, np.array([[-1.0], [0.5], [1.0]])).restore(np.array([[0.0], [2.0], [0.0]]))
    assert restored_pressure.ravel().tolist() == [0.0, 4.0, 0.0]


def test_one_sided_pressure_is_balanced_without_overflow() -> None:
    """The balance multiplies the load of the cells on the other side by 1e9."""
    arm = np.where(GRID.x[:, None] < 1.0, GRID.x[:, None] - 1.0, 1e-3 * (GRID.x[:, None] - 1.0))
    for signed_arm in (arm, -arm):
        resultants = Resultants(50.0, signed_arm / np.abs(signed_arm).max())
        pressure = np.where(signed_arm > 0, 1.0, 1e-9) if signed_arm is -arm else np.where(signed_arm < 0, 1.0, 1e-9)
        computed = resultants.restore(pressure)
        check_conditions(resultants, computed)
        assert np.isfinite(computed).all()
        assert (computed > 0).all()


def test_unbalanced_pressure_keeps_sum() -> None:
    pressure = np.where(LEVER > 0.1, 1.0, 0.0) * np.ones(GRID.shape)
    computed = Resultants(50.0, LEVER / np.abs(LEVER).max()).restore(pressure)
    assert computed.sum() == pytest.approx(50.0)
    assert ((computed > 0) == (pressure > 0)).all()


def make_state(gap: np.ndarray, resultants: Resultants, start: np.ndarray) -> _IterationState:
    return _IterationState(compute_displacement, BODY_OPERATOR.precondition, gap, resultants, start)


@given(rng=generators)
def test_one_sided_guess_adds_pressure_everywhere(rng: np.random.Generator):
    gap = make_rough_gap(rng, True)
    start = np.where(LEVER < -0.3, rng.random(GRID.shape), 0.0)
    computed = make_state(gap, BALANCED_LOAD, start).pressure
    assert ((computed > 0) == np.isfinite(gap)).all()
    check_conditions(BALANCED_LOAD, computed)
    two_sided_pressure = np.where(np.isfinite(gap), rng.random(GRID.shape), 0.0)
    assert make_state(gap, Resultants(50.0), start).pressure == pytest.approx(start * 50.0 / start.sum())
    check_conditions(BALANCED_LOAD, make_state(gap, BALANCED_LOAD, two_sided_pressure).pressure)


@given(rng=generators, has_sharp_end=st.booleans(), has_far_guess=st.booleans())
def test_guess_is_scaled_to_approach(rng: np.random.Generator, has_sharp_end: bool, has_far_guess: bool):
    """The scaled guess has the least energy of all its multiples; a guess outside the overlap is replaced."""
    gap = make_rough_gap(rng, has_sharp_end) - 0.5
    start = np.where((gap > 0.5) & np.isfinite(gap) if has_far_guess else gap < 0, 1.0 + rng.random(GRID.shape), 0.0)
    iteration = make_state(gap, Resultants(None), start)
    height = np.where(np.isfinite(gap), gap, 0.0) + compute_displacement(iteration.pressure)
    assert iteration.displacement == pytest.approx(compute_displacement(iteration.pressure))
    assert float((iteration.pressure * height).sum()) == pytest.approx(0.0, abs=1e-9 * float(iteration.pressure.sum()))
    assert ((iteration.pressure > 0) == (gap < 0)).all()
    if not has_far_guess:
        assert iteration.pressure / start.clip(1e-9) == pytest.approx(
            np.where(
                gap < 0, iteration.pressure.max() / start[iteration.pressure == iteration.pressure.max()].max(), 0.0
            )
        )


def compute_potential_energy(gap: np.ndarray, pressure: np.ndarray) -> float:
    return float((pressure * (np.where(np.isfinite(gap), gap, 0.0) + 0.5 * compute_displacement(pressure))).sum())


@settings(max_examples=10)
@given(
    rng=generators,
    has_sharp_end=st.booleans(),
    resultants=st.sampled_from([Resultants(50.0), BALANCED_LOAD, Resultants(None)]),
)
def test_area_change_reduces_energy_and_keeps_resultants(
    rng: np.random.Generator, has_sharp_end: bool, resultants: Resultants
):
    gap = make_rough_gap(rng, has_sharp_end) - (0.5 if resultants.total is None else 0.0)
    iteration = make_state(gap, resultants, make_random_guess(rng, gap) + np.where(gap < 0, 1e-3, 0.0))
    previous_energy = compute_potential_energy(gap, iteration.pressure)
    for index in range(8):
        opening = iteration.compute_opening()
        step, response, _ = iteration.search_step(np.where(iteration.contact, opening, 0.0))
        if index % 2:
            iteration._step_to_border(step, response)
        else:
            closed_cells = ~iteration.contact & (opening < 0)
            iteration.change_area(
                iteration.pressure - step * iteration.direction, closed_cells, opening, step, response
            )
        iteration.contact, iteration.area_changed = iteration.pressure > 0, True
        assert iteration.pressure.min() >= 0
        assert iteration.displacement == pytest.approx(compute_displacement(iteration.pressure), rel=1e-9)
        if resultants.total is not None:
            check_conditions(resultants, iteration.pressure)
        if index % 2 or closed_cells.any():
            energy_after = compute_potential_energy(gap, iteration.pressure)
            assert energy_after <= previous_energy + 1e-9 * abs(previous_energy)
        previous_energy = compute_potential_energy(gap, iteration.pressure)


@given(slope=st.floats(-2.0, 2.0), curvature=st.floats(0.01, 5.0))
def test_descent_fraction_minimises_energy(slope: float, curvature: float):
    """The energy is a parabola of the fraction: the fraction is 1 if the energy decreases, else its minimum."""
    change, opening = np.array([2.0, 0.0]), np.array([-0.5 * slope, np.inf])
    fraction = _descent_fraction(change, np.array([0.5 * curvature, 1.0]), opening)

    def compute_energy(trial_fraction: float) -> float:
        return -slope * trial_fraction + 0.5 * curvature * trial_fraction**2

    if slope <= 0:
        assert fraction == 0.0
    elif compute_energy(1.0) < 0:
        assert fraction == 1.0
    else:
        assert fraction == pytest.approx(min(slope / curvature, 1.0))
        assert compute_energy(fraction) <= min(compute_energy(0.99 * fraction), compute_energy(1.01 * fraction))


@settings(max_examples=10)
@given(rng=generators)
def test_iteration_ends_at_small_violation_and_change(rng: np.random.Generator):
    gap = make_rough_gap(rng, False)
    for unit in (1e-9, 1e9):
        computed = solve_complementarity(
            compute_displacement,
            BODY_OPERATOR.precondition,
            unit * gap,
            Resultants(50.0 * unit),
            unit * make_random_guess(np.random.default_rng(1), gap),
            tolerance=1e-6,
            max_iterations=500,
        )
        assert computed.converged
        displacement = compute_displacement(computed.pressure)
        relative_violation = np.abs(unit * gap + displacement - computed.motion[0])[
            computed.pressure > 0
        ].max() / np.ptp(displacement)
        assert relative_violation <= 2e-6


@pytest.mark.parametrize(
    ("slope", "curvature_ratio"), [(0.45, 0.45), (0.49, 0.49), (0.51, 1.0), (0.54, 1.0), (2.0, 1.0)]
)
def test_descending_change_is_complete(slope: float, curvature_ratio: float) -> None:
    assert _descent_fraction(np.ones(1), np.ones(1), np.array([-slope])) == pytest.approx(curvature_ratio)


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12])
def test_entering_cells_scale_with_overlap(unit: float) -> None:
    gap = (GRID.x[:, None] - 1.5) ** 2 / 4 + GRID.y**2 / 2 - 0.3
    start = np.where(np.hypot(GRID.x[:, None] - 1.5, GRID.y) < 0.3, 1.0, 0.0)
    iteration = make_state(unit * gap, Resultants(None), unit * start)
    opening = iteration.compute_opening()
    step, response, _ = iteration.search_step(np.where(iteration.contact, opening, 0.0))
    closed_cells = ~iteration.contact & (opening < 0)
    iteration.change_area(iteration.pressure - step * iteration.direction, closed_cells, opening, step, response)
    assert iteration.pressure[closed_cells].sum() > 0.05 * iteration.pressure.sum()
    baseline = make_state(gap, Resultants(None), start)
    assert iteration._balance_sides(unit * start) == pytest.approx(unit * baseline._balance_sides(start))
    balanced_state = make_state(
        unit * make_rough_gap(np.random.default_rng(0), False), Resultants(50.0 * unit, LEVER), unit * start
    )
    one_sided_pressure = np.where(LEVER < -0.3, 1.0, 0.0) * np.ones(GRID.shape)
    assert balanced_state._balance_sides(unit * one_sided_pressure) == pytest.approx(unit * (one_sided_pressure + 0.1))
    if unit == 1.0:
        return
    opening = baseline.compute_opening()
    step, response, _ = baseline.search_step(np.where(baseline.contact, opening, 0.0))
    baseline.change_area(baseline.pressure - step * baseline.direction, closed_cells, opening, step, response)
    assert iteration.pressure / unit == pytest.approx(baseline.pressure, rel=1e-6)


def test_directions_tolerate_unsymmetric_preconditioner() -> None:
    """With independent springs and no preconditioner the iteration takes 73 steps; a less tolerant formula takes over
    500."""
    stiffness = 1.0 + np.arange(SIZE).reshape(GRID.shape)
    start = 2.0 + np.random.default_rng(0).random(GRID.shape)
    computed = solve_complementarity(
        lambda pressure: stiffness * pressure,
        lambda gap: gap,
        -stiffness,
        Resultants(None),
        start,
        tolerance=1e-8,
        max_iterations=120,
    )
    assert computed.converged
    assert computed.pressure == pytest.approx(np.ones(GRID.shape), abs=1e-6)
