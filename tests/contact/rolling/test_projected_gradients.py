"""Tractions by descent: the law without a guess of the cells that slip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy.contact.rolling import coulomb
from contactstudy.contact.rolling.coulomb import CoulombProblem, Guess, balance_tractions, descend_energy, solve_coulomb
from tests.contact.rolling.test_coulomb import holds, problem

CELLS = 24


@pytest.mark.parametrize("size", [0.01, 0.3, 1.0, 30.0])
def test_descent_and_newton_agree(size: float) -> None:
    random = np.random.default_rng(3)
    bound, ones = random.uniform(0.2, 1.0, CELLS), np.ones(CELLS)
    asked = replace(problem(size * random.standard_normal((2, CELLS)), bound), relative_areas=ones)
    found, slip = descend_energy(asked.apply_compliance, asked.rigid, np.zeros((2, CELLS)), bound, ones)
    assert np.abs(found - solve_coulomb(asked).traction).max() < 1e-5
    assert np.abs(slip - asked.slip(found, np.zeros(0))).max() < 1e-9 * max(size, 1.0)


@pytest.mark.parametrize("part", [0.05, 0.5, 0.9])
def test_rigid_slips_make_the_prescribed_forces(part: float) -> None:
    random = np.random.default_rng(4)
    bound, ones = random.uniform(0.2, 1.0, CELLS), np.ones(CELLS)
    forces = part * bound.sum() * np.array([0.6, -0.8])
    asked = replace(problem(0.1 * random.standard_normal((2, CELLS)), bound, forces=forces), relative_areas=ones)
    expected = solve_coulomb(asked)
    found, amplitudes = balance_tractions(asked, Guess(np.zeros((2, CELLS)), np.zeros(2)), 1.0)
    assert (asked.resultant_weights * found).sum(axis=(1, 2)) == pytest.approx(forces, abs=1e-4 * bound.sum())
    assert np.abs(found - expected.traction).max() < 1e-3
    assert amplitudes == pytest.approx(expected.amplitudes, rel=1e-2)


@pytest.mark.parametrize("prescribed", [False, True])
def test_newton_restarts_from_descent(monkeypatch: pytest.MonkeyPatch, prescribed: bool) -> None:
    monkeypatch.setattr(coulomb, "DESCENT_INTERVAL", 3)
    descents = []

    def counted(*arguments: object) -> object:
        descents.append(arguments)
        return balance_tractions(*arguments)

    monkeypatch.setattr(coulomb, "balance_tractions", counted)
    random = np.random.default_rng(5)
    bound = random.uniform(0.2, 1.0, CELLS)
    forces = 0.5 * bound.sum() * np.array([0.6, -0.8]) if prescribed else None
    asked = problem(random.standard_normal((2, CELLS)), bound, forces=forces)
    asked = replace(asked, relative_areas=np.ones(CELLS), symmetric=True)
    found = solve_coulomb(asked)
    assert found.converged
    assert descents
    holds(asked, found)


def symmetric(seed: int, *, unit: float = 1.0, pressure: float = 1.0, forces: bool = False) -> CoulombProblem:
    """Cells of different sizes in some units, on which the compliance times the areas is symmetric."""
    random = np.random.default_rng(seed)
    bound, shares = pressure * random.uniform(0.2, 1.0, CELLS), random.uniform(0.2, 2.0, CELLS)
    wanted = 0.6 * float((shares * bound).sum()) * np.array([0.6, -0.8]) if forces else None
    asked = problem(0.3 * unit * random.standard_normal((2, CELLS)), bound, forces=wanted, seed=seed)
    both = np.tile(shares, 2)
    inner = np.stack([asked.apply_compliance(each.reshape(2, CELLS)).ravel() for each in np.eye(2 * CELLS)], axis=1)
    matrix = unit / pressure * inner * both
    inverse = np.linalg.inv(matrix)
    return replace(
        asked,
        apply_compliance=lambda traction: (matrix @ traction.ravel()).reshape(traction.shape),
        inverse=lambda slip: (inverse @ slip.ravel()).reshape(slip.shape),
        resultant_weights=0.01 * shares * asked.resultant_weights,
        resultants=0.01 * asked.resultants,
        relative_areas=shares,
        symmetric=True,
    )


@pytest.mark.parametrize(("unit", "pressure"), [(1e-6, 1.0), (1.0, 1.0), (1.0, 1e-9), (1e3, 1e9)])
@pytest.mark.parametrize("forces", [False, True])
def test_descent_on_graded_cells_in_any_unit(unit: float, pressure: float, *, forces: bool) -> None:
    asked = symmetric(8, unit=unit, pressure=pressure, forces=forces)
    applied: list[int] = []

    def counted(traction: np.ndarray) -> np.ndarray:
        applied.append(1)
        return asked.apply_compliance(traction)

    expected = solve_coulomb(replace(asked, max_steps=14))
    assert expected.converged
    found, amplitudes = balance_tractions(
        replace(asked, apply_compliance=counted), Guess(np.zeros((2, CELLS)), np.zeros(2 if forces else 0)), unit
    )
    assert np.abs(found - expected.traction).max() < 1e-3 * pressure
    assert amplitudes == pytest.approx(expected.amplitudes, abs=1e-3 * unit)
    assert len(applied) < (330 if forces else 84)


@pytest.mark.parametrize("seed", range(3))
def test_descent_steps_reduce_energy(seed: int) -> None:
    """So it cannot go round in circles."""
    asked, energies = symmetric(seed), []
    for steps in range(12):
        zero = np.zeros((2, CELLS))
        found, _ = descend_energy(asked.apply_compliance, asked.rigid, zero, asked.bound, asked.relative_areas, steps)
        energies.append(
            float((asked.relative_areas * found * (0.5 * asked.apply_compliance(found) - asked.rigid)).sum())
        )
    assert (np.diff(energies) < 0).all()


def test_descent_step_length_adapts() -> None:
    """It begins with a slip that the stiffest cell gives way to, whose step is a tenth of the others'."""
    stiffness, applied = np.geomspace(1.0, 10.0, CELLS), []

    def apply_compliance(traction: np.ndarray) -> np.ndarray:
        applied.append(traction)
        return stiffness * traction

    wanted = np.where(np.arange(CELLS) < CELLS - 1, 0.01, 1.0) * np.ones((2, CELLS))
    found, _ = descend_energy(
        apply_compliance, stiffness * wanted, np.zeros((2, CELLS)), np.full(CELLS, 10.0), np.ones(CELLS)
    )
    assert found == pytest.approx(wanted, abs=1e-4)
    assert len(applied) < 50
