"""The small drawing of a profile."""

from __future__ import annotations

import re

import numpy as np
import pytest

from contactstudy.profiles import Cylinder, FullCrown, Halves, Lundberg, Profile
from contactstudy.profiles.sketch import sketch


@pytest.mark.parametrize(
    ("profile", "said", "deepest"),
    [
        (Halves(Cylinder(), FullCrown(1.0)), "drop drawn up to 12.5 µm; L = 10 mm", np.inf),
        (Lundberg(2e-7), "drop drawn up to 0.97 µm, cut off at the ends; L = 10 mm", 0.97e-6),
        (FullCrown(1.0) + Cylinder(3e-4), "cut off at the ends", 30e-6),
    ],
)
def test_a_sketch_is_the_drop_in_one_scale(profile: Profile, said: str, deepest: float) -> None:
    svg = sketch(profile, 10e-3, "a <profile>")
    line = re.search(r'<polyline points="([^"]*)"', svg)
    assert line is not None
    points = np.array([point.split(",") for point in line.group(1).split()], dtype=float)
    place = (points[:, 0] - points[:, 0].mean()) / np.ptp(points[:, 0]) * 10e-3
    drop = profile.drop(np.clip(place, -5e-3, 5e-3), 10e-3)
    shown = drop < 0.9 * deepest
    scale, highest = np.polyfit(drop[shown], points[shown, 1], 1)
    assert scale < 0
    # Positions are rounded to a tenth of a unit.
    assert np.abs(points[shown, 1] - highest - scale * drop[shown]).max() < 2.5
    assert np.unique(points[drop > 1.1 * deepest, 1]).size <= 1
    assert said in svg
    assert "a &lt;profile&gt;" in svg


def test_what_is_infinite_is_cut_off_without_any_finite_drop() -> None:
    class Short:
        def drop(self, x, length):
            return np.where(np.abs(x) > 0.302 * length, np.inf, 0.0)

    svg = sketch(Short(), 10e-3, "short")
    line = re.search(r'<polyline points="([^"]*)"', svg)
    assert line is not None
    points = np.array([point.split(",") for point in line.group(1).split()], dtype=float)
    lower = points[:, 1] < points[:, 1].max() - 20
    place = np.abs(points[:, 0] - points[:, 0].mean()) / np.ptp(points[:, 0])
    assert np.array_equal(lower, place > 0.302)
    assert "no drop, cut off where it is infinite; L = 10 mm" in svg


def test_a_straight_roller_has_no_drop() -> None:
    assert "no drop; L = 2 mm" in sketch(Cylinder(), 2e-3, "straight")
