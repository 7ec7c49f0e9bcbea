"""The parameters of a study's case, in one table: name, kind, default, unit, meaning."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.bodies.models import MODELS
from contactstudy.errors import InvalidInputError
from contactstudy.study.kinds import BODIES, ROLLER_BODIES
from contactstudy.study.profile_kinds import profile_table

DIGITS = 12
"""Significant digits of a number in a study: more would tell apart values that are the same."""


def rounded(value: float) -> float:
    """Return `value` to :data:`DIGITS` significant digits, with one zero instead of two.

    Examples
    --------
    >>> rounded(0.1 + 0.2), rounded(-0.0)
    (0.3, 0.0)
    """
    return float(f"{value:.{DIGITS}g}") + 0.0


def _number(name: str, value: object) -> float:
    return rounded(checks.finite(name, value))


def _flag(name: str, value: object) -> bool:
    checks.instance(name, value, (bool, np.bool_), "true or false")
    return bool(value)


def _body(name: str, value: object) -> str:
    checks.instance(name, value, str, "text")
    return checks.known_name(name, str(value), BODIES)


def _model(name: str, value: object) -> str:
    checks.instance(name, value, str, "text")
    return checks.known_name(name, str(value), MODELS)


def _roller_body(name: str, value: object) -> str:
    checks.instance(name, value, str, "text")
    return checks.known_name(name, str(value), ROLLER_BODIES)


def _profile(name: str, value: object) -> dict[str, Any]:
    return {key: _rounded_within(entry) for key, entry in profile_table(value).items()}


def _rounded_within(entry: Any) -> Any:
    """Return an entry of a profile's table with all its numbers rounded."""
    if isinstance(entry, float):
        return rounded(entry)
    if isinstance(entry, list):
        return [_rounded_within(part) for part in entry]
    if isinstance(entry, dict):
        return {key: _rounded_within(part) for key, part in entry.items()}
    return entry


def _points(name: str, value: object) -> list[float]:
    """Points as a list: given so, or as a table {start, stop, count} of evenly spaced ones."""
    if isinstance(value, Mapping):
        for key in value:
            checks.known_name(f"{name} key", str(key), ("start", "stop", "count"))
        missing = {"start", "stop", "count"} - set(value)
        if missing:
            raise InvalidInputError(name, dict(value), "a list, or a table with start, stop and count")
        start, stop = (checks.finite(f"{name}.{key}", value[key]) for key in ("start", "stop"))
        points = np.linspace(start, stop, checks.count(f"{name}.count", value["count"]))
    else:
        points = checks.coordinates(name, value, "half-widths a")
    return [rounded(float(point)) for point in points]


class Parameter(NamedTuple):
    """Specification of one parameter; `default` None means that there is none, or that it may be left out."""

    check: Callable[[str, object], Any]
    default: Any
    units: str
    meaning: str


PARAMETERS: dict[str, Parameter] = {
    "body": Parameter(_body, "finite-length", "", "kind of elastic body"),
    "model": Parameter(_model, MODELS[0], "", "how free ends are treated: exactly, or by a quick fix for comparison"),
    "young": Parameter(_number, None, "Pa", "Young's modulus"),
    "poisson": Parameter(_number, None, "1", "Poisson's ratio"),
    "radius": Parameter(_number, None, "m", "roller radius"),
    "roller_length": Parameter(_number, None, "m", "roller length; the body is longer by 2 e"),
    "gamma": Parameter(_number, None, "1", "body length over roller radius; the roller is shorter by 2 e"),
    "e_over_a": Parameter(_number, None, "1", "distance e of roller end and free end over Hertz half-width a"),
    "end_distance": Parameter(_number, None, "m", "distance e of roller end and free end"),
    "max_pressure": Parameter(_number, None, "Pa", "peak pressure p0 of the Hertz line contact"),
    "load": Parameter(_number, None, "N", "normal load"),
    "friction": Parameter(_number, 0.0, "1", "coefficient of friction"),
    "profile": Parameter(_profile, {"kind": "cylinder"}, "", "roller profile"),
    "roller_body": Parameter(_roller_body, "rigid", "", "roller as a rigid shape or as an elastic body"),
    "roller_young": Parameter(_number, None, "Pa", "Young's modulus of an elastic roller; default: the body's"),
    "roller_poisson": Parameter(_number, None, "1", "Poisson's ratio of an elastic roller; default: the body's"),
    "tilt": Parameter(_number, 0.0, "rad", "misalignment of the roller; positive if larger x is pressed deeper"),
    "load_offset": Parameter(_number, None, "m", "where the load acts, from mid-length; default: the tilt is held"),
    "coupled": Parameter(_flag, False, "1", "whether friction displaces the surface normally"),
    "cells_x": Parameter(_number, 8.0, "1", "cells per half-width a along x"),
    "cells_y": Parameter(_number, 16.0, "1", "cells per half-width a along y"),
    "window": Parameter(_number, 2.0, "1", "half-width of the window in y over a"),
    "margin": Parameter(_number, 4.0, "1", "distance from roller to grid edge over a, where the body goes on"),
    "tolerance": Parameter(_number, 1e-6, "1", "tolerance of the contact iteration"),
    "error_estimate": Parameter(
        _flag, False, "1", "whether a contact on half the cells gives the discretisation error"
    ),
    "stresses": Parameter(_flag, True, "1", "whether stresses are calculated"),
    "field_x_over_a": Parameter(_points, None, "1", "stress points: x from the free end over a"),
    "field_y_over_a": Parameter(_points, None, "1", "stress points: y over a"),
    "field_z_over_a": Parameter(_points, None, "1", "stress points: depth over a"),
}
"""Every parameter that a case of a study can have."""


def checked(values: Mapping[str, Any], where: str = "parameter") -> dict[str, Any]:
    """Return `values` with known names and checked types, in the table's order; a None is left out.

    Parameters
    ----------
    values : mapping
        Parameters of a case.
    where : str
        What the names are, for error messages.

    Raises
    ------
    InvalidInputError
        If a name is unknown (with the nearest known one), or a value is of a wrong type.

    Examples
    --------
    >>> import numpy as np
    >>> checked({"friction": np.int64(1), "body": "half-space"})
    {'body': 'half-space', 'friction': 1.0}
    """
    for name in values:
        checks.known_name(where, str(name), PARAMETERS)
    return {
        name: parameter.check(name, values[name])
        for name, parameter in PARAMETERS.items()
        if values.get(name) is not None
    }


def without_defaults(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return checked `values` without those that equal the default and without a profile's name."""
    kept = {}
    for name, value in values.items():
        if name == "profile":
            value = {key: entry for key, entry in value.items() if key != "name"}
        if value != PARAMETERS[name].default:
            kept[name] = value
    return kept


def with_defaults(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return `values` completed by the defaults."""
    defaults = {name: entry.default for name, entry in PARAMETERS.items() if entry.default is not None}
    return defaults | dict(values)
