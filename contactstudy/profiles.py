"""Roller profiles: how much lower than the cylinder a roller's generatrix lies.

A profile is a small object with one method ``drop(x, length)``: the material removed, in metres and not negative,
at the distance `x` from mid-length of a roller of the given `length`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


@runtime_checkable
class Profile(Protocol):
    """What the solver needs of a profile."""

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; ``|x| <= length / 2``."""
        ...


@dataclass(frozen=True)
class Cylinder:
    """Cylinder with rounded ends: straight, then a circular fillet of radius `fillet_radius` at each end.

    ``drop = r0 - sqrt(r0**2 - d**2)`` where ``d`` is how far the point lies inside the fillet.

    Parameters
    ----------
    fillet_radius : float
        Radius ``r0`` of the roller's fillet, metres; 0 is a sharp end.

    Raises
    ------
    InvalidInputError
        If the radius is negative, or (on use) larger than half the roller's length.

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
        return np.asarray(radius - np.sqrt(radius**2 - inside**2))


@dataclass(frozen=True)
class Lundberg:
    """Lundberg's logarithmic profile, ``drop = delta * A * ln(1 / (1 - (2 x / length)**2))``.

    At its design load on a half-space, and with ``delta = 1``, the pressure is uniform along the roller.

    Parameters
    ----------
    amplitude : float
        ``A = q / (pi E*)``, metres, with the design load per length ``q`` and the contact modulus ``E*``
        (equivalently ``R (p0 / E*)**2``); see :meth:`for_pressure`.
    delta : float
        Modification factor on the amplitude.

    Raises
    ------
    InvalidInputError
        If a value is negative.

    References
    ----------
    G. Lundberg, Elastische Beruehrung zweier Halbraeume, Forschung auf dem Gebiet des Ingenieurwesens 10 (1939).

    Examples
    --------
    >>> profile = Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=230.77e9)
    >>> round(1e6 * profile.amplitude, 4)
    0.2112
    """

    amplitude: float
    delta: float = 1.0

    def __post_init__(self) -> None:
        """Check the parameters."""
        object.__setattr__(self, "amplitude", checks.not_negative("amplitude", self.amplitude, "metres"))
        object.__setattr__(self, "delta", checks.not_negative("delta", self.delta))

    @classmethod
    def for_pressure(cls, max_pressure: float, *, radius: float, modulus: float, delta: float = 1.0) -> Lundberg:
        """Profile whose design load gives the Hertz pressure `max_pressure` (Pa).

        Parameters
        ----------
        max_pressure : float
            Peak pressure of the Hertz line contact at the design load, Pa.
        radius : float
            Roller radius, metres.
        modulus : float
            Contact modulus ``E*``, Pa.
        delta : float
            Modification factor.
        """
        pressure = checks.positive("max_pressure", max_pressure, "Pa")
        modulus = checks.positive("modulus", modulus, "Pa")
        return cls(checks.positive("radius", radius, "metres") * (pressure / modulus) ** 2, delta)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; infinite at the very ends."""
        with np.errstate(divide="ignore"):
            return np.asarray(-self.delta * self.amplitude * np.log1p(-np.minimum((2 * x / length) ** 2, 1.0)))
