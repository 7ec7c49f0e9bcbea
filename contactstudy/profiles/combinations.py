"""Profiles of other profiles: two halves, and a profile over the effective length."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import (
    POSITIVE,
    Profile,
    Shape,
    SlopeJumps,
    as_shape,
    check_drop,
    describe_profile,
    local_radius,
)

SLOPE_STEP = 1e-6  # Step of the differences for a slope, over the length


@dataclass(frozen=True, repr=False)
class Halves(Shape):
    """Different profiles left and right of mid-length.

    Each half equals a roller's half with this profile at both ends: lengths refer to the full roller.

    Parameters
    ----------
    left, right : Profile
        Profiles for ``x < 0`` and ``x >= 0``, with drops that agree at mid-length to 1e-10 m.

    Raises
    ------
    InvalidInputError
        If an argument is no profile, or (on use) the halves do not meet.

    Examples
    --------
    >>> from contactstudy.profiles import Cylinder, FullCrown
    >>> profile = Halves(left=Cylinder(), right=FullCrown(crown_radius=1.25))
    >>> (1e6 * profile.drop(np.array([-5e-3, 0.0, 5e-3]), length=10e-3)).round(3).tolist()
    [0.0, 0.0, 10.0]
    """

    left: Profile
    right: Profile

    def __post_init__(self) -> None:
        for name in ("left", "right"):
            checks.instance(name, getattr(self, name), Profile, "a profile from contactstudy.profiles")

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        mid_length = np.zeros(1)
        left_drop, right_drop = (float(check_drop(half, mid_length, length)[0]) for half in (self.left, self.right))
        # Largest step between the two halves at mid-length, metres: about one atom
        if abs(left_drop - right_drop) > 1e-10:
            allowed = "equal drops at mid-length (metres), so that the halves meet"
            raise InvalidInputError("left, right", (left_drop, right_drop), allowed)
        x = np.asarray(x)
        return np.asarray(np.where(x < 0, *(check_drop(half, x, length) for half in (self.left, self.right))))

    def nodes(self, length: float) -> SlopeJumps:
        """Nodes of both halves, and mid-length."""
        left, right = (as_shape(half).nodes(length) for half in (self.left, self.right))
        left = SlopeJumps(*(values[left.positions < 0] for values in left))
        right = SlopeJumps(*(values[right.positions > 0] for values in right))
        return SlopeJumps.join(left, SlopeJumps(np.zeros(1), np.zeros(1)), right)

    def second_interpolation(self) -> Halves | None:
        """Profile with the second interpolation of a measured half."""
        lower, upper = as_shape(self.left).second_interpolation(), as_shape(self.right).second_interpolation()
        return Halves(lower or self.left, upper or self.right) if lower or upper else None

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m) of each half."""
        left_radius, right_radius = (local_radius(half, x, length, radius) for half in (self.left, self.right))
        return np.asarray(np.where(np.asarray(x) < 0, left_radius, right_radius))


MAX_SLOPE = 1.0  # Maximum slope of the profile at a corner's start: logarithmic profiles end with an infinite slope


class Corner(NamedTuple):
    """Circle that continues the profile to the roller's end."""

    start: float  # from mid-length, m, not negative
    drop: float  # at the start, m
    sine: float  # of the angle between generatrix and axis at the start
    cosine: float


@dataclass(frozen=True, repr=False)
class EffectiveLength(Shape):
    """A profile over the effective length of a drawing, without the roller's corners.

    Within the effective length the drop is that of `profile` on a roller of this length. The corners are circles over
    the remaining length at either end: each begins with the profile's slope, and is perpendicular to the axis at the
    roller's end. A profile with an infinite drop at its end, such as Lundberg's, continues up to the slope 1.

    Parameters
    ----------
    profile : Profile
        Any profile.
    effective_length : float
        Length without corners, metres; at most the roller's length.

    Raises
    ------
    InvalidInputError
        If the length is not positive, or (on use) the roller is shorter.

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
    effective_length: float = field(metadata=POSITIVE)

    def __post_init__(self) -> None:
        checks.instance("profile", self.profile, Profile, "a profile from contactstudy.profiles")
        super().__post_init__()

    @property
    def end_drop(self) -> float:
        """Larger drop at the two starts of the corners, metres."""
        return max(self._create_corner(side).drop for side in (-1, 1))

    def __repr__(self) -> str:
        length, drop = (format_quantity(value, "m") for value in (self.effective_length, self.end_drop))
        return f"EffectiveLength({describe_profile(self.profile)}, effective_length={length}, drop {drop} at its end)"

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        half_length = 0.5 * length
        if 0.5 * self.effective_length > half_length * (1 + 1e-12):
            allowed = f"at most the roller's length, {length:g} m"
            raise InvalidInputError("effective_length", self.effective_length, allowed)
        x = np.asarray(x)
        first, last = self._create_corner(-1), self._create_corner(1)
        drops = check_drop(self.profile, np.clip(x, -first.start, last.start), self.effective_length)
        for side, corner in ((-1, first), (1, last)):
            width = max(half_length - corner.start, 0.0)
            if width == 0:
                continue
            offset = np.clip(side * x - corner.start, 0.0, width)
            radius = width / (1 - corner.sine)
            chord = np.minimum(corner.sine * radius + offset, radius)
            # R cos - sqrt(R**2 - chord**2) without cancellation: exactly 0 at the start of the corner.
            denominator = radius * corner.cosine + np.sqrt((radius - chord) * (radius + chord))
            drops = drops + offset * (2 * corner.sine * radius + offset) / denominator
        return drops

    def _create_corner(self, side: int) -> Corner:
        """Return the corner at the end of smaller (-1) or larger (1) x."""
        length = self.effective_length
        half_length, step = 0.5 * length, SLOPE_STEP * length

        def drops(*distances: float) -> FloatArray:
            return check_drop(self.profile, side * np.array(distances), length)

        drop, inner = drops(half_length, half_length - step)
        if np.isfinite(drop):
            slope = float(np.clip((drop - inner) / step, 0.0, MAX_SLOPE))
            return Corner(half_length, float(drop), slope / float(np.hypot(1, slope)), 1 / float(np.hypot(1, slope)))
        low, high = 0.0, half_length
        for _ in range(60):  # Bisections for the position of the steepest slope
            midpoint = 0.5 * (low + high)
            width = SLOPE_STEP * (half_length - midpoint)
            inner_drop, outer_drop = drops(midpoint - width, midpoint)
            low, high = (midpoint, high) if outer_drop - inner_drop < MAX_SLOPE * width else (low, midpoint)
        return Corner(low, float(drops(low)[0]), np.sqrt(0.5), np.sqrt(0.5))

    def nodes(self, length: float) -> SlopeJumps:
        """Nodes of the profile."""
        return as_shape(self.profile).nodes(self.effective_length)

    def second_interpolation(self) -> EffectiveLength | None:
        """Profile with the second interpolation of its measured points."""
        variant = as_shape(self.profile).second_interpolation()
        return EffectiveLength(variant, self.effective_length) if variant else None

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m): the profile's, constant over the corners."""
        half = 0.5 * self.effective_length
        return local_radius(self.profile, np.clip(x, -half, half), self.effective_length, radius)
