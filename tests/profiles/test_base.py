"""Sums of profiles, and common properties of profiles."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, Roller
from contactstudy.profiles import (
    Cylinder,
    EffectiveLength,
    Ellipsoid,
    FujiwaraKawase,
    FullCrown,
    Halves,
    IsoCylindrical,
    IsoTapered,
    JohnsGohar,
    Lundberg,
    Measured,
    PartialCrown,
    Profile,
    Sphere,
    Sum,
    Tapered,
    local_radius,
)
from tests.profiles.conftest import LENGTH, RADIUS

FILLET = st.one_of(st.just(0.0), st.floats(1e-9, LENGTH / 2))
SYMMETRIC_PROFILES = st.one_of(
    st.builds(Cylinder, FILLET),
    st.builds(Tapered, st.floats(-0.1, 0.1), FILLET),
    st.builds(Lundberg, st.floats(0.0, 1e-5), st.floats(0.0, 3.0)),
    st.builds(JohnsGohar, st.floats(0.0, 1e-5), st.floats(0.0, LENGTH / 2)),
    st.builds(FujiwaraKawase, st.floats(1e-9, 1e-5), st.floats(0.0, 1e-4), st.floats(0.1, 10.0), st.floats(0.01, 1.0)),
    st.builds(IsoCylindrical, st.floats(1e-3, 20e-3)),
    st.builds(IsoTapered, st.floats(1e-3, 20e-3)),
    st.builds(FullCrown, st.floats(LENGTH / 2, 100.0)),
    st.builds(PartialCrown, st.floats(0.0, LENGTH / 2), st.floats(0.02, 10.0), st.just(1e-3), st.floats(5e-3, 0.02)),
    st.builds(Ellipsoid, st.floats(1e-2, 100.0)),
    st.just(Sphere(RADIUS)),
)
"""Symmetric profiles over their valid ranges for a roller of length LENGTH."""


@given(profile=SYMMETRIC_PROFILES, x=st.floats(0.0, LENGTH / 2))
def test_drop_is_symmetric_and_increases_outwards(profile: Profile, x: float) -> None:
    drop = profile.drop(np.array([-x, x, 0.9 * x, 0.0]), LENGTH)
    assert drop.shape == (4,)
    assert drop[0] == drop[1]
    assert drop[1] >= drop[2] * (1 - 1e-12) - 1e-18
    assert drop[2] >= drop[3] == 0.0


@given(first_profile=SYMMETRIC_PROFILES, second_profile=SYMMETRIC_PROFILES, third_profile=SYMMETRIC_PROFILES)
def test_sum_adds_the_drops(first_profile: Profile, second_profile: Profile, third_profile: Profile) -> None:
    x = LENGTH * np.linspace(-0.49, 0.49, 15)
    sum_profile = first_profile + second_profile + third_profile  # type: ignore[operator]
    assert (
        sum_profile
        == Sum((first_profile, second_profile, third_profile))
        == first_profile + (second_profile + third_profile)
    )  # type: ignore[operator]
    np.testing.assert_array_equal(
        sum_profile.drop(x, LENGTH),
        first_profile.drop(x, LENGTH) + second_profile.drop(x, LENGTH) + third_profile.drop(x, LENGTH),
    )


def test_user_profile_needs_only_a_drop() -> None:
    class Wedge:
        def drop(self, x, length):
            return 1e-4 * np.abs(x)

    x = np.array([-1e-3, 2e-3])
    roller = Roller(radius=RADIUS, length=LENGTH, profile=Wedge())
    np.testing.assert_array_equal(roller.clearance(x, np.array([0.0]))[:, 0], 1e-4 * np.abs(x))
    for combined_profile in (Wedge() + Lundberg(1e-6), Lundberg(1e-6) + Wedge()):
        np.testing.assert_allclose(combined_profile.drop(x, LENGTH), 1e-4 * np.abs(x) + Lundberg(1e-6).drop(x, LENGTH))
    np.testing.assert_array_equal(local_radius(Wedge(), x, LENGTH, RADIUS), [RADIUS, RADIUS])


@pytest.mark.parametrize(
    ("drop", "message"),
    [
        (lambda x: 0.0, "it returned float64 of shape ()"),
        (lambda x: np.zeros(7), "of shape (7,)"),
        (lambda x: None, "it returned object"),
        (lambda x: "deep", "it returned <U4"),
        (lambda x: x + 0j, "it returned complex128"),
        (lambda x: -1e-6 * np.ones_like(x), "it returned -1e-06 at x = "),
        (lambda x: np.where(x > 0, np.nan, 0.0), "it returned nan at x = 0.00"),
        (lambda x: np.full(x.shape, np.inf), "finite but at the very ends"),
    ],
)
def test_invalid_drops_of_a_user_profile_are_rejected(drop, message: str) -> None:
    class UserProfile:
        def drop(self, x, length):
            return drop(x)

    with pytest.raises(InvalidInputError, match=re.escape(message)):
        Roller(radius=RADIUS, length=LENGTH, profile=UserProfile())
    if "very ends" not in message:
        for combined_profile in (Sum((UserProfile(), Cylinder())), Halves(Cylinder(), UserProfile())):
            with pytest.raises(InvalidInputError, match="profile = "):
                combined_profile.drop(np.linspace(0.0, 0.4, 5) * LENGTH, LENGTH)


def test_nan_drop_near_the_end_is_rejected() -> None:
    class UserProfile:
        def drop(self, x, length):
            return np.where(np.abs(x) > 0.4 * length, np.nan, 0.0)

    roller = Roller(radius=RADIUS, length=LENGTH, profile=UserProfile())
    with pytest.raises(InvalidInputError, match="it returned nan at x = "):
        roller.clearance(np.array([-0.45 * LENGTH, 0.0]), np.zeros(1))


def test_repr_of_a_user_profile_is_its_name() -> None:
    class UserProfile:
        def drop(self, x, length):
            return np.zeros_like(x)

    for profile in (
        UserProfile(),
        Sum((UserProfile(), Cylinder())),
        Halves(UserProfile(), Cylinder()),
        EffectiveLength(UserProfile(), 0.5 * LENGTH),
    ):
        text = repr(Roller(radius=RADIUS, length=LENGTH, profile=profile))
        assert "UserProfile()" in text
        assert " at 0x" not in text


def test_user_profile_may_return_list() -> None:
    class UserProfile:
        def drop(self, x, length):
            return [1e-6 for _ in x]

    assert Roller(radius=RADIUS, length=LENGTH, profile=UserProfile()).clearance(np.zeros(2), np.zeros(1))[0, 0] == 1e-6


@pytest.mark.parametrize(
    "create",
    [
        lambda: FullCrown(1e300),
        lambda: FullCrown(1.0, centre=1e300),
        lambda: PartialCrown(0.0, 1e160),
        lambda: PartialCrown(1e-3, 1.0, 1e-4, 5e-324),
        lambda: Ellipsoid(5e-324),
        lambda: Lundberg(1e300),
        lambda: Lundberg(1e-6, 1e160),
        lambda: Lundberg.for_pressure(1e300, radius=5e-3, modulus=2e11),
        lambda: Lundberg.for_pressure(1e40, radius=1e40, modulus=1e-40),
        lambda: JohnsGohar.for_pressure(1e300, radius=5e-3, modulus=2e11),
        lambda: FujiwaraKawase.for_pressure(1e300, radius=5e-3, modulus=2e11, edge_drop=1e-6),
        lambda: FujiwaraKawase(1e-6, 1e-6, k1=5e-324),
        lambda: FujiwaraKawase(1e-6, 1e-6, k2=5e-324),
        lambda: IsoCylindrical(1e300),
        lambda: Measured((0, 1, 2, 3, 4), (0, 0, 10**400, 0, 0)),
        lambda: Measured((0, 1, 2, 3, 4), (1e300,) * 5),
    ],
)
def test_numbers_beyond_arithmetic_are_rejected(create) -> None:
    with pytest.raises(InvalidInputError, match=r"units are SI|numbers \(metres\)"):
        create()


def test_sum_keeps_the_radius_of_a_cone(positions: np.ndarray) -> None:
    cone = Tapered(half_angle=0.05)
    for combined_profile in (cone + IsoTapered(LENGTH), IsoTapered(LENGTH) + cone):
        np.testing.assert_array_equal(
            combined_profile.local_radius(positions, LENGTH, RADIUS), cone.local_radius(positions, LENGTH, RADIUS)
        )


@pytest.mark.parametrize("profile", [Cylinder(), Tapered(0.1), Lundberg(1e-6), Measured((0, 1, 2, 3, 4), (0,) * 5)])
def test_equal_profiles_are_equal_and_hashable(profile: Profile) -> None:
    equal_profile = replace(profile)  # type: ignore[type-var]
    assert equal_profile == profile
    assert hash(equal_profile) == hash(profile)
    assert profile + Cylinder() == equal_profile + Cylinder()  # type: ignore[operator]


def test_halves_have_different_drops(positions: np.ndarray) -> None:
    left_profile, right_profile = Cylinder(1e-3), FullCrown(2.0)
    drop = Halves(left=left_profile, right=right_profile).drop(positions, LENGTH)
    np.testing.assert_array_equal(drop[:100], left_profile.drop(positions[:100], LENGTH))
    np.testing.assert_array_equal(drop[100:], right_profile.drop(positions[100:], LENGTH))
    mirrored_drop = Halves(left=right_profile, right=left_profile).drop(-positions, LENGTH)
    np.testing.assert_array_equal(mirrored_drop, drop)


def test_halves_keep_their_radii(positions: np.ndarray) -> None:
    radius = Halves(left=Cylinder(), right=Tapered(0.1)).local_radius(positions, LENGTH, RADIUS)
    assert (radius[:100] == RADIUS).all()
    assert (np.diff(radius[100:]) > 0).all()


@pytest.mark.parametrize(
    ("create", "message"),
    [
        (lambda: Sum(()), r"terms = \(\): must be a tuple of at least one profile"),
        (lambda: Sum((Cylinder(), 3)), "terms = 3: must be profiles"),
        (lambda: Halves(left=Cylinder(), right="crown"), "right = 'crown'"),
        (
            lambda: Halves(left=FullCrown(1.0, centre=1e-3), right=Cylinder()).drop(np.zeros(1), LENGTH),
            "left, right.*equal drops at mid-length",
        ),
    ],
)
def test_invalid_argument_raises(create, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        create()


def test_sum_with_a_number_raises() -> None:
    with pytest.raises(TypeError, match="unsupported operand"):
        Cylinder() + 1e-6  # type: ignore[operator]
