"""Registries: from the words of a study to bodies and profiles.

A new body or profile becomes available to studies by one line: an entry in :data:`BODIES` or :data:`PROFILES`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from contactstudy import checks
from contactstudy.bodies import MODELS, Body, FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.errors import InvalidInputError
from contactstudy.material import Material
from contactstudy.profiles import Cylinder, Lundberg, Profile


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
    build : callable
        Makes the profile from its table (without `kind` and `name`) and the surroundings.
    keys : mapping
        Every key that the table may have, with its default (None: no default).
    """

    build: Callable[[Mapping[str, float], Surroundings], Profile]
    keys: Mapping[str, float | None] = field(default_factory=dict)


def _cylinder(table: Mapping[str, float], around: Surroundings) -> Profile:
    return Cylinder(**table)


def _lundberg(table: Mapping[str, float], around: Surroundings) -> Profile:
    if ("amplitude" in table) == ("design_pressure" in table):
        raise InvalidInputError("profile", dict(table), "given with exactly one of amplitude and design_pressure")
    delta = table.get("delta", 1.0)
    if "amplitude" in table:
        return Lundberg(table["amplitude"], delta)
    return Lundberg.for_pressure(table["design_pressure"], radius=around.radius, modulus=around.modulus, delta=delta)


PROFILES: dict[str, ProfileKind] = {
    "cylinder": ProfileKind(_cylinder, {"fillet_radius": 0.0}),
    "lundberg": ProfileKind(_lundberg, {"amplitude": None, "design_pressure": None, "delta": 1.0}),
}
"""Kinds of profile by their name in a study."""


def _half_space(material: Material, length: float, model: str) -> Body:
    if model != MODELS[0]:
        raise InvalidInputError("model", model, f"{MODELS[0]!r} for a half-space, which has no free end")
    return HalfSpace(material=material)


BODIES: dict[str, Callable[[Material, float, str], Body]] = {
    "finite-length": lambda material, length, model: FiniteLengthSpace(length=length, material=material, model=model),
    "quarter-space": lambda material, length, model: QuarterSpace(material=material, model=model),
    "half-space": _half_space,
}
"""Makers of a body from its material, the length between the free ends and the model of these, by name."""

PROFILE_CLASSES: dict[type, str] = {Cylinder: "cylinder", Lundberg: "lundberg"}
"""Profiles that may be given as objects, because their fields are the keys of their table."""


def profile_table(value: object) -> dict[str, Any]:
    """Table of a profile: checked keys, numbers as floats, defaults left out, `kind` always, `name` if given.

    Examples
    --------
    >>> profile_table({"kind": "cylinder", "fillet_radius": 1, "name": "rounded"})
    {'kind': 'cylinder', 'name': 'rounded', 'fillet_radius': 1.0}
    >>> profile_table(Cylinder())
    {'kind': 'cylinder'}
    """
    if type(value) in PROFILE_CLASSES:
        given = {entry.name: getattr(value, entry.name) for entry in fields(value)}  # type: ignore[arg-type]
        value = {"kind": PROFILE_CLASSES[type(value)], **given}
    if isinstance(value, str):
        value = {"kind": value}
    checks.instance("profile", value, Mapping, "a table with a kind, such as {kind = 'cylinder'}")
    assert isinstance(value, Mapping)
    if not isinstance(value.get("kind"), str):
        raise InvalidInputError("profile", dict(value), f"a table with a kind: one of {', '.join(PROFILES)}")
    kind = checks.known_name("profile.kind", value["kind"], PROFILES)
    table: dict[str, Any] = {"kind": kind}
    if "name" in value:
        checks.instance("profile.name", value["name"], str, "text")
        table["name"] = value["name"]
    known = PROFILES[kind].keys
    for key, entry in value.items():
        if key in ("kind", "name"):
            continue
        checks.known_name("profile key", str(key), {*known, "kind", "name"})
        number = checks.finite(f"profile.{key}", entry)
        if number != known[key]:
            table[str(key)] = number
    return table


def profile_label(table: Mapping[str, Any]) -> str:
    """Name of a profile on a dimension: its own, or one made from its values.

    Examples
    --------
    >>> profile_label({"kind": "cylinder", "fillet_radius": 2e-4})
    'cylinder fillet_radius=0.0002'
    """
    if "name" in table:
        return str(table["name"])
    values = [f"{key}={table[key]:g}" for key in sorted(table) if key != "kind"]
    return " ".join([str(table["kind"]), *values])


def build_profile(table: Mapping[str, Any], around: Surroundings) -> Profile:
    """Profile of a table from :func:`profile_table`."""
    values = {key: float(value) for key, value in table.items() if key not in ("kind", "name")}
    return PROFILES[table["kind"]].build(values, around)
