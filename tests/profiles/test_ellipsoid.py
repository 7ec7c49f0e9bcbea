"""Sphere and ellipsoid against Hertz' point and elliptic contact."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import InvalidInputError, Material, Roller
from contactstudy.profiles import Ellipsoid, Sphere
from contactstudy.verification.closed_forms import hertz_ellipse
from tests.profiles.conftest import LENGTH, RADIUS


def test_sphere_is_hertz_point_contact(pressed, steel: Material) -> None:
    load, length = 200.0, 2e-3
    result = pressed(Sphere(RADIUS), length, load=load, cells=4, window=4.0)
    radius = np.cbrt(0.75 * load * RADIUS / steel.plane_strain_modulus)
    assert float(result["pressure"].max()) == pytest.approx(1.5 * load / (np.pi * radius**2), rel=5e-3)
    cell = float(result["x"][1] - result["x"][0]) * float(result["y"][1] - result["y"][0])
    assert float((result["pressure"] > 0).sum()) * cell == pytest.approx(np.pi * radius**2, rel=0.04)


def test_sphere_is_an_ellipsoid_of_the_rollers_radius(places: np.ndarray) -> None:
    np.testing.assert_array_equal(Sphere(RADIUS).drop(places, LENGTH), Ellipsoid(RADIUS).drop(places, LENGTH))
    Roller(radius=RADIUS, length=LENGTH, profile=Sphere(RADIUS))


def test_ellipsoid_is_hertz_elliptic_contact(pressed, steel: Material) -> None:
    load, length, crown = 200.0, 4e-3, 8 * RADIUS
    result = pressed(Ellipsoid(crown), length, load=load, cells=3, window=5.0)
    exact = hertz_ellipse(load, crown, RADIUS, steel.plane_strain_modulus)
    assert float(result["pressure"].max()) == pytest.approx(exact.max_pressure, rel=5e-3)
    for axis, half in (("x", exact.long), ("y", exact.short)):
        positions = result[axis].values
        other = "y" if axis == "x" else "x"
        touched = positions[(result["pressure"] > 0).any(other).values]
        assert np.ptp(touched) / 2 == pytest.approx(half, abs=positions[1] - positions[0])


@pytest.mark.parametrize(
    ("make", "message"),
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
def test_bad_values_are_named(make, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        make()
