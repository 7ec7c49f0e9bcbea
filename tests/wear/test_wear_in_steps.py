"""Wear steps without convergence are shortened, down to a shortest length."""

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Material, Roller, choose_grid
from contactstudy.cache import ArrayKey
from contactstudy.contact.normal.contact import Settings, Shape
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.wear.wear_in import Wear, WearIntegrator


@pytest.fixture
def integrator():
    body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.4e-3), max_pressure=1.5e9)
    grid = choose_grid(case, cells_x=3, cells_y=6)
    gap = case.gap(grid)
    shape = Shape(case.body, grid, ArrayKey(gap), PrescribedLoad(case.normal_load).check(gap, grid))
    return WearIntegrator(
        case=case, shape=shape, settings=Settings(), rate=1e-17 / (2 * np.pi * 5e-3), law="slip", tolerance=0.01
    )


def make_initial_state(integrator: WearIntegrator, step: float) -> Wear:
    initial_state = integrator.initial_state(0.0, np.zeros(integrator.shape.grid.cells_x), 0.0)
    return initial_state._replace(next_step=step)


def test_contact_without_convergence_shortens_step(integrator, monkeypatch):
    initial_state = make_initial_state(integrator, 300.0)
    original_solve = WearIntegrator.solve_contact
    max_length = 50.0

    def solve_short_steps(contact, depth, compliance, initial_state):
        result = original_solve(contact, depth, compliance, initial_state)
        return replace(result, converged=compliance.max() < integrator.rate * max_length)

    monkeypatch.setattr(WearIntegrator, "solve_contact", solve_short_steps)
    states = list(integrator.integrate(initial_state, 300.0))
    assert states[-1].distance == 300.0
    assert states[-1].converged
    assert len(states) > 2


def test_shortest_step_continues_without_convergence(integrator, monkeypatch):
    initial_state = make_initial_state(integrator, 1.0)
    original_solve = WearIntegrator.solve_contact
    monkeypatch.setattr(
        WearIntegrator, "solve_contact", lambda *arguments: replace(original_solve(*arguments), converged=False)
    )
    states = integrator.integrate(initial_state, 1.0)
    state = next(states)
    assert 0 < state.distance < 1e-5
    assert not state.converged
    monkeypatch.undo()
    next_state = next(states)
    assert next_state.distance > 2 * state.distance
    assert not next_state.converged
