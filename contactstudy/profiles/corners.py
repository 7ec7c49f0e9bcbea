"""A profile over the effective length, with the corners that take the rest of the roller."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import quantity
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Profile, Shape, checked_drop, in_words, local_radius

STEP = 1e-6
"""Distance over which the slope at an end of the effective length is taken, over this length. Accuracy."""

STEEPEST = 1.0
"""Slope of the profile above which the corner begins with this one: logarithmic profiles can end upright."""


@dataclass(frozen=True, repr=False)
class EffectiveLength(Shape):
    """A profile that a drawing states over the effective length, without the roller's corners.

    Within the effective length the drop is that of `profile` on a roller of this length, so a drop that is stated at
    its end lies there. The corners are circles in what is left of the roller at either end: they go on from the
    profile with its slope, and are perpendicular to the axis at the very end.

    Parameters
    ----------
    profile : Profile
        The profile; its drop at the ends of the effective length must be finite.
    effective_length : float
        Length without corners, metres; at most the roller's length.

    Raises
    ------
    InvalidInputError
        If the length is not positive, the profile drops without limit at its end, or (on use) the roller is shorter.

    Examples
    --------
    A crown of 8 um at the ends of 9 of 10 mm; over the whole length the same crown would drop by 8 um at 5 mm only.

    >>> from contactstudy.profiles import FullCrown
    >>> crown = FullCrown(crown_radius=4.5e-3**2 / 16e-6)
    >>> EffectiveLength(crown, 9e-3)
    EffectiveLength(FullCrown(crown_radius=1266 mm), effective_length=9 mm, drop 8 µm at its end)
    >>> (1e6 * EffectiveLength(crown, 9e-3).drop(np.array([0.0, 4.5e-3, 4.6e-3]), length=10e-3)).round(1).tolist()
    [0.0, 8.0, 18.4]
    """

    profile: Profile
    effective_length: float

    def __post_init__(self) -> None:
        """Check the length, and the drop at its end."""
        checks.instance("profile", self.profile, Profile, "a profile from contactstudy.profiles")
        length = checks.positive("effective_length", self.effective_length, "metres")
        object.__setattr__(self, "effective_length", length)
        if not np.isfinite(self.end_drop):
            raise InvalidInputError(
                "profile",
                self.profile,
                "a profile whose drop at the end of the effective length is finite",
                "a logarithmic profile with an end of its own, such as Lundberg's, counts over the whole length",
            )

    @property
    def end_drop(self) -> float:
        """Largest drop at either end of the effective length, metres."""
        half = 0.5 * self.effective_length
        return float(checked_drop(self.profile, np.array([-half, half]), self.effective_length).max())

    def __repr__(self) -> str:
        length, drop = (quantity(value, "m") for value in (self.effective_length, self.end_drop))
        return f"EffectiveLength({in_words(self.profile)}, effective_length={length}, drop {drop} at its end)"

    def _said(self) -> Iterator[tuple[str, str]]:
        """Profile, effective length, and the drop at its end."""
        yield from super()._said()
        yield "drop_at_its_end", quantity(self.end_drop, "m")

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        half = 0.5 * self.effective_length
        corner = max(0.5 * length - half, 0.0)
        if half > 0.5 * length * (1 + 1e-12):
            raise InvalidInputError(
                "effective_length", self.effective_length, f"at most the roller's length, {length:g} m"
            )
        x = np.asarray(x)
        found = checked_drop(self.profile, np.clip(x, -half, half), self.effective_length)
        if corner == 0:
            return found
        for side, (sine, cosine) in zip((-1.0, 1.0), self._directions(), strict=True):
            beyond = np.clip(side * x - half, 0.0, corner)
            radius = corner / (1 - sine)
            along = np.minimum(sine * radius + beyond, radius)
            # R cos - sqrt(R**2 - along**2), without the rounding of a difference: exactly 0 where the corner begins.
            rest = radius * cosine + np.sqrt((radius - along) * (radius + along))
            found = found + beyond * (2 * sine * radius + beyond) / rest
        return found

    def _directions(self) -> list[tuple[float, float]]:
        """Sine and cosine of the angle at which the profile leaves the effective length, at its first and last end."""
        half, step = 0.5 * self.effective_length, STEP * self.effective_length
        places = np.array([-half, -(half - step), half - step, half])
        drops = checked_drop(self.profile, places, self.effective_length)
        slopes = np.clip([(drops[0] - drops[1]) / step, (drops[3] - drops[2]) / step], 0.0, STEEPEST)
        return [(slope / np.hypot(1.0, slope), 1.0 / np.hypot(1.0, slope)) for slope in slopes.tolist()]

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m): that of the profile, in the corners that at its end."""
        half = 0.5 * self.effective_length
        return local_radius(self.profile, np.clip(np.asarray(x), -half, half), self.effective_length, radius)
