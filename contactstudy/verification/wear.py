"""Checks of the worn profile: Archard's volume, a load that becomes uniform, steps taken by hand, rolling's work."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies import FiniteLengthSpace, Material
from contactstudy.case import Case, Roller, choose_grid
from contactstudy.case.motion import Rolling
from contactstudy.checks import FloatArray
from contactstudy.contact.solve import solve_contact
from contactstudy.profiles import FullCrown
from contactstudy.solution import solve
from contactstudy.verification.check import Check, Curve, compare, compare_fields
from contactstudy.verification.problems import on_grid
from contactstudy.wear import wear_in, worn_profile

STEEL = Material(210e9, 0.3)
COEFFICIENT = 1e-17
BY_HAND = 80
"""Explicit steps: their error is of first order."""


def sharp_roller() -> tuple[Case, Grid]:
    """Return a rigid roller with sharp ends inside the face, and cells."""
    body = FiniteLengthSpace(length=0.6e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.4e-3), max_pressure=1.5e9)
    return case, choose_grid(case, cells_x=3, cells_y=6)


def sliding_checks() -> Iterator[Check]:
    """Constant slip."""
    case, grid = sharp_roller()
    name = "sharp roller inside the face, full sliding"
    distances = [0.0, 3e3, 2e5]
    worn = wear_in(case, COEFFICIENT, distances, grid=grid)
    ideal = COEFFICIENT * case.normal_load * distances[2]
    volume = float(worn.worn_volume[2])
    yield compare(name, "worn volume", "Archard (1953): k W s", volume, ideal, 1e-9, relative=True)
    load = worn.line_load.values[2]
    under = np.isfinite(case.gap(grid)).any(axis=1)
    ratio = float(load[under].max() / load[under].min())
    source = "a steady profile wears evenly"
    yield compare(name, "largest load per length over the smallest, worn in", source, ratio, 1.0, 1e-3)
    by_hand = stepped_by_hand(case, grid, distances[1])
    found, scale = worn.wear_depth.values[1], by_hand.max()
    curve = Curve("x / mm", "worn depth over the largest", 1e3 * grid.x, found / scale, by_hand / scale)
    yield compare_fields(
        name,
        "worn depth early on, over the largest",
        f"{BY_HAND} explicit steps",
        found / scale,
        by_hand / scale,
        0.01,
        curve=curve,
    )
    profile = worn_profile(case, worn, distances[1])
    again = Case(body=case.body, roller=Roller(radius=5e-3, length=0.4e-3, profile=profile), max_pressure=1.5e9)
    pressed = grid.dy * solve(again, grid, stresses=False).pressure.sum("y").values
    load = worn.line_load.values[1]
    yield compare_fields(
        name,
        "load per length of the worn profile, over the largest",
        "the contact while it wore",
        pressed / load.max(),
        load / load.max(),
        2e-3,
    )


def stepped_by_hand(case: Case, grid: Grid, distance: float) -> FloatArray:
    """Worn depth by many explicit steps, each with a contact of its own."""
    gap = on_grid(case.gap, grid)
    depth = np.zeros((grid.cells_x, 1))
    per_load = COEFFICIENT * distance / BY_HAND / (2 * np.pi * case.roller.radius)
    for _ in range(BY_HAND):
        pressure = solve_contact(case.body, gap + depth, load=case.normal_load)["pressure"].values
        depth = depth + per_load * grid.dy * pressure.sum(axis=1, keepdims=True)
    return depth[:, 0]


def rolling_checks() -> Iterator[Check]:
    """Wear by the work of steady rolling."""
    body = FiniteLengthSpace(length=0.6e-3, material=STEEL)
    roller = Roller(radius=5e-3, length=0.4e-3, material=STEEL, profile=FullCrown(crown_radius=0.05))
    case = Case(body=body, roller=roller, max_pressure=1.5e9, friction=0.2, motion=Rolling(longitudinal_creepage=1e-3))
    grid = choose_grid(case, cells_x=3, cells_y=8, window=2.5)
    work = float(solve(case, grid, stresses=False).friction_work)
    worn = wear_in(case, COEFFICIENT, [100.0], grid=grid, law="work")
    volume, expected = float(worn.worn_volume[-1]), COEFFICIENT * work * 100.0
    name = "crowned roller rolling at a creepage, little worn"
    source = "k times the frictional work of the unworn contact"
    yield compare(name, "worn volume", source, volume, expected, 2e-3, relative=True)


def checks() -> Iterator[Check]:
    """All of them."""
    yield from sliding_checks()
    yield from rolling_checks()
