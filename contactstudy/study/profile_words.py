"""What a profile of a study is called: its label on a dimension, and in words with the units of engineers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from typing import Any

from contactstudy.arrays.engineering import quantity
from contactstudy.profiles.base import UNITS
from contactstudy.study import own_profiles

TABLE_UNITS = UNITS | {"design_pressure": "Pa", "design_load": "N"}
"""Units of the values of a profile's table that are no lengths."""


def profile_label(table: Mapping[str, Any]) -> str:
    """Name of a profile on a dimension: its own, or one made from its values.

    Examples
    --------
    >>> profile_label({"kind": "cylinder", "fillet_radius": 2e-4})
    'cylinder fillet_radius=0.0002'
    >>> profile_label({"kind": "sum", "terms": [{"kind": "cylinder"}, {"kind": "ellipsoid", "crown_radius": 2.0}]})
    'cylinder + ellipsoid crown_radius=2'
    """
    return _composed(table, " ", lambda key, value: f"{key}={value:g}", lambda length: f"{length:g} m")


def profile_in_words(table: Mapping[str, Any]) -> str:
    """Return a profile's name, or its kind and values in the units of engineers.

    Examples
    --------
    >>> profile_in_words({"kind": "cylinder", "fillet_radius": 2e-4})
    'cylinder, fillet radius 0.2 mm'
    >>> profile_in_words({"kind": "lundberg", "design_pressure": 2e9})
    'lundberg, design pressure 2 GPa'
    """

    def said(key: str, value: float) -> str:
        return f"{key.replace('_', ' ')} {quantity(value, TABLE_UNITS.get(key, 'm'))}"

    return _composed(table, ", ", said, lambda length: quantity(length, "m"))


def _composed(
    table: Mapping[str, Any], between: str, said: Callable[[str, float], str], length: Callable[[float], str]
) -> str:
    """Name of a profile from its parts, with values and an effective length as they are to be written."""
    if "name" in table:
        return str(table["name"])

    def part(inner: Mapping[str, Any]) -> str:
        return _composed(inner, between, said, length)

    kind = str(table["kind"])
    if kind == "sum":
        return " + ".join(map(part, table["terms"]))
    if kind == "halves":
        return f"{part(table['left'])} | {part(table['right'])}"
    if kind == "measured":
        return f"measured {hashlib.sha256(json.dumps(table).encode()).hexdigest()[:8]}"
    if kind == own_profiles.KIND:
        return f"{table['class']} {table['content'][:8]}"
    if kind == "effective-length":
        return f"{part(table['profile'])} over {length(table['effective_length'])}"
    return between.join([kind, *(said(key, table[key]) for key in sorted(table) if key != "kind")])
