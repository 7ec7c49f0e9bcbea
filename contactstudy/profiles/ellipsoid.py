"""Sphere and ellipsoid in Hertz' theory, for verification."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Shape


@dataclass(frozen=True, repr=False)
class Ellipsoid(Shape):
    """Parabola ``drop = x**2 / (2 R_x)``: the roller as an ellipsoid in Hertz' theory.

    The roller's circle is a parabola too, so the gap is exactly that of Hertz' elliptical contact.
    :class:`~contactstudy.profiles.FullCrown` is the circle.

    Parameters
    ----------
    crown_radius : float
        Radius of curvature ``R_x`` in the axial plane at mid-length, metres; positive. Equal to the roller's radius
        it makes a sphere. The parabola stands for the body only where ``x`` is small against it.

    Raises
    ------
    InvalidInputError
        If the radius is not positive.

    References
    ----------
    K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), chapter 4.

    Examples
    --------
    >>> import numpy as np
    >>> Ellipsoid(crown_radius=0.5).drop(np.array([0.0, 1e-3]), length=4e-3).tolist()
    [0.0, 1e-06]
    """

    crown_radius: float

    def __post_init__(self) -> None:
        """Check the radius."""
        object.__setattr__(self, "crown_radius", checks.positive("crown_radius", self.crown_radius, "metres"))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return np.asarray(np.asarray(x) ** 2 / (2 * self.crown_radius))


@dataclass(frozen=True, repr=False)
class Sphere(Shape):
    """Sphere in Hertz' theory: an :class:`Ellipsoid` whose crown radius is the roller's radius.

    Parameters
    ----------
    radius : float
        Radius, metres; must be that of the roller.

    Raises
    ------
    InvalidInputError
        If the radius is not positive, or the roller has another one.

    Examples
    --------
    >>> import numpy as np
    >>> Sphere(radius=5e-3).drop(np.array([0.0, 1e-4]), length=1e-3).tolist()
    [0.0, 1e-06]
    """

    radius: float

    def __post_init__(self) -> None:
        """Check the radius."""
        object.__setattr__(self, "radius", checks.positive("radius", self.radius, "metres"))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return Ellipsoid(self.radius).drop(x, length)

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius of the roller (m), which must be that of the sphere."""
        if not np.allclose(radius, self.radius, rtol=1e-9, atol=0.0):
            raise InvalidInputError(
                "radius", self.radius, f"the roller's radius, {np.max(radius):g} m", "an Ellipsoid may have another one"
            )
        return super().local_radius(x, length, radius)
