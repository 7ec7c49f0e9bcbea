"""The finite-element reference against exact solutions."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from benchmarks.finite_elements import contact, superpose
from contactstudy.verification import closed_forms as ref
from contactstudy.verification import problems as fe

make_coarse_resolution = partial(superpose.Resolution, order=4, nodes=5, growth=2.0)
BELOW_50, BELOW_25 = superpose.PANELS[:-1], superpose.PANELS[:-2]
Y = (-1.25, -0.5, 0.0, 0.25, 1.0)
UNIFORM_SHAPES = [(fe.Linear(), "z"), (fe.Linear(), "y")]


def test_meshes_contain_the_points_where_loads_begin() -> None:
    for length in (2.5, 4.0, 8.0):
        edges = superpose.Resolution().make_mesh_x(length)
        assert np.all(np.diff(edges) > 0)
        assert (edges[0], edges[-1]) == pytest.approx((0, length))
        for load_border in np.arange(0, length + 0.1, 0.5):
            assert np.abs(edges - load_border).min() < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize(("length", "poisson", "tolerance"), [(2.5, 0.0, 2e-4), (0.05, 0.3, 5e-4)])
def test_uniform_load_has_stresses_of_plane_problem(length: float, poisson: float, tolerance: float) -> None:
    """A body without lateral contraction is in plane strain, a thin plate in plane stress.

    Under a load uniform along x both have the stresses of the line contact in the plane, and `sigma_xx = 0`.
    """
    x, z = (0.0, 0.2 * length, 0.5 * length), (0.5, 0.8, 1.5, 3.0)
    harmonics = superpose.harmonics(length, poisson, UNIFORM_SHAPES, x, z, make_coarse_resolution(panels=BELOW_25))
    result = superpose.superpose_stresses(harmonics, 0, 1, 0.3, Y, superpose.transform_ellipse)
    exact = ref.hertz_strip(np.array(Y)[:, None], np.array(z), 1.0, 1.0, 0.0, 0.3)
    for name in ref.COMPONENTS:
        assert result[name] - exact[name] == pytest.approx(0, abs=tolerance), name
    assert np.abs(exact["tau_yz"]).max() > 0.2


@pytest.mark.slow
def test_displacement_of_line_contact_equals_closed_form() -> None:
    """`nu = 0`, inside the contact `E u_z` is `-p0 y^2 / a`, and friction adds the slope `q`."""
    case = fe.LoadCase(2.5, fe.Linear(), 0.3, 0.0)
    harmonics = superpose.harmonics(2.5, 0.0, UNIFORM_SHAPES, (0.0, 0.5, 1.25), (1.0,), make_coarse_resolution(nodes=4))
    y = np.array([-0.6, -0.3, 0.0, 0.3, 0.6])
    result = superpose.superpose_displacement(harmonics, case, 0, 1, y, 2, superpose.transform_ellipse)
    exact = -(y**2) + 0.3 * 0.5 * (y * np.sqrt(1 - y**2) + np.arcsin(y))
    assert result - exact == pytest.approx(0, abs=3e-5)


@pytest.mark.slow
def test_stresses_of_long_body_equal_half_space() -> None:
    """The reference is an integral over Boussinesq and Cerruti loads; the ends, `6 a` away, have a small influence."""
    load_shape = fe.Bump(6.0, 1.0)
    x, z = (6.0, 6.5, 7.5), (0.5, 1.0, 2.0)
    shapes = [(load_shape, "z"), (load_shape, "y")]
    harmonics = superpose.harmonics(
        12.0, 0.3, shapes, x, z, make_coarse_resolution(panels=BELOW_25, nodes=4, growth=2.5)
    )
    result = superpose.superpose_stresses(harmonics, 0, 1, 0.3, Y)
    node, weight = np.polynomial.legendre.leggauss(60)
    loads = np.outer(weight * load_shape(6 + node), weight * fe.quartic(node))
    dx = np.array(x)[:, None, None, None, None] - 6 - node[:, None]
    dy = np.array(Y)[:, None, None, None] - node
    point_stress = ref.point_load(dx, dy, np.array(z)[:, None, None], 0.3, 1.0, 0.3)
    for name in ref.COMPONENTS:
        exact = np.einsum("xyzij,ij->xyz", point_stress[name], loads)
        is_shear = name.startswith("tau")
        assert result[name] - exact == pytest.approx(0, abs=1e-3 if is_shear else 5e-3), name


@pytest.mark.slow
def test_contact_without_lateral_contraction_has_hertz_pressure() -> None:
    """With Poisson's ratio 0 a body of any length is in plane strain."""
    case = fe.ContactCase(2.0, 0.0, poisson=0.0)
    flexibility = contact.compute_flexibility(case, make_coarse_resolution(order=3, panels=BELOW_50))
    result = contact.solve(case, flexibility, 1 / 12, 1.25)
    half_width, peak = ref.hertz_line(case.load / case.length, 0.5, 1.0)
    exact = peak * np.sqrt(np.clip(1 - (result.y / half_width) ** 2, 0, None))
    in_contact = result.y < 0.7 * half_width
    assert result.pressure[:, in_contact] == pytest.approx(
        np.broadcast_to(exact, result.pressure.shape)[:, in_contact], abs=0.01
    )
    assert np.ptp(result.pressure[:, 0]) < 1e-3
    line_load = np.trapezoid(2 * np.trapezoid(result.pressure, result.y, axis=1), result.x)
    assert line_load == pytest.approx(case.load, rel=1e-6)
