"""A profile of a study in words, with the units of engineers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from contactstudy.arrays.engineering import quantity
from contactstudy.profiles.base import UNITS
from contactstudy.study import own_profiles
from contactstudy.study.profile_kinds import profile_label

TABLE_UNITS = UNITS | {"design_pressure": "Pa", "design_load": "N"}
"""Units of the values of a profile's table that are no lengths."""


def profile_in_words(table: Mapping[str, Any]) -> str:
    """Return a profile's name, or its kind and values in the units of engineers.

    Examples
    --------
    >>> profile_in_words({"kind": "cylinder", "fillet_radius": 2e-4})
    'cylinder, fillet radius 0.2 mm'
    >>> profile_in_words({"kind": "lundberg", "design_pressure": 2e9})
    'lundberg, design pressure 2 GPa'
    """
    kind = str(table.get("kind", ""))
    if not kind or "name" in table or kind in ("measured", own_profiles.KIND):
        return profile_label(table)
    if kind == "sum":
        return " + ".join(profile_in_words(term) for term in table["terms"])
    if kind == "halves":
        return f"{profile_in_words(table['left'])} | {profile_in_words(table['right'])}"
    if kind == "effective-length":
        return f"{profile_in_words(table['profile'])} over {quantity(table['effective_length'], 'm')}"
    values = [
        f"{key.replace('_', ' ')} {quantity(table[key], TABLE_UNITS.get(key, 'm'))}"
        for key in sorted(table)
        if key != "kind"
    ]
    return ", ".join([kind, *values])
