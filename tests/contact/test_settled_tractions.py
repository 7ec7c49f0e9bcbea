"""Stick and slip on the columns of a settled contact, without a grid: against fine uniform cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Grid, Material, Roller, Rolling, Shift, cache, choose_grid, solve
from contactstudy.contact.settled import settled_contact

STEEL = Material(210e9, 0.3)
BODY = FiniteLengthSpace(length=0.5e-3, material=STEEL)
LIKE = Case(body=BODY, roller=Roller(radius=5e-3, length=0.5e-3, material=STEEL), max_pressure=1.5e9, friction=0.1)
INSIDE = Case(
    body=FiniteLengthSpace(length=0.6e-3, material=STEEL),
    roller=Roller(radius=5e-3, length=0.5e-3),
    max_pressure=1.5e9,
    friction=0.1,
)
"""A rigid roller that ends inside the face: the pressure is singular there."""

WHOLE = 0.1 * LIKE.normal_load


@pytest.mark.parametrize(
    "motion",
    [
        Rolling(longitudinal_creepage=1e-3),
        Rolling(longitudinal_creepage=5e-4, lateral_creepage=-3e-4, spin=1.0),
        Rolling(force_y=0.6 * WHOLE, force_x=0.2 * WHOLE),
        Shift(y=3e-7),
        Shift(force_x=0.5 * WHOLE),
    ],
    ids=["creepage", "creepages and spin", "forces", "shift", "shifting force"],
)
def test_default_cells_agree_with_fine_uniform_ones_to_the_errors_that_are_stated(motion: Rolling | Shift) -> None:
    case = replace(LIKE, motion=motion)
    found = solve(case, stresses=False)
    assert bool(found.converged)
    fine = solve(case, choose_grid(case, cells_x=12, cells_y=40, window=1.5), stresses=False)
    scales = {"force_x": WHOLE, "force_y": WHOLE, "moment_z": WHOLE * 0.1e-3}
    for name, scale in scales.items():
        error = float(found.get(f"{name}_error", 0.0))
        assert error <= 0.01 * scale
        assert float(found[name]) == pytest.approx(float(fine[name]), abs=max(error, 2e-3 * scale))
    for name in ("longitudinal_creepage", "lateral_creepage", "shift_x", "shift_y"):
        if name in found:
            error = float(found.get(f"{name}_error", 0.0))
            usual = 0.1 * case.hertz_half_width / 5e-3 * (case.hertz_half_width if "shift" in name else 1.0)
            assert float(found[name]) == pytest.approx(
                float(fine[name]), abs=max(error, 2e-3 * usual, 1e-3 * abs(float(found[name])))
            )
    # What is lost is a difference of what is put in and what is stored.
    names = ("shift_x", "shift_y") if isinstance(motion, Shift) else ("lateral_creepage", "longitudinal_creepage")
    put_in = sum(
        abs(float(found[force] * found[name])) for force, name in zip(("force_x", "force_y"), names, strict=True)
    )
    assert float(found["friction_work"]) == pytest.approx(float(fine["friction_work"]), abs=5e-3 * put_in)


def test_the_columns_are_those_without_motion() -> None:
    still = solve(INSIDE, stresses=False)
    moved = solve(replace(INSIDE, motion=Rolling(longitudinal_creepage=2e-2)), stresses=False)
    assert np.array_equal(still["x"], moved["x"])
    assert float(moved["end_intensity_first"]) == pytest.approx(float(still["end_intensity_first"]), rel=0.01)
    assert 0 < float(moved["force_y"]) < 0.1 * INSIDE.normal_load
    bound = 0.1 * moved["pressure"]
    assert float((np.hypot(moved["traction_x"], moved["traction_y"]) - bound).max()) < 1e-6 * float(bound.max())


def test_creepages_share_one_settled_contact() -> None:
    cache.clear()
    first = settled_contact(replace(LIKE, motion=Rolling(longitudinal_creepage=1e-3)), 0.02, 1e-6)
    assert settled_contact(replace(LIKE, motion=Rolling(force_y=1.0)), 0.02, 1e-6) is first
    assert settled_contact(LIKE, 0.02, 1e-6) is not first  # its window is narrower


def test_coupled_tractions_are_in_the_values_that_are_stated() -> None:
    """A rigid roller on compressible material: what drives it lifts the surface."""
    case = replace(INSIDE, coupled=True, friction=0.5, motion=Rolling(longitudinal_creepage=0.05))
    found = solve(case, stresses=False, accuracy=0.02)
    free = solve(replace(case, coupled=False), stresses=False, accuracy=0.02)
    assert bool(found.converged)
    assert abs(float(found["end_load_first"] / free["end_load_first"]) - 1) > 1e-3
    assert float(found["force_y"]) == pytest.approx(0.5 * case.normal_load, rel=0.02)


def test_given_columns_are_taken() -> None:
    edges = LIKE.body.extent[1] * np.concatenate([np.linspace(0, 0.2, 9)[:-1], np.linspace(0.2, 1, 13)])
    half = LIKE.hertz_half_width
    case = replace(LIKE, motion=Rolling(longitudinal_creepage=1e-3))
    found = solve(case, Grid.from_edges(edges, (-1.5 * half, 1.5 * half), 40), stresses=False)
    assert found.sizes["x"] == edges.size - 1
    assert float(found["force_y"]) == pytest.approx(float(solve(case, stresses=False)["force_y"]), rel=3e-3)
