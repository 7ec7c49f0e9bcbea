"""A warning points to the caller's line, from whatever depth of the package it comes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

import contactstudy as cs

CASE = cs.Case(
    body=cs.FiniteLengthSpace(length=0.4e-3, material=cs.Material(young=210e9, poisson=0.3)),
    roller=cs.Roller(radius=5e-3, length=0.3e-3, profile=cs.profiles.FullCrown(crown_radius=0.1)),
    max_pressure=1.5e9,
)
CELLS = cs.choose_grid(CASE, cells_x=8, cells_y=16)
GAP = cs.solve(CASE, CELLS, stresses=False)["initial_gap"]
OUT_OF_REACH = 1e-30

CALLS: dict[str, tuple[type[Warning], Callable[[], Any]]] = {
    "a case": (cs.MagnitudeWarning, lambda: replace(CASE, friction=5.0)),
    "solve": (cs.ConvergenceWarning, lambda: cs.solve(CASE, CELLS, tolerance=OUT_OF_REACH)),
    "solve to an accuracy": (cs.ConvergenceWarning, lambda: cs.solve(CASE, accuracy=0.1, tolerance=OUT_OF_REACH)),
    "solve_contact": (cs.ConvergenceWarning, lambda: cs.solve_contact(CASE.body, GAP, load=10.0, max_iterations=3)),
    "wear_in": (
        cs.ConvergenceWarning,
        lambda: cs.wear.wear_in(CASE, 1e-17, [0.0, 1e3], grid=CELLS, max_steps=1, tolerance=1e-4),
    ),
    "best_profile": (
        cs.design.BoundWarning,
        lambda: cs.design.best_profile(
            CASE, cs.profiles.FullCrown, {"crown_radius": (0.05, 0.1)}, "end_load_last", accuracy=0.1, evaluations=8
        ),
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_the_line_is_that_of_the_caller(name: str) -> None:
    category, call = CALLS[name]
    with pytest.warns(category) as caught:
        call()
    assert {warning.filename for warning in caught if warning.category is category} == {__file__}


def test_bounds_in_millimetres_are_questioned_once() -> None:
    case = replace(CASE, roller=replace(CASE.roller, profile=cs.profiles.Cylinder()))
    with pytest.warns(cs.MagnitudeWarning, match="crown_radius = 50 m") as caught:
        cs.design.best_profile(
            case,
            cs.profiles.FullCrown,
            {"crown_radius": (50.0, 200.0)},
            lambda result: float(result["pressure"].max()),
            accuracy=0.1,
            evaluations=8,
        )
    assert [warning.filename for warning in caught if warning.category is cs.MagnitudeWarning] == [__file__]
