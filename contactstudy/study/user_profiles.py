"""Profiles of a user's class in a study: identity by content, transport to workers.

A file cannot contain the code of a class. The files of a study contain the name of the class, the values of the object
and a digest of values and drops; the object goes to workers as a pickle. Other processes can plan and open the study.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from contactstudy import checks
from contactstudy.case.serialization import tables_within
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.profiles import Profile
from contactstudy.profiles.base import check_drop, describe_profile, local_radius

KIND = "user"  # Kind of a profile of a user's class
KEYS = ("class", "values", "content")  # class name, values, identity of the object
LENGTHS = (1e-4, 1e-3, 1e-2, 1e-1)  # metres, of which drops enter the digest; a profile may be invalid for some
MAX_LISTED_SIZE = 100  # Largest array that a file lists; a digest represents a larger array
REMEDY = "give its values as numbers, texts or lists, or the shape as profiles.Measured(x, drop)"

DIGITS = 12  # Significant digits of a number in a study, beyond rounding

REGISTRY: dict[str, Profile] = {}  # copies by content; changes of the user's objects do not change them


def register(profile: Profile) -> dict[str, Any]:
    """Add a copy of a user's profile to this process' registry; return its table."""
    name = type(profile).__qualname__.split("<locals>.")[-1]
    values = _values(profile)
    content = _digest([name, values, _behaviour(profile)])
    if content not in REGISTRY:
        REGISTRY[content] = _copy_by_pickle(profile, name, content)
    has_default_repr = type(profile).__repr__ is object.__repr__
    label = f"{name} {content[:8]}" if has_default_repr else describe_profile(profile)
    return {"kind": KIND, "name": label, "class": name, "values": values, "content": content}


def read_table(table: Mapping[str, Any]) -> dict[str, Any]:
    """Check the table of a file."""
    for key in table:
        checks.known_name("profile key", str(key), [*KEYS, "kind", "name"])
    for key, kind in (("class", str), ("content", str), ("values", Mapping)):
        checks.instance(f"profile.{key}", table.get(key), kind, "the content of a user's profile, written by a study")
    return {key: table[key] for key in KEYS}


def user_profiles(parameters: Any) -> dict[str, Profile]:
    """Users' profiles within parameters of cases, by content, for a worker; raises if this process lacks a profile."""
    profiles = {}
    for table in tables_within(parameters):
        if table["kind"] != KIND:
            continue
        if table["content"] not in REGISTRY:
            allowed = "made by the running script: its class is not in the study's files"
            hint = "run the study from the script that makes this profile; opening it needs none"
            raise InvalidInputError("profile", f"{table['class']} {table['content'][:8]}", allowed, hint)
        profiles[table["content"]] = REGISTRY[table["content"]]
    return profiles


def _values(profile: Profile, name: str = "profile") -> dict[str, Any]:
    """JSON values of the fields of a dataclass, or of the attributes of another object."""
    kind: Any = type(profile)
    if is_dataclass(kind):
        names = [entry.name for entry in fields(kind)]
    else:
        slots = [slot for base in kind.__mro__ for slot in getattr(base, "__slots__", ())]
        names = sorted({*getattr(profile, "__dict__", {}), *(slot for slot in slots if hasattr(profile, slot))})
    return {key: _json_value(f"{name}.{key}", getattr(profile, key)) for key in names}


def round_digits(value: float) -> float:
    """Return `value` rounded to twelve significant digits; minus zero becomes zero."""
    return float(f"{value:.{DIGITS}g}") + 0.0


def _json_value(name: str, value: object) -> Any:
    """JSON value of an attribute."""
    if isinstance(value, np.ndarray) and value.size > MAX_LISTED_SIZE:
        return f"{value.size} values {_digest(_json_value(name, value.tolist()))[:16]}"
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if value is None or isinstance(value, (bool, str, int)):
        return value
    if isinstance(value, float):
        return round_digits(value) if np.isfinite(value) else repr(value)
    if isinstance(value, (list, tuple)):
        return [_json_value(name, entry) for entry in value]
    if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        return {key: _json_value(f"{name}.{key}", entry) for key, entry in value.items()}
    if isinstance(value, Profile):
        return {"class": type(value).__qualname__, **_values(value, name)}
    allowed = f"a number, a text, a list or a profile, which identify the profile, not {type(value).__name__}"
    raise InvalidInputError(name, value, allowed, REMEDY)


def _behaviour(profile: Profile) -> list[Any]:
    """Return drops and radii for every valid length, in 9 digits, because processors differ in rounding."""
    drops_and_radii: list[Any] = []
    last_error: Exception | None = None
    for length in LENGTHS:
        x = -0.5 * length * np.cos(np.linspace(0.0, np.pi, 1001))
        try:
            drops, radii = check_drop(profile, x, length), local_radius(profile, x, length, length)
        except (ContactStudyError, ArithmeticError, ValueError) as error:
            last_error = error
            drops_and_radii.append(None)
            continue
        drops_and_radii.append([f"{value:.9g}" for value in [*(drops + 0.0), *radii]])
    if not any(drops_and_radii):
        lengths = ", ".join(f"{length:g}" for length in LENGTHS)
        allowed = f"an object whose drop(x, length) is valid for a roller of {lengths} m, at least one of them"
        raise InvalidInputError("profile", profile, allowed, str(last_error))
    return drops_and_radii


def _digest(content: object) -> str:
    """SHA-256 of JSON values."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _copy_by_pickle(profile: Profile, name: str, content: str) -> Profile:
    """Copy of a profile by its pickle, as in a worker."""
    import pickle

    import cloudpickle  # type: ignore[import-untyped]

    requirement = "an object that can be pickled for workers ({})"
    try:
        profile_copy: Profile = pickle.loads(cloudpickle.dumps(profile))
        content_of_copy = _digest([name, _values(profile_copy), _behaviour(profile_copy)])
    except Exception as error:  # a user's class may raise anything
        reason = f"{type(error).__name__}: {error}"
        raise InvalidInputError("profile", name, requirement.format(reason), REMEDY) from error
    if content_of_copy != content:
        raise InvalidInputError("profile", name, requirement.format("its copy is another profile"), REMEDY)
    return profile_copy
