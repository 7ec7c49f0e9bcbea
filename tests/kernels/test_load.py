"""Loaded rectangle: stresses and displacements against closed forms, and the sum over mirror images."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import Grid
from contactstudy.arrays.grid import Points
from contactstudy.checks import FloatArray
from contactstudy.kernels import images
from contactstudy.kernels.field import displacement_influence, half_space_field
from contactstudy.kernels.load import (
    DISPLACEMENT_CORNERS,
    STRESS_CORNERS,
    Load,
    Response,
    normal_corner,
    normal_displacement_inside,
    tangential_corner,
    tangential_displacement_inside,
)
from contactstudy.kernels.strips import corner_function, strips_of
from contactstudy.verification import closed_forms as ref

CORNERS = {"normal": normal_corner, "tangential": tangential_corner}


def compute_stress_of_rectangle(
    kind: str, x: float, y: float, z: float, size: tuple[float, float] = (1.0, 1.0)
) -> np.ndarray:
    """Stresses under a unit load on a rectangle about the origin."""
    x_edges, y_edges = (
        centre + 0.5 * side_length * np.array([-1.0, 1.0]) for centre, side_length in zip((x, y), size, strict=True)
    )
    corner = CORNERS[kind](x_edges[:, None], y_edges[None, :], z, 0.3)
    return np.diff(np.diff(corner, axis=-1), axis=-2)[:, 0, 0]


@pytest.mark.parametrize("kind", sorted(CORNERS))
def test_distant_rectangle_equals_point_load(kind: str) -> None:
    """The field equals Boussinesq's and Cerruti's."""
    point = (6.0, -8.0, 5.0)
    point_stress = ref.point_load(*point, poisson=0.3, **{load_kind: float(load_kind == kind) for load_kind in CORNERS})
    computed = compute_stress_of_rectangle(kind, *point, size=(0.1, 0.1)) / 0.01
    assert computed == pytest.approx([float(point_stress[c]) for c in ref.COMPONENTS], rel=1e-3, abs=1e-8)


@given(st.sampled_from(sorted(CORNERS)), st.floats(-3, 3), st.floats(-3, 3), st.floats(0.2, 3))
def test_stress_is_in_equilibrium(kind: str, x: float, y: float, z: float) -> None:
    step = 1e-3

    def compute_slope(axis: int) -> np.ndarray:
        upper_point, lower_point = np.array([x, y, z]), np.array([x, y, z])
        upper_point[axis] += step
        lower_point[axis] -= step
        return (compute_stress_of_rectangle(kind, *upper_point) - compute_stress_of_rectangle(kind, *lower_point)) / (
            2 * step
        )

    x_derivative, y_derivative, z_derivative = compute_slope(0), compute_slope(1), compute_slope(2)
    assert abs(x_derivative[0] + y_derivative[3] + z_derivative[4]) < 1e-3
    assert abs(x_derivative[3] + y_derivative[1] + z_derivative[5]) < 1e-3
    assert abs(x_derivative[4] + y_derivative[5] + z_derivative[2]) < 1e-3


@pytest.mark.parametrize(("kind", "component"), [("normal", 2), ("tangential", 5)])
def test_surface_traction_equals_load(kind: str, component: int) -> None:
    inside_stress, outside_stress = (
        compute_stress_of_rectangle(kind, 0.2, -0.3, 0.0),
        compute_stress_of_rectangle(kind, 0.9, 0.2, 0.0),
    )
    for traction_component in (2, 4, 5):
        assert inside_stress[traction_component] == pytest.approx(
            -1.0 if traction_component == component else 0.0, abs=1e-12
        )
        assert outside_stress[traction_component] == pytest.approx(0.0, abs=1e-12)


def test_corners_and_edges_have_finite_stress() -> None:
    edges = np.array([-1.0, 0.0, 1.0])
    for corner in CORNERS.values():
        assert np.isfinite(corner(edges[:, None], edges[None, :], 0.0, 0.3)).all()


@pytest.mark.parametrize("kind", sorted(CORNERS))
@pytest.mark.parametrize("depth", [0.0, 0.4])
@pytest.mark.parametrize(
    ("length", "dy", "cells_y", "cells_x", "tolerance"),
    [(2.0, 0.2, 3, 20, 1e-8), (0.2, 0.12, 30, 20, 3e-8), (2.0, 0.2, 3, 2, 1e-5)],
    ids=["long", "thin", "two cells"],
)
def test_kernel_includes_all_images(
    kind: str, depth: float, length: float, dy: float, cells_y: int, cells_x: int, tolerance: float
) -> None:
    """The reference is a sum over 1600 images, extrapolated to infinitely many."""
    dx = length / cells_x
    corner = partial(CORNERS[kind], z=depth, poisson=0.3)
    x, y = dx * np.arange(0, cells_x + 1), dy * np.arange(cells_y)
    computed = images.mirrored_kernel(corner, x, y, dx, dy, length, 0.0)
    near_images, far_images = (
        sum(images.cell_kernel(corner, x + 2 * length * image_number, y, dx, dy) for image_number in image_numbers)
        for image_numbers in (range(-400, 401), [*range(-800, -400), *range(401, 801)])
    )
    far_limit = near_images + 2 * far_images
    # The tolerance is over the level of the image sum, 1 / length.
    assert np.abs(computed - far_limit).max() < tolerance / length


@pytest.mark.parametrize("span", [0.3, 1.0, 4.0])
def test_interpolation_of_far_images_has_default_tolerance(span: float) -> None:
    length, positions = 1.0, np.linspace(2.0, 2.0 + span, 200)
    points, matrix = images.interpolation_points(positions, length)
    assert matrix is not None
    assert points.size < 120
    for image_position in (1.0 - length, 2.0 + span + length):
        expected = 1 / (positions - image_position)
        assert (
            np.abs(matrix @ (1 / (points - image_position)) - expected).max()
            < 2 * images.INTERPOLATION_ERROR * np.abs(expected).max()
        )


def test_coincident_points_are_merged() -> None:
    points, matrix = images.interpolation_points(np.full(3, 0.7), 1.0)
    assert points.tolist() == [0.7]
    assert np.array_equal(np.ones((3, 1)), matrix)
    assert images.interpolation_points(np.array([0.7]), 1.0)[1] is None


NU = 0.3


def compute_mean_on_rectangle(corner, x, y, z, size=(1e-3, 1e-3)):
    edges_x, edges_y = (centre + 0.5 * length * np.array([-1, 1]) for centre, length in zip((x, y), size, strict=True))
    corners = corner(edges_x[:, None], edges_y[None, :], z, NU)
    return np.diff(np.diff(corners, axis=1), axis=2)[:, 0, 0] / (size[0] * size[1])


@pytest.mark.parametrize("point", [(0.7, -0.4, 0.5), (-0.2, 0.3, 0.05), (1.0, 2.0, 0.0)])
def test_small_rectangle_equals_point_load_displacements(point):
    x, y, z = point
    r = np.sqrt(x * x + y * y + z * z)
    compressibility = 1 - 2 * NU
    radial_term = z / r**3 - compressibility / (r * (r + z))
    np.testing.assert_allclose(
        compute_mean_on_rectangle(normal_displacement_inside, *point),
        [x * radial_term, y * radial_term, 2 * (1 - NU) / r + z * z / r**3],
        rtol=1e-4,
        atol=1e-6,
    )
    axial_kernel = 1 / r + y * y / r**3 + compressibility * (1 / (r + z) - y * y / (r * (r + z) ** 2))
    lateral_kernel = x * y * (1 / r**3 - compressibility / (r * (r + z) ** 2))
    np.testing.assert_allclose(
        compute_mean_on_rectangle(tangential_displacement_inside, *point),
        [lateral_kernel, axial_kernel, y * (z / r**3 + compressibility / (r * (r + z)))],
        rtol=1e-4,
        atol=1e-6,
    )


@pytest.mark.parametrize("load", list(Load))
def test_displacements_inside_match_surface_kernel(load: Load):
    x, y = np.meshgrid([-0.7, 0.0, 0.2, 1.1], [-0.3, 0.0, 0.4, 0.9], indexing="ij")

    def compute_mixed_difference(corner_values):
        return np.diff(np.diff(corner_values, axis=0), axis=1)

    inside_corners = DISPLACEMENT_CORNERS[load](x, y, 0.0, NU)
    for direction, expected in zip((Load.ALONG_X, Load.ALONG_Y, Load.NORMAL), inside_corners, strict=True):
        computed = compute_mixed_difference(corner_function(strips_of(Response(direction, load), NU))(x, y))
        np.testing.assert_allclose(computed, compute_mixed_difference(expected), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("load", list(Load))
@pytest.mark.parametrize("offset", [(0.5, 0.0), (0.0, -0.5), (0.0, 0.0)])
def test_corner_functions_are_continuous(load: Load, offset: tuple[float, float]):
    corner, (x, y) = DISPLACEMENT_CORNERS[load], offset
    computed = corner(np.array([x]), np.array([y]), 0.0, NU)
    adjacent = corner(np.array([x + 1e-9]), np.array([y + 1e-9]), 0.0, NU)
    np.testing.assert_allclose(computed, adjacent, atol=1e-7)


EDGES = {"uniform": np.linspace(0.0, 3.0, 9), "graded": np.array([0.0, 0.2, 0.5, 1.0, 1.6, 2.3, 3.0])}


def compute_displacements(
    load: Load, edges: FloatArray, *, offset: float = 0.0, unit: float = 1.0, is_smooth: bool = True
) -> FloatArray:
    grid = Grid.between(unit * (edges + offset), (-unit, unit), 8)
    pressure = np.sqrt(np.maximum(1 - (grid.y / unit / 0.8) ** 2, 0.0)) * (1 + 0.3 * (grid.x[:, None] / unit - offset))
    extent = (unit * offset, unit * (offset + 3.0))
    x, y, z = unit * (np.array([0.0, 0.7, 2.2]) + offset), unit * np.array([-0.1, 0.4]), unit * np.array([0.05, 0.6])
    shape = pressure if is_smooth else None
    influence = displacement_influence(load, 0.3, extent[1] - extent[0], 30.0 * unit)
    return half_space_field(pressure, influence, grid, Points(x, y, z), extent=extent, shape=shape)


@pytest.mark.parametrize("name", EDGES)
@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("is_smooth", [True, False])
def test_results_scale_with_unit_and_position(load: Load, name: str, *, is_smooth: bool) -> None:
    baseline = compute_displacements(load, EDGES[name], is_smooth=is_smooth)
    # Uniform cells of a body with ends begin at 0.
    for position, unit in ((0.0, 2.0**-17), *(() if name == "uniform" else ((8.0, 1.0), (-32.0, 1.0)))):
        scaled_displacements = compute_displacements(load, EDGES[name], offset=position, unit=unit, is_smooth=is_smooth)
        assert scaled_displacements / unit == pytest.approx(baseline, abs=1e-7 * np.abs(baseline).max())


def test_unit_traction_on_top_equals_one() -> None:
    edge = np.array([-1.0, 1.0])
    for corner, component in ((STRESS_CORNERS[Load.ALONG_Y], 5), (STRESS_CORNERS[Load.ALONG_X], 4)):
        corner_values = corner(edge[:, None], edge[None, :], 0.0, 0.3)
        assert np.diff(np.diff(corner_values, axis=1), axis=2)[component, 0, 0] == pytest.approx(-1.0)
