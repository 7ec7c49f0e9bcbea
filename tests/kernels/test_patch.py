"""Closed forms of the loaded rectangle, and the sum over its mirror images."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy.kernels import images, patch
from contactstudy.verification import closed_forms as ref

CORNERS = {"normal": patch.normal_corner, "tangential": patch.tangential_corner}


def rectangle(kind: str, x: float, y: float, z: float, size: tuple[float, float] = (1.0, 1.0)) -> np.ndarray:
    """Stresses under a unit load on a rectangle about the origin."""
    x_edges, y_edges = (c + 0.5 * s * np.array([-1.0, 1.0]) for c, s in zip((x, y), size, strict=True))
    corner = CORNERS[kind](x_edges[:, None], y_edges[None, :], z, 0.3)
    return np.diff(np.diff(corner, axis=-1), axis=-2)[:, 0, 0]


@pytest.mark.parametrize("kind", sorted(CORNERS))
def test_far_away_a_rectangle_is_a_point_load(kind: str) -> None:
    """Boussinesq and Cerruti."""
    point = (6.0, -8.0, 5.0)
    exact = ref.point_load(*point, poisson=0.3, **{k: float(k == kind) for k in CORNERS})
    found = rectangle(kind, *point, size=(0.1, 0.1)) / 0.01
    assert found == pytest.approx([float(exact[c]) for c in ref.COMPONENTS], rel=1e-3, abs=1e-8)


@given(st.sampled_from(sorted(CORNERS)), st.floats(-3, 3), st.floats(-3, 3), st.floats(0.2, 3))
def test_stress_is_in_equilibrium(kind: str, x: float, y: float, z: float) -> None:
    step = 1e-3

    def slope(axis: int) -> np.ndarray:
        up, down = np.array([x, y, z]), np.array([x, y, z])
        up[axis] += step
        down[axis] -= step
        return (rectangle(kind, *up) - rectangle(kind, *down)) / (2 * step)

    along_x, along_y, along_z = slope(0), slope(1), slope(2)
    assert abs(along_x[0] + along_y[3] + along_z[4]) < 1e-3
    assert abs(along_x[3] + along_y[1] + along_z[5]) < 1e-3
    assert abs(along_x[4] + along_y[5] + along_z[2]) < 1e-3


@pytest.mark.parametrize(("kind", "component"), [("normal", 2), ("tangential", 5)])
def test_surface_carries_the_load_and_nothing_else(kind: str, component: int) -> None:
    inside, outside = rectangle(kind, 0.2, -0.3, 0.0), rectangle(kind, 0.9, 0.2, 0.0)
    for number in (2, 4, 5):
        assert inside[number] == pytest.approx(-1.0 if number == component else 0.0, abs=1e-12)
        assert outside[number] == pytest.approx(0.0, abs=1e-12)


def test_corners_and_edges_on_the_surface_give_numbers() -> None:
    edges = np.array([-1.0, 0.0, 1.0])
    for corner in CORNERS.values():
        assert np.isfinite(corner(edges[:, None], edges[None, :], 0.0, 0.3)).all()


@pytest.mark.parametrize("kind", sorted(CORNERS))
@pytest.mark.parametrize("depth", [0.0, 0.3, 4.0])
@pytest.mark.parametrize(
    ("length", "dy", "cells_y", "cells_x", "allowed"),
    [(2.0, 0.2, 3, 20, 1e-8), (0.2, 0.04, 90, 20, 1e-8), (2.0, 0.2, 3, 2, 1e-5)],
    ids=["long", "thin", "two cells"],
)
def test_all_images_are_summed(
    kind: str, depth: float, length: float, dy: float, cells_y: int, cells_x: int, allowed: float
) -> None:
    """Against a plain sum over many images, extrapolated to infinitely many; also seen from many lengths aside."""
    dx = length / cells_x
    corner = partial(CORNERS[kind], z=depth, poisson=0.3)
    x, y = dx * np.arange(0, cells_x + 1), dy * np.arange(cells_y)
    found = images.mirrored_kernel(corner, x, y, dx, dy, length)
    sums = []
    for count in (400, 800):
        shifts = 2 * length * np.arange(-count, count + 1)
        sums.append(sum(images.cell_kernel(corner, x + shift, y, dx, dy) for shift in shifts))
    limit = sums[1] + (sums[1] - sums[0])
    # Far below the length of the body there is next to nothing left of one cell's load.
    assert np.abs(found - limit).max() < allowed / length


@pytest.mark.parametrize("span", [0.3, 1.0, 4.0])
def test_few_points_stand_for_many_a_length_away(span: float) -> None:
    length, values = 1.0, np.linspace(2.0, 2.0 + span, 200)
    points, matrix = images.few_points(values, length)
    assert matrix is not None
    assert points.size < 120
    for away in (1.0 - length, 2.0 + span + length):
        expected = 1 / (values - away)
        assert np.abs(matrix @ (1 / (points - away)) - expected).max() < 2 * images.LEFT * np.abs(expected).max()


def test_points_at_one_place_are_one() -> None:
    points, matrix = images.few_points(np.full(3, 0.7), 1.0)
    assert points.tolist() == [0.7]
    assert np.array_equal(np.ones((3, 1)), matrix)
    assert images.few_points(np.array([0.7]), 1.0)[1] is None
