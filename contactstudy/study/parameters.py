"""The parameters of a study's case, in one table: name, check, unit, meaning, and the function that takes it.

A new parameter is one entry of :data:`PARAMETERS` if `Case`, `choose_grid` or `solver_settings` has a keyword of the
same name: its default is read from that signature, and the value is handed on. Any other parameter is used by name in
:func:`contactstudy.study.setup.setup_of`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from contactstudy import checks
from contactstudy.arrays.vocabulary import COORDINATES
from contactstudy.bodies.models import MODELS
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.motion import MODELS as ROLLING_MODELS
from contactstudy.case.settings import ACCURACY, solver_settings
from contactstudy.study.motion_kinds import KINDS
from contactstudy.study.numbers import number
from contactstudy.study.parameter import Parameter, flag, one_of, points, profile

UNIFORM = ("cells_x", "cells_y", "window", "margin", "error_estimate")
"""Parameters of uniform cells; a case that gives one of them has such cells."""

BODIES = ("finite-length", "quarter-space", "half-space")

# How a roller's ends are treated, by the name of the body that it is; None for a rigid one.
ROLLER_BODIES: dict[str, str | None] = {"rigid": None, "finite-length": "free", "half-space": "none"}

_WITH_CASE = (
    Parameter(
        "body",
        one_of(BODIES),
        "",
        "kind of elastic body",
        fallback=BODIES[0],
        note="`finite-length`, `quarter-space` (one free end, at x = 0) or `half-space`",
    ),
    Parameter(
        "model",
        one_of(MODELS),
        "",
        "how free ends are treated",
        fallback=MODELS[0],
        note="`exact`; for comparison `mirror` and `mirror-factor`, quick fixes in use, and `single-mirror` (two ends "
        "only), the published scheme with one pair of images",
    ),
    Parameter("young", number, "Pa", "Young's modulus of the body", absent="required", label="Young's modulus"),
    Parameter("poisson", number, "1", "Poisson's ratio of the body", absent="required", label="Poisson's ratio"),
    Parameter("radius", number, "m", "roller radius", absent="required"),
    Parameter("roller_length", number, "m", "roller length; the body is longer by 2 e", absent="or `gamma`"),
    Parameter(
        "gamma",
        number,
        "1",
        "body length over roller radius; the roller is shorter by 2 e",
        absent="or `roller_length`",
        label=COORDINATES["gamma"].long_name,
    ),
    Parameter(
        "e_over_a",
        number,
        "1",
        COORDINATES["e_over_a"].comment,
        absent="or `end_distance`",
        label=COORDINATES["e_over_a"].long_name,
        note="negative: the roller overhangs",
    ),
    Parameter("end_distance", number, "m", "distance e of roller end and free end", absent="or `e_over_a`"),
    Parameter(
        "max_pressure",
        number,
        "Pa",
        "peak pressure p0 of the Hertz line contact",
        Case,
        absent="or `load`",
        label="Hertz pressure p0",
    ),
    Parameter("load", number, "N", "normal load", Case, absent="or `max_pressure`", label="normal load"),
    Parameter(
        "approach",
        number,
        "m",
        "how far the roller is pressed down at its mid-length, from first touch without tilt",
        Case,
        absent="or `load`",
        note="the load results, and with it a: give `end_distance`, and leave out uniform cells and stress points, "
        "which are over a",
    ),
    Parameter("friction", number, "1", "coefficient of friction", Case, label=COORDINATES["friction"].long_name),
    Parameter(
        "profile", profile, "", "roller profile", fallback={"kind": "cylinder"}, label=COORDINATES["profile"].long_name
    ),
    Parameter(
        "roller_body",
        one_of(ROLLER_BODIES),
        "",
        "roller as a rigid shape or as an elastic body",
        fallback="rigid",
        note="`rigid`; `finite-length`, with free ends; or `half-space`",
    ),
    Parameter(
        "roller_young",
        number,
        "Pa",
        "Young's modulus of an elastic roller",
        absent="the body's",
        label="roller's Young's modulus",
    ),
    Parameter(
        "roller_poisson",
        number,
        "1",
        "Poisson's ratio of an elastic roller",
        absent="the body's",
        label="roller's Poisson's ratio",
    ),
    Parameter("tilt", number, "rad", "misalignment of the roller; positive if larger x is pressed deeper", Case),
    Parameter(
        "load_offset",
        number,
        "m",
        "where the load acts, from mid-length",
        absent="the tilt is held",
        note="the roller tilts until it balances",
    ),
    Parameter("coupled", flag, "1", "whether friction displaces the surface normally", Case),
    Parameter(
        "motion",
        one_of(KINDS),
        "",
        "how the roller moves against the body",
        fallback=KINDS[0],
        note="`sliding` fully; `shift`, one from rest, or `rolling`, steady, both with stick and slip",
    ),
    Parameter(
        "longitudinal_creepage",
        number,
        "1",
        "velocity of the roller's surface against the body along y over the rolling speed",
        absent="0",
        note="rolling only; or `force_y`",
    ),
    Parameter("lateral_creepage", number, "1", "likewise along x", absent="0", note="rolling only; or `force_x`"),
    Parameter(
        "spin",
        number,
        "rad/m",
        "angular velocity about z over the rolling speed",
        absent="0",
        note="rolling only; or `moment_z`",
    ),
    Parameter("shift_x", number, "m", "rigid shift along x", absent="0", note="shift only; or `force_x`"),
    Parameter("shift_y", number, "m", "rigid shift along y", absent="0", note="shift only; or `force_y`"),
    Parameter(
        "force_x", number, "N", "force on the body along x", absent="follows", note="shift or rolling; less than slides"
    ),
    Parameter("force_y", number, "N", "force on the body along y", absent="follows", note="likewise"),
    Parameter(
        "moment_z", number, "N m", "moment on the body about the roller's middle", absent="follows", note="rolling only"
    ),
    Parameter(
        "rolling_model",
        one_of(ROLLING_MODELS),
        "",
        "how the tractions of rolling are found",
        fallback=ROLLING_MODELS[0],
        note="`exact`; for comparison `fastsim`, strips without an influence of neighbours and free ends",
    ),
)
_WITH_SOLVER = (
    Parameter(
        "accuracy",
        number,
        "1",
        "error over the peak to which peak, end pressures and end loads are settled",
        absent=f"{ACCURACY:g}",
        note="columns are refined until it is reached; without one, if anything is said about cells, these are uniform",
    ),
    Parameter("cells_x", number, "1", "cells per half-width a along x", choose_grid, note="uniform cells"),
    Parameter("cells_y", number, "1", "cells per half-width a along y", choose_grid, note="uniform cells"),
    Parameter(
        "window",
        number,
        "1",
        "half-width of the window in y over a",
        choose_grid,
        note="uniform cells; the default is widened where the contact needs more; any other value is kept",
    ),
    Parameter(
        "margin",
        number,
        "1",
        "distance from roller to grid edge over a, where the body goes on",
        choose_grid,
        note="uniform cells",
    ),
    Parameter("tolerance", number, "1", "tolerance of the contact iteration", solver_settings),
    Parameter(
        "error_estimate",
        flag,
        "1",
        "whether a contact on half the cells gives the discretisation error",
        solver_settings,
        note="uniform cells",
    ),
    Parameter("stresses", flag, "1", "whether stresses are calculated", solver_settings),
    Parameter(
        "field_x_over_a",
        points,
        "1",
        "stress points: x from the free end over a",
        absent="cell centres",
        note="a list, or `{start, stop, count}`",
    ),
    Parameter("field_y_over_a", points, "1", "stress points: y over a", absent="cell centres"),
    Parameter("field_z_over_a", points, "1", "stress points: depth over a", absent="19 depths"),
)
PARAMETERS: dict[str, Parameter] = {entry.name: entry for entry in (*_WITH_CASE, *_WITH_SOLVER)}
"""Every parameter that a case of a study can have."""

REQUIRED = (
    ("young",),
    ("poisson",),
    ("radius",),
    ("gamma", "roller_length"),
    ("e_over_a", "end_distance"),
    ("max_pressure", "load", "approach"),
)
"""Parameters of which every case gives exactly one."""


def taken_by(taker: Callable[..., Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return those of `values` that `taker` has keyword arguments for.

    Examples
    --------
    >>> taken_by(choose_grid, {"cells_x": 4.0, "friction": 0.1})
    {'cells_x': 4.0}
    """
    return {name: value for name, value in values.items() if PARAMETERS[name].taker is taker}


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
        name: parameter.checked(values[name]) for name, parameter in PARAMETERS.items() if values.get(name) is not None
    }


def completed(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return checked `values` with the accuracy of a case that says nothing about its cells.

    It counts for the identity: a case without it has uniform cells, as every case had before columns were refined.

    Examples
    --------
    >>> completed({"friction": 0.1}), completed({"cells_x": 4.0})
    ({'friction': 0.1, 'accuracy': 0.01}, {'cells_x': 4.0})
    """
    said = any(name in values for name in ("accuracy", *UNIFORM))
    return dict(values) if said else {**values, "accuracy": ACCURACY}


def counted(name: str, value: Any) -> Any:
    """Return what of a checked value counts for a case's identity; None if that is its default.

    Examples
    --------
    >>> counted("friction", 0.0), counted("profile", {"kind": "tapered", "half_angle": 0.1, "name": "ours"})
    (None, {'kind': 'tapered', 'half_angle': 0.1})
    """
    if name == "profile":
        value = {key: entry for key, entry in value.items() if key != "name"}
    return None if value == PARAMETERS[name].default else value


def without_defaults(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return checked `values` without those that equal the default and without a profile's name."""
    pairs = ((name, counted(name, value)) for name, value in values.items())
    return {name: value for name, value in pairs if value is not None}


def with_defaults(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return `values` completed by the defaults."""
    return {name: entry.default for name, entry in PARAMETERS.items() if entry.default is not None} | dict(values)


def _written(value: Any) -> str:
    """Return a default as it is written in a study file."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {_written(entry)}' for key, entry in value.items())}}}"
    return f'"{value}"' if isinstance(value, str) else f"{value:g}"


def documented() -> str:
    """Return the table of all parameters in Markdown, as the documentation shows it."""
    rows = ["| parameter | default | unit | meaning |", "|---|---|---|---|"]
    for name, entry in PARAMETERS.items():
        default = entry.absent if entry.default is None else f"`{_written(entry.default)}`"
        meaning = f"{entry.meaning}; {entry.note}" if entry.note else entry.meaning
        rows.append(f"| `{name}` | {default} | {entry.units if entry.units != '1' else ''} | {meaning} |")
    return "\n".join(rows)
