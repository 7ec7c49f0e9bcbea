"""Profiles of straight lines and arcs: cylinder, cone, chamfers and crowns; sphere and ellipsoid of Hertz' theory."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import NOT_NEGATIVE_LENGTH, POSITIVE_LENGTH, Shape, SlopeJumps

MAX_HALF_ANGLE = np.pi / 4  # Largest half cone angle, radians. Limit.


def _arc_drop(distance: FloatArray, radius: float) -> FloatArray:
    """Drop of a circle of `radius` at `distance` from its highest point, without cancellation."""
    return np.asarray(distance**2 / (radius + np.sqrt(radius**2 - distance**2)))


@dataclass(frozen=True, repr=False)
class Cylinder(Shape):
    """Cylinder with rounded ends: straight, then a circular fillet of radius `fillet_radius` at each end.

    ``drop = r0 - sqrt(r0**2 - d**2)`` with the distance ``d`` of a point from the fillet's start.

    Parameters
    ----------
    fillet_radius : float
        Radius ``r0`` of the roller's fillet, metres; 0 is a sharp end. At most half the roller's length.

    Raises
    ------
    InvalidInputError
        If the radius is negative, or (on use) larger than half the roller's length.

    Examples
    --------
    >>> Cylinder(fillet_radius=1e-3).drop(np.array([0.0, 4e-3, 5e-3]), length=10e-3).tolist()
    [0.0, 0.0, 0.001]
    """

    fillet_radius: float = field(default=0.0, metadata=NOT_NEGATIVE_LENGTH)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        radius = self.fillet_radius
        if radius > length / 2:
            raise InvalidInputError("fillet_radius", radius, f"at most half the length, {length / 2:g} m")
        distance = np.clip(np.abs(x) - (length / 2 - radius), 0.0, radius)
        # Squares of the smallest radii underflow.
        return np.asarray(np.maximum(radius - np.sqrt(radius**2 - distance**2), 0.0))


@dataclass(frozen=True, repr=False)
class Tapered(Shape):
    """Tapered roller with rounded ends: a cone that lies on the body with its generatrix.

    The generatrix is straight, so only the fillets drop. The radius of curvature across it is that of a cone in the
    plane normal to its generatrix, ``R(x) = radius / cos(beta) + x tan(beta)`` with `radius` of the roller at
    mid-length, measured at right angles to the axis. The pressure is higher at the small end.

    Parameters
    ----------
    half_angle : float
        Half cone angle ``beta``, radians, between the axis and the generatrix. Between -pi/4 and pi/4; 0 is the
        :class:`Cylinder`, bit for bit. Positive: the roller is thick at ``x = +length / 2``.
    fillet_radius : float
        Radius ``r0`` of the fillet at both ends, metres; at most half the roller's length.

    Raises
    ------
    InvalidInputError
        If the angle is too steep, the fillet is negative or (on use) larger than half the roller's length, or the
        cone's tip would lie within the roller.

    Notes
    -----
    `length` and `x` are measured along the generatrix. The Hertz scales of results belong to a cylinder with the
    roller's `radius`, without ``1 / cos(beta)``: up to 1.0025 in bearings.

    References
    ----------
    Meusnier's theorem: M. P. do Carmo, Differential Geometry of Curves and Surfaces (1976), section 3-2.

    Examples
    --------
    >>> x = np.array([-5e-3, 0.0, 5e-3])
    >>> Tapered(half_angle=0.05).local_radius(x, length=10e-3, radius=5e-3).round(6).tolist()
    [0.004756, 0.005006, 0.005256]
    >>> Tapered(half_angle=0.05).drop(x, length=10e-3).tolist()
    [0.0, 0.0, 0.0]
    """

    half_angle: float = field(metadata=checks.number(checks.finite, "radians"))
    fillet_radius: float = field(default=0.0, metadata=NOT_NEGATIVE_LENGTH)

    def __post_init__(self) -> None:
        super().__post_init__()
        if abs(self.half_angle) > MAX_HALF_ANGLE:
            hint = "an angle in degrees needs numpy.radians"
            raise InvalidInputError("half_angle", self.half_angle, "between -pi/4 and pi/4 (radians)", hint)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length: the fillets."""
        return Cylinder(self.fillet_radius).drop(x, length)

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius of the cone across its generatrix (m) at distances `x` (m) from mid-length."""
        mid_radius = np.asarray(radius) / np.cos(self.half_angle)
        slope = np.tan(self.half_angle)
        if np.min(mid_radius) <= abs(slope) * length / 2:
            max_angle = np.arcsin(min(1.0, float(2 * np.min(radius) / length)))
            allowed, reason = f"below {max_angle:.3g} rad for this roller", "the cone's tip would lie within the roller"
            raise InvalidInputError("half_angle", self.half_angle, allowed, reason)
        return np.asarray(mid_radius + slope * np.asarray(x))


@dataclass(frozen=True, repr=False, kw_only=True)
class Chamfer(Shape):
    """Straight chamfer at each end, with a sharp or a rounded corner.

    Two of `depth`, `width` and `angle` are given: ``depth = width tan(angle)``.

    Parameters
    ----------
    depth : float, optional
        Drop at the ends, metres; positive.
    width : float, optional
        Axial width at each end, metres; positive, at most half the roller's length.
    angle : float, optional
        Angle between chamfer and generatrix, radians; between 0 and pi/2.
    blend_radius : float
        Radius ``rho`` of the arc between generatrix and chamfer, metres; 0 is a sharp corner. The arc is tangential to
        both, and extends over ``rho tan(angle / 2)`` to either side of the corner.

    Raises
    ------
    InvalidInputError
        If not exactly two of the three sizes are given, a value is out of range, or (on use) chamfer and arc do not fit
        the roller.

    Notes
    -----
    Under a loaded sharp corner the pressure is unbounded: ``p = E* s / (2 pi) ln(d0 / d)`` at distances d well below
    d0, with the slope ``s = tan(angle)``. :func:`contactstudy.contact.corner_peak` returns the peak of a small
    blend radius.

    Examples
    --------
    >>> chamfer = Chamfer(width=0.5e-3, angle=np.radians(45))
    >>> (1e3 * chamfer.drop(np.array([0.0, 4.5e-3, 5e-3]), length=10e-3)).round(6).tolist()
    [0.0, 0.0, 0.5]
    """

    depth: float | None = field(default=None, metadata=POSITIVE_LENGTH)
    width: float | None = field(default=None, metadata=POSITIVE_LENGTH)
    angle: float | None = field(default=None, metadata=checks.number(checks.positive, "radians"))
    blend_radius: float = field(default=0.0, metadata=NOT_NEGATIVE_LENGTH)

    def __post_init__(self) -> None:
        sizes = self.depth, self.width, self.angle
        if sum(size is not None for size in sizes) != 2:
            raise InvalidInputError("depth, width, angle", sizes, "exactly two of the three")
        super().__post_init__()
        if self.angle is not None and self.angle >= np.pi / 2:
            raise InvalidInputError("angle", self.angle, "below pi/2 (radians)", "45 degrees are numpy.radians(45)")

    @property
    def slope(self) -> float:
        """Slope of the chamfer."""
        if self.angle is not None:
            return float(np.tan(self.angle))
        return float(self.depth) / float(self.width)  # type: ignore[arg-type]

    @property
    def axial_width(self) -> float:
        """Axial width at each end, metres."""
        return self.width if self.width is not None else float(self.depth) / self.slope  # type: ignore[arg-type]

    @property
    def inner_blend(self) -> float:
        """Axial length of the arc on the inner side of the corner, metres."""
        return self.blend_radius * float(np.tan(0.5 * np.arctan(self.slope)))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        half_length, width, inner_blend = 0.5 * length, self.axial_width, self.inner_blend
        if width > half_length:
            raise InvalidInputError("width", width, f"at most half the length, {half_length:g} m")
        outer_blend = self.blend_radius * np.sin(np.arctan(self.slope)) - inner_blend
        if outer_blend > width or width + inner_blend > half_length:
            max_radius = min(width / outer_blend, (half_length - width) / inner_blend) * self.blend_radius
            raise InvalidInputError("blend_radius", self.blend_radius, f"at most {max_radius:.3g} m on this chamfer")
        distance = np.abs(x) - (half_length - width)
        chamfer_drop = self.slope * np.maximum(distance, 0.0)
        if inner_blend == 0:
            return np.asarray(chamfer_drop)
        # On the arc, from -inner_blend to outer_blend, the drop is that of a circle from the arc's start.
        chord = np.clip(distance + inner_blend, 0.0, inner_blend + outer_blend)
        return np.where(distance < outer_blend, _arc_drop(chord, self.blend_radius), chamfer_drop)

    def nodes(self, length: float) -> SlopeJumps:
        """Both corners and the ends of their arcs."""
        corner = 0.5 * length - self.axial_width
        outer_blend = self.blend_radius * np.sin(np.arctan(self.slope)) - self.inner_blend
        positions = np.outer([-1.0, 1.0], [corner - self.inner_blend, corner, corner + outer_blend]).ravel()
        return SlopeJumps(positions, np.zeros(positions.size))


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
        max_distance = length / 2 + abs(self.centre)
        if self.crown_radius < max_distance:
            allowed = f"at least {max_distance:g} m, the distance to the roller's farther end"
            raise InvalidInputError("crown_radius", self.crown_radius, allowed)
        return _arc_drop(np.minimum(np.abs(np.asarray(x) - self.centre), max_distance), self.crown_radius)


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
        dub_off = self.dub_length, self.dub_radius
        if (self.dub_length > 0) != (self.dub_radius is not None):
            raise InvalidInputError("dub_length, dub_radius", dub_off, "given both or neither")
        if self.dub_radius is not None and self.dub_radius > self.crown_radius:
            raise InvalidInputError("dub_radius", self.dub_radius, f"at most crown_radius, {self.crown_radius:g} m")

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        end_length = (length - self.straight_length) / 2
        if end_length < 0:
            allowed = f"at most the roller's length, {length:g} m"
            raise InvalidInputError("straight_length", self.straight_length, allowed)
        crown_length = end_length - self.dub_length
        if crown_length < -1e-9 * length:
            allowed = f"at most {end_length:g} m, the length between the straight middle and the end"
            raise InvalidInputError("dub_length", self.dub_length, allowed)
        crown_length = max(crown_length, 0.0)
        if crown_length > self.crown_radius:
            allowed = f"at least {crown_length:g} m, the length of the crown"
            raise InvalidInputError("crown_radius", self.crown_radius, allowed)
        distance = np.clip(np.abs(x) - self.straight_length / 2, 0.0, end_length)
        if self.dub_radius is None:
            return _arc_drop(distance, self.crown_radius)
        sine = crown_length / self.crown_radius
        dub_start = self.dub_radius * sine
        if end_length - crown_length + dub_start > self.dub_radius:
            allowed = f"at least {(end_length - crown_length) / (1 - sine):g} m, to reach the roller's end"
            raise InvalidInputError("dub_radius", self.dub_radius, allowed)
        crown_drop = _arc_drop(np.minimum(distance, crown_length), self.crown_radius)
        dub_drop = _arc_drop(np.maximum(distance - crown_length, 0.0) + dub_start, self.dub_radius)
        return np.asarray(crown_drop + (dub_drop - _arc_drop(np.array(dub_start), self.dub_radius)))


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
