"""Motions: prescribed values and rejected input."""

from __future__ import annotations

import pytest

from contactstudy import Case, HalfSpace, InvalidInputError, Material, Roller, Rolling, Shift, Sliding
from contactstudy.case.motion import Motion, SurfaceSpeeds

STEEL = Material(210e9, 0.3)


def create_case(motion: Motion, friction: float = 0.1) -> Case:
    return Case(
        body=HalfSpace(material=STEEL),
        roller=Roller(radius=5e-3, length=1e-3),
        max_pressure=1e9,
        friction=friction,
        motion=motion,
    )


def test_default_motion_is_zero() -> None:
    assert Rolling() == Rolling(longitudinal_creepage=0.0, lateral_creepage=0.0, spin=0.0)
    assert Shift() == Shift(x=0, y=0)
    assert Rolling(force_y=2).longitudinal_creepage is None
    assert Rolling(force_y=2, moment_z=0.0).modes == ("y", "spin")
    assert Shift(force_x=1.0, force_y=2.0).modes == ("x", "y")


def test_full_sliding_is_the_default() -> None:
    assert create_case(Sliding()) == Case(
        body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=1e-3), max_pressure=1e9, friction=0.1
    )
    assert hash(create_case(Rolling(spin=1.0))) != hash(create_case(Rolling(spin=2.0)))


def test_motion_and_force_exclude_each_other() -> None:
    with pytest.raises(InvalidInputError, match="longitudinal_creepage, force_y"):
        Rolling(longitudinal_creepage=1e-3, force_y=1.0)
    with pytest.raises(InvalidInputError, match="spin, moment_z"):
        Rolling(spin=0.0, moment_z=0.0)
    with pytest.raises(InvalidInputError, match="x, force_x"):
        Shift(x=1e-6, force_x=1.0)


@pytest.mark.parametrize("value", [float("nan"), "fast", True])
def test_other_values_than_numbers_are_rejected(value: object) -> None:
    with pytest.raises(InvalidInputError, match="longitudinal_creepage"):
        Rolling(longitudinal_creepage=value)  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match="force_y"):
        Shift(force_y=value)  # type: ignore[arg-type]


def test_motion_limits_the_friction() -> None:
    with pytest.raises(InvalidInputError, match="motion = 'rolling'"):
        create_case("rolling")  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match=r"friction = -0.1.*not below zero"):
        create_case(Rolling(), -0.1)
    assert create_case(Sliding(), -0.1).friction == -0.1


def test_entrainment_and_slide_roll_ratio():
    speeds = SurfaceSpeeds(body=2.0, roller=3.0)
    assert (speeds.entrainment, speeds.slide_roll_ratio) == (2.5, 0.4)
