"""Closed forms of the verification: equilibrium, boundary values, published values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.verification import closed_forms as ref
from contactstudy.verification import free_ends
from tests.closed_forms import compute_hertz_surface_stress, compute_sliding_surface_stress

NU = 0.3
Field = Callable[[np.ndarray, np.ndarray, np.ndarray], ref.Stress]

FIELDS: dict[str, Field] = {
    "Boussinesq": lambda x, y, z: ref.point_load(x, y, z, NU),
    "Cerruti": lambda x, y, z: ref.point_load(x, y, z, NU, 0.0, 1.0),
    "circle": lambda x, y, z: ref.hertz_circle(x, y, z, 1.3, 0.8, NU),
    "sliding circle": lambda x, y, z: ref.hertz_circle(x, y, z, 1.3, 0.8, NU, 0.4),
    "sliding strip": lambda x, y, z: ref.hertz_strip(y, z, 1.3, 0.8, NU, 0.4),
}


def make_tensor(stress: ref.Stress) -> np.ndarray:
    """Stress tensor; the first two dimensions are its components."""
    xx, yy, zz, xy, xz, yz = np.broadcast_arrays(*(stress[name] for name in ref.COMPONENTS))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def compute_gradient(field: Field, points: np.ndarray, step: float = 1e-2) -> np.ndarray:
    """Gradient `[k, i, j, point]` of the stress by sixth-order central differences."""
    step_factors, weights = np.array([-3, -2, -1, 1, 2, 3]), np.array([-1, 9, -45, 45, -9, 1]) / (60 * step)
    shifted_points = points[:, None, None] + (step * np.eye(3)[:, :, None] * step_factors)[..., None]
    stress = make_tensor(field(*shifted_points.reshape(3, -1))).reshape(3, 3, *shifted_points.shape[1:])
    return np.einsum("ijkfn,f->kijn", stress, weights)


@pytest.mark.parametrize("name", FIELDS)
def test_stresses_satisfy_equilibrium_and_compatibility(name: str) -> None:
    """The body force is zero, the mean stress is harmonic, and Beltrami's equations hold."""
    field = FIELDS[name]
    points = np.random.default_rng(1).uniform(-2, 2, (3, 6))
    points[2] = 0.3 + np.abs(points[2])
    gradient = compute_gradient(field, points)
    assert np.abs(np.einsum("kkjn->jn", gradient)).max() < 1e-7

    def compute_mean_stress_gradient(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> ref.Stress:
        gradients = compute_gradient(field, np.array([x, y, z]))
        trace = np.einsum("kiin->kn", gradients)
        return dict(zip(ref.COMPONENTS, (*trace, *np.zeros_like(trace)), strict=True))

    hessian = np.einsum("kiin->kin", compute_gradient(compute_mean_stress_gradient, points))
    assert np.abs(np.einsum("kkn->n", hessian)).max() < 1e-4

    def compute_laplacian(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        step, centre = 0.02, np.array([x, y, z])
        weighted_sum = -3 * 490 / 180 * make_tensor(field(*centre))
        for axis in range(3):
            for step_count, weight in ((1, 270), (2, -27), (3, 2)):
                shift = np.zeros((3, 1))
                shift[axis] = step_count * step
                weighted_sum = weighted_sum + weight / 180 * (
                    make_tensor(field(*(centre + shift))) + make_tensor(field(*(centre - shift)))
                )
        return weighted_sum / step**2

    assert compute_laplacian(*points) + hessian / (1 + NU) == pytest.approx(0, abs=2e-4)


def test_surface_stress_of_circle_equals_closed_form() -> None:
    r = np.array([0.0, 0.3, 0.6, 0.9, 1.2, 2.0])
    stress = ref.hertz_circle(r, 0.0, 0.0, 1.0, 1.0, NU, 0.25)
    pressure = np.sqrt(np.clip(1 - r**2, 0, None))
    assert stress["sigma_zz"] == pytest.approx(-pressure, abs=1e-9)
    assert stress["tau_yz"] == pytest.approx(-0.25 * pressure, abs=1e-9)
    assert stress["tau_xz"] == pytest.approx(0, abs=1e-9)
    radial, hoop = compute_hertz_surface_stress(r, 1.0, 1.0, NU)
    frictionless_stress = ref.hertz_circle(r, 0.0, 0.0, 1.0, 1.0, NU)
    assert frictionless_stress["sigma_xx"] == pytest.approx(radial, abs=1e-9)
    assert frictionless_stress["sigma_yy"] == pytest.approx(hoop, abs=1e-9)
    x, y = np.array([0.1, 0.4, -0.3]), np.array([0.2, -0.5, 0.6])
    shear = ref.hertz_circle(x, y, 0.0, 1.0, 1.0, NU, 1.0)
    circle_stress = ref.hertz_circle(x, y, 0.0, 1.0, 1.0, NU)
    for name, value in compute_sliding_surface_stress(x, y, 1.0, 1.0, NU).items():
        assert shear[name] - circle_stress[name] == pytest.approx(value, abs=1e-9), name


def test_stress_of_circle_on_axis_and_at_distance_equals_closed_forms() -> None:
    z = np.linspace(0, 5, 26)
    zz, rr = ref.hertz_circle_axis(z, 2.0, 3.0, NU)
    stress = ref.hertz_circle(0.0, 0.0, z, 2.0, 3.0, NU)
    assert stress["sigma_zz"] == pytest.approx(zz, abs=1e-10)
    assert stress["sigma_xx"] == pytest.approx(rr, abs=1e-10)
    depths = np.linspace(0.3, 0.7, 401)
    zz, rr = ref.hertz_circle_axis(depths, 1.0, 1.0, NU)
    shear = 0.5 * np.abs(zz - rr)
    assert shear.max() == pytest.approx(0.310, abs=5e-4)
    assert depths[shear.argmax()] == pytest.approx(0.48, abs=0.01)
    x, y, depth = np.array([30.0, -5.0]), np.array([10.0, 40.0]), np.array([20.0, 7.0])
    load = 2 / 3 * np.pi
    distant_stress = ref.hertz_circle(x, y, depth, 1.0, 1.0, NU, 0.5)
    point = ref.point_load(x, y, depth, NU, load, 0.5 * load)
    for name in ref.COMPONENTS:
        assert distant_stress[name] == pytest.approx(point[name], abs=2e-3 * np.abs(point["sigma_zz"]).max()), name


def test_stress_of_circle_is_symmetric() -> None:
    x, y, z = np.array([0.4, 1.1]), np.array([0.7, -0.2]), np.array([0.2, 0.9])
    odd_in_x, odd_in_y = {"tau_xy", "tau_xz"}, {"tau_xy", "tau_yz"}
    frictionless_stress, sliding_stress = (ref.hertz_circle(x, y, z, 1.0, 1.0, NU, friction) for friction in (0.0, 1.0))
    mirrored_frictionless, mirrored_sliding = (
        ref.hertz_circle(x, -y, z, 1.0, 1.0, NU, friction) for friction in (0.0, 1.0)
    )
    x_mirrored_sliding = ref.hertz_circle(-x, y, z, 1.0, 1.0, NU, 1.0)
    for name in ref.COMPONENTS:
        sign = -1 if name in odd_in_y else 1
        assert mirrored_frictionless[name] == pytest.approx(sign * frictionless_stress[name], abs=1e-12)
        assert mirrored_sliding[name] - mirrored_frictionless[name] == pytest.approx(
            -sign * (sliding_stress[name] - frictionless_stress[name]), abs=1e-12
        )
        assert x_mirrored_sliding[name] == pytest.approx(
            (-1 if name in odd_in_x else 1) * sliding_stress[name], abs=1e-12
        )


def test_hertz_contact_equals_closed_form() -> None:
    modulus = 115.3846e9
    a, p0, approach = ref.hertz_point(100.0, 0.01, modulus)
    assert approach == pytest.approx((9 * 100**2 / (16 * 0.01 * modulus**2)) ** (1 / 3))
    assert p0 == pytest.approx((6 * 100 * modulus**2 / (np.pi**3 * 0.01**2)) ** (1 / 3))
    a, p0 = ref.hertz_line(2e5, 0.005, modulus)
    assert p0 == pytest.approx(np.sqrt(2e5 * modulus / (np.pi * 0.005)))
    assert 0.5 * np.pi * a * p0 == pytest.approx(2e5)


def test_surface_stress_of_strip_equals_closed_form() -> None:
    y = np.array([-3.0, -1.2, -0.8, 0.0, 0.5, 0.9, 1.5])
    pressure = np.sqrt(np.clip(1 - y**2, 0, None))
    stress = ref.hertz_strip(y, 0.0, 1.0, 1.0, NU, 0.2)
    assert stress["sigma_zz"] == pytest.approx(-pressure, abs=1e-12)
    assert stress["tau_yz"] == pytest.approx(-0.2 * pressure, abs=1e-12)
    in_strip = np.abs(y) < 1
    assert stress["sigma_yy"][in_strip] == pytest.approx((-pressure - 0.4 * y)[in_strip], abs=1e-12)
    expected_outside = -0.4 * (y - np.sign(y) * np.sqrt(np.clip(y**2 - 1, 0, None)))
    assert stress["sigma_yy"][~in_strip] == pytest.approx(expected_outside[~in_strip], abs=1e-12)


@pytest.mark.parametrize(
    ("friction", "maximum", "y_position", "depth", "surface_maximum"),
    [
        (0.0, 0.5575, 0.0, 0.70, 0.400),
        (0.1, 0.5654, 0.29, 0.67, 0.438),
        (0.2, 0.5900, 0.55, 0.57, 0.535),
        (0.25, 0.6093, 0.68, 0.49, 0.598),
        (0.3, None, None, None, 0.667),
    ],
)
def test_largest_von_mises_stress_of_strip_equals_published_values(
    friction: float, maximum: float | None, y_position: float, depth: float, surface_maximum: float
) -> None:
    """Published largest von Mises stresses of a sliding line contact, Poisson's ratio 0.3."""
    y, z = np.linspace(-1.2, 1.2, 481)[:, None], np.linspace(0, 1.5, 301)[None, :]
    mises = ref.von_mises(ref.hertz_strip(y, z, 1.0, 1.0, NU, friction))
    assert mises[:, 0].max() == pytest.approx(surface_maximum, abs=1e-3)
    if maximum is not None:
        subsurface = mises[:, 40:]
        i, j = np.unravel_index(subsurface.argmax(), subsurface.shape)
        assert subsurface.max() == pytest.approx(maximum, abs=1e-4)
        assert (abs(y[i, 0]), z[0, 40 + j]) == pytest.approx((y_position, depth), abs=0.012)


def test_largest_orthogonal_shear_of_strip_equals_published_value() -> None:
    y, z = np.linspace(-1.5, 1.5, 601)[:, None], np.linspace(0.2, 0.9, 141)[None, :]
    shear = ref.hertz_strip(y, z, 1.0, 1.0, NU)["tau_yz"]
    i, j = np.unravel_index(np.abs(shear).argmax(), shear.shape)
    assert np.abs(shear).max() == pytest.approx(0.25, abs=1e-4)
    assert (abs(y[i, 0]), z[0, j]) == pytest.approx((0.866, 0.5), abs=0.01)


def test_strip_equals_integral_of_point_loads() -> None:
    """Boussinesq and Cerruti loads, integrated along x and over the ellipse."""
    parameter = np.linspace(-17, 17, 1001)
    x, dx = np.sinh(parameter), np.cosh(parameter) * 34 / 1000
    positions_y, weight = np.polynomial.chebyshev.chebgauss(60)
    z, y = 0.6, 0.45
    loads = weight * (1 - positions_y**2)
    point = ref.point_load(x[:, None], y - positions_y[None, :], z, NU, 1.0, 0.3)
    strip = ref.hertz_strip(y, z, 1.0, 1.0, NU, 0.3)
    for name in ref.COMPONENTS:
        assert np.einsum("xn,x,n->", point[name], dx, loads) == pytest.approx(float(strip[name]), abs=1e-6), name


@pytest.mark.parametrize("ratio", [1.0, 1.3, 4.0, 30.0])
def test_pressure_of_ellipse_causes_paraboloid(ratio: float) -> None:
    """Elements with the pressure of the ellipse displace the surface inside the contact to the paraboloid."""
    contact = ref.hertz_ellipse(0.7, ratio, 1.0, 1.5)
    assert contact.long >= contact.short
    count = 80
    element_edges = np.linspace(-1, 1, count + 1)
    midpoints = 0.5 * (element_edges[1:] + element_edges[:-1])
    pressure = np.sqrt(np.clip(1 - midpoints[:, None] ** 2 - midpoints**2, 0, None))
    pressure *= contact.max_pressure * 2 / 3 * np.pi / (pressure.sum() * (2 / count) ** 2) / contact.max_pressure
    for x, y in ((0.003, 0.002), (0.503, 0.0021), (0.0033, 0.603)):
        point = (x * contact.long, y * contact.short)
        unit_displacements = ref.rectangle_displacement(
            point[0] - contact.long * midpoints[:, None],
            point[1] - contact.short * midpoints,
            contact.long / count,
            contact.short / count,
            1.5,
        )
        displacement = contact.max_pressure * float((pressure * unit_displacements).sum())
        paraboloid = contact.approach - point[0] ** 2 / (2 * ratio) - point[1] ** 2 / 2
        assert displacement == pytest.approx(paraboloid, abs=2e-3 * contact.approach)


def test_ellipse_with_exchanged_radii_raises() -> None:
    with pytest.raises(InvalidInputError, match="long_radius"):
        ref.hertz_ellipse(1.0, 1.0, 2.0, 1.0)


def test_stress_below_rectangle_equals_newmark() -> None:
    z = np.array([0.5, 1.0, 3.0])
    stress = ref.rectangle(1.0, 0.5, z, 1.0, 0.5, NU, friction=0.0)
    assert stress["sigma_zz"] == pytest.approx(ref.below_rectangle_corner(z, 2.0, 1.0), abs=1e-9)


def test_wedge_stress_balances_load() -> None:
    """The radial field of a quarter plane loaded at its corner: forces across any arc."""
    angle, weight = np.polynomial.legendre.leggauss(20)
    angle, weight = 0.25 * np.pi * (angle + 1), 0.25 * np.pi * weight
    radial = free_ends.wedge_stress(angle)
    assert weight @ (radial * np.sin(angle)) == pytest.approx(-1.0)
    assert weight @ (radial * np.cos(angle)) == pytest.approx(0.0, abs=1e-12)
