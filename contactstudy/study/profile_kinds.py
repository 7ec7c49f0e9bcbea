"""Registry of profiles: from the table of a profile in a study to the profile.

A new profile becomes available to studies by one line, an entry in :data:`PROFILES`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

from contactstudy import checks, profiles
from contactstudy.errors import InvalidInputError
from contactstudy.profiles import Profile
from contactstudy.study import own_profiles
from contactstudy.study.numbers import number

Table = dict[str, Any]

# Profiles within profiles, as sums of halves of sums.
DEEPEST = 16

DESIGN = ("design_pressure", "design_load")
"""Keys of which a profile's amplitude may follow: Pa, and N on the whole roller."""

# Points of a measured profile in a study.
MOST_POINTS = 50_000


@dataclass(frozen=True)
class Surroundings:
    """What a profile may need to know of the case that it belongs to: SI units."""

    radius: float
    modulus: float
    length: float


class ProfileKind(Protocol):
    """How one kind of profile is written in a study."""

    @property
    def made(self) -> type:
        """The class of the profile; its fields are keys of the table."""

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Check keys and values of a table without `kind` and `name`; leave out what is at its default.

        Profiles within the table are at `depth` + 1.
        """

    def build(self, table: Mapping[str, Any], around: Surroundings) -> Profile:
        """Make the profile from what :meth:`read` returns, and the surroundings."""


def _only(table: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in table:
        checks.known_name("profile key", str(key), [*known, "kind", "name"])


def _require(table: Mapping[str, Any], *names: str) -> None:
    for name in names:
        if name not in table:
            raise InvalidInputError("profile", dict(table), f"given with {name}")


@dataclass(frozen=True)
class Numbers:
    """Kind of profile whose fields are numbers: a dataclass says which, and their defaults.

    Parameters
    ----------
    made : type
        The dataclass.
    designed : tuple of str
        Fields that `design_pressure` or `design_load` may be given for, through the class' ``for_pressure`` or
        ``for_load``.
    of_radius : mapping
        Fields that need not be given, and how many times the roller's radius they then are.
    """

    made: Any
    designed: tuple[str, ...] = ()
    of_radius: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def _defaults(self) -> dict[str, Any]:
        """Default of every key; MISSING where a value is needed."""
        return {entry.name: None if entry.name in self.of_radius else entry.default for entry in fields(self.made)}

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Check that the keys are fields and the values numbers."""
        defaults = {**self._defaults, **dict.fromkeys(DESIGN)} if self.designed else self._defaults
        _only(table, list(defaults))
        given = {key: number(f"profile.{key}", value) for key, value in table.items() if value is not None}
        return {key: value for key, value in given.items() if value != defaults[key]}

    def build(self, table: Mapping[str, Any], around: Surroundings) -> Profile:
        """Call the class with the numbers, or its ``for_pressure`` or ``for_load``."""
        design = {name: table[name] for name in DESIGN if name in table}
        values = {name: value for name, value in table.items() if name not in design}
        if self.designed and len(design) + any(name in values for name in self.designed) != 1:
            choice = f"exactly one of {' with '.join(self.designed)}, {' and '.join(DESIGN)}"
            raise InvalidInputError("profile", dict(table), f"given with {choice}")
        needed = [name for name, default in self._defaults.items() if default is MISSING]
        if not design:
            _require(values, *needed)
            sizes = {name: times * around.radius for name, times in self.of_radius.items()}
            made: Profile = self.made(**(sizes | values))
        else:
            _require(values, *(name for name in needed if name not in self.designed))
            values |= {"radius": around.radius, "modulus": around.modulus}
            if "design_load" in design:
                made = self.made.for_load(design["design_load"], length=around.length, **values)
            else:
                made = self.made.for_pressure(design["design_pressure"], **values)
        return made


class MeasuredPoints:
    """Kind of profile that is given by its points, or by a file that has them."""

    made = profiles.Measured

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Positions and drops, from the file if one is named: the content is what counts, not where it was."""
        numbers, points = ("largest_spike", "cutoff"), ("positions", "drops")
        flags = ("remove_tilt", "remove_offset")
        _only(table, ["file", *flags, "turn", *numbers, *points])
        values = {key: value for key, value in table.items() if value is not None}
        if "file" in values:
            if any(name in values for name in points):
                raise InvalidInputError("profile", sorted(values), "given with file, or with positions and drops")
            checks.instance("profile.file", values["file"], str, "the path of a CSV or netCDF file")
            for option in flags:
                checks.instance(f"profile.{option}", values.get(option, False), bool, "true or false")
            read = profiles.Measured.from_file(values.pop("file"), **values)
            kept = {name: getattr(read, name) for name in (*points, *numbers)}
            values = {name: value for name, value in kept.items() if value is not None}
        _only(values, [*points, *numbers])
        _require(values, *points)
        result: Table = {
            name: checks.coordinates(f"profile.{name}", values[name], "metres").tolist() for name in points
        }
        if len(result["positions"]) > MOST_POINTS:
            raise InvalidInputError(
                "profile",
                f"{len(result['positions'])} points",
                f"measured at no more than {MOST_POINTS} points, because every result keeps them",
                "thin the points out: cells of the contact are micrometres wide",
            )
        given = {name: number(f"profile.{name}", values[name]) for name in numbers if name in values}
        return result | given

    def build(self, table: Mapping[str, Any], around: Surroundings) -> Profile:
        """Make the profile of the points."""
        return self.made(**table)


class TwoHalves:
    """Kind of profile whose halves are profiles."""

    made = profiles.Halves

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Check both halves."""
        _only(table, ["left", "right"])
        _require(table, "left", "right")
        return {side: _nameless(table[side], depth + 1) for side in ("left", "right")}

    def build(self, table: Mapping[str, Any], around: Surroundings) -> Profile:
        """Make both halves."""
        return self.made(**{side: build_profile(table[side], around) for side in ("left", "right")})


class Terms:
    """Kind of profile that is a sum of profiles."""

    made = profiles.Sum

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Check all terms."""
        _only(table, ["terms"])
        _require(table, "terms")
        checks.instance("profile.terms", table["terms"], (list, tuple), "a list of profiles")
        return {"terms": [_nameless(term, depth + 1) for term in table["terms"]]}

    def build(self, table: Mapping[str, Any], around: Surroundings) -> Profile:
        """Make all terms."""
        return self.made(tuple(build_profile(term, around) for term in table["terms"]))


class WithoutCorners:
    """Kind of profile that counts over the effective length."""

    made = profiles.EffectiveLength

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Check the profile and the length."""
        _only(table, ["profile", "effective_length"])
        _require(table, "profile", "effective_length")
        length = number("profile.effective_length", table["effective_length"])
        return {"profile": _nameless(table["profile"], depth + 1), "effective_length": length}

    def build(self, table: Mapping[str, Any], around: Surroundings) -> Profile:
        """Make the profile."""
        return self.made(build_profile(table["profile"], around), table["effective_length"])


class Own:
    """Kind of a profile whose class is the user's: its table is made from the object."""

    made = own_profiles.Unknown

    def read(self, table: Mapping[str, Any], depth: int) -> Table:
        """Check what a file holds of it."""
        return own_profiles.read_table(table)

    def build(self, table: Mapping[str, Any], around: Surroundings) -> Profile:
        """Return the object that this process knows."""
        return own_profiles.own_profile(table["content"])


def _nameless(value: object, depth: int) -> Table:
    """Table of a profile within another one, without its name."""
    return {key: entry for key, entry in profile_table(value, depth).items() if key != "name"}


PROFILES: dict[str, ProfileKind] = {
    "cylinder": Numbers(profiles.Cylinder),
    "tapered": Numbers(profiles.Tapered),
    "lundberg": Numbers(profiles.Lundberg, designed=("amplitude",)),
    "johns-gohar": Numbers(profiles.JohnsGohar, designed=("amplitude", "half_width")),
    "fujiwara-kawase": Numbers(profiles.FujiwaraKawase, designed=("amplitude",)),
    "iso-cylindrical": Numbers(profiles.IsoCylindrical, of_radius={"diameter": 2.0}),
    "iso-tapered": Numbers(profiles.IsoTapered, of_radius={"diameter": 2.0}),
    "full-crown": Numbers(profiles.FullCrown),
    "partial-crown": Numbers(profiles.PartialCrown),
    "ellipsoid": Numbers(profiles.Ellipsoid),
    "sphere": Numbers(profiles.Sphere, of_radius={"radius": 1.0}),
    "measured": MeasuredPoints(),
    "halves": TwoHalves(),
    "effective-length": WithoutCorners(),
    "sum": Terms(),
}
"""Kinds of profile by their name in a study."""

KINDS: dict[str, ProfileKind] = {**PROFILES, own_profiles.KIND: Own()}
"""These, and the kind of those that are made in Python from a class of the user's."""

KIND_OF = {kind.made: name for name, kind in PROFILES.items()}
"""Profiles may also be given as objects, because their fields are the keys of their table."""


def profile_table(value: object, depth: int = 0) -> Table:
    """Table of a profile: checked keys, numbers as floats, defaults left out, `kind` always, `name` if given.

    Parameters
    ----------
    value : mapping, str or Profile
        A table with a `kind`, the name of a kind without any more keys, or a profile, one of the user's own among
        them. Profiles within it (of a sum, of two halves) likewise.
    depth : int
        Number of profiles that this one is within.

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
    if depth > DEEPEST:
        raise InvalidInputError("profile", f"more than {DEEPEST} profiles within one another", "nested less deeply")
    if is_dataclass(value) and type(value) in KIND_OF:
        given = {entry.name: getattr(value, entry.name) for entry in fields(value)}
        value = {"kind": KIND_OF[type(value)], **given}
    elif isinstance(value, Profile) and not isinstance(value, type):
        return own_profiles.own_table(value)
    if isinstance(value, str):
        value = {"kind": value}
    allowed = "a profile, an object with drop(x, length), or a table with a kind, such as {kind = 'cylinder'}"
    checks.instance("profile", value, Mapping, allowed)
    assert isinstance(value, Mapping)
    if not isinstance(value.get("kind"), str):
        raise InvalidInputError("profile", dict(value), f"a table with a kind: one of {', '.join(PROFILES)}")
    kind = checks.known_name("profile.kind", value["kind"], KINDS)
    table: Table = {"kind": kind}
    name = value.get("name")
    if name is None and isinstance(value.get("file"), str):
        name = Path(value["file"]).stem
    if name is not None:
        checks.instance("profile.name", name, str, "text")
        table["name"] = name
    content = {key: entry for key, entry in value.items() if key not in ("kind", "name")}
    return table | KINDS[kind].read(content, depth)


def build_profile(table: Mapping[str, Any], around: Surroundings) -> Profile:
    """Profile of a table from :func:`profile_table`."""
    values = {key: value for key, value in table.items() if key not in ("kind", "name")}
    return KINDS[table["kind"]].build(values, around)


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
