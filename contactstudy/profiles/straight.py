"""Straight generatrices: the cylinder and the cone, with rounded ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Shape

STEEPEST = np.pi / 4
"""Largest half cone angle, radians."""


@dataclass(frozen=True, repr=False)
class Cylinder(Shape):
    """Cylinder with rounded ends: straight, then a circular fillet of radius `fillet_radius` at each end.

    ``drop = r0 - sqrt(r0**2 - d**2)`` where ``d`` is how far the point lies inside the fillet.

    Parameters
    ----------
    fillet_radius : float
        Radius ``r0`` of the roller's fillet, metres; 0 is a sharp end. At most half the roller's length.

    Raises
    ------
    InvalidInputError
        If the radius is negative, or (on use) larger than half the roller's length.

    Notes
    -----
    The fillet is a quarter circle: it leaves the cylinder without a corner and is perpendicular to it at the very
    end, where the drop is ``r0``.

    Examples
    --------
    >>> import numpy as np
    >>> Cylinder(fillet_radius=1e-3).drop(np.array([0.0, 4e-3, 5e-3]), length=10e-3).tolist()
    [0.0, 0.0, 0.001]
    """

    fillet_radius: float = 0.0

    def __post_init__(self) -> None:
        """Check the radius."""
        object.__setattr__(self, "fillet_radius", checks.not_negative("fillet_radius", self.fillet_radius, "metres"))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        radius = self.fillet_radius
        if radius > length / 2:
            raise InvalidInputError("fillet_radius", radius, f"at most half the roller's length, {length / 2:g} m")
        inside = np.clip(np.abs(x) - (length / 2 - radius), 0.0, radius)
        # Squares of the smallest radii underflow.
        return np.asarray(np.maximum(radius - np.sqrt(radius**2 - inside**2), 0.0))


@dataclass(frozen=True, repr=False)
class Tapered(Shape):
    """Tapered roller with rounded ends: a cone that lies on the body with its generatrix.

    The generatrix is straight, so nothing but the fillets drops. What varies is the radius of curvature across it,
    that of a cone in the plane normal to its generatrix::

        R(x) = radius / cos(beta) + x tan(beta)

    with `radius` of the roller at mid-length, measured at right angles to the axis. The gap is ``y**2 / (2 R(x))``:
    the contact is narrower and the pressure higher at the small end.

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
    `length` and `x` are measured along the generatrix. In bearings ``beta`` is up to about 0.07 rad (4 degrees), and
    ``1 / cos(beta)`` up to 1.0025: the Hertz half-width and pressure that results are given over are those of a
    cylinder with the roller's `radius`, without this factor.

    A roller whose *axis* is parallel to the surface, so that one end is higher than the other, is not tapered but
    tilted. Profiles of tapered rollers in use, such as :class:`~contactstudy.profiles.IsoTapered`, are departures
    from the cone: add them, ``Tapered(beta) + IsoTapered(diameter)``.

    References
    ----------
    The radius follows from Meusnier's theorem, M. P. do Carmo, Differential Geometry of Curves and Surfaces (1976),
    section 3-2: the circle of latitude, of radius ``radius + s sin(beta)`` where the generatrix has the length ``s``,
    is cut at the angle ``beta`` to the normal section.

    Examples
    --------
    >>> import numpy as np
    >>> x = np.array([-5e-3, 0.0, 5e-3])
    >>> Tapered(half_angle=0.05).local_radius(x, length=10e-3, radius=5e-3).round(6).tolist()
    [0.004756, 0.005006, 0.005256]
    >>> Tapered(half_angle=0.05).drop(x, length=10e-3).tolist()
    [0.0, 0.0, 0.0]
    """

    half_angle: float
    fillet_radius: float = 0.0

    def __post_init__(self) -> None:
        """Check the parameters."""
        angle = checks.finite("half_angle", self.half_angle, "radians")
        if abs(angle) > STEEPEST:
            raise InvalidInputError(
                "half_angle", angle, "between -pi/4 and pi/4 (radians)", "an angle in degrees needs numpy.radians"
            )
        object.__setattr__(self, "half_angle", angle)
        object.__setattr__(self, "fillet_radius", checks.not_negative("fillet_radius", self.fillet_radius, "metres"))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length: the fillets."""
        return Cylinder(self.fillet_radius).drop(x, length)

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius of the cone across its generatrix (m) at distances `x` (m) from mid-length."""
        middle = np.asarray(radius) / np.cos(self.half_angle)
        slope = np.tan(self.half_angle)
        if np.min(middle) <= abs(slope) * length / 2:
            raise InvalidInputError(
                "half_angle",
                self.half_angle,
                f"below {np.arcsin(min(1.0, float(2 * np.min(radius) / length))):.3g} rad for this roller",
                "the cone's tip would lie within the roller",
            )
        return np.asarray(middle + slope * np.asarray(x))
