"""Failing steps are shortened, down to a least length."""

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Material, Roller, choose_grid
from contactstudy.cache import ArrayKey
from contactstudy.contact.normal.contact import Settings, Shape
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.wear.wear_in import WearIntegrator, WornContact


@pytest.fixture
def integrator():
    body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.4e-3), max_pressure=1.5e9)
    grid = choose_grid(case, cells_x=3, cells_y=6)
    gap = case.gap(grid)
    shape = Shape(case.body, grid, ArrayKey(gap), PrescribedLoad(case.normal_load).check(gap, grid))
    return WearIntegrator(WornContact(case, shape, Settings()), 1e-17 / (2 * np.pi * 5e-3), "slip", 0.01)


def test_failed_contact_shortens_the_step(integrator, monkeypatch):
    initial_state = integrator.initial_state(0.0, np.zeros(integrator.contact.shape.grid.cells_x), 0.0)
    solve = WornContact.solve
    max_length = 50.0

    def solve_short_steps(contact, depth, compliance, start):
        result = solve(contact, depth, compliance, start)
        return result._replace(converged=compliance.max() < integrator.rate * max_length)

    monkeypatch.setattr(WornContact, "solve", solve_short_steps)
    states = [state for state, _ in integrator.integrate(initial_state, 300.0, 300.0)]
    assert states[-1].distance == 300.0
    assert states[-1].converged
    assert len(states) > 2


def test_shortest_step_without_convergence(integrator, monkeypatch):
    initial_state = integrator.initial_state(0.0, np.zeros(integrator.contact.shape.grid.cells_x), 0.0)
    solve = WornContact.solve
    monkeypatch.setattr(WornContact, "solve", lambda *arguments: solve(*arguments)._replace(converged=False))
    states = integrator.integrate(initial_state, 1.0, 1.0)
    state, _ = next(states)
    assert 0 < state.distance < 1e-5
    assert not state.converged
    monkeypatch.undo()
    next_state, _ = next(states)
    assert next_state.distance > 2 * state.distance
    assert not next_state.converged
