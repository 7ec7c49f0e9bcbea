"""The problems that stored finite-element references belong to.

Lengths are in units of ``a`` and pressures in units of ``p0``: half-width and peak of the load where it is prescribed,
of the Hertz line contact under the same load per length where it is a contact (whose ``E*`` and ``R = a / 2`` are then
1 and 1/2, and the gap ``y**2``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray

LINE_LOAD = 0.5 * np.pi
"""Load per length of the line contact of half-width and peak pressure 1."""


@dataclass(frozen=True)
class Uniform:
    """The same pressure from end to end."""

    def __call__(self, x: FloatArray) -> FloatArray:
        """Shape along x."""
        return np.ones_like(np.asarray(x, dtype=float))

    def __str__(self) -> str:
        return "g(x) = 1"


@dataclass(frozen=True)
class Linear:
    """A pressure that falls from 1 at ``x = 0`` with a constant slope."""

    slope: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """Shape along x."""
        return np.asarray(1 - self.slope * np.asarray(x, dtype=float))

    def __str__(self) -> str:
        return f"g(x) = 1 - {self.slope} x"


@dataclass(frozen=True)
class Bump:
    """A squared cosine, zero from `half_width` off its centre."""

    centre: float
    half_width: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """Shape along x."""
        t = np.clip((np.asarray(x, dtype=float) - self.centre) / self.half_width, -1, 1)
        return np.asarray(np.cos(0.5 * np.pi * t) ** 2)

    def __str__(self) -> str:
        c, w = self.centre, self.half_width
        return f"g(x) = cos(pi (x - {c}) / {2 * w})^2 on |x - {c}| < {w}, else 0"


def quartic(y: FloatArray) -> FloatArray:
    """`h(y)`: `(1 - y^2)^2` inside `|y| < 1`, zero outside."""
    return np.asarray(np.clip(1 - np.asarray(y, dtype=float) ** 2, 0, None) ** 2)


@dataclass(frozen=True)
class LoadCase:
    """A body with free ends at ``x = 0`` and ``x = length``, and the load ``p0 g(x) h(y)`` on its top.

    Parameters
    ----------
    length : float
        Distance between the ends.
    g : callable
        Shape of the load along x.
    friction : float
        Coefficient of the traction along +y.
    poisson : float
        Poisson's ratio.
    """

    length: float
    g: Callable[[FloatArray], FloatArray]
    friction: float = 0.0
    poisson: float = 0.3

    @property
    def h(self) -> Callable[[FloatArray], FloatArray]:
        """Shape of the load along y."""
        return quartic

    def pressure(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Pressure at the tensor product of points."""
        return np.outer(self.g(np.asarray(x)), self.h(np.asarray(y)))

    @property
    def symmetric(self) -> bool:
        """Even about mid-length: only then have differences of the top's displacement a meaning."""
        x = np.linspace(0, self.length, 101)
        return bool(np.allclose(self.g(x), self.g(x)[::-1]))


@dataclass(frozen=True)
class ContactCase:
    """A rigid roller centred over a body with two free ends: the gap is ``y**2 + crown (x - length / 2)**2``.

    Parameters
    ----------
    length : float
        Distance between the ends.
    distance : float
        ``e``, from either free end to the roller's; the roller may end beyond the body (negative), which then makes
        no difference but through its crown.
    crown : float
        Curvature of the generatrix: half of it over ``a / (2 R)``.
    poisson : float
        Poisson's ratio.
    """

    length: float
    distance: float
    crown: float = 0.0
    poisson: float = 0.3

    @property
    def start(self) -> float:
        """First x under the roller."""
        return max(self.distance, 0.0)

    @property
    def stop(self) -> float:
        """Last x under the roller."""
        return self.length - self.start

    @property
    def load(self) -> float:
        """Load: that of the line contact of half-width and peak pressure 1 along all of the contact."""
        return LINE_LOAD * (self.stop - self.start)

    def gap_x(self, x: FloatArray) -> FloatArray:
        """Gap along the roller's generatrix."""
        return np.asarray(self.crown * (np.asarray(x, dtype=float) - 0.5 * self.length) ** 2)

    def gap(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Gap at the tensor product of points, infinite beyond the roller."""
        outside = (x < self.start) | (x > self.stop)
        return np.asarray(np.where(outside, np.inf, self.gap_x(x))[:, None] + y[None, :] ** 2)


@dataclass(frozen=True)
class PassesCase:
    """Passes of Hertz' line contact of half-width and peak pressure 1 over an elastic-plastic half-plane.

    Attributes
    ----------
    shear_yield_stress : float
        k over the peak pressure.
    friction : float
        Full sliding: the shear traction on the body is friction times pressure, along +y, as the contact moves.
    passes : int
        How many.
    kinematic_hardening : float
        Growth of the back stress in tension per plastic strain, over Young's modulus.
    poisson : float
        Poisson's ratio.
    """

    shear_yield_stress: float
    friction: float
    passes: int
    kinematic_hardening: float = 0.0
    poisson: float = 0.3


LOAD_CASES: dict[str, LoadCase] = {
    "full": LoadCase(8.0, Uniform()),
    "middle": LoadCase(8.0, Bump(4.0, 2.0)),
    "eccentric": LoadCase(8.0, Bump(1.5, 1.0)),
    "full_sliding": LoadCase(8.0, Uniform(), friction=0.3),
    "eccentric_sliding": LoadCase(8.0, Bump(1.5, 1.0), friction=0.3),
    "thin": LoadCase(2.5, Uniform()),
    "plate_sliding": LoadCase(0.5, Uniform(), friction=0.3),
    "wedge_sliding": LoadCase(4.0, Linear(0.2), friction=0.2, poisson=0.1),
}
"""Loads whose stresses are stored, by name."""

CONTACT_CASES: dict[str, ContactCase] = {
    "flush": ContactCase(8.0, 0.0),
    "inside": ContactCase(8.0, 1.0),
    "crowned": ContactCase(8.0, 0.5, crown=0.15),
    "overhanging": ContactCase(8.0, -2.0, crown=0.03),
}
"""Contacts that are stored, by name."""

PASSES_CASES: dict[str, PassesCase] = {
    "settling": PassesCase(1 / 3.6, friction=0.0, passes=2),
    "settling_sliding": PassesCase(1 / 3.1, friction=0.2, passes=5),
    "flowing": PassesCase(1 / 4.3, friction=0.0, passes=3),
    "flowing_sliding": PassesCase(1 / 3.4, friction=0.2, passes=2),
}
"""Passes whose residual stresses and plastic strains are stored: either side of the shakedown limits 4.0 k, 3.2 k."""
