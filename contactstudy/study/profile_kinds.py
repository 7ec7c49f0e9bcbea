"""Registry of profiles: from the table of a profile in a study to the profile.

A new profile becomes available to studies by one line, an entry in :data:`PROFILES`.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

from contactstudy import checks, profiles
from contactstudy.errors import InvalidInputError
from contactstudy.profiles import Profile

Table = dict[str, Any]


@dataclass(frozen=True)
class Surroundings:
    """What a profile may need to know of the case that it belongs to: SI units."""

    radius: float
    modulus: float
    max_pressure: float


@dataclass(frozen=True)
class ProfileKind:
    """How one kind of profile is written in a study.

    Parameters
    ----------
    made : type
        The class of the profile; its fields are the keys of the table.
    read : callable
        Checks the keys and values of a table (without `kind` and `name`); leaves out what is at its default.
    build : callable
        Makes the profile from what `read` returns, and the surroundings.
    """

    made: type
    read: Callable[[Mapping[str, Any]], Table]
    build: Callable[[Mapping[str, Any], Surroundings], Profile]


def _only(table: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in table:
        checks.known_name("profile key", str(key), [*known, "kind", "name"])


def _require(table: Mapping[str, Any], *names: str) -> None:
    for name in names:
        if name not in table:
            raise InvalidInputError("profile", dict(table), f"given with {name}")


def _numbers(made: Any, *designed: str, of_radius: Mapping[str, float] | None = None) -> ProfileKind:
    """Kind of profile whose fields are numbers.

    Parameters
    ----------
    made : type
        The dataclass.
    *designed : str
        Fields that `design_pressure` may be given for, through the class' ``for_pressure``.
    of_radius : mapping
        Fields that need not be given, and how many times the roller's radius they then are.
    """
    scales = of_radius or {}
    defaults = {entry.name: None if entry.default is MISSING else entry.default for entry in fields(made)} | (
        {"design_pressure": None} if designed else {}
    )
    needed = [entry.name for entry in fields(made) if entry.default is MISSING and entry.name not in scales]

    def read(table: Mapping[str, Any]) -> Table:
        _only(table, list(defaults))
        given = {key: checks.finite(f"profile.{key}", value) for key, value in table.items() if value is not None}
        return {key: value for key, value in given.items() if value != defaults[key]}

    def build(table: Mapping[str, Any], around: Surroundings) -> Profile:
        values = dict(table)
        if designed and ("design_pressure" in values) == any(name in values for name in designed):
            choice = f"exactly one of {' with '.join(designed)} and design_pressure"
            raise InvalidInputError("profile", dict(table), f"given with {choice}")
        if "design_pressure" in values:
            _require(values, *(name for name in needed if name not in designed))
            pressure = values.pop("design_pressure")
            designed_for: Profile = made.for_pressure(pressure, radius=around.radius, modulus=around.modulus, **values)
            return designed_for
        _require(values, *needed)
        profile: Profile = made(**{name: scale * around.radius for name, scale in scales.items()} | values)
        return profile

    return ProfileKind(made, read, build)


def _read_measured(table: Mapping[str, Any]) -> Table:
    """Positions and drops, from the file if one is named: the content is what counts, not where it was."""
    options = ("remove_tilt", "remove_offset", "largest_spike")
    points = ("positions", "drops")
    _only(table, ["file", *options, *points])
    values = {key: value for key, value in table.items() if value is not None}
    if "file" in values:
        if any(name in values for name in points):
            raise InvalidInputError("profile", sorted(values), "given with file, or with positions and drops")
        checks.instance("profile.file", values["file"], str, "the path of a CSV or netCDF file")
        for option in options[:2]:
            checks.instance(f"profile.{option}", values.get(option, False), bool, "true or false")
        read = profiles.Measured.from_file(values.pop("file"), **values)
        values = {"positions": read.positions, "drops": read.drops, "largest_spike": read.largest_spike}
    _only(values, [*points, "largest_spike"])
    _require(values, *points)
    result: Table = {name: checks.coordinates(f"profile.{name}", values[name], "metres").tolist() for name in points}
    if values.get("largest_spike") is not None:
        result["largest_spike"] = checks.finite("profile.largest_spike", values["largest_spike"])
    return result


def _nameless(value: object) -> Table:
    return {key: entry for key, entry in profile_table(value).items() if key != "name"}


def _read_halves(table: Mapping[str, Any]) -> Table:
    _only(table, ["left", "right"])
    _require(table, "left", "right")
    return {side: _nameless(table[side]) for side in ("left", "right")}


def _read_sum(table: Mapping[str, Any]) -> Table:
    _only(table, ["terms"])
    _require(table, "terms")
    checks.instance("profile.terms", table["terms"], (list, tuple), "a list of profiles")
    return {"terms": [_nameless(term) for term in table["terms"]]}


PROFILES: dict[str, ProfileKind] = {
    "cylinder": _numbers(profiles.Cylinder),
    "tapered": _numbers(profiles.Tapered),
    "lundberg": _numbers(profiles.Lundberg, "amplitude"),
    "johns-gohar": _numbers(profiles.JohnsGohar, "amplitude", "half_width"),
    "fujiwara-kawase": _numbers(profiles.FujiwaraKawase, "amplitude"),
    "iso-cylindrical": _numbers(profiles.IsoCylindrical, of_radius={"diameter": 2.0}),
    "iso-tapered": _numbers(profiles.IsoTapered, of_radius={"diameter": 2.0}),
    "full-crown": _numbers(profiles.FullCrown),
    "partial-crown": _numbers(profiles.PartialCrown),
    "ellipsoid": _numbers(profiles.Ellipsoid),
    "sphere": _numbers(profiles.Sphere, of_radius={"radius": 1.0}),
    "measured": ProfileKind(profiles.Measured, _read_measured, lambda table, around: profiles.Measured(**table)),
    "halves": ProfileKind(
        profiles.Halves,
        _read_halves,
        lambda table, around: profiles.Halves(
            left=build_profile(table["left"], around), right=build_profile(table["right"], around)
        ),
    ),
    "sum": ProfileKind(
        profiles.Sum,
        _read_sum,
        lambda table, around: profiles.Sum(tuple(build_profile(term, around) for term in table["terms"])),
    ),
}
"""Kinds of profile by their name in a study."""

KIND_OF = {kind.made: name for name, kind in PROFILES.items()}
"""Profiles may also be given as objects, because their fields are the keys of their table."""


def profile_table(value: object) -> Table:
    """Table of a profile: checked keys, numbers as floats, defaults left out, `kind` always, `name` if given.

    Parameters
    ----------
    value : mapping, str or Profile
        A table with a `kind`, the name of a kind without any more keys, or a profile. Profiles within it (of a sum,
        of two halves) likewise.

    Raises
    ------
    InvalidInputError
        If a key is unknown or a value is of a wrong type, or a file with a measured profile is not usable.

    Examples
    --------
    >>> profile_table({"kind": "cylinder", "fillet_radius": 1, "name": "rounded"})
    {'kind': 'cylinder', 'name': 'rounded', 'fillet_radius': 1.0}
    >>> profile_table(profiles.Cylinder() + profiles.Lundberg(1e-6))
    {'kind': 'sum', 'terms': [{'kind': 'cylinder'}, {'kind': 'lundberg', 'amplitude': 1e-06}]}
    """
    if is_dataclass(value) and type(value) in KIND_OF:
        given = {entry.name: getattr(value, entry.name) for entry in fields(value)}
        value = {"kind": KIND_OF[type(value)], **given}
    if isinstance(value, str):
        value = {"kind": value}
    checks.instance("profile", value, Mapping, "a table with a kind, such as {kind = 'cylinder'}")
    assert isinstance(value, Mapping)
    if not isinstance(value.get("kind"), str):
        raise InvalidInputError("profile", dict(value), f"a table with a kind: one of {', '.join(PROFILES)}")
    kind = checks.known_name("profile.kind", value["kind"], PROFILES)
    table: Table = {"kind": kind}
    name = value.get("name")
    if name is None and isinstance(value.get("file"), str):
        name = Path(value["file"]).stem
    if name is not None:
        checks.instance("profile.name", name, str, "text")
        table["name"] = name
    content = {key: entry for key, entry in value.items() if key not in ("kind", "name")}
    return table | PROFILES[kind].read(content)


def profile_label(table: Mapping[str, Any]) -> str:
    """Name of a profile on a dimension: its own, or one made from its values.

    Examples
    --------
    >>> profile_label({"kind": "cylinder", "fillet_radius": 2e-4})
    'cylinder fillet_radius=0.0002'
    >>> profile_label({"kind": "sum", "terms": [{"kind": "cylinder"}, {"kind": "ellipsoid", "crown_radius": 2.0}]})
    'cylinder + ellipsoid crown_radius=2'
    """
    if "name" in table:
        return str(table["name"])
    kind = str(table["kind"])
    if kind == "sum":
        return " + ".join(profile_label(term) for term in table["terms"])
    if kind == "halves":
        return f"{profile_label(table['left'])} | {profile_label(table['right'])}"
    if kind == "measured":
        return f"measured {hashlib.sha256(json.dumps(table).encode()).hexdigest()[:8]}"
    values = [f"{key}={table[key]:g}" for key in sorted(table) if key != "kind"]
    return " ".join([kind, *values])


def build_profile(table: Mapping[str, Any], around: Surroundings) -> Profile:
    """Profile of a table from :func:`profile_table`."""
    values = {key: value for key, value in table.items() if key not in ("kind", "name")}
    return PROFILES[table["kind"]].build(values, around)


def with_files_in(content: Any, folder: Path) -> Any:
    """Return tables with the files of measured profiles found from `folder` instead of the working directory."""
    if isinstance(content, Mapping):
        found = {key: with_files_in(entry, folder) for key, entry in content.items()}
        if found.get("kind") == "measured" and isinstance(found.get("file"), str):
            found["file"] = str(folder / found["file"])
        return found
    if isinstance(content, list):
        return [with_files_in(entry, folder) for entry in content]
    return content
