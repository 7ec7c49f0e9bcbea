"""Ctrl-C in a long calculation ends it with the caller's line alone; every other error keeps its trace."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import contactstudy as cs
from contactstudy.interrupts import BriefInterrupt

CASE = cs.Case(
    body=cs.FiniteLengthSpace(length=0.4e-3, material=cs.Material(young=210e9, poisson=0.3)),
    roller=cs.Roller(radius=5e-3, length=0.3e-3, profile=cs.profiles.FullCrown(crown_radius=0.1)),
    max_pressure=1.5e9,
)
CELLS = cs.choose_grid(CASE, cells_x=4, cells_y=8)
RESULT = cs.solve(CASE, CELLS, stresses=False)

CALLS: dict[str, Callable[[], Any]] = {
    "solve": lambda: cs.solve(CASE),
    "solve on given cells": lambda: cs.solve(CASE, CELLS),
    "solve_contact": lambda: cs.solve_contact(CASE.body, RESULT["initial_gap"], load=10.0),
    "contact_law": lambda: cs.bearing.contact_law(CASE, np.linspace(-2e-4, 2e-4, 5)),
    "best_profile": lambda: cs.design.best_profile(CASE, cs.profiles.Lundberg, {"amplitude": (1e-7, 1e-6)}),
    "stress_field": lambda: cs.stress_field(CASE.body, RESULT["pressure"], z=[1e-5]),
    "wear_in": lambda: cs.wear.wear_in(CASE, 1e-17, [0.0, 1e3], grid=CELLS),
}


def _interrupted(*arguments: object, **settings: object) -> None:
    try:
        raise ValueError("what was being handled")
    except ValueError:
        raise KeyboardInterrupt from None


@pytest.mark.parametrize("name", CALLS)
def test_the_trace_of_an_interrupt_is_that_of_the_caller(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("contactstudy.contact.conjugate_gradients._State.__init__", _interrupted)
    monkeypatch.setattr("contactstudy.fields.stress.stresses_at", _interrupted)
    cs.cache.clear()
    with pytest.raises(KeyboardInterrupt) as caught:
        CALLS[name]()
    places = [frame.filename for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert str(Path(__file__)) in places
    assert not [place for place in places if Path(cs.__file__).parent in Path(place).parents]
    assert caught.value.__context__ is None


def test_other_errors_keep_their_trace() -> None:
    with pytest.raises(ZeroDivisionError) as caught, BriefInterrupt():
        raise ZeroDivisionError
    assert caught.value.__traceback__ is not None
