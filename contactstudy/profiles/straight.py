"""Straight generatrices: the cylinder and the cone with rounded ends, and straight chamfers."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import NOT_NEGATIVE_LENGTH, POSITIVE_LENGTH, Shape, SlopeJumps

MAX_HALF_ANGLE = np.pi / 4  # Largest half cone angle, radians


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
    Under a loaded sharp corner the pressure is unbounded: ``p = E* s / (2 pi) ln(d0 / d)`` at the
    distance d, with the slope ``s = tan(angle)``. :func:`contactstudy.contact.corner_peak` returns the peak of a small
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
        arc_drop = chord**2 / (self.blend_radius + np.sqrt(self.blend_radius**2 - chord**2))
        return np.asarray(np.where(distance < outer_blend, arc_drop, chamfer_drop))

    def nodes(self, length: float) -> SlopeJumps:
        """Both corners and the ends of their arcs."""
        corner = 0.5 * length - self.axial_width
        outer_blend = self.blend_radius * np.sin(np.arctan(self.slope)) - self.inner_blend
        positions = np.outer([-1.0, 1.0], [corner - self.inner_blend, corner, corner + outer_blend]).ravel()
        return SlopeJumps(positions, np.zeros(positions.size))
