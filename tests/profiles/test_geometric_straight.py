"""Cylinder and cone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, Roller
from contactstudy.profiles import Cylinder, Tapered
from tests.profiles.conftest import LENGTH, RADIUS, list_axial_results


@given(st.floats(1e-6, LENGTH / 2), st.floats(0.0, LENGTH / 2))
def test_fillet_lies_on_its_circle(fillet: float, x: float) -> None:
    """The circle's centre is one fillet radius from the end face and from the generatrix."""
    drop = float(Cylinder(fillet).drop(np.array([x]), LENGTH)[0])
    fillet_start = LENGTH / 2 - fillet
    if x <= fillet_start:
        assert drop == 0.0
    else:
        assert np.hypot(x - fillet_start, fillet - drop) == pytest.approx(fillet, rel=1e-9)


@given(
    fillet=st.floats(0.0, LENGTH / 2),
    x=st.lists(st.floats(-LENGTH / 2, LENGTH / 2), min_size=1, max_size=9),
    radius=st.floats(1e-4, 1.0),
)
def test_taper_of_zero_equals_the_cylinder_bitwise(fillet: float, x: list[float], radius: float) -> None:
    y = np.array([0.0, 1e-5, -3.3e-4])
    heights = [
        Roller(radius=radius, length=LENGTH, profile=profile).clearance(np.array(x), y)
        for profile in (Cylinder(fillet), Tapered(0.0, fillet))
    ]
    np.testing.assert_array_equal(*heights)


@given(angle=st.floats(-0.4, 0.4), x=st.floats(-LENGTH / 2, LENGTH / 2))
def test_taper_radius_equals_the_cone_curvature(angle: float, x: float) -> None:
    """The height over the tangent plane along the generatrix follows from the equation of the cone."""
    from scipy.optimize import brentq

    roller_radius, y = 20e-3, 1e-5
    cosine, sine = np.cos(angle), np.sin(angle)

    def compute_distance_outside(height: float) -> float:
        """Distance from the axis minus the cone's radius, at `height` below the tangent plane."""
        along_axis, below_axis = x * cosine + height * sine, roller_radius + x * sine - height * cosine
        return float(np.hypot(y, below_axis) - (roller_radius + along_axis * np.tan(angle)))

    exact_drop = brentq(compute_distance_outside, -1e-9, 1e-6, xtol=1e-20)
    radius = float(Tapered(angle).local_radius(np.array([x]), LENGTH, roller_radius)[0])
    assert y**2 / (2 * radius) == pytest.approx(exact_drop, rel=1e-4)


def test_taper_pressure_follows_the_local_radius(solve_profile) -> None:
    """Sections are line contacts of local load and radius; the pressure is higher at the small end."""
    profile = Tapered(half_angle=0.2)
    position, peak, line_load = list_axial_results(solve_profile(profile, 4e-3))
    is_inner = np.abs(position) < 0.6
    radius = profile.local_radius(2e-3 * position, 4e-3, RADIUS)
    np.testing.assert_allclose(peak[is_inner], np.sqrt(line_load * RADIUS / radius)[is_inner], rtol=4e-3)
    assert np.interp(-0.6, position, peak) > np.interp(0.6, position, peak) + 0.03


def test_mirrored_taper_has_the_mirrored_pressure(solve_profile) -> None:
    pressure, mirrored_pressure = (
        list_axial_results(solve_profile(Tapered(angle), 2e-3, cells=4))[1] for angle in (0.1, -0.1)
    )
    np.testing.assert_allclose(pressure, mirrored_pressure[::-1], atol=1e-5)
    assert np.ptp(pressure - pressure[::-1]) > 0.01


@pytest.mark.parametrize(
    ("create", "message"),
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
def test_invalid_argument_raises(create, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        create()
