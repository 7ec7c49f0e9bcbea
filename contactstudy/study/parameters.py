"""The parameters of a study's case, in one table: name, check, unit, meaning, and the function that uses the parameter.

A new parameter is one entry of :data:`PARAMETERS` if `Case` or `choose_grid` has a keyword of the same name: the
signature contains the default, and the function receives the value. Every other parameter is used by name in
`contactstudy.study.case_setup.build_setup`. The identity of a case is a hash of its normalised parameters.
"""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.arrays.vocabulary import COORDINATES
from contactstudy.bodies.lubricant import OILS
from contactstudy.bodies.models import MODELS
from contactstudy.case.case import Case
from contactstudy.case.gridding import ACCURACY, TOLERANCE, choose_grid
from contactstudy.case.motion import MODELS as ROLLING_MODELS
from contactstudy.errors import InvalidInputError
from contactstudy.study.profile_tables import EDGE_KINDS, check_number, profile_table

MAX_POINTS = 100_000  # Largest number of points of a table {start, stop, count}
SCHEMA = 1  # Version of the parameters' meanings; raised only if a parameter changes its meaning


def check_flag(name: str, value: object) -> bool:
    """Return True or False."""
    checks.instance(name, value, (bool, np.bool_), "true or false")
    return bool(value)


def check_positive(name: str, value: object) -> float:
    """Return a positive number."""
    return checks.positive(name, check_number(name, value))


def check_points(name: str, value: object) -> list[float]:
    """Return points given as a list, or as a table {start, stop, count} of even spacing."""
    if isinstance(value, Mapping):
        for key in value:
            checks.known_name(f"{name} key", str(key), ("start", "stop", "count"))
        missing = {"start", "stop", "count"} - set(value)
        if missing:
            raise InvalidInputError(name, dict(value), "a list, or a table with start, stop and count")
        start, stop = (checks.finite(f"{name}.{key}", value[key]) for key in ("start", "stop"))
        count = checks.count(f"{name}.count", value["count"])
        if count > MAX_POINTS:
            raise InvalidInputError(f"{name}.count", count, f"at most {MAX_POINTS}")
        positions = np.linspace(start, stop, count)
    else:
        positions = checks.coordinates(name, value, "half-widths a")
    return [check_number(name, point) for point in positions.tolist()]


class Parameter(NamedTuple):
    """Specification of one parameter."""

    name: str
    units: str  # empty for a word
    meaning: str  # comment of the coordinate, and the documentation
    absent: str = ""  # meaning of a missing parameter without a default, for the documentation
    check: Callable[[str, object], Any] = check_number  # (name, value): returns the value for identities, or raises
    words: tuple[str, ...] = ()  # allowed words; the first is the default unless `absent` has another meaning
    consumer: Callable[..., Any] | None = None  # function with a keyword of this name, whose default is the default
    fallback: Any = None  # default of a parameter without a consumer; None: no default
    note: str = ""  # addition to the meaning, for the documentation
    label: str = ""  # long name of the coordinate, short enough for an axis; default: a result's long name, or `name`

    @property
    def attrs(self) -> dict[str, str]:
        """Attributes of the coordinate in a Dataset."""
        standard_label = COORDINATES[self.name].long_name if self.name in COORDINATES else self.name.replace("_", " ")
        attributes = {"units": self.units, "long_name": self.label or standard_label, "comment": self.meaning}
        return {name: text for name, text in attributes.items() if text}

    def normalize(self, value: object) -> Any:
        """Return a value in the normalised form of identities; a scalar with another unit is converted."""
        value = checks.scalar(self.name, value, self.units)
        if not self.words:
            return self.check(self.name, value)
        checks.instance(self.name, value, str, "text")
        return checks.known_name(self.name, str(value), self.words)

    @property
    def default(self) -> Any:
        """Value of a case without the parameter; None if it is required or optional."""
        if self.words:
            return None if self.absent else self.words[0]
        value = self.fallback
        if self.consumer is not None:
            value = inspect.signature(self.consumer).parameters[self.name].default
        return None if value is None else self.check(self.name, value)


UNIFORM_CELL_PARAMETERS = ("cells_x", "cells_y", "window", "margin")  # a case with one has uniform cells

_PARAMETERS = (
    Parameter(
        "body",
        "",
        "kind of elastic body",
        words=("finite-length", "quarter-space", "half-space"),
        note="`finite-length`, `quarter-space` (one free end, at x = 0) or `half-space`",
    ),
    Parameter("body_edge", "", "edge of the body's top", check=partial(profile_table, kinds=EDGE_KINDS), consumer=Case),
    Parameter(
        "model",
        "",
        "model of the free ends",
        words=MODELS,
        label="model of the free ends",
        note="`exact`; for comparison `mirror` and `mirror-factor`, usual approximations, and `single-mirror` (two "
        "ends only), the published scheme with one pair of images",
    ),
    Parameter("young", "Pa", "Young's modulus of the body", "required", label="Young's modulus"),
    Parameter("poisson", "1", "Poisson's ratio of the body", "required", label="Poisson's ratio"),
    Parameter("radius", "m", "roller radius", "required"),
    Parameter("roller_length", "m", "roller length; the body is longer by 2 e", "or `gamma`"),
    Parameter("gamma", "1", "body length over roller radius; the roller is shorter by 2 e", "or `roller_length`"),
    Parameter(
        "e_over_a", "1", COORDINATES["e_over_a"].comment, "or `end_distance`", note="negative: the roller overhangs"
    ),
    Parameter("end_distance", "m", "distance e of roller end and free end", "or `e_over_a`"),
    Parameter(
        "max_pressure",
        "Pa",
        "peak pressure p0 of the Hertz line contact",
        "or `load`",
        consumer=Case,
        label="Hertz pressure p0",
    ),
    Parameter("load", "N", "normal load", "or `max_pressure`", consumer=Case, label="normal load"),
    Parameter(
        "approach",
        "m",
        "approach at mid-length, from first contact without tilt, relative to reference_depth",
        "or `load`",
        consumer=Case,
        note="determines load and a: give `end_distance`, but no uniform cells or stress points, which scale with a",
    ),
    Parameter("friction", "1", "coefficient of friction", consumer=Case),
    Parameter("profile", "", "roller profile", check=profile_table, fallback={"kind": "cylinder"}),
    Parameter(
        "roller_body",
        "",
        "roller as a rigid shape or as an elastic body",
        words=("rigid", "finite-length", "half-space"),
        note="`rigid`; `finite-length`, with free ends; or `half-space`",
    ),
    Parameter(
        "roller_young", "Pa", "Young's modulus of an elastic roller", "the body's", label="roller's Young's modulus"
    ),
    Parameter(
        "roller_poisson", "1", "Poisson's ratio of an elastic roller", "the body's", label="roller's Poisson's ratio"
    ),
    Parameter(
        "reference_depth",
        "m",
        "depth of the material line below the load to which approach and tilt refer",
        "one length between free ends, else far away",
    ),
    Parameter(
        "roller_reference_depth",
        "m",
        "distance from the contact to the reference line of an elastic roller",
        "the roller's length with free ends, else far away",
    ),
    Parameter("tilt", "rad", "misalignment from reference_depth; positive: larger x is pressed deeper", consumer=Case),
    Parameter(
        "load_offset",
        "m",
        "position of the load, from mid-length",
        "the tilt is prescribed",
        note="the roller tilts until it balances",
    ),
    Parameter("coupled", "1", "whether friction displaces the surface normally", check=check_flag, consumer=Case),
    Parameter(
        "motion",
        "",
        "motion of the roller against the body",
        words=("sliding", "shift", "rolling"),
        note="`sliding`: full sliding; `shift`: one shift from rest; `rolling`: steady; the last two stick and slip",
    ),
    Parameter(
        "longitudinal_creepage",
        "1",
        "velocity of the roller's surface against the body along y over the rolling speed",
        "0",
        note="rolling only; or `force_y`",
    ),
    Parameter("lateral_creepage", "1", "the same velocity ratio along x", "0", note="rolling only; or `force_x`"),
    Parameter(
        "spin", "rad/m", "angular velocity about z over the rolling speed", "0", note="rolling only; or `moment_z`"
    ),
    Parameter("shift_x", "m", "rigid shift along x", "0", note="shift only; or `force_x`"),
    Parameter("shift_y", "m", "rigid shift along y", "0", note="shift only; or `force_y`"),
    Parameter("force_x", "N", "force on the body along x", "follows", note="shift or rolling; less than slides"),
    Parameter("force_y", "N", "force on the body along y", "follows", note="shift or rolling"),
    Parameter("moment_z", "N m", "moment on the body about the roller's middle", "follows", note="rolling only"),
    Parameter(
        "rolling_model",
        "",
        "model of the tractions of rolling",
        words=ROLLING_MODELS,
        note="`exact`; for comparison `fastsim`, strips without an influence of neighbours and free ends",
    ),
    Parameter("lubricant", "", "oil of a film between the surfaces", "or `viscosity`; dry", words=tuple(OILS)),
    Parameter("temperature", "degC", "temperature of the oil in the inlet", "with `lubricant`"),
    Parameter("viscosity", "Pa s", "viscosity at ambient pressure", "or `lubricant`; dry", check=check_positive),
    Parameter("pressure_viscosity", "Pa-1", "pressure-viscosity coefficient", "with `viscosity`", check=check_positive),
    Parameter(
        "entrainment_speed",
        "m s-1",
        "mean speed of both surfaces along +y",
        "required for a film",
        check=check_positive,
    ),
    Parameter("slide_roll_ratio", "1", "difference of the speeds over their mean", "0"),
    Parameter("roughness_rms", "m", "composite rms roughness", "smooth", check=check_positive),
    Parameter(
        "accuracy",
        "1",
        "largest error of peak, end pressures and end loads, over the peak",
        f"{ACCURACY:g}",
        note="the solver refines the columns accordingly; left out with parameters of uniform cells",
    ),
    Parameter("cells_x", "1", "cells per half-width a along x", consumer=choose_grid, note="uniform cells"),
    Parameter("cells_y", "1", "cells per half-width a along y", consumer=choose_grid, note="uniform cells"),
    Parameter(
        "window",
        "1",
        "half-width of the window in y over a",
        consumer=choose_grid,
        note="for uniform cells; a default window grows with the contact, a given window does not",
    ),
    Parameter(
        "margin",
        "1",
        "distance from roller to grid edge over a, where the body goes on",
        consumer=choose_grid,
        note="uniform cells",
    ),
    Parameter("tolerance", "1", "tolerance of the contact iteration", fallback=TOLERANCE),
    Parameter("stresses", "1", "whether stresses are calculated", check=check_flag, fallback=True),
    Parameter(
        "field_x_over_a",
        "1",
        "stress points: x from the free end over a",
        "from face to face",
        check=check_points,
        note="a list, or `{start, stop, count}`",
    ),
    Parameter("field_y_over_a", "1", "stress points: y over a", "cell centres", check=check_points),
    Parameter("field_z_over_a", "1", "stress points: depth over a", "13 to 25 depths to 5 a", check=check_points),
)
PARAMETERS: dict[str, Parameter] = {entry.name: entry for entry in _PARAMETERS}  # of a case, by name
DEFAULTS: dict[str, Any] = {name: entry.default for name, entry in PARAMETERS.items() if entry.default is not None}
REQUIRED = (  # Groups of parameters; every case has exactly one parameter of each group
    ("young",),
    ("poisson",),
    ("radius",),
    ("gamma", "roller_length"),
    ("e_over_a", "end_distance"),
    ("max_pressure", "load", "approach"),
)


def keywords_of(function: Callable[..., Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters that are keyword arguments of `function`."""
    return {name: value for name, value in values.items() if PARAMETERS[name].consumer is function}


def check_parameters(values: Mapping[str, Any], where: str = "parameter") -> dict[str, Any]:
    """Return `values` with known names and checked types, in the table's order, without values that are None."""
    for name in values:
        checks.known_name(where, str(name), PARAMETERS)
    return {
        name: parameter.normalize(values[name])
        for name, parameter in PARAMETERS.items()
        if values.get(name) is not None
    }


def add_default_accuracy(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return checked `values` with the default accuracy, unless the cells are uniform; identities depend on it."""
    has_cells = any(name in values for name in ("accuracy", *UNIFORM_CELL_PARAMETERS))
    return dict(values) if has_cells else {**values, "accuracy": ACCURACY}


def identity_value(name: str, value: Any) -> Any:
    """Part of a checked value that belongs to the identity; None for a default."""
    if isinstance(value, dict):
        value = {key: entry for key, entry in value.items() if key != "name"}
    return None if value == DEFAULTS.get(name) else value


def without_defaults(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return checked `values` without defaults and without a profile's name."""
    return {name: entry for name, value in values.items() if (entry := identity_value(name, value)) is not None}


def with_defaults(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return `values` completed by the defaults."""
    return DEFAULTS | dict(values)


def identity_fragment(name: str, value: Any) -> str:
    """Part of a checked parameter in JSON with sorted keys and without spaces; empty if the value is the default."""
    value = identity_value(name, value)
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return "" if value is None else f'"{name}":{text}'


def hash_fragments(fragments: Iterable[str]) -> bytes:
    """Identity of a case, SHA-256 in 64 hexadecimal digits, from the fragments of its parameters, sorted by name."""
    content = ",".join(filter(None, fragments))
    return hashlib.sha256(f'{{"case":{{{content}}},"schema":{SCHEMA}}}'.encode()).hexdigest().encode()


def _format_default(value: Any) -> str:
    """Return a default in the notation of a study file."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {_format_default(entry)}' for key, entry in value.items())}}}"
    return f'"{value}"' if isinstance(value, str) else f"{value:g}"


def parameter_table() -> str:
    """Return the table of all parameters in Markdown, for the documentation."""
    rows = ["| parameter | default | unit | meaning |", "|---|---|---|---|"]
    for name, entry in PARAMETERS.items():
        default = entry.absent if entry.default is None else f"`{_format_default(entry.default)}`"
        meaning = f"{entry.meaning}; {entry.note}" if entry.note else entry.meaning
        rows.append(f"| `{name}` | {default} | {entry.units if entry.units != '1' else ''} | {meaning} |")
    return "\n".join(rows)
