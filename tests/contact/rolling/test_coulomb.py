"""Coulomb's law on few cells: every condition is checked in each cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.rolling import coulomb
from contactstudy.contact.rolling.coulomb import (
    CoulombProblem,
    CoulombSolution,
    Guess,
    _select_first,
    law_violation,
    solve_coulomb,
)


def make_problem(
    rigid_slip: FloatArray, bound: FloatArray, *, forces: FloatArray | None = None, skew: float = 0.0, seed: int = 0
) -> CoulombProblem:
    """Problem with a random positive definite compliance; `skew` adds an antisymmetric matrix, as in rolling."""
    rng = np.random.default_rng(seed)
    unknown_count = 2 * bound.size
    random_factor = rng.standard_normal((unknown_count, unknown_count)) / np.sqrt(unknown_count)
    random_skew = rng.standard_normal((unknown_count, unknown_count)) / np.sqrt(unknown_count)
    matrix = random_factor @ random_factor.T + 0.3 * np.eye(unknown_count) + skew * (random_skew - random_skew.T)
    inverse = np.linalg.inv(matrix)
    modes = np.zeros((0, 2, bound.size))
    if forces is not None:
        modes = np.zeros((2, 2, bound.size))
        modes[0, 0] = modes[1, 1] = 1.0
    return CoulombProblem(
        apply_compliance=lambda traction: (matrix @ traction.ravel()).reshape(traction.shape),
        inverse=lambda slip: (inverse @ slip.ravel()).reshape(slip.shape),
        bound=bound,
        rigid=rigid_slip,
        modes=modes,
        resultant_weights=modes,
        resultants=np.zeros(0) if forces is None else forces,
        relative_areas=np.random.default_rng(seed).uniform(0.1, 2.0, bound.size),
        tolerance=1e-8,
    )


def check_law(request: CoulombProblem, solution: CoulombSolution) -> None:
    """Check every condition of the law in each cell."""
    slip = request.slip(solution.traction, solution.amplitudes)
    traction_size = np.hypot(*solution.traction)
    assert (traction_size <= request.bound * (1 + 1e-9)).all()
    is_sticking = traction_size < request.bound * (1 - 1e-9)
    scale = np.hypot(*request.rigid).max() + np.abs(solution.amplitudes).sum()
    assert np.hypot(*slip[:, is_sticking]).max(initial=0.0) <= 1e-6 * scale
    slip_along_traction = (slip * solution.traction).sum(axis=0)[~is_sticking]
    assert (slip_along_traction >= -1e-6 * scale * request.bound[~is_sticking]).all()
    assert np.allclose(
        slip_along_traction, (np.hypot(*slip) * traction_size)[~is_sticking], atol=1e-6 * scale * request.bound.max()
    )


@pytest.mark.parametrize("skew", [0.0, 1.0])
@pytest.mark.parametrize("slip_scale", [0.01, 0.3, 1.0, 30.0])
@pytest.mark.parametrize("seed", range(3))
def test_the_law_holds_from_stick_to_full_sliding(slip_scale: float, skew: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    bound = rng.uniform(0.2, 1.0, 24)
    request = make_problem(slip_scale * rng.standard_normal((2, 24)), bound, skew=skew, seed=seed)
    computed = solve_coulomb(request)
    assert computed.converged
    check_law(request, computed)


@pytest.mark.parametrize("force_fraction", [0.0, 0.4, 0.95])
def test_rigid_slip_satisfies_prescribed_forces(force_fraction: float) -> None:
    bound = np.random.default_rng(5).uniform(0.2, 1.0, 30)
    force = force_fraction * bound.sum() * np.array([0.6, 0.8])
    request = make_problem(np.zeros((2, 30)), bound, forces=force, skew=0.5)
    computed = solve_coulomb(request)
    assert computed.converged
    check_law(request, computed)
    assert computed.traction.sum(axis=1) == pytest.approx(force, abs=1e-6 * bound.sum())


def test_guess_changes_steps_only() -> None:
    rng = np.random.default_rng(7)
    bound = rng.uniform(0.2, 1.0, 40)
    request = make_problem(rng.standard_normal((2, 40)), bound, skew=0.5)
    baseline = solve_coulomb(request)
    guessed_solution = solve_coulomb(request, Guess(baseline.traction, baseline.amplitudes))
    assert guessed_solution.steps < baseline.steps
    assert guessed_solution.traction == pytest.approx(baseline.traction, abs=1e-6)


def test_unconverged_solution_is_reported() -> None:
    rng = np.random.default_rng(0)
    request = make_problem(rng.standard_normal((2, 24)), rng.uniform(0.2, 1.0, 24))
    assert not solve_coulomb(CoulombProblem(**{**vars(request), "max_steps": 1})).converged


def test_law_violation_measures_violations() -> None:
    traction, bound = np.array([[1.0, 0.5], [0.0, 0.0]]), np.array([1.0, 1.0])
    sticks = np.array([False, True])
    no_violation = law_violation(traction, np.array([[2.0, 0.0], [0.0, 0.0]]), bound, sticks, 1.0)
    assert no_violation == (0.0, 0.0)
    assert law_violation(1.1 * traction, np.zeros((2, 2)), bound, sticks, 1.0)[0] == pytest.approx(0.1)
    for slip in ([[-2.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [2.0, 0.0]], [[0.0, 2.0], [0.0, 0.0]]):
        assert law_violation(traction, np.array(slip), bound, sticks, 1.0)[1] == pytest.approx(2.0)


@pytest.mark.parametrize("length", [1.0, 1e-9])
def test_all_cells_slip_under_prescribed_force(length: float) -> None:
    """The rigid slip along one axis is prescribed and large; the rigid motions of force and moment leave no stick."""
    rng = np.random.default_rng(3)
    bound = rng.uniform(0.2, 1.0, 12)
    rigid_slip = np.stack([np.zeros(12), np.full(12, 30.0)])
    request = make_problem(rigid_slip, bound, skew=0.5)
    modes = np.zeros((2, 2, 12))
    modes[0, 0] = 1.0
    modes[1] = length * rng.standard_normal((2, 12))
    requested_forces = np.array([0.1 * bound.sum(), 0.05 * length * bound.sum()])
    request = replace(request, modes=modes, resultant_weights=modes, resultants=requested_forces)
    computed = solve_coulomb(request)
    assert computed.converged
    assert not computed.sticks.any()
    assert computed.traction[0].sum() == pytest.approx(requested_forces[0], rel=1e-6)
    assert (modes[1] * computed.traction).sum() == pytest.approx(requested_forces[1], rel=1e-6)


def test_select_first_keeps_first_fraction_of_cells() -> None:
    cells = np.array([False, True, True, False, True, True, True])
    assert _select_first(cells, 1.0) is cells
    for fraction, cell_count in ((0.9, 4), (0.5, 2), (0.2, 1), (0.01, 1)):
        assert np.flatnonzero(_select_first(cells, fraction)).tolist() == [1, 2, 4, 5, 6][:cell_count]


def test_guess_keeps_slip_on_bound_and_sticking_tractions() -> None:
    """A cell just below its bound counts as slipping, a cell without traction as sticking; one step suffices."""
    rng = np.random.default_rng(7)
    bound = rng.uniform(0.2, 1.0, 40)
    request = replace(make_problem(rng.standard_normal((2, 40)), bound, skew=0.5), max_steps=1)
    baseline = solve_coulomb(replace(request, max_steps=40))
    perturbed_traction = np.where(baseline.sticks, 1.0, 1 - 1e-7) * baseline.traction
    for guess in (baseline.traction, perturbed_traction):
        computed = solve_coulomb(request, Guess(guess, baseline.amplitudes))
        assert computed.converged
        assert computed.traction == pytest.approx(baseline.traction, abs=1e-6)
        assert np.array_equal(computed.sticks, baseline.sticks)


@pytest.mark.parametrize(("forces", "limits"), [(False, (83, 468)), (True, (94, 520))])
def test_steps_and_applications_are_few(*, forces: bool, limits: tuple[int, int]) -> None:
    """Small problems from partial slip to almost full sliding, some with cycling cells, need few applications."""
    steps, applications = 0, []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        bound = rng.uniform(0.2, 1.0, 24)
        requested_forces = rng.uniform(-0.5, 0.5, 2) * bound.sum() if forces else None
        rigid_slip = rng.uniform(0.1, 2.0) * rng.standard_normal((2, 24))
        request = make_problem(rigid_slip, bound, forces=requested_forces, skew=0.2 * (seed % 6), seed=seed)

        def apply_compliance(traction: FloatArray, request: CoulombProblem = request) -> FloatArray:
            applications.append(1)
            return request.apply_compliance(traction)

        computed = solve_coulomb(replace(request, apply_compliance=apply_compliance))
        assert computed.converged
        steps += computed.steps
    assert steps <= limits[0]
    assert len(applications) <= limits[1]


def test_cycling_cells_change_singly(monkeypatch: pytest.MonkeyPatch) -> None:
    """A compliance that changes with each application makes three cells cycle: the fraction of changed cells
    decreases."""
    rng = np.random.default_rng(0)
    request = make_problem(rng.standard_normal((2, 3)), np.ones(3))
    fractions: list[float] = []

    def record_selection(cells: BoolArray, selected_fraction: float) -> BoolArray:
        fractions.append(selected_fraction)
        return _select_first(cells, selected_fraction)

    monkeypatch.setattr(coulomb, "_select_first", record_selection)
    random_problem = replace(
        request, apply_compliance=lambda traction: rng.standard_normal(traction.shape), max_steps=80
    )
    assert not solve_coulomb(random_problem).converged
    steps = np.array(fractions[::2])
    assert steps[0] == steps.max() == 1.0
    assert steps.min() < 2.0**-4
    ratios = steps[1:] / steps[:-1]
    assert set(ratios[steps[:-1] < 0.7].tolist()) <= {0.5, 1.0, 2.0}


@pytest.mark.parametrize("seed", range(8))
def test_prescribed_forces_meet_tolerance_of_full_sliding(seed: int) -> None:
    """The tolerance of the forces is relative to full sliding, in any unit of force."""
    rng = np.random.default_rng(seed)
    bound = rng.uniform(0.2, 1.0, 24)
    full_problem = make_problem(
        rng.standard_normal((2, 24)), bound, forces=0.5 * bound.sum() * np.array([0.6, 0.7]), seed=seed
    )
    for unit in (1e-6, 1.0, 1e6):
        request = replace(
            full_problem,
            resultant_weights=unit * full_problem.resultant_weights,
            resultants=unit * full_problem.resultants,
            tolerance=1e-3,
        )
        computed = solve_coulomb(request)
        assert computed.converged
        assert np.abs(computed.traction.sum(axis=1) - full_problem.resultants).max() <= 1e-3 * bound.sum()
