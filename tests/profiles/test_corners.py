"""Profiles over the effective length."""

from __future__ import annotations

import re

import numpy as np
import pytest

from contactstudy import InvalidInputError, Roller
from contactstudy.profiles import Cylinder, EffectiveLength, FullCrown, Lundberg, Tapered, local_radius
from tests.profiles.conftest import LENGTH, RADIUS

CROWN = FullCrown(0.8)


def test_within_the_effective_length_it_is_the_profile_on_that_length(places: np.ndarray) -> None:
    effective = 0.9 * LENGTH
    inside = places[np.abs(places) <= 0.5 * effective]
    assert EffectiveLength(CROWN, effective).drop(inside, LENGTH) == pytest.approx(CROWN.drop(inside, effective))
    assert EffectiveLength(CROWN, LENGTH).drop(places, LENGTH) == pytest.approx(CROWN.drop(places, LENGTH))


def test_corners_are_those_of_a_rounded_cylinder(places: np.ndarray) -> None:
    found = EffectiveLength(Cylinder(), 0.8 * LENGTH).drop(places, LENGTH)
    assert found == pytest.approx(Cylinder(fillet_radius=0.1 * LENGTH).drop(places, LENGTH), abs=1e-18)


def test_radius_across_is_that_of_the_profile(places: np.ndarray) -> None:
    inside = places[np.abs(places) <= 0.4 * LENGTH]
    found = local_radius(EffectiveLength(Tapered(0.05), 0.8 * LENGTH), inside, LENGTH, RADIUS)
    assert found == pytest.approx(local_radius(Tapered(0.05), inside, 0.8 * LENGTH, RADIUS))


def test_it_says_the_drop_at_its_end() -> None:
    assert repr(EffectiveLength(FullCrown(1.0), 8e-3)).endswith("effective_length=8 mm, drop 8 µm at its end)")


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: EffectiveLength(CROWN, 0.0), "effective_length = 0.0"),
        (lambda: EffectiveLength(Lundberg(1e-6), LENGTH), "drop at the end of the effective length is finite"),
        (lambda: EffectiveLength("crown", LENGTH), "profile = 'crown'"),
        (
            lambda: Roller(radius=RADIUS, length=LENGTH, profile=EffectiveLength(CROWN, 1.1 * LENGTH)),
            "at most the roller's length, 0.01 m",
        ),
    ],
)
def test_bad_input(make, said: str) -> None:
    with pytest.raises(InvalidInputError, match=re.escape(said)):
        make()
