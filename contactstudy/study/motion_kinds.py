"""The motion of a study's case, from parameters that are numbers and words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from contactstudy.case.motion import Motion, Rolling, Shift, Sliding
from contactstudy.errors import InvalidInputError

KINDS = ("sliding", "shift", "rolling")
"""Motions by name, the default first."""

_TAKES = {
    "sliding": {},
    "shift": {"shift_x": "x", "shift_y": "y", "force_x": "force_x", "force_y": "force_y"},
    "rolling": {
        "longitudinal_creepage": "longitudinal_creepage",
        "lateral_creepage": "lateral_creepage",
        "spin": "spin",
        "force_x": "force_x",
        "force_y": "force_y",
        "moment_z": "moment_z",
    },
}
"""Parameters that a motion takes, and what it calls them."""

_ALL = tuple(dict.fromkeys(name for takes in _TAKES.values() for name in takes))


def motion_of(values: Mapping[str, Any]) -> Motion:
    """Motion of a case, from its checked parameters with their defaults.

    Raises
    ------
    InvalidInputError
        If a parameter is given that this motion does not have, or a creepage or shift together with its force.

    Examples
    --------
    >>> motion_of({"motion": "shift", "shift_y": 1e-6, "rolling_model": "exact"})
    Shift(x=0.0, y=1e-06, force_x=None, force_y=None)
    """
    kind, takes = values["motion"], _TAKES[values["motion"]]
    for name in _ALL:
        if name in values and name not in takes:
            owners = " or ".join(repr(other) for other, theirs in _TAKES.items() if name in theirs)
            raise InvalidInputError(name, values[name], f"left out for motion = {kind!r}", f"it belongs to {owners}")
    if kind != "rolling" and values["rolling_model"] != "exact":
        raise InvalidInputError("rolling_model", values["rolling_model"], f"left out for motion = {kind!r}")
    given = {own: values[name] for name, own in takes.items() if name in values}
    if kind == "rolling":
        return Rolling(**given, model=values["rolling_model"])
    return Shift(**given) if kind == "shift" else Sliding()
