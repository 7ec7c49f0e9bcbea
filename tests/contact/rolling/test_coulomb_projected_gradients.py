"""Tractions by projected gradients, without a guess of the slipping cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy.contact.rolling import coulomb
from contactstudy.contact.rolling.coulomb import CoulombProblem, Guess, balance_tractions, descend_energy, solve_coulomb
from tests.contact.rolling.test_coulomb import check_law, make_problem

CELLS = 24


@pytest.mark.parametrize("slip_scale", [0.01, 0.3, 1.0, 30.0])
def test_descent_and_newton_agree(slip_scale: float) -> None:
    rng = np.random.default_rng(3)
    bound, ones = rng.uniform(0.2, 1.0, CELLS), np.ones(CELLS)
    request = replace(make_problem(slip_scale * rng.standard_normal((2, CELLS)), bound), relative_areas=ones)
    computed, slip = descend_energy(request.apply_compliance, request.rigid, np.zeros((2, CELLS)), bound, ones)
    assert np.abs(computed - solve_coulomb(request).traction).max() < 1e-5
    assert np.abs(slip - request.slip(computed, np.zeros(0))).max() < 1e-9 * max(slip_scale, 1.0)


@pytest.mark.parametrize("force_fraction", [0.05, 0.5, 0.9])
def test_rigid_slips_make_the_prescribed_forces(force_fraction: float) -> None:
    rng = np.random.default_rng(4)
    bound, ones = rng.uniform(0.2, 1.0, CELLS), np.ones(CELLS)
    forces = force_fraction * bound.sum() * np.array([0.6, -0.8])
    request = replace(make_problem(0.1 * rng.standard_normal((2, CELLS)), bound, forces=forces), relative_areas=ones)
    expected = solve_coulomb(request)
    computed, amplitudes = balance_tractions(request, Guess(np.zeros((2, CELLS)), np.zeros(2)), 1.0)
    assert (request.resultant_weights * computed).sum(axis=(1, 2)) == pytest.approx(forces, abs=1e-4 * bound.sum())
    assert np.abs(computed - expected.traction).max() < 1e-3
    assert amplitudes == pytest.approx(expected.amplitudes, rel=1e-2)


@pytest.mark.parametrize("has_prescribed_forces", [False, True])
def test_newton_restarts_from_descent(monkeypatch: pytest.MonkeyPatch, has_prescribed_forces: bool) -> None:
    monkeypatch.setattr(coulomb, "DESCENT_INTERVAL", 3)
    descents = []

    def count_descents(*arguments: object) -> object:
        descents.append(arguments)
        return balance_tractions(*arguments)

    monkeypatch.setattr(coulomb, "balance_tractions", count_descents)
    rng = np.random.default_rng(5)
    bound = rng.uniform(0.2, 1.0, CELLS)
    forces = 0.5 * bound.sum() * np.array([0.6, -0.8]) if has_prescribed_forces else None
    request = make_problem(rng.standard_normal((2, CELLS)), bound, forces=forces)
    request = replace(request, relative_areas=np.ones(CELLS), symmetric=True)
    computed = solve_coulomb(request)
    assert computed.converged
    assert descents
    check_law(request, computed)


def make_graded_problem(seed: int, *, unit: float = 1.0, pressure: float = 1.0, forces: bool = False) -> CoulombProblem:
    """Cells of different sizes in some units, on which the compliance times the areas is symmetric."""
    rng = np.random.default_rng(seed)
    bound, relative_areas = pressure * rng.uniform(0.2, 1.0, CELLS), rng.uniform(0.2, 2.0, CELLS)
    requested_forces = 0.6 * float((relative_areas * bound).sum()) * np.array([0.6, -0.8]) if forces else None
    request = make_problem(0.3 * unit * rng.standard_normal((2, CELLS)), bound, forces=requested_forces, seed=seed)
    component_fractions = np.tile(relative_areas, 2)
    uniform_matrix = np.stack(
        [request.apply_compliance(column.reshape(2, CELLS)).ravel() for column in np.eye(2 * CELLS)], axis=1
    )
    matrix = unit / pressure * uniform_matrix * component_fractions
    inverse = np.linalg.inv(matrix)
    return replace(
        request,
        apply_compliance=lambda traction: (matrix @ traction.ravel()).reshape(traction.shape),
        inverse=lambda slip: (inverse @ slip.ravel()).reshape(slip.shape),
        resultant_weights=0.01 * relative_areas * request.resultant_weights,
        resultants=0.01 * request.resultants,
        relative_areas=relative_areas,
        symmetric=True,
    )


@pytest.mark.parametrize(("unit", "pressure"), [(1e-6, 1.0), (1.0, 1.0), (1.0, 1e-9), (1e3, 1e9)])
@pytest.mark.parametrize("forces", [False, True])
def test_descent_on_graded_cells_equals_coulomb_solution_in_any_unit(
    unit: float, pressure: float, *, forces: bool
) -> None:
    request = make_graded_problem(8, unit=unit, pressure=pressure, forces=forces)
    applications: list[int] = []

    def count_applications(traction: np.ndarray) -> np.ndarray:
        applications.append(1)
        return request.apply_compliance(traction)

    expected = solve_coulomb(replace(request, max_steps=14))
    assert expected.converged
    computed, amplitudes = balance_tractions(
        replace(request, apply_compliance=count_applications),
        Guess(np.zeros((2, CELLS)), np.zeros(2 if forces else 0)),
        unit,
    )
    assert np.abs(computed - expected.traction).max() < 1e-3 * pressure
    assert amplitudes == pytest.approx(expected.amplitudes, abs=1e-3 * unit)
    assert len(applications) < (330 if forces else 84)


@pytest.mark.parametrize("seed", range(3))
def test_descent_steps_reduce_energy(seed: int) -> None:
    """A decreasing energy excludes cycles."""
    request, energies = make_graded_problem(seed), []
    for steps in range(12):
        zero_traction = np.zeros((2, CELLS))
        computed, _ = descend_energy(
            request.apply_compliance, request.rigid, zero_traction, request.bound, request.relative_areas, steps
        )
        energies.append(
            float(
                (request.relative_areas * computed * (0.5 * request.apply_compliance(computed) - request.rigid)).sum()
            )
        )
    assert (np.diff(energies) < 0).all()


def test_descent_step_length_adapts() -> None:
    """The first step suits the slip of the stiffest cell; the other cells need steps ten times as large."""
    stiffness, applications = np.geomspace(1.0, 10.0, CELLS), []

    def apply_compliance(traction: np.ndarray) -> np.ndarray:
        applications.append(traction)
        return stiffness * traction

    requested_forces = np.where(np.arange(CELLS) < CELLS - 1, 0.01, 1.0) * np.ones((2, CELLS))
    computed, _ = descend_energy(
        apply_compliance, stiffness * requested_forces, np.zeros((2, CELLS)), np.full(CELLS, 10.0), np.ones(CELLS)
    )
    assert computed == pytest.approx(requested_forces, abs=1e-4)
    assert len(applications) < 50
