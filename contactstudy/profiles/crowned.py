"""Crowns of circular arcs; sphere and ellipsoid of Hertz' theory."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import NOT_NEGATIVE_LENGTH, POSITIVE_LENGTH, Shape


def _arc_drop(distance: FloatArray, radius: float) -> FloatArray:
    """Drop of a circle of `radius` at `distance` from its highest point, without cancellation."""
    return np.asarray(distance**2 / (radius + np.sqrt(radius**2 - distance**2)))


@dataclass(frozen=True, repr=False)
class FullCrown(Shape):
    """Full crown: one circular arc from end to end, ``drop = R - sqrt(R**2 - (x - centre)**2)``.

    Parameters
    ----------
    crown_radius : float
        Radius ``R`` of the arc in the axial plane, metres; at least ``length / 2 + |centre|``.
    centre : float
        Distance of the highest point from mid-length, metres; within the roller.

    Raises
    ------
    InvalidInputError
        If the radius is not positive, or (on use) too small for the roller, or the centre is beyond its ends.

    Examples
    --------
    >>> (1e6 * FullCrown(crown_radius=1.25).drop(np.array([0.0, 5e-3]), length=10e-3)).round(3).tolist()
    [0.0, 10.0]
    """

    crown_radius: float = field(metadata=POSITIVE_LENGTH)
    centre: float = field(default=0.0, metadata=checks.number(checks.finite, "metres"))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        if abs(self.centre) > length / 2:
            raise InvalidInputError("centre", self.centre, f"within half the roller's length, {length / 2:g} m")
        reach = length / 2 + abs(self.centre)
        if self.crown_radius < reach:
            allowed = f"at least {reach:g} m, the distance to the roller's farther end"
            raise InvalidInputError("crown_radius", self.crown_radius, allowed)
        return _arc_drop(np.minimum(np.abs(np.asarray(x) - self.centre), reach), self.crown_radius)


@dataclass(frozen=True, repr=False)
class PartialCrown(Shape):
    """Partial crown: a straight middle, a crown of circular arcs, and an optional dub-off at each end.

    The crown's arc leaves the straight middle tangentially. The dub-off is a second arc with a smaller radius that
    leaves the first one tangentially, at the distance `dub_length` from the end ("two tangential radii"). With
    ``straight_length = length - 2 * dub_length`` the first arc vanishes: a straight roller with dub-off.

    Parameters
    ----------
    straight_length : float
        Length of the straight middle, metres. Not negative, not more than the roller's length; 0 is a full crown.
    crown_radius : float
        Radius of the crown's arc, metres. At least the axial length of the crown at one end.
    dub_length : float
        Axial length of the dub-off at each end, metres; 0 is none.
    dub_radius : float, optional
        Radius of the dub-off's arc, metres; given with a `dub_length`, and at most `crown_radius`. The arc must
        reach the end of the roller.

    Raises
    ------
    InvalidInputError
        If a value is out of range, or (on use) the parts do not fit the roller's length.

    Examples
    --------
    >>> profile = PartialCrown(straight_length=6e-3, crown_radius=1.0, dub_length=0.5e-3, dub_radius=0.02)
    >>> (1e6 * profile.drop(np.array([3e-3, 4.5e-3, 5e-3]), length=10e-3)).round(2).tolist()
    [0.0, 1.13, 8.13]
    """

    straight_length: float = field(metadata=NOT_NEGATIVE_LENGTH)
    crown_radius: float = field(metadata=POSITIVE_LENGTH)
    dub_length: float = field(default=0.0, metadata=NOT_NEGATIVE_LENGTH)
    dub_radius: float | None = field(default=None, metadata=POSITIVE_LENGTH)

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.dub_length > 0) != (self.dub_radius is not None):
            raise InvalidInputError(
                "dub_length, dub_radius", (self.dub_length, self.dub_radius), "given both or neither"
            )
        if self.dub_radius is not None and self.dub_radius > self.crown_radius:
            raise InvalidInputError("dub_radius", self.dub_radius, f"at most crown_radius, {self.crown_radius:g} m")

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        end = (length - self.straight_length) / 2
        if end < 0:
            allowed = f"at most the roller's length, {length:g} m"
            raise InvalidInputError("straight_length", self.straight_length, allowed)
        begin = end - self.dub_length
        if begin < -1e-9 * length:
            allowed = f"at most {end:g} m, the length between the straight middle and the end"
            raise InvalidInputError("dub_length", self.dub_length, allowed)
        begin = max(begin, 0.0)
        if begin > self.crown_radius:
            raise InvalidInputError("crown_radius", self.crown_radius, f"at least {begin:g} m, the length of the crown")
        distance = np.clip(np.abs(x) - self.straight_length / 2, 0.0, end)
        if self.dub_radius is None:
            return _arc_drop(distance, self.crown_radius)
        sine = begin / self.crown_radius
        shift = self.dub_radius * sine
        if end - begin + shift > self.dub_radius:
            allowed = f"at least {(end - begin) / (1 - sine):g} m, to reach the roller's end"
            raise InvalidInputError("dub_radius", self.dub_radius, allowed)
        crown_drop = _arc_drop(np.minimum(distance, begin), self.crown_radius)
        dub_drop = _arc_drop(np.maximum(distance - begin, 0.0) + shift, self.dub_radius)
        return np.asarray(crown_drop + (dub_drop - _arc_drop(np.array(shift), self.dub_radius)))


@dataclass(frozen=True, repr=False)
class Ellipsoid(Shape):
    """Parabola ``drop = x**2 / (2 R_x)``: the roller as an ellipsoid in Hertz' theory.

    The roller's circle is a parabola too, so the gap is exactly Hertz' elliptical contact. `FullCrown` is the circle.

    Parameters
    ----------
    crown_radius : float
        Radius of curvature ``R_x`` in the axial plane at mid-length, metres; positive and large against ``x``.

    Raises
    ------
    InvalidInputError
        If the radius is not positive.

    References
    ----------
    K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), chapter 4.

    Examples
    --------
    >>> Ellipsoid(crown_radius=0.5).drop(np.array([0.0, 1e-3]), length=4e-3).tolist()
    [0.0, 1e-06]
    """

    crown_radius: float = field(metadata=POSITIVE_LENGTH)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return np.asarray(np.asarray(x) ** 2 / (2 * self.crown_radius))


@dataclass(frozen=True, repr=False)
class Sphere(Shape):
    """Sphere in Hertz' theory: an :class:`Ellipsoid` whose crown radius is the roller's radius.

    Parameters
    ----------
    radius : float
        Radius, metres; must equal the roller's.

    Raises
    ------
    InvalidInputError
        If the radius is not positive, or differs from the roller's.

    Examples
    --------
    >>> Sphere(radius=5e-3).drop(np.array([0.0, 1e-4]), length=1e-3).tolist()
    [0.0, 1e-06]
    """

    radius: float = field(metadata=POSITIVE_LENGTH)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return Ellipsoid(self.radius).drop(x, length)

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius of the roller (m), which must equal the sphere's."""
        if not np.allclose(radius, self.radius, rtol=1e-9, atol=0.0):
            allowed = f"the roller's radius, {np.max(radius):g} m"
            raise InvalidInputError("radius", self.radius, allowed, "an Ellipsoid may have any radius")
        return super().local_radius(x, length, radius)
