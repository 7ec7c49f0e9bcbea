"""Crowns, sphere and ellipsoid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, Material, Roller
from contactstudy.profiles import Cylinder, Ellipsoid, FullCrown, PartialCrown, Sphere
from contactstudy.verification.closed_forms import hertz_ellipse
from tests.profiles.conftest import LENGTH, RADIUS

HALF_LENGTH = LENGTH / 2


@given(st.floats(HALF_LENGTH, 10.0), st.floats(-HALF_LENGTH, HALF_LENGTH))
def test_full_crown_lies_on_its_circle(radius: float, x: float) -> None:
    drop = float(FullCrown(radius).drop(np.array([x]), LENGTH)[0])
    assert np.hypot(x, radius - drop) == pytest.approx(radius, rel=1e-12)


def test_centre_is_the_highest_point_of_a_crown(positions: np.ndarray) -> None:
    drop = FullCrown(1.0, centre=1e-3).drop(positions, LENGTH)
    assert positions[drop.argmin()] == pytest.approx(1e-3)
    assert drop.min() == pytest.approx(0.0, abs=1e-18)


def test_full_crown_of_large_radius_equals_the_parabola(positions: np.ndarray) -> None:
    np.testing.assert_allclose(
        FullCrown(50.0).drop(positions, LENGTH), Ellipsoid(50.0).drop(positions, LENGTH), rtol=1e-8
    )


@given(straight_length=st.floats(0.0, 6e-3), crown=st.floats(0.05, 10.0), end_length=st.floats(0.1e-3, 1.5e-3))
def test_arcs_of_a_partial_crown_join_tangentially(straight_length: float, crown: float, end_length: float) -> None:
    """The curvatures are 0, 1/R1, 1/R2: their integral from mid-length is the slope, the slope's integral the drop."""
    profile = PartialCrown(straight_length, crown, end_length, dub_radius=0.02)
    x = np.linspace(0.0, HALF_LENGTH, 4001)
    midpoints = 0.5 * (x[1:] + x[:-1])
    curvature = np.where(
        midpoints < straight_length / 2, 0.0, np.where(midpoints < HALF_LENGTH - end_length, 1 / crown, 1 / 0.02)
    )
    sine = np.concatenate([[0.0], np.cumsum(curvature) * (x[1] - x[0])])
    slope = sine / np.sqrt(1 - sine**2)
    drop = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1])) * (x[1] - x[0])])
    np.testing.assert_allclose(profile.drop(x, LENGTH), drop, rtol=0, atol=1e-2 * drop.max())


def test_partial_crown_equals_crown_and_cylinder_in_the_limits(positions: np.ndarray) -> None:
    np.testing.assert_array_equal(
        PartialCrown(0.0, 2.0).drop(positions, LENGTH), FullCrown(2.0).drop(positions, LENGTH)
    )
    np.testing.assert_array_equal(PartialCrown(LENGTH, 2.0).drop(positions, LENGTH), 0.0)


def test_dub_off_of_equal_radius_has_no_influence(positions: np.ndarray) -> None:
    plain_crown, dubbed_crown = PartialCrown(2e-3, 0.5), PartialCrown(2e-3, 0.5, dub_length=1e-3, dub_radius=0.5)
    np.testing.assert_allclose(
        dubbed_crown.drop(positions, LENGTH), plain_crown.drop(positions, LENGTH), rtol=1e-12, atol=1e-18
    )


def test_drop_of_corner_radius_is_added(positions: np.ndarray) -> None:
    crown, corner = PartialCrown(6e-3, 1.0, 0.5e-3, 0.02), Cylinder(fillet_radius=0.2e-3)
    drop = (crown + corner).drop(positions, LENGTH)
    is_inner = np.abs(positions) <= HALF_LENGTH - 0.2e-3
    np.testing.assert_array_equal(drop[is_inner], crown.drop(positions, LENGTH)[is_inner])
    assert drop[-1] == pytest.approx(crown.drop(positions, LENGTH)[-1] + 0.2e-3)


@pytest.mark.parametrize(
    ("create", "message"),
    [
        (lambda: FullCrown(0.0), "crown_radius = 0.0"),
        (lambda: FullCrown(4e-3).drop(np.zeros(1), LENGTH), "crown_radius = 0.004: must be at least 0.005 m"),
        (lambda: FullCrown(1.0, centre="left"), "centre = 'left'"),
        (lambda: FullCrown(1.0, centre=6e-3).drop(np.zeros(1), LENGTH), "centre = 0.006: must be within"),
        (lambda: PartialCrown(-1e-3, 1.0), "straight_length = -0.001"),
        (lambda: PartialCrown(11e-3, 1.0).drop(np.zeros(1), LENGTH), "straight_length = 0.011: must be at most"),
        (lambda: PartialCrown(0.0, -1.0), "crown_radius = -1.0"),
        (lambda: PartialCrown(0.0, 1e-3).drop(np.zeros(1), LENGTH), "crown_radius = 0.001: must be at least 0.005"),
        (lambda: PartialCrown(0.0, 1.0, dub_length=1e-3), "dub_length, dub_radius = .*both or neither"),
        (lambda: PartialCrown(0.0, 1.0, dub_radius=1e-3), "both or neither"),
        (lambda: PartialCrown(0.0, 1.0, 1e-3, dub_radius=2.0), "dub_radius = 2.0: must be at most crown_radius"),
        (lambda: PartialCrown(0.0, 1.0, 1e-3, 1e-4).drop(np.zeros(1), LENGTH), "dub_radius = 0.0001: must be at least"),
        (lambda: PartialCrown(9e-3, 1.0, 1e-3, 0.1).drop(np.zeros(1), LENGTH), "dub_length = 0.001: must be at most"),
    ],
)
def test_invalid_crown_raises(create, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        create()


def test_sphere_pressure_equals_hertz_point_contact(solve_profile, steel: Material) -> None:
    load, length = 200.0, 2e-3
    result = solve_profile(Sphere(RADIUS), length, load=load, cells=4, window=4.0)
    radius = np.cbrt(0.75 * load * RADIUS / steel.plane_strain_modulus)
    assert float(result["pressure"].max()) == pytest.approx(1.5 * load / (np.pi * radius**2), rel=5e-3)
    cell_area = float(result["x"][1] - result["x"][0]) * float(result["y"][1] - result["y"][0])
    assert float((result["pressure"] > 0).sum()) * cell_area == pytest.approx(np.pi * radius**2, rel=0.04)


def test_sphere_equals_an_ellipsoid_of_equal_radius(positions: np.ndarray) -> None:
    np.testing.assert_array_equal(Sphere(RADIUS).drop(positions, LENGTH), Ellipsoid(RADIUS).drop(positions, LENGTH))
    Roller(radius=RADIUS, length=LENGTH, profile=Sphere(RADIUS))


def test_ellipsoid_pressure_equals_hertz_elliptic_contact(solve_profile, steel: Material) -> None:
    load, length, crown = 200.0, 4e-3, 8 * RADIUS
    result = solve_profile(Ellipsoid(crown), length, load=load, cells=3, window=5.0)
    exact_contact = hertz_ellipse(load, crown, RADIUS, steel.plane_strain_modulus)
    assert float(result["pressure"].max()) == pytest.approx(exact_contact.max_pressure, rel=5e-3)
    for axis, semi_axis in (("x", exact_contact.long), ("y", exact_contact.short)):
        positions = result[axis].values
        other_axis = "y" if axis == "x" else "x"
        loaded_positions = positions[(result["pressure"] > 0).any(other_axis).values]
        assert np.ptp(loaded_positions) / 2 == pytest.approx(semi_axis, abs=positions[1] - positions[0])


@pytest.mark.parametrize(
    ("create", "message"),
    [
        (lambda: Ellipsoid(0.0), "crown_radius = 0.0"),
        (lambda: Ellipsoid("round"), "crown_radius = 'round'"),
        (lambda: Sphere(-1.0), "radius = -1.0"),
        (
            lambda: Roller(radius=RADIUS, length=LENGTH, profile=Sphere(4e-3)),
            "radius = 0.004: must be the roller's radius, 0.005 m",
        ),
    ],
)
def test_invalid_sphere_or_ellipsoid_raises(create, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        create()
