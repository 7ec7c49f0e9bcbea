"""Serialization of cases with any components."""

from __future__ import annotations

import json

import numpy as np
import pytest

from contactstudy import (
    Case,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    Rolling,
    profiles,
)
from contactstudy.case.motion import AxialFriction
from contactstudy.case.serialization import Sampled, from_dict, to_dict

STEEL = Material(210e9, 0.3)
X = np.linspace(0, 1e-3, 101)
PROFILES = [
    profiles.Lundberg(2e-7) + profiles.Cylinder(1e-5),
    profiles.Halves(profiles.Cylinder(), profiles.FullCrown(1.0)),
    profiles.Measured(X.tolist(), ((X - 5e-4) ** 2).tolist()),
    profiles.PartialCrown(1e-4, 1.0),
    profiles.EffectiveLength(profiles.FullCrown(1.0), 0.9e-3),
]


@pytest.mark.parametrize("profile", PROFILES, ids=lambda profile: type(profile).__name__)
@pytest.mark.parametrize("body", [HalfSpace(material=STEEL), QuarterSpace(material=STEEL, model="mirror")])
def test_case_survives_serialization(profile: profiles.Profile, body: HalfSpace) -> None:
    roller = Roller(radius=5e-3, length=1e-3, profile=profile, material=Material(3e11, 0.25))
    motion = Rolling(longitudinal_creepage=1e-3, force_x=0.0)
    friction = AxialFriction((0.0, 1e-3), (0.1, 0.2))
    case = Case(
        body=body, roller=roller, load=np.float64(100.0), friction=friction, motion=motion, tilt=1e-4, end_distance=1e-4
    )
    assert from_dict(json.loads(json.dumps(to_dict(case))), Case) == case


class UserProfile:
    """A user's profile, infinite at the ends."""

    def drop(self, x, length):
        return np.where(np.abs(x) < 0.499 * length, 1e-3 * x**2, np.inf)


def test_user_profile_is_stored_as_samples() -> None:
    body = FiniteLengthSpace(length=2e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3, profile=UserProfile()), max_pressure=1e9)
    restored_profile = from_dict(json.loads(json.dumps(to_dict(case))), Case).roller.profile
    x = np.array([-4.2e-4, 0.0, 3e-4, 5e-4])
    assert np.allclose(restored_profile.drop(x, 1e-3), UserProfile().drop(x, 1e-3), rtol=1e-3, atol=1e-14)


class QuarticProfile:
    """A user's profile over the effective length."""

    def drop(self, x, length):
        return 1e-5 * (2 * np.abs(x) / length) ** 4


def test_user_profile_over_effective_length_is_stored_as_samples() -> None:
    profile = profiles.EffectiveLength(QuarticProfile(), 0.8e-3)
    case = Case(
        body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=1e-3, profile=profile), max_pressure=1e9
    )
    restored_profile = from_dict(to_dict(case), Case).roller.profile
    x = np.array([-4.9e-4, 0.0, 2e-4, 4e-4])
    assert np.allclose(restored_profile.drop(x, 1e-3), profile.drop(x, 1e-3), rtol=1e-3, atol=1e-10)


@pytest.mark.parametrize("table", [{}, {"kind": "Nothing"}, {"kind": "Material", "young": 1.0, "poisson": 0.3}])
def test_table_of_another_class_raises(table: dict[str, object]) -> None:
    with pytest.raises(InvalidInputError, match="case = "):
        from_dict(table, Case)


def test_samples_are_interpolated_linearly():
    sampled_profile = Sampled("wedge", (-0.5, 0.0, 0.5), (1e-6, 0.0, 1e-6))
    assert sampled_profile.drop(np.array([2.5e-3]), 10e-3).tolist() == [5e-07]
