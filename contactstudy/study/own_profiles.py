"""Profiles of the user's own in a study: known by their content, stated in its files, and sent to its workers.

A file cannot hold the code of a class. It states the class, its values and a digest of both with the drops that it
gives; the object itself goes to workers as a pickle, and is never read from a file.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.profiles import Profile, Shape
from contactstudy.profiles.base import checked_drop, in_words, local_radius

KIND = "own"
"""Kind of a profile whose class is the user's."""

KEYS = ("class", "values", "content")
"""Keys of its table: name of the class, its values, and the digest that tells it from others."""

LENGTHS = (1e-4, 1e-3, 1e-2, 1e-1)
"""Lengths of roller, metres, for which drops count for the content; a profile need not be valid for all."""

POINTS = 1001
"""Points of each length at which drops count for the content, closer to each other towards the ends."""

DIGITS = 9
"""Digits of a drop that count: other processors round others."""

MOST_LISTED = 100
"""Numbers of an array that a file states one by one; of more it states the digest."""

INSTEAD = "give its values as numbers, texts or lists, or the shape as profiles.Measured(x, drop)"

_pickles: dict[str, bytes] = {}
"""Pickled profiles of this process, by content: copies, which nobody can change later."""


@dataclass(frozen=True, repr=False)
class Unknown(Shape):
    """A profile that a file names and this process has not got: enough to plan and to open a study, not to solve it.

    Parameters
    ----------
    content : str
        Its digest.
    """

    content: str

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Return zeros, for nothing is known of it."""
        return np.zeros(np.shape(x))


def own_table(profile: Profile) -> dict[str, Any]:
    """Table of a profile of the user's own, which this process knows from then on.

    Parameters
    ----------
    profile : Profile
        An object of any class.

    Raises
    ------
    InvalidInputError
        If it cannot be told from others by its values, or cannot be pickled for workers.

    Examples
    --------
    >>> class Wedge:
    ...     def __init__(self, slope):
    ...         self.slope = slope
    ...     def drop(self, x, length):
    ...         return self.slope * np.abs(x)
    >>> table = own_table(Wedge(1e-4))
    >>> table["class"], table["values"], table["content"] == own_table(Wedge(2e-4))["content"]
    ('Wedge', {'slope': 0.0001}, False)
    """
    name = type(profile).__qualname__.split("<locals>.")[-1]
    values = {key: _plain(f"profile.{key}", value) for key, value in _attributes(profile)}
    content = _digest([name, values, _behaviour(profile)])
    if content not in _pickles:
        _pickles[content] = _pickled(profile, name, content)
    silent = type(profile).__repr__ is object.__repr__
    said = f"{name} {content[:8]}" if silent else in_words(profile)
    return {"kind": KIND, "name": said, "class": name, "values": values, "content": content}


def read_table(table: Mapping[str, Any]) -> dict[str, Any]:
    """Check the keys of a table that a file holds."""
    for key in table:
        checks.known_name("profile key", str(key), [*KEYS, "kind", "name"])
    for key, kind in (("class", str), ("content", str), ("values", Mapping)):
        checks.instance(f"profile.{key}", table.get(key), kind, "what a study wrote for an own profile")
    return {key: table[key] for key in KEYS}


def own_profile(content: str) -> Profile:
    """Profile of a content; Unknown if this process has not got it."""
    return _unpickled(_pickles[content]) if content in _pickles else Unknown(content)


def pickles_of(parameters: Mapping[str, Any]) -> dict[str, bytes]:
    """Pickles of the own profiles within parameters, for a worker.

    Raises
    ------
    InvalidInputError
        If this process has not got one of them.
    """
    found = {}
    for table in _own_within(parameters):
        if table["content"] not in _pickles:
            raise InvalidInputError(
                "profile",
                f"{table['class']} {table['content'][:8]}",
                "known to solve a case with it: its class is not in the study's files",
                "run the study from the script that makes this profile; opening it needs none",
            )
        found[table["content"]] = _pickles[table["content"]]
    return found


def receive(pickles: Mapping[str, bytes]) -> None:
    """Make profiles known to this process, a worker, as another one sent them."""
    _pickles.update(pickles)


def _own_within(value: Any) -> Iterator[Mapping[str, Any]]:
    """Tables of own profiles anywhere within plain values."""
    if isinstance(value, Mapping):
        if value.get("kind") == KIND:
            yield value
            return
        value = list(value.values())
    if isinstance(value, (list, tuple)):
        for entry in value:
            yield from _own_within(entry)


def _attributes(profile: Profile) -> Iterable[tuple[str, Any]]:
    """Values that a profile was made with: fields of a dataclass, or whatever it keeps."""
    kind: Any = type(profile)
    if is_dataclass(kind):
        return [(entry.name, getattr(profile, entry.name)) for entry in fields(kind)]
    kept: dict[str, Any] = dict(getattr(profile, "__dict__", {}))
    slots = [name for base in kind.__mro__ for name in getattr(base, "__slots__", ())]
    return sorted((kept | {name: getattr(profile, name) for name in slots if hasattr(profile, name)}).items())


def _plain(name: str, value: object) -> Any:
    """Return a value of a profile as JSON has it, or raise."""
    if isinstance(value, np.ndarray) and value.size > MOST_LISTED:
        return f"{value.size} values {_digest(_plain(name, value.tolist()))[:16]}"
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if value is None or isinstance(value, (bool, str, int)):
        return value
    if isinstance(value, float):
        return float(f"{value:.12g}") if np.isfinite(value) else repr(value)
    if isinstance(value, (list, tuple)):
        return [_plain(name, entry) for entry in value]
    if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        return {key: _plain(f"{name}.{key}", entry) for key, entry in value.items()}
    if isinstance(value, Profile):
        return {"class": type(value).__qualname__} | {
            key: _plain(f"{name}.{key}", entry) for key, entry in _attributes(value)
        }
    raise InvalidInputError(
        name,
        value,
        f"a number, a text, a list or a profile, by which a study tells this profile from others, not "
        f"{type(value).__name__}",
        INSTEAD,
    )


def _behaviour(profile: Profile) -> list[Any]:
    """Return drops and radii of a profile, rounded, for every length that it is valid for."""
    found: list[Any] = []
    refused: Exception | None = None
    for length in LENGTHS:
        x = -0.5 * length * np.cos(np.linspace(0.0, np.pi, POINTS))
        try:
            drops, radii = checked_drop(profile, x, length), local_radius(profile, x, length, length)
        except (ContactStudyError, ArithmeticError, ValueError) as error:
            refused = error
            found.append(None)
            continue
        found.append([f"{value:.{DIGITS}g}" for value in [*(drops + 0.0), *radii]])
    if not any(found):
        raise InvalidInputError(
            "profile",
            profile,
            f"an object whose drop(x, length) is valid for a roller of {', '.join(f'{each:g}' for each in LENGTHS)} m, "
            "at least one of them",
            str(refused),
        )
    return found


def _digest(content: object) -> str:
    """SHA-256 of plain values."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _pickled(profile: Profile, name: str, content: str) -> bytes:
    """Pickle of a profile that gives the same one again, or an error."""
    import cloudpickle  # type: ignore[import-untyped]

    try:
        pickled = bytes(cloudpickle.dumps(profile))
        copy = _unpickled(pickled)
    except Exception as error:  # whatever a class of the user's raises
        raise _not_sent(name, f"{type(error).__name__}: {error}") from error
    values = {key: _plain(f"profile.{key}", value) for key, value in _attributes(copy)}
    if _digest([name, values, _behaviour(copy)]) != content:
        raise _not_sent(name, "its copy is another profile")
    return pickled


def _not_sent(name: str, reason: str) -> InvalidInputError:
    """Error of a profile that workers cannot be given."""
    return InvalidInputError("profile", name, f"an object that can be pickled for workers ({reason})", INSTEAD)


@lru_cache(maxsize=256)
def _unpickled(pickled: bytes) -> Profile:
    """Profile from its pickle, which this process or the one that sent it made."""
    import pickle

    found: Profile = pickle.loads(pickled)
    return found
