"""Residual stress of eigenstrains: closed forms, finite elements between free ends, equilibrium."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from benchmarks.finite_elements.eigenstrain import compute_residual_stress
from contactstudy.bodies.material import Material
from contactstudy.eigenstrain.body import DEEP_LENGTHS, EigenstrainBody, grade_to_face, grow_edges
from contactstudy.verification.closed_forms import rectangle_in_half_plane

NO_ENDS = (-np.inf, np.inf)
TEST_MATERIAL = Material(2.0, 0.3)
COMPONENTS = np.array([1.0, 0.5, -0.3, 0.2, 0.4, -0.6])
"""All six components of an eigenstrain."""


@pytest.fixture(scope="module")
def make_rectangle_body() -> Callable[..., tuple[EigenstrainBody, np.ndarray]]:
    """Make a body whose cells cover a rectangle of eigenstrain and up to three cells around it."""

    def build_body(extent, x_range, z_range, cells=8, **settings):
        edges = []
        for (low, high), (body_start, body_end) in zip((x_range, z_range), (extent, (0.0, np.inf)), strict=True):
            width = (high - low) / cells
            axis_edges = low + width * np.arange(-3, cells + 4)
            edges.append(axis_edges[(axis_edges > body_start - 1e-9) & (axis_edges < body_end + 1e-9)])
            edges[-1] = np.where(np.abs(edges[-1] - body_start) < 1e-9, body_start, edges[-1])
            edges[-1] = np.where(np.abs(edges[-1] - body_end) < 1e-9, body_end, edges[-1])
        strain = np.zeros((6, edges[0].size - 1, edges[1].size - 1))
        axes_inside = [
            (axis_edges[:-1] >= low - 1e-9) & (axis_edges[1:] <= high + 1e-9)
            for axis_edges, (low, high) in zip(edges, (x_range, z_range), strict=True)
        ]
        strain[:, axes_inside[0][:, None] & axes_inside[1]] = COMPONENTS[:, None]
        return EigenstrainBody(
            material=TEST_MATERIAL, extent=extent, x_edges=edges[0], z_edges=edges[1], **settings
        ), strain

    return build_body


def test_closed_form_leaves_the_top_free() -> None:
    computed = rectangle_in_half_plane(
        np.linspace(-2, 2, 9), 0.0, (-0.5, 0.7), (0.4, 1.1), (1, 0.5, -0.3, 0.4), 2.0, 0.3
    )
    assert np.abs(computed[2:]).max() < 1e-9
    assert np.abs(computed[0]).max() > 0.1


@pytest.mark.parametrize(
    ("x_range", "z_range"),
    [((0.0, 0.6), (0.0, 0.5)), pytest.param((1.2, 2.0), (0.1, 0.4), marks=pytest.mark.slow)],
)
def test_stress_between_free_ends_matches_finite_elements(make_rectangle_body, x_range, z_range) -> None:
    """The stress agrees at the end and on the top, and at the other end."""
    body, strain = make_rectangle_body((0.0, 2.0), x_range, z_range, splits=2, degree=5)
    x, z = np.array([0.05, 0.2, 0.45, 0.75, 1.1, 1.5, 1.9]), np.array([0.05, 0.15, 0.3, 0.6, 0.9, 2.0])
    computed = body.solve(strain).stresses(x, z)
    expected = compute_residual_stress(2.0, (x_range, z_range), COMPONENTS, 0.3, x=x, z=z) * TEST_MATERIAL.shear_modulus
    assert np.abs(computed - expected).max() < 1e-3 * np.abs(expected).max()


def test_quarter_space_equals_long_body(make_rectangle_body) -> None:
    stresses = []
    for extent in ((0.0, np.inf), (0.0, 60.0)):
        body, strain = make_rectangle_body(extent, (0.0, 1.0), (0.2, 0.8))
        stresses.append(body.solve(strain).stresses(np.array([0.05, 0.5, 1.2]), np.array([0.1, 0.5, 1.0])))
    assert np.abs(np.subtract(*stresses)).max() < 1e-3 * np.abs(stresses[0]).max()


def test_second_end_mirrors_first_end(make_rectangle_body) -> None:
    """Components with one index x change sign."""
    first_body, strain = make_rectangle_body((0.0, 2.0), (0.2, 0.8), (0.1, 0.6))
    second_body, mirrored_strain = make_rectangle_body((0.0, 2.0), (1.2, 1.8), (0.1, 0.6))
    signs = np.array([1, 1, 1, -1, -1, 1.0])[:, None, None]
    x, z = np.array([0.1, 0.51, 1.3]), np.array([0.21, 0.7])
    second_stress = signs * second_body.solve(signs * mirrored_strain).stresses(2 - x, z)
    expected = first_body.solve(strain).stresses(x, z)
    assert np.abs(second_stress - expected).max() < 1e-7 * np.abs(expected).max()


def test_residual_stress_is_in_equilibrium_with_free_faces(make_rectangle_body) -> None:
    body, strain = make_rectangle_body((0.0, 2.0), (0.0, 0.6), (0.0, 0.5))
    solution = body.solve(strain)
    inner_points = np.sqrt(2) * np.linspace(0.011, 1.4, 23), np.sqrt(2) * np.linspace(0.013, 1.0, 17)
    step = 1e-6
    max_stress = np.abs(solution.stresses(*inner_points)).max()
    (upper_x_stress, lower_x_stress), (upper_z_stress, lower_z_stress) = (
        [
            solution.stresses(*(positions + sign * step * (axis == i) for i, positions in enumerate(inner_points)))
            for sign in (1, -1)
        ]
        for axis in (0, 1)
    )
    derivative_x, derivative_z = (
        (upper_x_stress - lower_x_stress) / (2 * step),
        (upper_z_stress - lower_z_stress) / (2 * step),
    )
    for x_component, z_component in ((0, 4), (4, 2), (3, 5)):  # xx,x + xz,z; xz,x + zz,z; xy,x + yz,z
        assert np.abs(derivative_x[x_component] + derivative_z[z_component]).max() < 1e-6 * np.abs(derivative_x).max()
    end_stresses = solution.stresses(np.array([0.0, 2.0]), inner_points[1])
    top_stresses = solution.stresses(inner_points[0], np.array([0.0]))
    assert np.abs(end_stresses[[0, 3, 4]]).max() < 1e-9 * max_stress
    assert np.abs(top_stresses[[2, 4, 5]]).max() < 1e-9 * max_stress


def test_compatible_strain_has_no_stress() -> None:
    """A uniform temperature between free ends causes no stress; its lower border is too deep for an influence."""
    body = EigenstrainBody(
        material=TEST_MATERIAL,
        extent=(0.0, 1.0),
        x_edges=np.linspace(0, 1, 5),
        z_edges=np.array([0.0, 0.5, 1.0, 2.0, 4.0, 6.0]),
    )
    strain = np.zeros((6, 4, 5))
    strain[[0, 2]] = 1.0
    computed = body.solve(strain).stresses(np.linspace(0, 1, 9), np.array([0.0, 0.3, 1.0]))
    assert np.abs(computed).max() < 1e-5 * TEST_MATERIAL.young


def test_strain_along_y_causes_stress_along_y_only() -> None:
    body = EigenstrainBody(
        material=TEST_MATERIAL,
        extent=(0.0, 1.0),
        x_edges=np.linspace(0, 1, 5),
        z_edges=np.array([0.0, 0.5, 1.0, 2.0, 4.0, 6.0]),
    )
    strain = np.zeros((6, 4, 5))
    strain[1] = 1.0
    computed = body.solve(strain).stresses(np.linspace(0, 1, 9), np.array([0.0, 0.3, 1.0]))
    assert computed[1] == pytest.approx(-TEST_MATERIAL.young, rel=1e-5)
    assert np.abs(computed[[0, 2, 3, 4, 5]]).max() < 1e-5 * TEST_MATERIAL.young


def test_layer_on_half_space_matches_closed_form() -> None:
    """At mid-length, a layer with a length of 40 depths has nearly the stress of an infinite layer."""
    body = EigenstrainBody(
        material=TEST_MATERIAL,
        extent=NO_ENDS,
        x_edges=np.concatenate([[-11], np.linspace(-10, 10, 41), [11]]),
        z_edges=np.array([0, 0.5, 1]),
    )
    strain = np.zeros((6, 42, 2))
    strain[:, 1:-1, 0] = COMPONENTS[:, None]
    x, z = np.array([-3.1, 0.0]), np.array([0.2, 0.7])
    computed = body.solve(strain).stresses(x, z)
    layer_strain = tuple(COMPONENTS[[0, 1, 2, 4]])
    expected = rectangle_in_half_plane(
        x[:, None], z, (-10.0, 10.0), (0.0, 0.5), layer_strain, TEST_MATERIAL.young, TEST_MATERIAL.poisson
    )
    assert np.abs(computed[[0, 1, 2, 4]] - expected).max() < 1e-4 * np.abs(expected).max()
    infinite_layer_stress = -TEST_MATERIAL.plane_strain_modulus * (
        COMPONENTS[0] + TEST_MATERIAL.poisson * COMPONENTS[1]
    )
    assert computed[0, 1, 0] == pytest.approx(infinite_layer_stress, rel=0.08)


def test_full_length_layer_keeps_ends_straight(make_rectangle_body) -> None:
    """On every plane x = const the stress along x has no resultant: compression above balances tension below."""
    body, strain = make_rectangle_body((0.0, 2.0), (0.0, 2.0), (0.0, 0.3))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    edges = body.elements[1]
    z = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (1 + nodes)).ravel()
    dz = (0.5 * np.diff(edges)[:, None] * weights).ravel()
    computed = body.solve(strain).stresses(np.array([0.3, 1.0]), z)
    resultant, force_scale = computed[0] @ dz, np.abs(computed[0]) @ dz
    assert np.abs(resultant).max() < 1e-9 * force_scale.max()


def test_surface_displacement_is_reciprocal_to_eigenstrain() -> None:
    """The displacement of the top equals the work of the eigenstrain on the stress of a unit line force (Flamant)."""
    body = EigenstrainBody(
        material=TEST_MATERIAL,
        extent=NO_ENDS,
        x_edges=np.linspace(-0.1, 0.1, 3),
        z_edges=np.linspace(0.9, 1.1, 3),
        degree=5,
    )
    strain = np.zeros((6, 2, 2))
    strain[:] = COMPONENTS[:, None, None]
    x = np.array([-1.0, 0.0, 0.6])
    displacement, displacement_y = body.solve(strain).top_displacement(x)
    # Flamant's stress under a unit force into the body at x: -2 / pi x'^i z^(3-i) / r^4, averaged over the square.
    node, weight = np.polynomial.legendre.leggauss(6)
    node_x, node_z, node_weight = 0.1 * node[:, None], 1 + 0.1 * node, 0.01 * weight[:, None] * weight
    for position, computed, computed_y in zip(x, displacement, displacement_y, strict=True):
        distance_x, squared_distance = node_x - position, (node_x - position) ** 2 + node_z**2
        xx, zz, xz = (-2 / np.pi * distance_x**i * node_z ** (3 - i) / squared_distance**2 for i in (2, 0, 1))
        scale = 0.04 * np.abs(COMPONENTS).max() * 2 / np.pi
        work = COMPONENTS[0] * xx + COMPONENTS[2] * zz + 2 * COMPONENTS[4] * xz + COMPONENTS[1] * 0.3 * (xx + zz)
        assert computed == pytest.approx(float((work * node_weight).sum()), abs=2e-3 * scale)
        # A unit force along y: antiplane, t_xy = -x' / (pi r^2), t_yz = -z / (pi r^2).
        antiplane_kernel = -2 * (COMPONENTS[3] * distance_x + COMPONENTS[5] * node_z) / (np.pi * squared_distance)
        assert computed_y == pytest.approx(float((antiplane_kernel * node_weight).sum()), abs=2e-3 * scale)


def test_cell_averages_match_stresses(make_rectangle_body) -> None:
    body, strain = make_rectangle_body((0.0, 2.0), (0.0, 0.6), (0.0, 0.5), cells=2)
    solution = body.solve(strain)
    node, weight = np.polynomial.legendre.leggauss(8)
    x, z = (
        (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (1 + node)).ravel()
        for edges in (body.x_edges, body.z_edges)
    )
    stress = solution.stresses(x, z).reshape(6, body.x_edges.size - 1, 8, body.z_edges.size - 1, 8)
    mean_stress = np.einsum("cipjq,p,q->cij", stress, weight, weight) / 4
    assert np.allclose(solution.cell_averages(), mean_stress, atol=1e-10)


def test_work_is_symmetric_and_negative_on_own_stress(make_rectangle_body) -> None:
    """The work of one eigenstrain on the stress of another is symmetric, and negative on its own stress."""
    body, strain = make_rectangle_body((0.0, 2.0), (0.0, 0.6), (0.0, 0.5), cells=3)
    rng = np.random.default_rng(0)
    areas = np.diff(body.x_edges)[:, None] * np.diff(body.z_edges)
    component_weights = np.array([1, 1, 1, 2, 2, 2.0])[:, None, None]
    first_strain, second_strain = rng.normal(size=(2, *strain.shape))
    work = [
        float((component_weights * areas * eigenstrain * body.solve(source_strain).cell_averages()).sum())
        for eigenstrain, source_strain in (
            (first_strain, second_strain),
            (second_strain, first_strain),
            (first_strain, first_strain),
        )
    ]
    assert work[0] == pytest.approx(work[1], rel=1e-8)
    assert work[2] < 0


def test_elements_extend_to_ends_and_depth() -> None:
    body = EigenstrainBody(
        material=TEST_MATERIAL, extent=(0.0, 3.0), x_edges=np.array([1.0, 1.5, 2.0]), z_edges=np.array([0.2, 0.4])
    )
    x, z = body.elements
    assert x[0] == 0.0
    assert x[-1] == 3.0
    assert z[0] == 0.0
    assert z[-1] == pytest.approx(0.4 + DEEP_LENGTHS * 3.0)
    assert {1.0, 1.5, 2.0} <= set(x)


def test_elements_grow_away_from_cells() -> None:
    assert grow_edges(0.0, 10.0, 1.0).round(2).tolist() == [0.76, 1.9, 3.6, 6.16, 10.0]
    assert grade_to_face(0.0, 2.0, 0.3).round(2).tolist() == [0.21, 0.53, 1.0, 1.47, 1.79, 2.0]
