"""Motions: prescribed values and invalid input."""

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


def test_default_motion_of_case_is_sliding() -> None:
    assert create_case(Sliding()) == Case(
        body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=1e-3), max_pressure=1e9, friction=0.1
    )
    assert hash(create_case(Rolling(spin=1.0))) != hash(create_case(Rolling(spin=2.0)))


def test_creepage_and_its_force_together_raise() -> None:
    with pytest.raises(InvalidInputError, match="longitudinal_creepage, force_y"):
        Rolling(longitudinal_creepage=1e-3, force_y=1.0)
    with pytest.raises(InvalidInputError, match="spin, moment_z"):
        Rolling(spin=0.0, moment_z=0.0)
    with pytest.raises(InvalidInputError, match="x, force_x"):
        Shift(x=1e-6, force_x=1.0)


@pytest.mark.parametrize("value", [float("nan"), "fast", True])
def test_motion_without_number_raises(value: object) -> None:
    with pytest.raises(InvalidInputError, match="longitudinal_creepage"):
        Rolling(longitudinal_creepage=value)  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match="force_y"):
        Shift(force_y=value)  # type: ignore[arg-type]


def test_negative_friction_with_rolling_raises() -> None:
    with pytest.raises(InvalidInputError, match="motion = 'rolling'"):
        create_case("rolling")  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match=r"friction = -0.1.*not below zero"):
        create_case(Rolling(), -0.1)
    assert create_case(Sliding(), -0.1).friction == -0.1


def test_entrainment_and_slide_roll_ratio_of_speeds():
    speeds = SurfaceSpeeds(body=2.0, roller=3.0)
    assert (speeds.entrainment, speeds.slide_roll_ratio) == (2.5, 0.4)
