"""Contacts at given approaches and tilts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, HalfSpace, InvalidInputError, Material, QuarterSpace, Roller, profiles
from contactstudy.bearing.energy_spline import Nodes
from contactstudy.bearing.tabulation import ContactSolver, estimate_discretisation_errors, solve_nodes

STEEL = Material(210e9, 0.3)
BALL = Roller(radius=5e-3, length=0.8e-3, profile=profiles.FullCrown(crown_radius=5e-3))
CASE = Case(body=HalfSpace(material=STEEL), roller=BALL, load=60.0)


def test_energy_of_ball_is_two_fifths_of_work() -> None:
    approach = 2e-6
    load, moment, energy = ContactSolver(CASE, 0.05, 1e-6).solve_at_approach(approach, 0.0, 20.0)
    assert energy == pytest.approx(0.4 * load * approach, rel=2e-3)
    assert abs(moment) < 1e-6 * load * BALL.radius


class SpringSolver(ContactSolver):
    """Two springs of 10 N/um, 0.1 mm from mid-length; the solver records the solved approaches and tilts."""

    solved_motions: list[tuple[float, float]]

    def solve_at_approach(self, approach: float, tilt: float, load: float) -> np.ndarray:
        assert load > 0
        self.solved_motions.append((approach, tilt))
        return np.array([2e7 * approach, 0.2 * tilt, 1e7 * approach**2 + 0.1 * tilt**2])


@pytest.mark.parametrize(
    ("changes", "tilts", "solved_count"),
    [
        ({}, [-1.0, -0.5, 0.0, 0.5, 1.0], 3),
        ({}, [-1.0, -0.5, 0.0, 0.5, 1.1], 5),
        ({}, [-1.5, -0.5, 0.5, 1.5], 2),
        ({"body": FiniteLengthSpace(length=1e-3, material=STEEL)}, [-1.0, 0.0, 1.0], 2),
        ({"body": FiniteLengthSpace(length=1e-3, material=STEEL), "end_distance": 0.0}, [-1.0, 0.0, 1.0], 3),
        ({"body": QuarterSpace(material=STEEL)}, [-1.0, 0.0, 1.0], 3),
        ({"roller": replace(BALL, profile=profiles.Tapered(0.05))}, [-1.0, 0.0, 1.0], 3),
    ],
)
def test_symmetric_case_is_solved_at_half_of_the_tilts(changes, tilts, solved_count: int) -> None:
    solver = SpringSolver(replace(CASE, **changes), 0.05, 1e-6)
    object.__setattr__(solver, "solved_motions", [])
    approaches, tilts_in_rad = 1e-6 * np.array([1.0, 2.0, 4.0]), 1e-3 * np.array(tilts)
    nodes = solve_nodes(solver, approaches, tilts_in_rad)
    assert len(solver.solved_motions) == 3 * solved_count
    np.testing.assert_allclose(nodes.normal_load, 2e7 * approaches[:, None] + 0 * tilts_in_rad)
    np.testing.assert_allclose(nodes.moment, 0.2 * tilts_in_rad + 0 * approaches[:, None])
    assert np.isfinite(nodes.energy).all()


def test_tilt_without_contact_raises() -> None:
    with pytest.raises(InvalidInputError, match=r"tilts, approaches = 'a tilt of 0.09 rad under 1e\+07 N'.*smaller"):
        ContactSolver(CASE, 0.05, 1e-6).solve_at_load(1e7, 0.09)


def test_discretisation_error_is_estimated_at_largest_tilt(monkeypatch) -> None:
    tilts = 1e-4 * np.array([-9.0, -6.0, -3.0, 0.0, 2.0])
    loads = np.ones((2, 5))
    nodes = Nodes(np.array([1e-6, 2e-6]), tilts, loads, loads, 0 * loads)
    solved_tilts = []

    def solve_at_approach(self: ContactSolver, approach: float, tilt: float, load: float) -> np.ndarray:
        solved_tilts.append(tilt)
        return np.array([1.0 + abs(tilt), 0.0, 1.0])

    monkeypatch.setattr(ContactSolver, "solve_at_approach", solve_at_approach)
    errors = estimate_discretisation_errors(ContactSolver(CASE, 0.01, 1e-6), nodes)
    assert sorted(solved_tilts) == [tilts[0], 0.0]
    assert errors[0] == pytest.approx(9e-4)
