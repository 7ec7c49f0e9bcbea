"""Smallest enclosing balls: exact for known shapes, minimal around random points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from contactstudy.fatigue.history import enclosing_balls

Array = np.ndarray


def is_minimal(points: Array, centre: Array, radius: float) -> bool:
    """Whether the centre is in the convex hull of the support, the condition of the smallest ball."""
    from scipy.optimize import nnls

    support = points[np.linalg.norm(points - centre, axis=1) >= radius * (1 - 1e-7)] - centre
    system = np.vstack([support.T / radius, np.ones(len(support))])
    _, residual = nnls(system, np.append(np.zeros(points.shape[1]), 1.0))
    return bool(residual < 1e-6)


@pytest.mark.parametrize("axes", [1, 2, 3, 5])
def test_ball_of_simplex_is_circumscribed(axes: int) -> None:
    """The vertices, on a unit sphere, support the ball."""
    vertices = np.eye(axes + 1) - 1 / (axes + 1)
    basis = np.linalg.svd(vertices)[2][:axes]
    points = vertices @ basis.T
    points /= np.linalg.norm(points[0])
    centre, radius = enclosing_balls(points[None] + 3.0)
    assert radius == pytest.approx([1.0], rel=1e-9)
    assert centre == pytest.approx(np.full((1, axes), 3.0), rel=1e-9)


def test_ball_of_circle_has_radius_of_circle() -> None:
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    points = np.zeros((1, 40, 5))
    points[0, :, 1], points[0, :, 3] = np.cos(angle), np.sin(angle)
    centre, radius = enclosing_balls(points)
    assert radius == pytest.approx([1.0])
    assert np.abs(centre).max() < 1e-9


def test_ball_of_line_has_half_length() -> None:
    line = np.linspace(0, 1, 7)[:, None] * np.array([3.0, 4.0, 0.0, 0.0, 0.0])
    _, radius = enclosing_balls(np.stack([np.full((7, 5), 2.0), line]))
    assert radius == pytest.approx([0.0, 2.5])


@given(points=arrays(float, (12, 3), elements=st.integers(-4, 4).map(float)))
def test_ball_of_any_points_is_minimal(points: Array) -> None:
    """Many points with integer coordinates coincide, lie on lines, in planes or on spheres."""
    centre, radius = enclosing_balls(points[None])
    assert np.linalg.norm(points - centre[0], axis=1).max() <= radius[0] * (1 + 1e-9) + 1e-12
    assert radius[0] == 0 or is_minimal(points, centre[0], radius[0])


def test_balls_of_many_random_paths_are_minimal() -> None:
    rng = np.random.default_rng(1)
    points = np.cumsum(rng.normal(size=(60, 90, 5)), axis=1) * 10.0 ** rng.integers(-3, 9, (60, 1, 1))
    centre, radius = enclosing_balls(points)
    for path, ball_centre, ball_radius in zip(points, centre, radius, strict=True):
        assert is_minimal(path, ball_centre, ball_radius)
