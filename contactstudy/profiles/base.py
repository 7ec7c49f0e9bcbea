"""Interface of profiles: drop, local radius, corners, samples, and addition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import Field, dataclass, fields, is_dataclass
from itertools import chain
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

# Units of the parameters of profiles other than lengths
UNITS = {"half_angle": "rad", "angle": "rad", "delta": "1", "k1": "1", "k2": "1"}
UNIT_WORDS = {"m": "metres", "rad": "radians", "1": ""}  # Words for the units in messages
# Metadata of the numbers among the fields of a profile: the check of the value
FINITE, NOT_NEGATIVE, POSITIVE = ({"check": check} for check in (checks.finite, checks.not_negative, checks.positive))
MIN_JUMP = 1e-6  # Minimum jump of a slope at a corner, of a formula over one plus the slope, because of rounding
# Windows and rounds of the search for corners, and least ratio of the jumps in the last two rounds; a bend has 1/4
WINDOWS, ROUNDS, MIN_JUMP_RATIO = 512, 6, 0.75


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


def find_slope_jumps(drop: Callable[[FloatArray], FloatArray], length: float) -> SlopeJumps:
    """Find the corners of a generatrix: the slope changes by as much between closer points."""
    edges = 0.5 * length * np.sin(np.linspace(-0.5, 0.5, WINDOWS + 1)[1:-1] * np.pi)  # denser at the ends
    centres, step, jumps = 0.5 * (edges[:-1] + edges[1:]), 0.5 * np.diff(edges), np.zeros(WINDOWS - 2)
    for _ in range(ROUNDS):
        step = step / 4
        x = centres[:, None] + step[:, None] * np.arange(-6, 7)
        with np.errstate(invalid="ignore"):  # infinite drops
            slopes = np.diff(drop(x.ravel()).reshape(x.shape)) / step[:, None]
            changes = np.nan_to_num(np.diff(slopes), posinf=0.0)
        sums = sliding_window_view(changes, 3, axis=1).sum(axis=2)  # a corner contributes to two neighbours at most
        largest = np.abs(sums).argmax(axis=1)[:, None]
        nodes, previous_jumps = largest + np.arange(3), jumps
        jumps = np.take_along_axis(sums, largest, axis=1)[:, 0]
        x = np.take_along_axis(x, nodes + 1, axis=1)
        centres = x[:, 1]
    min_jumps = MIN_JUMP * (1 + np.abs(slopes[:, 0]))
    is_corner = np.abs(jumps) > np.maximum(MIN_JUMP_RATIO * np.abs(previous_jumps), min_jumps)
    weighted_x = (x * np.take_along_axis(changes, nodes, axis=1)).sum(axis=1)
    positions, jumps = weighted_x[is_corner] / jumps[is_corner], jumps[is_corner]
    is_first = np.diff(positions, prepend=-np.inf) > 4 * step[is_corner]  # neighbouring windows may share a corner
    return SlopeJumps(positions[is_first], jumps[is_first])


class Shape:
    """Base of the profiles of this package: defines ``+``, the radius across the roller, corners and samples.

    A user's class needs only ``drop(x, length)``. A class derived from `Shape` can be a summand and override these
    methods.
    """

    def __post_init__(self) -> None:
        """Check the numbers among the fields and store them as floats."""
        for entry in self._entries():
            value, check = getattr(self, entry.name), entry.metadata.get("check")
            if check is not None and not (value is None and entry.default is None):
                unit = UNIT_WORDS[UNITS.get(entry.name, "m")]
                checks.store(self, **{entry.name: check(entry.name, value, unit)})

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
        """Points between which the profile is smooth, with jumps that measured points do not resolve, or 0."""
        return SlopeJumps(np.zeros(0), np.zeros(0))

    def second_interpolation(self) -> Profile | None:
        """Profile through the same measured points by another interpolation; None for a formula."""
        return None

    def __repr__(self) -> str:
        arguments = []  # other than the defaults, in engineering units
        for entry in self._entries():
            value = getattr(self, entry.name)
            if value != entry.default:
                is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
                text = format_quantity(value, UNITS.get(entry.name, "m")) if is_number else describe_profile(value)
                arguments.append(f"{entry.name}={text}")
        return f"{type(self).__name__}({', '.join(arguments)})"

    def __add__(self, other: object) -> Sum:
        """Return the sum of both profiles."""
        if not isinstance(other, Profile):
            return NotImplemented
        return Sum((self, other))

    __radd__ = __add__


def unit_of(profile: object, name: str) -> str:
    """Return the unit of a parameter of a profile's class; empty for a user's class or function."""
    is_package_profile = isinstance(profile, type) and issubclass(profile, Shape) and is_dataclass(profile)
    return UNITS.get(name, "m") if is_package_profile and any(entry.name == name for entry in fields(profile)) else ""  # type: ignore[arg-type]


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
    """Sum of profiles, usually written ``first + second``: the drops add up.

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

    def second_interpolation(self) -> Sum | None:
        """Sum with the second interpolation of every measured summand."""
        variants = [as_shape(term).second_interpolation() for term in self.terms]
        if not any(variants):
            return None
        return Sum(tuple(variant or term for variant, term in zip(variants, self.terms, strict=True)))

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m) after every summand in turn."""
        for term in self.terms:
            radius = local_radius(term, x, length, radius)
        return np.asarray(radius)
