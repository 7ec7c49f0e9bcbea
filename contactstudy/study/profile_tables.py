"""Profiles as tables in a study: ``kind`` and the fields of the class, nested where a profile consists of profiles.

A new profile becomes available to studies by an entry in :data:`PROFILES`.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contactstudy import checks, profiles
from contactstudy.arrays.engineering import format_quantity
from contactstudy.case.serialization import Sampled, tables_within
from contactstudy.errors import InvalidInputError
from contactstudy.profiles import Profile
from contactstudy.profiles.base import UNITS
from contactstudy.study import user_profiles
from contactstudy.study.user_profiles import REGISTRY, round_digits

if TYPE_CHECKING:
    from contactstudy.study.case_setup import Dimensions

Table = dict[str, Any]
MAX_NESTING = 16  # Largest depth of profiles within profiles
MAX_POINTS = 50_000  # Largest number of points of a measured profile
DESIGN = ("design_pressure", "design_load")  # determine the amplitude: Pa, and N on the roller
POINTS = ("positions", "drops")  # Fields that contain lists of lengths
NESTED = ("left", "right", "profile")  # Fields that contain a profile
FILE_FLAGS = ("remove_tilt", "remove_offset")
FILE_OPTIONS = ("file", *FILE_FLAGS, "turn")  # Keys of a measured profile that is read from a file
MIN_MAGNITUDE = 1 / checks.MAX_MAGNITUDE


def check_number(name: str, value: object) -> float:
    """Return a finite number of limited size, rounded."""
    finite = checks.finite(name, value)
    if 0 < abs(finite) < MIN_MAGNITUDE:
        raise InvalidInputError(name, value, f"0, or of a size from {MIN_MAGNITUDE:g} on", "units are SI")
    return round_digits(finite)


@dataclass(frozen=True)
class ProfileKind:
    """Class of a profile, whose fields are the keys of its table."""

    profile_class: Any  # the dataclass
    design_fields: tuple[str, ...] = ()  # fields that follow from DESIGN by the class' for_pressure or for_load
    radius_multiples: Mapping[str, float] = field(default_factory=dict)  # defaults in multiples of the roller's radius

    @cached_property
    def defaults(self) -> dict[str, Any]:
        """Default of every field; MISSING where a value is required."""
        entries = fields(self.profile_class)
        return {entry.name: None if entry.name in self.radius_multiples else entry.default for entry in entries}

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Check keys and values of a table without `kind` and `name`; omit defaults."""
        is_measured = self.profile_class is profiles.Measured
        keys = [*self.defaults, *(DESIGN if self.design_fields else ()), *(FILE_OPTIONS if is_measured else ())]
        for key in table:
            checks.known_name("profile key", str(key), [*keys, "kind", "name"])
        stated_entries = {key: entry for key, entry in table.items() if entry is not None}
        if is_measured:
            stated_entries = _read_points(stated_entries)
        values = {key: _check_value(key, entry, depth) for key, entry in stated_entries.items()}
        design_count = sum(name in values for name in DESIGN)
        if self.design_fields and design_count + any(name in values for name in self.design_fields) != 1:
            choice = f"exactly one of {' with '.join(self.design_fields)}, {' and '.join(DESIGN)}"
            raise InvalidInputError("profile", dict(table), f"given with {choice}")
        for name, default in self.defaults.items():
            follows = design_count and name in self.design_fields
            if default is MISSING and name not in values and not follows:
                raise InvalidInputError("profile", dict(table), f"given with {name}")
        return {key: values[key] for key in keys if key in values and values[key] != self.defaults.get(key)}

    def build(self, table: Mapping[str, Any], sizes: Dimensions) -> Profile:
        """Profile of the values that :meth:`read` returns."""
        design = {name: table[name] for name in DESIGN if name in table}
        values: dict[str, Any] = {}
        for name, value in table.items():
            if isinstance(value, Mapping):
                values[name] = build_profile(value, sizes)
            elif name == "terms":
                values[name] = tuple(build_profile(term, sizes) for term in value)
            elif name not in design:
                values[name] = value
        profile: Profile
        if not design:
            radii = {name: factor * sizes.radius for name, factor in self.radius_multiples.items()}
            profile = self.profile_class(**(radii | values))
        elif "design_load" in design:
            values |= {"length": sizes.roller_length, "radius": sizes.radius, "modulus": sizes.modulus}
            profile = self.profile_class.for_load(design["design_load"], **values)
        else:
            values |= {"radius": sizes.radius, "modulus": sizes.modulus}
            profile = self.profile_class.for_pressure(design["design_pressure"], **values)
        return profile


def _check_value(key: str, value: object, depth: int) -> Any:
    """Value of a table after its check: a nested profile, a list of profiles or lengths, or a number."""
    if key in NESTED:
        return _check_nested_table(value, depth)
    if key == "terms":
        checks.instance("profile.terms", value, (list, tuple), "a list of profiles")
        assert isinstance(value, Sequence)
        return [_check_nested_table(term, depth) for term in value]
    if key not in POINTS:
        return check_number(f"profile.{key}", value)
    points = checks.coordinates(f"profile.{key}", value, "metres").tolist()
    if len(points) > MAX_POINTS:
        remedy = "thin the points out: cells of the contact are micrometres wide"
        raise InvalidInputError("profile", f"{len(points)} points", f"at most {MAX_POINTS} points", remedy)
    return [round_digits(point) for point in points]


def _check_nested_table(value: object, depth: int) -> Table:
    """Table of a profile within another profile, without the inner profile's name."""
    return {key: entry for key, entry in profile_table(value, depth + 1).items() if key != "name"}


def _read_points(table: Table) -> Table:
    """Table of a measured profile with the points of its file: the points, not the path, determine the identity."""
    if "file" not in table:
        for key in FILE_OPTIONS:
            if key in table:
                raise InvalidInputError(f"profile.{key}", table[key], "left out: it belongs to a file")
        return table
    if any(name in table for name in POINTS):
        raise InvalidInputError("profile", sorted(table), "given with file, or with positions and drops")
    checks.instance("profile.file", table["file"], str, "the path of a CSV or netCDF file")
    for flag in FILE_FLAGS:
        checks.instance(f"profile.{flag}", table.get(flag, False), bool, "true or false")
    options = {key: entry for key, entry in table.items() if key != "file"}
    measured = profiles.Measured.from_file(table["file"], **options)
    values = {entry.name: getattr(measured, entry.name) for entry in fields(measured)}
    return {name: value for name, value in values.items() if value is not None}


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


def profile_table(value: object, depth: int = 0) -> Table:
    """Table of a profile without defaults; `value` is a kind, a table with ``kind`` and fields, or a profile object."""
    if depth > MAX_NESTING:
        raise InvalidInputError("profile", f"more than {MAX_NESTING} profiles within one another", "nested less deeply")
    if is_dataclass(value) and type(value) in KIND_OF:
        value = {"kind": KIND_OF[type(value)], **{entry.name: getattr(value, entry.name) for entry in fields(value)}}
    elif isinstance(value, Profile) and not isinstance(value, type):
        return user_profiles.register(value)
    if isinstance(value, str):
        value = {"kind": value}
    allowed = "a profile, an object with drop(x, length), or a table with a kind, such as {kind = 'cylinder'}"
    checks.instance("profile", value, Mapping, allowed)
    assert isinstance(value, Mapping)
    if not isinstance(value.get("kind"), str):
        raise InvalidInputError("profile", dict(value), f"a table with a kind: one of {', '.join(PROFILES)}")
    kind = checks.known_name("profile.kind", value["kind"], [*PROFILES, user_profiles.KIND])
    table: Table = {"kind": kind}
    name = value.get("name")
    if name is None and isinstance(value.get("file"), str):
        name = Path(value["file"]).stem
    if name is not None:
        checks.instance("profile.name", name, str, "text")
        table["name"] = name
    content = {key: entry for key, entry in value.items() if key not in ("kind", "name")}
    if kind == user_profiles.KIND:
        return table | user_profiles.read_table(content)
    return table | PROFILES[kind].read(content, depth)


def build_profile(table: Mapping[str, Any], sizes: Dimensions) -> Profile:
    """Profile of a table from :func:`profile_table`."""
    if table["kind"] == user_profiles.KIND:
        # A process without the object plans with a straight line.
        return REGISTRY.get(table["content"]) or Sampled(str(table["class"]), (-0.5, 0.5), (0.0, 0.0))
    values = {key: value for key, value in table.items() if key not in ("kind", "name")}
    return PROFILES[table["kind"]].build(values, sizes)


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
    kind, units = str(table["kind"]), UNITS | {"design_pressure": "Pa", "design_load": "N"}
    if kind == "sum":
        return " + ".join(format_profile(term, in_units=in_units) for term in table["terms"])
    if kind == "halves":
        return " | ".join(format_profile(table[side], in_units=in_units) for side in ("left", "right"))
    if kind == "measured":
        return f"measured {hashlib.sha256(json.dumps(table).encode()).hexdigest()[:8]}"
    if kind == user_profiles.KIND:
        return f"{table['class']} {table['content'][:8]}"
    if kind == "effective-length":
        length = table["effective_length"]
        length_text = format_quantity(length, "m") if in_units else f"{length:g} m"
        return f"{format_profile(table['profile'], in_units=in_units)} over {length_text}"
    values = {key: table[key] for key in sorted(table) if key != "kind"}
    if not in_units:
        return " ".join([kind, *(f"{key}={value:g}" for key, value in values.items())])
    texts = (f"{key.replace('_', ' ')} {format_quantity(value, units.get(key, 'm'))}" for key, value in values.items())
    return ", ".join([kind, *texts])
