"""What every profile can do: a drop, a local radius, and addition."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import Field, dataclass, fields, is_dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.html_table import html_table
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

UNITS = {"half_angle": "rad", "delta": "1", "k1": "1", "k2": "1"}
"""Units of the numbers of profiles that are no lengths."""


@runtime_checkable
class Profile(Protocol):
    """What the solver needs of a profile."""

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; ``|x| <= length / 2``."""
        ...


def in_words(profile: object) -> str:
    """Return what a profile says of itself; of a class of one's own that says nothing its name, not its address."""
    silent = type(profile).__repr__ is object.__repr__
    return f"{type(profile).__name__}()" if silent else repr(profile)


class Shape:
    """Base of the profiles of this package: gives them ``+`` and a radius across.

    A class of one's own needs only ``drop(x, length)``; derived from this one it can be a summand, and may have a
    radius that varies along the roller.
    """

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        raise NotImplementedError

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius of curvature across the roller (m) at `x`, for a roller with `radius` at mid-length: the same."""
        return np.broadcast_to(np.asarray(radius, dtype=np.float64), np.shape(x))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={text}' for name, text in self._said())})"

    def _repr_html_(self) -> str:
        rows = [(name.replace("_", " "), text) for name, text in self._said()]
        return html_table([(type(self).__name__, rows)])

    def _said(self) -> Iterator[tuple[str, str]]:
        """Values that are not the default ones, in the units of engineers."""
        entries: tuple[Field[object], ...] = fields(self) if is_dataclass(self) else ()
        for entry in entries:
            value = getattr(self, entry.name)
            if value != entry.default:
                number = isinstance(value, (int, float)) and not isinstance(value, bool)
                yield entry.name, quantity(value, UNITS.get(entry.name, "m")) if number else in_words(value)

    def __add__(self, other: object) -> Sum:
        """Both profiles on one roller."""
        if not isinstance(other, Profile):
            return NotImplemented
        return Sum((*_terms(self), *_terms(other)))

    __radd__ = __add__


def unit_of(profile: object, name: str) -> str:
    """Return the unit of a number of a profile's class; it is empty for a class or function of one's own.

    Examples
    --------
    >>> from contactstudy.profiles import FujiwaraKawase
    >>> [unit_of(FujiwaraKawase, name) for name in ("amplitude", "k1", "other")], unit_of(lambda k1: None, "k1")
    (['m', '1', ''], '')
    """
    own = isinstance(profile, type) and issubclass(profile, Shape) and is_dataclass(profile)
    return UNITS.get(name, "m") if own and any(entry.name == name for entry in fields(profile)) else ""  # type: ignore[arg-type]


def _terms(profile: Shape | Profile) -> tuple[Profile, ...]:
    """Summands of a profile; itself unless it is a sum."""
    return profile.terms if isinstance(profile, Sum) else (profile,)


def local_radius(profile: Profile, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
    """Radius of curvature across the roller (m) at distances `x` from mid-length.

    Parameters
    ----------
    profile : Profile
        Any profile; one that says nothing of it leaves `radius` as it is.
    x : array
        Distances from mid-length, metres.
    length : float
        Length of the roller, metres.
    radius : float or array
        Radius at mid-length (or, in a sum, what the other summands make of it), metres.

    Returns
    -------
    array
        Of the shape of `x`, metres.
    """
    if isinstance(profile, Shape):
        return profile.local_radius(x, length, radius)
    return Shape().local_radius(x, length, radius)


def checked_drop(profile: Profile, x: FloatArray, length: float) -> FloatArray:
    """Drop (m) of any profile at distances `x` from mid-length, or an error if it is not one number for each.

    Parameters
    ----------
    profile : Profile
        Any profile, a class of one's own among them.
    x : array
        Distances from mid-length, metres.
    length : float
        Length of the roller, metres.

    Returns
    -------
    array
        Of the shape of `x`, metres; may be infinite.

    Raises
    ------
    InvalidInputError
        If what the profile returns has another shape, is not real, or is negative or NaN somewhere.
    """
    found = np.asarray(profile.drop(x, length))
    expected = "a profile whose drop(x, length) is an array like x, metres, not negative"
    if found.shape != x.shape or found.dtype.kind not in "iuf":
        raise InvalidInputError("profile", profile, expected, f"it returned {found.dtype} of shape {found.shape}")
    wrong = np.flatnonzero(~(found >= 0))
    if wrong.size:
        where = f"it returned {found[wrong[0]]} at x = {x[wrong[0]]:g} m"
        raise InvalidInputError("profile", profile, expected, where)
    return np.asarray(found, dtype=np.float64)


@dataclass(frozen=True, repr=False)
class Sum(Shape):
    """Profiles on top of each other, usually written ``one + other``: the drops add up.

    Parameters
    ----------
    terms : tuple of Profile
        At least one. Each must be valid for the roller's length.

    Raises
    ------
    InvalidInputError
        If there is no summand, or one is not a profile.

    Notes
    -----
    Every summand is counted from its own highest point, so a sum is nowhere negative. Where the highest points differ
    (a crown and a measured waviness) the sum is positive everywhere, and the approach of a contact, which is counted
    from drop 0, contains that constant.

    Examples
    --------
    >>> from contactstudy.profiles import Cylinder, FullCrown
    >>> crowned = FullCrown(crown_radius=1.25) + Cylinder(fillet_radius=1e-3)
    >>> (1e6 * crowned.drop(np.array([0.0, 4e-3, 5e-3]), length=10e-3)).round(1).tolist()
    [0.0, 6.4, 1010.0]
    """

    terms: tuple[Profile, ...]

    def __post_init__(self) -> None:
        """Check the summands."""
        if not isinstance(self.terms, tuple) or not self.terms:
            raise InvalidInputError("terms", self.terms, "a tuple of at least one profile")
        for term in self.terms:
            checks.instance("terms", term, Profile, "profiles from contactstudy.profiles")

    def __repr__(self) -> str:
        return " + ".join(map(in_words, self.terms))

    def _said(self) -> Iterator[tuple[str, str]]:
        """Summands."""
        yield from (("and" if number else "sum of", in_words(term)) for number, term in enumerate(self.terms))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Sum of the drops (m) at distances `x` (m) from mid-length."""
        drops = [checked_drop(term, np.asarray(x), length) for term in self.terms]
        return np.asarray(sum(drops[1:], start=drops[0]))

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m) after every summand in turn."""
        for term in self.terms:
            radius = local_radius(term, x, length, radius)
        return np.asarray(radius)
