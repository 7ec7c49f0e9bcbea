"""Profiles over the effective length."""

from __future__ import annotations

import re

import numpy as np
import pytest

from contactstudy import InvalidInputError, Roller
from contactstudy.profiles import (
    Cylinder,
    EffectiveLength,
    FujiwaraKawase,
    FullCrown,
    JohnsGohar,
    Lundberg,
    Profile,
    Tapered,
    local_radius,
)
from contactstudy.profiles.base import Shape
from tests.profiles.conftest import LENGTH, RADIUS

CROWN = FullCrown(0.8)


def test_drop_within_effective_length_equals_inner_profile(positions: np.ndarray) -> None:
    effective_length = 0.9 * LENGTH
    inner_positions = positions[np.abs(positions) <= 0.5 * effective_length]
    assert EffectiveLength(CROWN, effective_length).drop(inner_positions, LENGTH) == pytest.approx(
        CROWN.drop(inner_positions, effective_length)
    )
    assert EffectiveLength(CROWN, LENGTH).drop(positions, LENGTH) == pytest.approx(CROWN.drop(positions, LENGTH))


def test_corners_equal_a_rounded_cylinder(positions: np.ndarray) -> None:
    drops = EffectiveLength(Cylinder(), 0.8 * LENGTH).drop(positions, LENGTH)
    assert drops == pytest.approx(Cylinder(fillet_radius=0.1 * LENGTH).drop(positions, LENGTH), abs=1e-18)


@pytest.mark.parametrize(
    "profile", [CROWN, FujiwaraKawase(2e-7, 1e-6), FujiwaraKawase(5e-7, 8e-6), JohnsGohar(1e-6, 4e-5)]
)
def test_corners_continue_the_profile(profile: Profile) -> None:
    """The corner starts with the slope of the profile; a corner parallel to the axis would carry load."""
    effective_length = 0.9 * LENGTH
    x = np.linspace(0.4 * LENGTH, 0.5 * LENGTH, 20001)
    drop = EffectiveLength(profile, effective_length).drop(x, LENGTH)
    assert np.array_equal(drop, EffectiveLength(profile, effective_length).drop(-x, LENGTH))
    slope = np.diff(drop) / np.diff(x)
    # The corner continues slopes up to 1, steeper than any contact.
    assert (np.diff(np.minimum(slope, 0.99)) > -1e-9).all()
    assert slope[-1] > 50
    radius = 0.05 * LENGTH
    assert drop[-1] > EffectiveLength(profile, effective_length).end_drop + radius


def test_corner_is_a_circle_up_to_a_right_angle() -> None:
    """The corner turns from a flank of slope 3/4 to a right angle, with the radius c / (1 - 0.6)."""

    class Cone(Shape):
        def drop(self, x, length):
            return 0.75 * np.abs(x)

    half_effective_length, corner = 0.4 * LENGTH, 0.1 * LENGTH
    angle = np.linspace(np.arcsin(0.6), 0.5 * np.pi, 7)
    radius = corner / 0.4
    x, drop = (
        half_effective_length + radius * (np.sin(angle) - 0.6),
        0.75 * half_effective_length + radius * (0.8 - np.cos(angle)),
    )
    assert EffectiveLength(Cone(), 2 * half_effective_length).drop(x, LENGTH) == pytest.approx(drop, rel=1e-6)


def test_radius_across_equals_the_profile(positions: np.ndarray) -> None:
    inner_positions = positions[np.abs(positions) <= 0.4 * LENGTH]
    radii = local_radius(EffectiveLength(Tapered(0.05), 0.8 * LENGTH), inner_positions, LENGTH, RADIUS)
    assert radii == pytest.approx(local_radius(Tapered(0.05), inner_positions, 0.8 * LENGTH, RADIUS))


def test_infinite_drop_continues_up_to_slope_one() -> None:
    effective_length = 0.9 * LENGTH
    profile = EffectiveLength(Lundberg(2e-7), effective_length)
    x = np.linspace(0.0, 0.5 * LENGTH, 100001)
    drop = profile.drop(x, LENGTH)
    inner_positions = x < 0.4999 * effective_length
    assert drop[inner_positions] == pytest.approx(Lundberg(2e-7).drop(x[inner_positions], effective_length))
    assert np.isfinite(drop).all()
    assert (np.diff(drop) >= 0).all()
    assert drop[-1] > 0.05 * LENGTH


def test_repr_contains_the_end_drop() -> None:
    assert repr(EffectiveLength(FullCrown(1.0), 8e-3)).endswith("effective_length=8 mm, drop 8 µm at its end)")


@pytest.mark.parametrize(
    ("create", "message"),
    [
        (lambda: EffectiveLength(CROWN, 0.0), "effective_length = 0.0"),
        (lambda: EffectiveLength("crown", LENGTH), "profile = 'crown'"),
        (
            lambda: Roller(radius=RADIUS, length=LENGTH, profile=EffectiveLength(CROWN, 1.1 * LENGTH)),
            "at most the roller's length, 0.01 m",
        ),
    ],
)
def test_invalid_argument_raises(create, message: str) -> None:
    with pytest.raises(InvalidInputError, match=re.escape(message)):
        create()
