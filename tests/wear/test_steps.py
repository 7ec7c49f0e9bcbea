"""Steps that fail: they are cut, down to a shortest one."""

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Material, Roller, choose_grid
from contactstudy.cache import ArrayKey
from contactstudy.contact.normal.contact import Settings, Shape
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.wear.wear_in import Stepper, WornContact


@pytest.fixture
def stepper():
    body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.4e-3), max_pressure=1.5e9)
    grid = choose_grid(case, cells_x=3, cells_y=6)
    gap = case.gap(grid)
    shape = Shape(case.body, grid, ArrayKey(gap), PrescribedLoad(case.normal_load).check(gap, grid))
    return Stepper(WornContact(case, shape, Settings()), 1e-17 / (2 * np.pi * 5e-3), "slip", 0.01)


def test_step_after_a_failed_contact(stepper, monkeypatch):
    begun = stepper.initial(0.0, np.zeros(stepper.contact.shape.grid.cells_x), 0.0)
    real = WornContact.pressed
    longest = 50.0

    def fails(contact, depth, compliance, start):
        found = real(contact, depth, compliance, start)
        return found._replace(converged=compliance.max() < stepper.rate * longest)

    monkeypatch.setattr(WornContact, "pressed", fails)
    states = [state for state, _ in stepper.states(begun, 300.0, 300.0)]
    assert states[-1].distance == 300.0
    assert states[-1].converged
    assert len(states) > 2


def test_shortest_step_without_convergence(stepper, monkeypatch):
    begun = stepper.initial(0.0, np.zeros(stepper.contact.shape.grid.cells_x), 0.0)
    real = WornContact.pressed
    monkeypatch.setattr(WornContact, "pressed", lambda *arguments: real(*arguments)._replace(converged=False))
    states = stepper.states(begun, 1.0, 1.0)
    state, _ = next(states)
    assert 0 < state.distance < 1e-5
    assert not state.converged
    monkeypatch.undo()
    again, _ = next(states)
    assert again.distance > 2 * state.distance
    assert not again.converged
