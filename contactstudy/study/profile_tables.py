"""Profiles as tables in a study: ``kind`` and the fields of the class, nested where a profile consists of profiles.

A new profile becomes available to studies by an entry in :data:`PROFILES`. A file cannot contain the code of a user's
class. The files of a study contain its name, the values of the object and a digest of values and drops; the object goes
to workers as a pickle. Other processes can plan and open the study.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from contactstudy import checks, profiles
from contactstudy.arrays.engineering import format_quantity
from contactstudy.bodies import hertz
from contactstudy.case.serialization import Sampled, tables_within
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.profiles import Profile
from contactstudy.profiles.base import check_drop, describe_profile, local_radius, unit_of

Table = dict[str, Any]
MAX_NESTING = 16  # Largest depth of profiles within profiles
MAX_POINTS = 50_000  # Largest number of points of a measured profile
DESIGN_KEYS = ("design_pressure", "design_load")  # determine the amplitude: Pa, and N on the roller
POINT_KEYS = ("positions", "drops")  # Fields that contain lists of lengths
NESTED_KEYS = ("left", "right", "profile")  # Fields that contain a profile
FILE_FLAGS = ("remove_tilt", "remove_offset")
FILE_OPTIONS = ("file", *FILE_FLAGS, "turn")  # Keys of a measured profile that is read from a file
MIN_MAGNITUDE = 1 / checks.MAX_MAGNITUDE
USER_KIND = "user"  # Kind of a profile of a user's class
USER_KEYS = ("class", "values", "content")  # class name, values, identity of the object
DIGEST_LENGTHS = (1e-4, 1e-3, 1e-2, 1e-1)  # roller lengths, metres, whose drops enter the digest
MAX_LISTED_SIZE = 100  # Largest array that a file lists; a digest represents a larger array
REMEDY = "give its values as numbers, texts or lists, or the shape as profiles.Measured(x, drop)"
DIGITS = 12  # Significant digits of a number in a study, beyond rounding
REGISTRY: dict[str, Profile] = {}  # copies by content; changes of the user's objects do not change them


def round_digits(value: float) -> float:
    """Return `value` rounded to twelve significant digits; minus zero becomes zero."""
    return float(f"{value:.{DIGITS}g}") + 0.0


def check_number(name: str, value: object) -> float:
    """Return a finite number of limited size, rounded."""
    number = checks.finite(name, value)
    if 0 < abs(number) < MIN_MAGNITUDE:
        raise InvalidInputError(name, value, f"0, or of a size from {MIN_MAGNITUDE:g} on", "units are SI")
    return round_digits(number)


class Dimensions(NamedTuple):
    """Interdependent lengths of a case, metres, and the contact modulus, Pa."""

    radius: float
    body_length: float
    roller_length: float
    end_distance: float
    half_width: float
    modulus: float

    @classmethod
    def of(cls, values: Mapping[str, Any], modulus: float) -> Dimensions:
        """Dimensions of a case; under a load, ``a`` and length depend on each other; at an approach, ``a`` is NaN."""
        radius = checks.positive("radius", values["radius"], "metres")

        def compute_dimensions(half_width: float) -> Dimensions:
            distance = values["end_distance"] if "end_distance" in values else values["e_over_a"] * half_width
            if "gamma" in values:
                body_length = checks.positive("gamma", values["gamma"]) * radius
                roller_length = body_length - 2 * distance
            else:
                roller_length = values["roller_length"]
                body_length = roller_length + 2 * distance
            return cls(radius, body_length, roller_length, distance, half_width=half_width, modulus=modulus)

        if "max_pressure" in values:
            pressure = checks.positive("max_pressure", values["max_pressure"], "Pa")
            return compute_dimensions(hertz.line_half_width(pressure, radius, modulus))._check_lengths()
        if "approach" in values:
            return compute_dimensions(np.nan)._check_lengths()
        load, dimensions = checks.positive("load", values["load"], "N"), compute_dimensions(0.0)._check_lengths()
        for _ in range(500):
            length, previous_half_width = min(dimensions.body_length, dimensions.roller_length), dimensions.half_width
            if length <= 0:
                break
            pressure = hertz.line_max_pressure(load / length, radius, modulus)
            dimensions = compute_dimensions(hertz.line_half_width(pressure, radius, modulus))
            if abs(dimensions.half_width - previous_half_width) <= 1e-14 * dimensions.half_width:
                return dimensions._check_lengths()
        raise InvalidInputError("load", load, "small enough for a roller of positive length at this e_over_a")

    def _check_lengths(self) -> Dimensions:
        """Return the dimensions, or raise if a length is not positive."""
        for name, length in (("roller length", self.roller_length), ("body length", self.body_length)):
            if length <= 0:
                hint = f"e = {self.end_distance:g} m" + (f", a = {self.half_width:g} m" if self.half_width > 0 else "")
                raise InvalidInputError(name, length, "positive (metres)", hint)
        return self


@dataclass(frozen=True)
class ProfileKind:
    """Class of a profile, whose fields are the keys of its table."""

    profile_class: Any  # the dataclass
    design_fields: tuple[str, ...] = ()  # fields that follow from DESIGN_KEYS by the class' for_pressure or for_load
    radius_multiples: Mapping[str, float] = field(default_factory=dict)  # defaults in multiples of the roller's radius

    @cached_property
    def defaults(self) -> dict[str, Any]:
        """Default of every field; MISSING where a value is required."""
        entries = fields(self.profile_class)
        return {entry.name: None if entry.name in self.radius_multiples else entry.default for entry in entries}

    def read(self, name: str, table: Mapping[str, Any], depth: int) -> Table:
        """Check keys and values of a parameter's table without `kind` and `name`; omit defaults."""
        is_measured = self.profile_class is profiles.Measured
        keys = [*self.defaults, *(DESIGN_KEYS if self.design_fields else ()), *(FILE_OPTIONS if is_measured else ())]
        for key in table:
            checks.known_name(f"{name} key", str(key), [*keys, "kind", "name"])
        stated_entries = {key: entry for key, entry in table.items() if entry is not None}
        if is_measured:
            stated_entries = _read_points(name, stated_entries)
        values = {key: _check_value(name, key, entry, depth) for key, entry in stated_entries.items()}
        design_count = sum(key in values for key in DESIGN_KEYS)
        if self.design_fields and design_count + any(key in values for key in self.design_fields) != 1:
            choice = f"exactly one of {' with '.join(self.design_fields)}, {' and '.join(DESIGN_KEYS)}"
            raise InvalidInputError(name, dict(table), f"given with {choice}")
        for key, default in self.defaults.items():
            follows_from_design = design_count and key in self.design_fields
            if default is MISSING and key not in values and not follows_from_design:
                raise InvalidInputError(name, dict(table), f"given with {key}")
        return {key: values[key] for key in keys if key in values and values[key] != self.defaults.get(key)}

    def build(self, name: str, table: Mapping[str, Any], sizes: Dimensions) -> Profile:
        """Profile of the values that :meth:`read` returns."""
        values: dict[str, Any] = {key: factor * sizes.radius for key, factor in self.radius_multiples.items()}
        for key, value in table.items():
            if isinstance(value, Mapping):
                values[key] = build_profile(name, value, sizes)
            elif key == "terms":
                values[key] = tuple(build_profile(name, term, sizes) for term in value)
            elif key not in DESIGN_KEYS:
                values[key] = value
        create, scales = self.profile_class, {"radius": sizes.radius, "modulus": sizes.modulus}
        if "design_pressure" in table:
            create = partial(create.for_pressure, table["design_pressure"], **scales)
        elif "design_load" in table:
            create = partial(create.for_load, table["design_load"], length=sizes.roller_length, **scales)
        with checks.name_argument(name):
            profile: Profile = create(**values)
        return profile


def _check_value(name: str, key: str, value: object, depth: int) -> Any:
    """Value of a table after its check: a nested profile, a list of profiles or lengths, or a number."""
    if key in NESTED_KEYS:
        return _check_nested_table(name, value, depth)
    if key == "terms":
        checks.instance(f"{name}.terms", value, (list, tuple), "a list of profiles")
        assert isinstance(value, Sequence)
        return [_check_nested_table(name, term, depth) for term in value]
    if key not in POINT_KEYS:
        return check_number(f"{name}.{key}", value)
    points = checks.coordinates(f"{name}.{key}", value, "metres").tolist()
    if len(points) > MAX_POINTS:
        remedy = "thin the points out: cells of the contact are micrometres wide"
        raise InvalidInputError(name, f"{len(points)} points", f"at most {MAX_POINTS} points", remedy)
    return [round_digits(point) for point in points]


def _check_nested_table(name: str, value: object, depth: int) -> Table:
    """Table of a profile within another profile, without the inner profile's name."""
    return {key: entry for key, entry in profile_table(name, value, depth + 1).items() if key != "name"}


def _read_points(name: str, table: Table) -> Table:
    """Table of a measured profile with the points of its file: the points, not the path, determine the identity."""
    if "file" not in table:
        for key in FILE_OPTIONS:
            if key in table:
                raise InvalidInputError(f"{name}.{key}", table[key], "left out: it belongs to a file")
        return table
    if any(key in table for key in POINT_KEYS):
        raise InvalidInputError(name, sorted(table), "given with file, or with positions and drops")
    checks.instance(f"{name}.file", table["file"], str, "the path of a CSV or netCDF file")
    for flag in FILE_FLAGS:
        checks.instance(f"{name}.{flag}", table.get(flag, False), bool, "true or false")
    options = {key: entry for key, entry in table.items() if key != "file"}
    measured = profiles.Measured.from_file(table["file"], **options)
    return {entry.name: value for entry in fields(measured) if (value := getattr(measured, entry.name)) is not None}


PROFILES: dict[str, ProfileKind] = {  # Kinds of profile by their name in a study
    "cylinder": ProfileKind(profiles.Cylinder),
    "tapered": ProfileKind(profiles.Tapered),
    "lundberg": ProfileKind(profiles.Lundberg, design_fields=("amplitude",)),
    "johns-gohar": ProfileKind(profiles.JohnsGohar, design_fields=("amplitude", "half_width")),
    "fujiwara-kawase": ProfileKind(profiles.FujiwaraKawase, design_fields=("amplitude",)),
    "iso-cylindrical": ProfileKind(profiles.IsoCylindrical, radius_multiples={"diameter": 2.0}),
    "iso-tapered": ProfileKind(profiles.IsoTapered, radius_multiples={"diameter": 2.0}),
    "full-crown": ProfileKind(profiles.FullCrown),
    "partial-crown": ProfileKind(profiles.PartialCrown),
    "ellipsoid": ProfileKind(profiles.Ellipsoid),
    "sphere": ProfileKind(profiles.Sphere, radius_multiples={"radius": 1.0}),
    "chamfer": ProfileKind(profiles.Chamfer),
    "measured": ProfileKind(profiles.Measured),
    "halves": ProfileKind(profiles.Halves),
    "effective-length": ProfileKind(profiles.EffectiveLength),
    "sum": ProfileKind(profiles.Sum),
}

KIND_OF = {kind.profile_class: name for name, kind in PROFILES.items()}  # Name of the kind of each class
KINDS = (*PROFILES, USER_KIND)
EDGE_KINDS = ("cylinder", "chamfer")  # of a case's `body_edge`


def profile_table(name: str, value: object, depth: int = 0, kinds: Sequence[str] = KINDS) -> Table:
    """Table of a profile without defaults; `value` is a kind, a table with ``kind`` and fields, or a profile object."""
    if depth > MAX_NESTING:
        raise InvalidInputError(name, f"more than {MAX_NESTING} profiles within one another", "nested less deeply")
    if is_dataclass(value) and type(value) in KIND_OF:
        value = {"kind": KIND_OF[type(value)], **{entry.name: getattr(value, entry.name) for entry in fields(value)}}
    elif USER_KIND in kinds and isinstance(value, Profile) and not isinstance(value, type):
        return _register_profile(value)
    if isinstance(value, str):
        value = {"kind": value}
    if not isinstance(value, Mapping) or not isinstance(value.get("kind"), str):
        allowed = f"a profile, or a table with a kind: one of {', '.join(kinds)}"
        raise InvalidInputError(name, value, allowed)
    kind = checks.known_name(f"{name}.kind", value["kind"], kinds)
    table: Table = {"kind": kind}
    label = value.get("name")
    if label is None and isinstance(value.get("file"), str):
        label = Path(value["file"]).stem
    if label is not None:
        checks.instance(f"{name}.name", label, str, "text")
        table["name"] = label
    content = {key: entry for key, entry in value.items() if key not in ("kind", "name")}
    if kind == USER_KIND:
        for key in content:
            checks.known_name("profile key", str(key), [*USER_KEYS, "kind", "name"])
        for key, expected in (("class", str), ("content", str), ("values", Mapping)):
            allowed = "the content of a user's profile, written by a study"
            checks.instance(f"profile.{key}", content.get(key), expected, allowed)
        return table | {key: content[key] for key in USER_KEYS}
    return table | PROFILES[kind].read(name, content, depth)


def build_profile(name: str, table: Mapping[str, Any], sizes: Dimensions) -> Profile:
    """Profile of a table from :func:`profile_table`."""
    if table["kind"] == USER_KIND:
        # A process without the object plans with a straight line.
        return REGISTRY.get(table["content"]) or Sampled(str(table["class"]), (-0.5, 0.5), (0.0, 0.0))
    values = {key: value for key, value in table.items() if key not in ("kind", "name")}
    return PROFILES[table["kind"]].build(name, values, sizes)


def resolve_files(content: Any, folder: Path) -> Any:
    """Return `content` with paths of measured profiles that are relative to `folder`, not the working directory."""
    if isinstance(content, Mapping):
        resolved = {key: resolve_files(entry, folder) for key, entry in content.items()}
        if resolved.get("kind") == "measured" and isinstance(resolved.get("file"), str):
            resolved["file"] = str(folder / resolved["file"])
        return resolved
    return [resolve_files(entry, folder) for entry in content] if isinstance(content, list) else content


def check_without_files(content: Any) -> None:
    """Raise if a measured profile within tables names a file: a stranger's study could name any file."""
    for table in tables_within(content):
        if table["kind"] == "measured" and "file" in table:
            raise InvalidInputError("profile.file", table["file"], "left out of study.json, which contains the points")


def format_profile(table: Mapping[str, Any], *, in_units: bool = False) -> str:
    """Name of a profile, or its kind and values in SI (for a dimension's label) or in the units of engineers."""
    if "name" in table:
        return str(table["name"])
    kind = str(table["kind"])
    if kind == "sum":
        return " + ".join(format_profile(term, in_units=in_units) for term in table["terms"])
    if kind == "halves":
        return " | ".join(format_profile(table[side], in_units=in_units) for side in ("left", "right"))
    if kind == "measured":
        return f"measured {hashlib.sha256(json.dumps(table).encode()).hexdigest()[:8]}"
    if kind == USER_KIND:
        return f"{table['class']} {table['content'][:8]}"
    if kind == "effective-length":
        length = table["effective_length"]
        length_text = format_quantity(length, "m") if in_units else f"{length:g} m"
        return f"{format_profile(table['profile'], in_units=in_units)} over {length_text}"
    values = {key: table[key] for key in sorted(table) if key != "kind"}
    if not in_units:
        return " ".join([kind, *(f"{key}={value:g}" for key, value in values.items())])
    units = {key: unit_of(PROFILES[kind].profile_class, key) for key in values}
    units |= {"design_pressure": "Pa", "design_load": "N"}
    texts = (f"{key.replace('_', ' ')} {format_quantity(value, units[key])}" for key, value in values.items())
    return ", ".join([kind, *texts])


def _register_profile(profile: Profile) -> dict[str, Any]:
    """Add a copy of a user's profile to this process' registry; return its table."""
    name = type(profile).__qualname__.split("<locals>.")[-1]
    values = _read_values(profile)
    content = _digest([name, values, _sample_profile(profile)])
    if content not in REGISTRY:
        REGISTRY[content] = _copy_by_pickle(profile, name, content)
    has_default_repr = type(profile).__repr__ is object.__repr__
    label = f"{name} {content[:8]}" if has_default_repr else describe_profile(profile)
    return {"kind": USER_KIND, "name": label, "class": name, "values": values, "content": content}


def user_profiles(parameters: Any) -> dict[str, Profile]:
    """Users' profiles within parameters of cases, by content, for a worker; raises if this process lacks a profile."""
    profiles = {}
    for table in tables_within(parameters):
        if table["kind"] != USER_KIND:
            continue
        if table["content"] not in REGISTRY:
            allowed = "made by the running script: its class is not in the study's files"
            hint = "run the study from the script that makes this profile; opening it needs none"
            raise InvalidInputError("profile", f"{table['class']} {table['content'][:8]}", allowed, hint)
        profiles[table["content"]] = REGISTRY[table["content"]]
    return profiles


def _read_values(profile: Profile, name: str = "profile") -> dict[str, Any]:
    """JSON values of the fields of a dataclass, or of the attributes of another object."""
    kind: Any = type(profile)
    if is_dataclass(kind):
        names = [entry.name for entry in fields(kind)]
    else:
        slots = [slot for base in kind.__mro__ for slot in getattr(base, "__slots__", ())]
        names = sorted({*getattr(profile, "__dict__", {}), *(slot for slot in slots if hasattr(profile, slot))})
    return {key: _json_value(f"{name}.{key}", getattr(profile, key)) for key in names}


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
        return {"class": type(value).__qualname__, **_read_values(value, name)}
    allowed = f"a number, a text, a list or a profile, which identify the profile, not {type(value).__name__}"
    raise InvalidInputError(name, value, allowed, REMEDY)


def _sample_profile(profile: Profile) -> list[Any]:
    """Return drops and radii for every valid length, in 9 digits, because processors differ in rounding."""
    drops_and_radii: list[Any] = []
    last_error: Exception | None = None
    for length in DIGEST_LENGTHS:
        x = -0.5 * length * np.cos(np.linspace(0.0, np.pi, 1001))
        try:
            drops, radii = check_drop(profile, x, length), local_radius(profile, x, length, length)
        except (ContactStudyError, ArithmeticError, ValueError) as error:
            last_error = error
            drops_and_radii.append(None)
            continue
        drops_and_radii.append([f"{value:.9g}" for value in [*(drops + 0.0), *radii]])
    if not any(drops_and_radii):
        lengths = ", ".join(f"{length:g}" for length in DIGEST_LENGTHS)
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
        content_of_copy = _digest([name, _read_values(profile_copy), _sample_profile(profile_copy)])
    except Exception as error:  # a user's class may raise anything
        reason = f"{type(error).__name__}: {error}"
        raise InvalidInputError("profile", name, requirement.format(reason), REMEDY) from error
    if content_of_copy != content:
        raise InvalidInputError("profile", name, requirement.format("its copy is another profile"), REMEDY)
    return profile_copy
