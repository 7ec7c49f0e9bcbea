"""Cases, rollers, grids and materials: properties and invalid input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    choose_grid,
    profiles,
    solve,
)
from contactstudy.bodies import Body
from contactstudy.bodies.models import BodyWithFreeEnds
from contactstudy.report import assess

STEEL = Material(young=210e9, poisson=0.3)
ROLLER = Roller(radius=5e-3, length=10e-3, profile=profiles.Cylinder(fillet_radius=0.2e-3))
BODY = FiniteLengthSpace(length=10.2e-3, material=STEEL)


@given(st.floats(0.5e9, 3e9))
def test_load_and_pressure_are_equivalent(pressure: float) -> None:
    case_by_pressure = Case(body=BODY, roller=ROLLER, max_pressure=pressure)
    case_by_load = Case(body=BODY, roller=ROLLER, load=case_by_pressure.normal_load)
    assert case_by_load.hertz_max_pressure == pytest.approx(pressure, rel=1e-12)
    assert case_by_load.hertz_half_width == pytest.approx(case_by_pressure.hertz_half_width, rel=1e-12)


def test_roller_is_centred_by_default() -> None:
    case = Case(body=BODY, roller=ROLLER, max_pressure=1e9)
    assert case.contact_range == pytest.approx((0.1e-3, 10.1e-3))
    assert replace(case, end_distance=0.0).contact_range == pytest.approx((0.0, 10e-3))
    assert replace(case, end_distance=-1e-3).contact_range == pytest.approx((0.0, 9e-3))
    assert replace(case, body=HalfSpace(material=STEEL)).contact_range == pytest.approx((0.0, 10e-3))


def test_gap_is_zero_at_first_touch() -> None:
    case = Case(body=BODY, roller=ROLLER, max_pressure=1e9)
    gap = case.gap(Grid(x_range=(0.0, 10.2e-3), y_range=(-1e-4, 1e-4), cells_x=102, cells_y=11))
    assert gap.min() == 0.0
    assert np.isinf(gap[0]).all()
    assert gap[50, 0] == pytest.approx((1e-4 * 10 / 11) ** 2 / 2 / 5e-3)


def test_chosen_grid_covers_body_and_half_widths() -> None:
    case = Case(body=BODY, roller=ROLLER, max_pressure=1.5e9)
    grid = choose_grid(case, cells_x=6, cells_y=12, window=1.7)
    assert grid.x_range == (0.0, 10.2e-3)
    assert grid.dx <= case.hertz_half_width / 6
    assert grid.dy <= case.hertz_half_width / 12
    assert grid.y_range[1] == pytest.approx(1.7 * case.hertz_half_width)
    half_space_grid = choose_grid(replace(case, body=HalfSpace(material=STEEL)), margin=2.0)
    assert half_space_grid.x_range[0] == pytest.approx(-2 * case.hertz_half_width)


@given(st.floats(-1e3, 1e3), st.floats(1e-6, 1e3), st.integers(2, 200))
def test_grid_from_centres_equals_grid(start: float, span: float, cells: int) -> None:
    grid = Grid(x_range=(start, start + span), y_range=(-span, span), cells_x=cells, cells_y=cells + 1)
    assume(grid.dx > 1e-9 * abs(start))  # larger positions would make the differences of centres rounding errors
    restored_grid = Grid.from_centres(grid.x, grid.y)
    assert restored_grid.shape == grid.shape
    assert restored_grid.dx == pytest.approx(grid.dx, rel=1e-3)


@pytest.mark.parametrize(
    ("create", "message"),
    [
        (lambda: Material(young=-1.0, poisson=0.3), r"young = -1.0: must be a positive finite number \(Pa\)"),
        (lambda: Material(young=1.0, poisson=0.51), r"poisson = 0.51: must be in \(-1, 0.5\]"),
        (lambda: Material(young=1.0, poisson=-1.0), "poisson = -1.0"),
        (lambda: Material(young="hard", poisson=0.3), "young = 'hard'"),
        (lambda: Material(young=True, poisson=0.3), "young = True"),
        (lambda: FiniteLengthSpace(length=-1.0, material=STEEL), "length = -1.0"),
        (lambda: FiniteLengthSpace(length=1.0, material="steel"), "material = 'steel'.*not str"),
        (lambda: Roller(radius=0.0, length=1.0), "radius = 0.0"),
        (lambda: Roller(radius=1.0, length=np.nan), "length = nan"),
        (lambda: Roller(radius=1.0, length=1.0, profile=3), "profile = 3"),
        (lambda: Roller(radius=1.0, length=1.0, profile=profiles.Cylinder(fillet_radius=0.6)), "fillet_radius = 0.6"),
        (
            lambda: Case(body=BODY, roller=Roller(radius=5e-3, length=11e-3), max_pressure=1e9),
            r"roller.length = 0.011: must be at most the body's length, 0.0102 m; give end_distance",
        ),
        (lambda: Case(body=None, roller=ROLLER, max_pressure=1e9), "body = None: must be elastic.*two rigid bodies"),
        (lambda: Material(young=np.inf, poisson=0.3), "young = inf"),
        (lambda: Case(body=BODY, roller=ROLLER), "max_pressure, load, approach = .*exactly one"),
        (lambda: Case(body=BODY, roller=ROLLER, load=1.0, approach=1e-6), "exactly one of the three"),
        (lambda: Case(body=BODY, roller=ROLLER, approach=[1e-6, 2e-6]), "one number .*sweep a list in a Study"),
        (lambda: Case(body=BODY, roller=ROLLER, approach=0.0), "more than that of first touch, 0 m"),
        (lambda: Case(body=BODY, roller=ROLLER, approach=1.0), "no more than the roller.s radius"),
        (lambda: Case(body=BODY, roller=ROLLER, approach=1e-6, load_position=1e-3), "load_position = 0.001"),
        (
            lambda: Case(body=BODY, roller=ROLLER, approach=1e-6).normal_load,
            "approach = 1e-06.*give load =",
        ),
        (lambda: Case(body=BODY, roller=ROLLER, max_pressure=1e9, load=1.0), "exactly one"),
        (lambda: Case(body=BODY, roller=ROLLER, max_pressure=-1e9), "max_pressure = -1000000000.0"),
        (
            lambda: Case(body=BODY, roller=ROLLER, max_pressure=1e9, end_distance=1.0),
            "end_distance = 1.0.*over the body",
        ),
        (lambda: Case(body=BODY, roller=ROLLER, max_pressure=1e9, friction="none"), "friction = 'none'"),
        (lambda: Grid(x_range=(0.0, 0.0), y_range=(0.0, 1.0), cells_x=1, cells_y=1), r"x_range = \(0.0, 0.0\)"),
        (
            lambda: Grid(x_range=(0.0, 1.0), y_range=(0.0, 1.0), cells_x=0, cells_y=1),
            "cells_x = 0: must be a whole number",
        ),
        (lambda: Grid(x_range=(0.0, 1.0), y_range=(0.0, 1.0), cells_x=1, cells_y=1.5), "cells_y = 1.5"),
        (lambda: choose_grid(Case(body=BODY, roller=ROLLER, max_pressure=1e9), window=0.0), "window = 0.0"),
    ],
)
def test_invalid_argument_raises(create, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        create()


@pytest.mark.parametrize(
    ("material", "load", "message"),
    [
        (Material(210.0, 0.3), {"max_pressure": 1.5e9}, "max_pressure = .* in Pa"),
        (STEEL, {"max_pressure": 1e11}, "max_pressure = "),
        (STEEL, {"max_pressure": 1.5}, "max_pressure = 1.5.* at least 1e-07 of .* in Pa"),
        (STEEL, {"load": 1e-40}, "load = 1e-40.* loads in N"),
        (STEEL, {"load": 5e-324}, r"load = 5e-324: .*of a size from 1e-50 to 1e\+50"),
        (STEEL, {"load": 1e300}, r"load = 1e\+300: .*of a size from 1e-50 to 1e\+50"),
        (STEEL, {"max_pressure": 5e-324}, "max_pressure = 5e-324: .*of a size"),
        (STEEL, {"load": 1e7}, "load = .* loads in N"),
    ],
    ids=[
        "modulus in GPa",
        "pressure",
        "load",
        "pressure in GPa",
        "tiny load",
        "least float",
        "huge load",
        "least pressure",
    ],
)
def test_impossible_loads_are_rejected(material: Material, load: dict[str, float], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        Case(body=FiniteLengthSpace(length=10e-3, material=material), roller=replace(ROLLER, length=10e-3), **load)


@pytest.mark.parametrize(
    ("radius", "length", "message"),
    [(1.0, 1e-9, "roller.length = 1e-09.*Hertz half-widths"), (1e-8, 1e9, "roller.length = .*Hertz half-widths")],
)
def test_lengths_out_of_proportion_are_rejected(radius: float, length: float, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        Case(body=HalfSpace(material=STEEL), roller=Roller(radius=radius, length=length), max_pressure=1e9)


def test_pressure_in_another_unit_is_rejected() -> None:
    with pytest.raises(InvalidInputError, match=r"max_pressure = 1500.0: .* 1500 MPa is 1.5e9 Pa"):
        Case(body=BODY, roller=ROLLER, max_pressure=1500.0)
    with pytest.raises(InvalidInputError, match=r"at most 1e\+08 cells.*pressures are in Pa"):
        choose_grid(Case(body=BODY, roller=ROLLER, max_pressure=30000.0))


def test_base_classes_of_bodies_are_rejected() -> None:
    for body_class in (Body, BodyWithFreeEnds):
        with pytest.raises(InvalidInputError, match=f"body = '{body_class.__name__}': must be a HalfSpace"):
            body_class(material=STEEL)
    with pytest.raises(InvalidInputError, match=r"body = 'half-space': must be elastic.*not str"):
        Case(body="half-space", roller=ROLLER, max_pressure=1e9)  # type: ignore[arg-type]


def test_coupled_must_be_boolean() -> None:
    with pytest.raises(InvalidInputError, match="coupled = 1"):
        Case(body=BODY, roller=ROLLER, max_pressure=1e9, coupled=1)  # type: ignore[arg-type]


def test_combined_radius_of_two_curved_bodies() -> None:
    assert Roller.combined_radius(6e-3, 30e-3) == pytest.approx(5e-3)
    assert Roller.combined_radius(30e-3, 6e-3) == pytest.approx(5e-3)
    assert Roller.combined_radius(6e-3, -42e-3) == pytest.approx(7e-3)
    x = np.linspace(-1e-4, 1e-4, 5)  # gap between two circles, and gap of the combined radius
    circles = [radius - np.sqrt(radius**2 - x**2) for radius in (6e-3, 42e-3)]
    roller = Roller(radius=Roller.combined_radius(6e-3, -42e-3), length=1e-3)
    np.testing.assert_allclose(roller.clearance(np.zeros(1), x)[0], circles[0] - circles[1], rtol=2e-4, atol=1e-15)


@pytest.mark.parametrize(
    ("first_radius", "second_radius", "message"),
    [
        (6e-3, -6e-3, "hollow radius is the larger"),
        (6e-3, -5e-3, "hollow radius is the larger"),
        (-6e-3, -7e-3, "hollow radius is the larger"),
        (0.0, 6e-3, "first = 0"),
        (6e-3, np.inf, "second = inf"),
        ("6 mm", 6e-3, "first = '6 mm'"),
    ],
)
def test_radii_without_a_gap_are_rejected(first_radius, second_radius, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        Roller.combined_radius(first_radius, second_radius)


def test_roller_ends_are_symmetric_within_rounding() -> None:
    """75 cells on 0.6 mm have midpoints at 0.1 and 0.5 mm, at the ends of the roller."""
    grid = Grid(x_range=(0.0, 0.6e-3), y_range=(-1e-4, 1e-4), cells_x=75, cells_y=4)
    for profile, end_columns in ((profiles.Cylinder(), [12, 62]), (profiles.Lundberg(2e-7), [13, 61])):
        roller = Roller(radius=5e-3, length=0.4e-3, profile=profile)
        case = Case(body=FiniteLengthSpace(length=0.6e-3, material=STEEL), roller=roller, max_pressure=1.5e9)
        gap = case.gap(grid)
        np.testing.assert_allclose(gap, gap[::-1])
        assert np.flatnonzero(np.isfinite(gap[:, 0]))[[0, -1]].tolist() == end_columns


@pytest.mark.parametrize("body", [FiniteLengthSpace(length=10e-3, material=STEEL), QuarterSpace(material=STEEL)])
@pytest.mark.parametrize("edge", [profiles.Cylinder(0.5e-3), profiles.Chamfer(width=0.5e-3, angle=0.2)])
def test_body_edge_opens_the_gap_at_the_free_ends(body: Body, edge: profiles.Profile) -> None:
    case = Case(body=body, roller=Roller(radius=5e-3, length=14e-3), load=1e3, end_distance=-2e-3, body_edge=edge)
    distances = np.array([0.0, 0.1e-3, 0.4e-3, 5e-3])
    expected = edge.drop(5e-3 - distances, 10e-3)
    np.testing.assert_allclose(case.gap_on_axis(distances), expected, atol=1e-15)
    far_drop = expected if isinstance(body, FiniteLengthSpace) else 0.0
    np.testing.assert_allclose(case.gap_on_axis(10e-3 - distances), far_drop, atol=1e-15)


def test_edge_radius_of_the_body_bounds_the_pressure() -> None:
    body = FiniteLengthSpace(length=0.4e-3, material=STEEL)
    roller = Roller(radius=5e-3, length=0.6e-3, material=STEEL)
    case = Case(body=body, roller=roller, load=60.0, end_distance=-0.1e-3)
    sharp_result = solve(case, accuracy=0.05, stresses=False)
    rounded_result = solve(replace(case, body_edge=profiles.Cylinder(0.04e-3)), accuracy=0.05, stresses=False)
    assert np.isinf(sharp_result.peak_pressure)
    assert "body_edge" in str(assess(sharp_result))
    assert np.isfinite(rounded_result.peak_pressure)
