"""One parameter of a study, and the checks of its values."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contactstudy import checks
from contactstudy.errors import InvalidInputError
from contactstudy.study.numbers import number, rounded
from contactstudy.study.profile_kinds import profile_table

# Most points that a table {start, stop, count} may ask for: a wrong digit asks for many more.
MOST_POINTS = 100_000

Check = Callable[[str, object], Any]


def flag(name: str, value: object) -> bool:
    """Return True or False."""
    checks.instance(name, value, (bool, np.bool_), "true or false")
    return bool(value)


def one_of(known: Iterable[str]) -> Check:
    """Return the check of a word that must be one of `known`."""
    names = tuple(known)

    def word(name: str, value: object) -> str:
        checks.instance(name, value, str, "text")
        return checks.known_name(name, str(value), names)

    return word


def profile(name: str, value: object) -> dict[str, Any]:
    """Return a profile's table with all its numbers rounded."""
    return {key: _rounded_within(entry) for key, entry in profile_table(value).items()}


def _rounded_within(entry: Any) -> Any:
    """Return an entry of a profile's table with all its numbers rounded."""
    if isinstance(entry, float):
        return rounded(entry)
    if isinstance(entry, list):
        return [_rounded_within(part) for part in entry]
    if isinstance(entry, dict):
        return {key: _rounded_within(part) for key, part in entry.items()}
    return entry


def points(name: str, value: object) -> list[float]:
    """Return points given as a list, or as a table {start, stop, count} of evenly spaced ones."""
    if isinstance(value, Mapping):
        for key in value:
            checks.known_name(f"{name} key", str(key), ("start", "stop", "count"))
        missing = {"start", "stop", "count"} - set(value)
        if missing:
            raise InvalidInputError(name, dict(value), "a list, or a table with start, stop and count")
        start, stop = (checks.finite(f"{name}.{key}", value[key]) for key in ("start", "stop"))
        count = checks.count(f"{name}.count", value["count"])
        if count > MOST_POINTS:
            raise InvalidInputError(f"{name}.count", count, f"at most {MOST_POINTS}")
        listed = np.linspace(start, stop, count)
    else:
        listed = checks.coordinates(name, value, "half-widths a")
    return [number(name, point) for point in listed.tolist()]


@dataclass(frozen=True)
class Parameter:
    """Specification of one parameter.

    Parameters
    ----------
    name : str
        As in a study.
    check : callable
        Takes name and value; returns the value in the form that counts for the identity, or raises.
    units : str
        Unit; empty for a word.
    meaning : str
        For the reader: comment of the coordinate, and the documentation.
    taker : callable, optional
        Has a keyword argument of this name: its default is the parameter's, and the value is handed on to it.
    fallback : object
        Default of a parameter without a taker; None: there is none, or it may be left out.
    absent : str
        For the documentation: what it is to leave out a parameter without a default.
    note : str
        For the documentation: what to know beside the meaning.
    label : str
        Long name of the coordinate, short enough for an axis; default: the name.
    """

    name: str
    check: Check
    units: str
    meaning: str
    taker: Callable[..., Any] | None = None
    fallback: Any = None
    absent: str = ""
    note: str = ""
    label: str = ""

    @property
    def attrs(self) -> dict[str, str]:
        """Attributes of the coordinate in a Dataset."""
        said = {"units": self.units, "long_name": self.label or self.name.replace("_", " "), "comment": self.meaning}
        return {name: text for name, text in said.items() if text}

    def checked(self, value: object) -> Any:
        """Return a value in the form that counts for the identity; a scalar that says its unit is converted first."""
        return self.check(self.name, checks.scalar(self.name, value, self.units))

    @cached_property
    def default(self) -> Any:
        """Value of a case that does not give the parameter; None if there is none, or it may be left out."""
        value = self.fallback
        if self.taker is not None:
            value = inspect.signature(self.taker).parameters[self.name].default
        return None if value is None else self.check(self.name, value)
