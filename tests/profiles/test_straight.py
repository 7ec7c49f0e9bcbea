"""Cylinder and cone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, Roller
from contactstudy.profiles import Cylinder, Tapered
from tests.profiles.conftest import LENGTH, RADIUS, along


@given(st.floats(1e-6, LENGTH / 2), st.floats(0.0, LENGTH / 2))
def test_fillet_lies_on_its_circle(fillet: float, x: float) -> None:
    """The circle's centre is one fillet radius from the end face and from the generatrix."""
    drop = float(Cylinder(fillet).drop(np.array([x]), LENGTH)[0])
    begin = LENGTH / 2 - fillet
    if x <= begin:
        assert drop == 0.0
    else:
        assert np.hypot(x - begin, fillet - drop) == pytest.approx(fillet, rel=1e-9)


@given(
    fillet=st.floats(0.0, LENGTH / 2),
    x=st.lists(st.floats(-LENGTH / 2, LENGTH / 2), min_size=1, max_size=9),
    radius=st.floats(1e-4, 1.0),
)
def test_a_taper_of_zero_is_the_cylinder_bit_for_bit(fillet: float, x: list[float], radius: float) -> None:
    y = np.array([0.0, 1e-5, -3.3e-4])
    heights = [
        Roller(radius=radius, length=LENGTH, profile=profile).clearance(np.array(x), y)
        for profile in (Cylinder(fillet), Tapered(0.0, fillet))
    ]
    np.testing.assert_array_equal(*heights)


@given(angle=st.floats(-0.4, 0.4), x=st.floats(-LENGTH / 2, LENGTH / 2))
def test_taper_has_the_curvature_of_the_cone(angle: float, x: float) -> None:
    """Height over the plane that touches along the generatrix, found from the equation of the cone itself."""
    from scipy.optimize import brentq

    roller_radius, y = 20e-3, 1e-5
    cos, sin = np.cos(angle), np.sin(angle)

    def outside(height: float) -> float:
        """Distance from the axis minus the cone's radius there, `height` below the tangent plane."""
        along_axis, below_axis = x * cos + height * sin, roller_radius + x * sin - height * cos
        return float(np.hypot(y, below_axis) - (roller_radius + along_axis * np.tan(angle)))

    exact = brentq(outside, -1e-9, 1e-6, xtol=1e-20)
    radius = float(Tapered(angle).local_radius(np.array([x]), LENGTH, roller_radius)[0])
    assert y**2 / (2 * radius) == pytest.approx(exact, rel=1e-4)


def test_pressure_of_a_taper_is_that_of_the_local_radius(pressed) -> None:
    """Each section is the line contact of its own load and radius; the small end bears the higher pressure."""
    profile = Tapered(half_angle=0.2)
    place, peak, line_load = along(pressed(profile, 4e-3))
    inside = np.abs(place) < 0.6
    radius = profile.local_radius(2e-3 * place, 4e-3, RADIUS)
    np.testing.assert_allclose(peak[inside], np.sqrt(line_load * RADIUS / radius)[inside], rtol=4e-3)
    assert np.interp(-0.6, place, peak) > np.interp(0.6, place, peak) + 0.03


def test_taper_and_its_mirror_image_give_mirrored_pressures(pressed) -> None:
    one, other = (along(pressed(Tapered(angle), 2e-3, cells=4))[1] for angle in (0.1, -0.1))
    np.testing.assert_allclose(one, other[::-1], atol=1e-5)
    assert np.ptp(one - one[::-1]) > 0.01


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Cylinder(-1e-3), "fillet_radius = -0.001"),
        (lambda: Cylinder(6e-3).drop(np.zeros(1), LENGTH), "fillet_radius = 0.006: must be at most half"),
        (lambda: Tapered(3.0), "half_angle = 3.0.*degrees"),
        (lambda: Tapered("steep"), "half_angle = 'steep'"),
        (lambda: Tapered(np.nan), "half_angle = nan"),
        (lambda: Tapered(0.1, fillet_radius=-1.0), "fillet_radius = -1.0"),
        (
            lambda: Roller(radius=1e-3, length=LENGTH, profile=Tapered(0.3)),
            "half_angle = 0.3: must be below 0.201 rad.*tip",
        ),
    ],
)
def test_bad_values_are_named(make, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        make()
