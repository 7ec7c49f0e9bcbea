"""Interface of profiles, and composite profiles: sums, two halves, a profile over the effective length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import Field, dataclass, field, fields, is_dataclass, replace
from itertools import chain
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

POSITIVE_LENGTH = checks.number(checks.positive, "metres")
NOT_NEGATIVE_LENGTH = checks.number(checks.not_negative, "metres")
MIN_JUMP = 1e-6  # Minimum jump of the slope at a corner, over one plus the slope. Rounding.
CELLS, SUBCELLS, ROUNDS = 1024, 16, 3  # Search for corners: cells, subcells of a cell in each round, rounds. Accuracy.
MIN_JUMP_RATIO = 3.0  # Minimum jump at a corner over the changes of the slope on both sides; a bend has 0. Accuracy.
SLOPE_STEP = 1e-6  # Step of the differences for a slope, over the length. Accuracy.
MAX_SLOPE = 1.0  # Maximum slope of the profile where a corner starts; logarithmic ends are steeper. Physics.


@runtime_checkable
class Profile(Protocol):
    """Interface that the solver requires of a profile."""

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; ``|x| <= length / 2``."""
        ...


def describe_profile(profile: object) -> str:
    """Return the repr of a profile, or the class name of a user's class without a repr."""
    has_no_repr = type(profile).__repr__ is object.__repr__
    return f"{type(profile).__name__}()" if has_no_repr else repr(profile)


class SlopeJumps(NamedTuple):
    """Corners of a generatrix."""

    positions: FloatArray  # from mid-length, m
    jumps: FloatArray  # increase of the slope of the drop; positive at a convex corner

    @classmethod
    def join(cls, *corners: SlopeJumps) -> SlopeJumps:
        """Corners of several profiles."""
        return cls(*(np.concatenate(values) for values in zip(*corners, strict=True)))


@np.errstate(invalid="ignore")  # infinite drops
def find_slope_jumps(drop: Callable[[FloatArray], FloatArray], length: float) -> SlopeJumps:
    """Find the corners of a generatrix: subdivide cells with jumps of the slope, then compare both sides' slopes."""
    edges = 0.5 * length * np.sin(np.linspace(-0.5, 0.5, CELLS + 1)[1:-1] * np.pi)  # denser at the ends
    starts, steps = edges[:-1], np.diff(edges)
    for _ in range(ROUNDS):
        steps = steps / SUBCELLS
        x = starts[:, None] + steps[:, None] * np.arange(-2, SUBCELLS + 3)
        slopes = np.diff(drop(x.ravel()).reshape(x.shape)) / steps[:, None]
        # The slopes' third difference is at least half the jump at an end of the corner's subcell, 0 on a parabola.
        has_jump = np.abs(np.diff(slopes, 3)) > 0.5 * MIN_JUMP * (1 + np.abs(slopes[:, :1]))
        cells, subcells = np.nonzero(has_jump[:, :-1] | has_jump[:, 1:])
        starts, steps = x[cells, subcells + 2], steps[cells]
        if not starts.size:
            return SlopeJumps(starts, starts)
    is_new_corner = np.diff(starts, prepend=-np.inf) > 1.5 * steps  # neighbouring subcells share a corner
    low, high = starts[is_new_corner], (starts + steps)[np.roll(is_new_corner, -1)]
    middle, half_width = 0.5 * (low + high), 0.5 * (high - low)
    x = middle[:, None] + half_width[:, None] * np.array([-8, -4, -2, -1, 1, 2, 4, 8])
    drops = drop(x.ravel()).reshape(x.shape)
    slopes = np.diff(drops) / np.diff(x)
    left_slopes, right_slopes = slopes[:, 2], slopes[:, 4]
    jumps = (4 * (right_slopes - left_slopes) - slopes[:, 6] + slopes[:, 0]) / 3  # extrapolated to distance 0
    changes = np.abs(left_slopes - slopes[:, 0]) + np.abs(slopes[:, 6] - right_slopes)
    is_corner = np.abs(jumps) > np.maximum(MIN_JUMP * (1 + np.abs(left_slopes)), MIN_JUMP_RATIO * changes)
    tangent_gaps = (left_slopes + right_slopes) * half_width - (drops[:, 4] - drops[:, 3])  # at the midpoint
    return SlopeJumps(middle[is_corner] + tangent_gaps[is_corner] / jumps[is_corner], jumps[is_corner])


class Shape:
    """Base of the profiles of this package: defines ``+``, the radius across the roller, corners and samples.

    A user's class needs only ``drop(x, length)``. A subclass of `Shape` can be a summand and override these methods.
    """

    def __post_init__(self) -> None:
        """Check the numbers among the fields and store them as floats."""
        checks.store_numbers(self)

    def _entries(self) -> tuple[Field[Any], ...]:
        """Fields of a dataclass; none of another class."""
        return fields(self) if is_dataclass(self) else ()

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        raise NotImplementedError

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius of curvature across the roller (m) at `x`, from the `radius` (m) of the preceding summands."""
        return np.broadcast_to(np.asarray(radius, dtype=np.float64), np.shape(x))

    def nodes(self, length: float) -> SlopeJumps:
        """Points between which the profile is smooth, with the slope jumps that measured points do not resolve."""
        return SlopeJumps(np.zeros(0), np.zeros(0))

    def second_interpolation(self) -> Any:
        """Profile with another interpolation of the measured points in it; None without measured points."""
        variants = {entry.name: _second_interpolation(getattr(self, entry.name)) for entry in self._entries()}
        changes = {name: variant for name, variant in variants.items() if variant is not None}
        return replace(self, **changes) if changes else None  # type: ignore[type-var]

    def __repr__(self) -> str:
        arguments = []  # other than the defaults, in engineering units
        for entry in self._entries():
            value = getattr(self, entry.name)
            if value != entry.default:
                is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
                text = format_quantity(value, _unit_of(entry)) if is_number else describe_profile(value)
                arguments.append(f"{entry.name}={text}")
        return f"{type(self).__name__}({', '.join(arguments)})"

    def __add__(self, other: object) -> Sum:
        if not isinstance(other, Profile):
            return NotImplemented
        return Sum((self, other))

    __radd__ = __add__


def _second_interpolation(profile: object) -> Any:
    """Second interpolation of a profile, or of profiles in a tuple; None without measured points."""
    if not isinstance(profile, tuple):
        return profile.second_interpolation() if isinstance(profile, Shape) else None
    variants = [_second_interpolation(term) for term in profile]
    return tuple(variant or term for variant, term in zip(variants, profile, strict=True)) if any(variants) else None


def unit_of(profile: object, name: str) -> str:
    """Return the unit of a parameter of a profile's class; empty for a user's class or function."""
    is_package_profile = isinstance(profile, type) and issubclass(profile, Shape) and is_dataclass(profile)
    entries = fields(profile) if is_package_profile else ()  # type: ignore[arg-type]
    return next((_unit_of(entry) for entry in entries if entry.name == name), "")


def _unit_of(entry: Field[Any]) -> str:
    """SI unit of a field of a profile; m without metadata."""
    unit: str = entry.metadata.get("unit", "metres")
    return checks.SI_UNITS.get(unit, unit)


def local_radius(profile: Profile, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
    """Radius of curvature across the roller (m) at distances `x` from mid-length.

    See :meth:`Shape.local_radius`; a user's class without this method leaves `radius` unchanged.
    """
    return as_shape(profile).local_radius(x, length, radius)


def as_shape(profile: Profile) -> Shape:
    """Return a profile with the methods of `Shape`; a user's class is smooth and without measured points."""
    return profile if isinstance(profile, Shape) else Shape()


def check_drop(profile: Profile, x: FloatArray, length: float) -> FloatArray:
    """Return the drop (m) of a profile at distances `x` from mid-length; raise unless it has a number >= 0 for each."""
    drops = np.asarray(profile.drop(x, length))
    expected = "a profile whose drop(x, length) is an array like x, metres, not negative"
    if drops.shape != x.shape or drops.dtype.kind not in "iuf":
        raise InvalidInputError("profile", profile, expected, f"it returned {drops.dtype} of shape {drops.shape}")
    bad_indices = np.flatnonzero(~(drops >= 0))
    if bad_indices.size:
        reason = f"it returned {drops[bad_indices[0]]} at x = {x[bad_indices[0]]:g} m"
        raise InvalidInputError("profile", profile, expected, reason)
    return np.asarray(drops, dtype=np.float64)


@dataclass(frozen=True, repr=False)
class Sum(Shape):
    """Sum of profiles, usually written ``profile + other``: the drops add up.

    Parameters
    ----------
    terms : tuple of Profile
        At least one profile, valid for the roller's length; a sum counts as its terms.

    Raises
    ------
    InvalidInputError
        If the tuple is empty, or a summand is not a profile.

    Examples
    --------
    >>> from contactstudy.profiles import Cylinder, FullCrown
    >>> crowned = FullCrown(crown_radius=1.25) + Cylinder(fillet_radius=1e-3)
    >>> (1e6 * crowned.drop(np.array([0.0, 4e-3, 5e-3]), length=10e-3)).round(1).tolist()
    [0.0, 6.4, 1010.0]
    """

    terms: tuple[Profile, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.terms, tuple) or not self.terms:
            raise InvalidInputError("terms", self.terms, "a tuple of at least one profile")
        for term in self.terms:
            checks.instance("terms", term, Profile, "profiles from contactstudy.profiles")
        nested_terms = (term.terms if isinstance(term, Sum) else (term,) for term in self.terms)
        checks.store(self, terms=tuple(chain.from_iterable(nested_terms)))

    def __repr__(self) -> str:
        return " + ".join(map(describe_profile, self.terms))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Sum of the drops (m) at distances `x` (m) from mid-length."""
        drops = [check_drop(term, np.asarray(x), length) for term in self.terms]
        return np.asarray(sum(drops[1:], start=drops[0]))

    def nodes(self, length: float) -> SlopeJumps:
        """Nodes of all summands."""
        return SlopeJumps.join(*(as_shape(term).nodes(length) for term in self.terms))

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m), which each summand in turn may change."""
        for term in self.terms:
            radius = local_radius(term, x, length, radius)
        return np.asarray(radius)


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
        # The largest step between both halves at mid-length is about one atom, in metres.
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

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m) of each half."""
        left_radius, right_radius = (local_radius(half, x, length, radius) for half in (self.left, self.right))
        return np.asarray(np.where(np.asarray(x) < 0, left_radius, right_radius))


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
    effective_length: float = field(metadata=POSITIVE_LENGTH)

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
        low_corner, high_corner = self._create_corner(-1), self._create_corner(1)
        drops = check_drop(self.profile, np.clip(x, -low_corner.start, high_corner.start), self.effective_length)
        for side, corner in ((-1, low_corner), (1, high_corner)):
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

        drop, inner_drop = drops(half_length, half_length - step)
        if np.isfinite(drop):
            slope = float(np.clip((drop - inner_drop) / step, 0.0, MAX_SLOPE))
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

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m): the profile's, constant over the corners."""
        half_length = 0.5 * self.effective_length
        return local_radius(self.profile, np.clip(x, -half_length, half_length), self.effective_length, radius)
