"""Profiles as tables in a study: ``kind`` and the fields of the class, nested where a profile consists of profiles.

A new profile becomes available to studies by an entry in :data:`PROFILES`.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cached_property, partial
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

    def read(self, name: str, table: Mapping[str, Any], depth: int) -> Table:
        """Check keys and values of a parameter's table without `kind` and `name`; omit defaults."""
        is_measured = self.profile_class is profiles.Measured
        keys = [*self.defaults, *(DESIGN if self.design_fields else ()), *(FILE_OPTIONS if is_measured else ())]
        for key in table:
            checks.known_name(f"{name} key", str(key), [*keys, "kind", "name"])
        stated_entries = {key: entry for key, entry in table.items() if entry is not None}
        if is_measured:
            stated_entries = _read_points(name, stated_entries)
        values = {key: _check_value(name, key, entry, depth) for key, entry in stated_entries.items()}
        design_count = sum(key in values for key in DESIGN)
        if self.design_fields and design_count + any(key in values for key in self.design_fields) != 1:
            choice = f"exactly one of {' with '.join(self.design_fields)}, {' and '.join(DESIGN)}"
            raise InvalidInputError(name, dict(table), f"given with {choice}")
        for key, default in self.defaults.items():
            follows = design_count and key in self.design_fields
            if default is MISSING and key not in values and not follows:
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
            elif key not in DESIGN:
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
    if key in NESTED:
        return _check_nested_table(name, value, depth)
    if key == "terms":
        checks.instance(f"{name}.terms", value, (list, tuple), "a list of profiles")
        assert isinstance(value, Sequence)
        return [_check_nested_table(name, term, depth) for term in value]
    if key not in POINTS:
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
    if any(key in table for key in POINTS):
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
KINDS = (*PROFILES, user_profiles.KIND)
EDGE_KINDS = ("cylinder", "chamfer")  # of a case's `body_edge`


def profile_table(name: str, value: object, depth: int = 0, kinds: Sequence[str] = KINDS) -> Table:
    """Table of a profile without defaults; `value` is a kind, a table with ``kind`` and fields, or a profile object."""
    if depth > MAX_NESTING:
        raise InvalidInputError(name, f"more than {MAX_NESTING} profiles within one another", "nested less deeply")
    if is_dataclass(value) and type(value) in KIND_OF:
        value = {"kind": KIND_OF[type(value)], **{entry.name: getattr(value, entry.name) for entry in fields(value)}}
    elif user_profiles.KIND in kinds and isinstance(value, Profile) and not isinstance(value, type):
        return user_profiles.register(value)
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
    if kind == user_profiles.KIND:
        return table | user_profiles.read_table(content)
    return table | PROFILES[kind].read(name, content, depth)


def build_profile(name: str, table: Mapping[str, Any], sizes: Dimensions) -> Profile:
    """Profile of a table from :func:`profile_table`."""
    if table["kind"] == user_profiles.KIND:
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
