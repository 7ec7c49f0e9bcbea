"""Chamfers, and the corners of generatrices."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.profiles import Chamfer, Cylinder, EffectiveLength, FullCrown, Halves, Lundberg, Measured
from contactstudy.profiles.base import find_slope_jumps

LENGTH = 2e-3
ANGLE = np.radians(2)
X = np.linspace(-LENGTH / 2, LENGTH / 2, 401)


@pytest.mark.parametrize(
    "dimensions",
    [
        {"width": 0.5e-3, "angle": ANGLE},
        {"depth": 0.5e-3 * np.tan(ANGLE), "angle": ANGLE},
        {"depth": 0.5e-3 * np.tan(ANGLE), "width": 0.5e-3},
    ],
)
def test_two_dimensions_determine_chamfer(dimensions: dict[str, float]) -> None:
    drop = Chamfer(**dimensions).drop(X, LENGTH)
    np.testing.assert_allclose(drop, np.maximum(np.abs(X) - 0.5e-3, 0.0) * np.tan(ANGLE), atol=1e-18)


def test_blend_arc_is_tangential_to_both_sides() -> None:
    radius = 5e-3
    chamfer = Chamfer(width=0.5e-3, angle=ANGLE, blend_radius=radius)
    x = np.linspace(0.0, LENGTH / 2, 200001)
    drop = chamfer.drop(x, LENGTH)
    slope = np.diff(drop) / np.diff(x)
    assert np.abs(np.diff(slope)).max() < 1.01 * (x[1] - x[0]) / radius
    assert drop[-1] == pytest.approx(0.5e-3 * np.tan(ANGLE))
    assert not find_slope_jumps(lambda x: chamfer.drop(x, LENGTH), LENGTH).positions.size


@pytest.mark.parametrize(
    ("dimensions", "parameter"),
    [
        ({"width": 1e-4}, "depth, width, angle"),
        ({"width": 1e-4, "depth": 1e-5, "angle": 0.1}, "depth, width, angle"),
        ({"width": 1e-4, "angle": 45.0}, "angle"),
        ({"width": 2 * LENGTH, "angle": 0.1}, "width"),
        ({"width": 1e-4, "angle": 0.5, "blend_radius": 1e-2}, "blend_radius"),
    ],
)
def test_invalid_dimensions_raise(dimensions: dict[str, float], parameter: str) -> None:
    with pytest.raises(InvalidInputError) as caught:
        Chamfer(**dimensions).drop(X, LENGTH)
    assert caught.value.parameter == parameter


RIDGE = Halves(FullCrown(0.2, centre=0.5e-3), FullCrown(0.2, centre=-0.5e-3))


@pytest.mark.parametrize(
    ("profile", "positions", "jumps"),
    [
        (Chamfer(width=0.5e-3, angle=ANGLE), [-0.5e-3, 0.5e-3], [np.tan(ANGLE)] * 2),
        (RIDGE, [0.0], [0.005]),
        (RIDGE + Chamfer(width=0.5e-3, angle=ANGLE), [-0.5e-3, 0.0, 0.5e-3], [np.tan(ANGLE), 0.005, np.tan(ANGLE)]),
        (EffectiveLength(RIDGE, 1.8e-3), [0.0], [0.005]),
        (Lundberg(1e-6) + Chamfer(width=0.3777e-3, angle=ANGLE), [-0.6223e-3, 0.6223e-3], [np.tan(ANGLE)] * 2),
        (Cylinder(0.1e-3), [], []),
        (Cylinder(1e-6) + Lundberg(1e-6), [], []),
        (Halves(FullCrown(1.0), FullCrown(0.5)), [], []),
    ],
)
def test_slope_jumps_of_profiles_equal_formulas(profile, positions: list[float], jumps: list[float]) -> None:
    corners = find_slope_jumps(lambda x: profile.drop(x, LENGTH), LENGTH)
    np.testing.assert_allclose(corners.positions, positions, atol=1e-12)
    np.testing.assert_allclose(corners.jumps, jumps, rtol=1e-4)


@pytest.mark.parametrize(
    ("positions", "jumps"),
    [
        ([-20e-6, 0.0, 20e-6], [0.02, -0.04, 0.02]),  # V groove
        ([0.35e-3, 0.355e-3, 0.445e-3, 0.45e-3], [0.02, -0.02, -0.02, 0.02]),  # flat groove with steep flanks
        ([0.3e-3, 0.31e-3], [0.02, 0.005]),
        ([0.3e-3, 0.31e-3], [0.005, 0.02]),
        ([0.3e-3, 0.301e-3, 0.302e-3], [-0.001, 0.02, -0.01]),
    ],
)
def test_close_corners_are_distinguished(positions: list[float], jumps: list[float]) -> None:
    """The smallest distance of corners is 1e-4 of the length."""

    def drop(x: np.ndarray) -> np.ndarray:
        return 0.4 * x**2 + np.maximum(x[:, None] - positions, 0.0) @ jumps

    corners = find_slope_jumps(drop, 10e-3)
    np.testing.assert_allclose(corners.positions, positions, atol=1e-11)
    np.testing.assert_allclose(corners.jumps, jumps, rtol=1e-4)


@pytest.mark.parametrize("radius", [1.0, 10.0, 1000.0])
def test_arc_has_no_corner_from_rounding(radius: float) -> None:
    """The formula of the arc is a difference of two large numbers."""
    assert not find_slope_jumps(lambda x: radius - np.sqrt(radius**2 - x**2), 10e-3).positions.size


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5])
def test_measured_points_do_not_resolve_a_corner(shift: float) -> None:
    chamfer = Chamfer(width=0.5e-3 + shift * (X[1] - X[0]), angle=ANGLE)
    nodes = Measured(X, chamfer.drop(X, LENGTH)).nodes(LENGTH)
    is_corner = nodes.jumps != 0
    np.testing.assert_allclose(np.abs(nodes.positions[is_corner]), 0.5e-3, atol=5.1e-6)
    np.testing.assert_allclose(nodes.jumps[is_corner], np.tan(ANGLE), rtol=1e-9)


def test_measured_points_resolve_an_edge_radius() -> None:
    nodes = Measured(X, Cylinder(0.1e-3).drop(X, LENGTH)).nodes(LENGTH)
    assert not (np.abs(nodes.positions[nodes.jumps != 0]) < 0.98e-3).any()
