"""Tables of a case: its inputs, and its main numbers with their errors."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from contactstudy.analysis import contact_edges, cut_ends, peak, single_case
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute
from contactstudy.arrays.engineering import NUMBER_STYLE, TEXT_STYLE, format_quantity, format_with_error, html_table
from contactstudy.arrays.variables import AXES, NOT_ESTIMATED, STRESSES, UNKNOWN_ERROR, variable_of
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, FiniteLengthSpace
from contactstudy.case.case import Case
from contactstudy.case.gridding import TOLERANCE
from contactstudy.case.motion import AxialFriction, Sliding
from contactstudy.contact.solve import reference_depths
from contactstudy.profiles import Cylinder, Profile, Shape
from contactstudy.profiles.base import describe_profile

SINGULAR = "singular: unbounded towards a sharp end"
CELL_MEAN = f"mean over the cell of largest pressure, {UNKNOWN_ERROR}"
OPEN_END = "no contact at this end"
ENDS = {"first": "end I", "last": "end II"}  # Ends of the roller: suffixes of variables, and names in the table
HERTZ_MEANINGS = {
    "normal_load": "normal load",
    "hertz_max_pressure": "Hertz pressure p0",
    "hertz_half_width": "Hertz half-width a",
}
FILM_NAMES = ("central_film", "least_film", "end_film_ratio", "least_film_ratio")  # rows if present
CORNER_NAMES = ("corner_x", "corner_slope", "corner_intensity", "corner_distance")  # rows unless NaN
SCALAR_MEANINGS = {  # Scalars that have a row if present and not zero, with the row's text
    "approach": "approach of roller and body",
    "tilt": "tilt",
    "reference_depth": "reference depth of approach and tilt in the body",
    "roller_reference_depth": "reference depth of approach and tilt in the roller",
    "load_position": "position x of the resultant",
    "force_x": "force along the axis",
    "force_y": "force along rolling",
    "moment_z": "moment about z",
    "longitudinal_creepage": "longitudinal creepage",
    "lateral_creepage": "lateral creepage",
    "spin": "spin",
    "shift_x": "shift along the axis",
    "shift_y": "shift along rolling",
    "friction_work": "frictional work",
}

OUTPUTS = ("approach", "load_position", "force_x", "force_y", "moment_z", "shift_x", "shift_y", "friction_work")
"""Scalars among `SCALAR_MEANINGS` that follow from the solution unless the case prescribes them."""

BALANCED = "load_position"  # Scalar whose ``_error`` is the residual of a prescribed value, in other units


class Quantity(NamedTuple):
    """Row of a summary."""

    name: str
    meaning: str
    value: float  # SI
    error: float  # SI; NaN without an estimate
    units: str
    text: str  # value and error in engineers' units
    remark: str = ""  # why a value has no error or is unbounded; for a position, the nearest end
    mark: str = ""  # kind of the remark: "not estimated", "singular", "open", "law" or "rounding"


@dataclass(frozen=True)
class Summary:
    """Main numbers of a result; prints as a table, in a notebook too."""

    numbers: tuple[Quantity, ...]

    def __getitem__(self, name: str) -> Quantity:
        return next(row for row in self.numbers if row.name == name)

    def __contains__(self, name: object) -> bool:
        return any(row.name == name for row in self.numbers)

    def __repr__(self) -> str:
        meaning_width = max((len(row.meaning) for row in self.numbers), default=0)
        text_width = max((len(row.text) for row in self.numbers), default=0)
        rows = ((row.meaning.ljust(meaning_width), row.text.ljust(text_width), row.remark) for row in self.numbers)
        return "\n".join("  ".join(row).rstrip() for row in rows)

    def _repr_html_(self) -> str:
        rows = ((row.meaning, row.text, row.remark) for row in self.numbers)
        return html_table([("", rows)], styles=(TEXT_STYLE, NUMBER_STYLE, TEXT_STYLE))

    def to_dataframe(self) -> pd.DataFrame:
        """Table of the numbers in SI, by name."""
        rows = pd.DataFrame(self.numbers, columns=Quantity._fields).set_index("name")
        return rows[["value", "error", "units", "meaning", "remark"]]


def summary(dataset: xr.Dataset) -> Summary:
    """Return the main numbers of a result with their errors, in engineers' units.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, its file, or one case selected from a study.

    Returns
    -------
    Summary
        Load, Hertz pressure and half-width, peak and end pressures, laws of singular ends, loads on the ends, length
        of the contact, largest von Mises stress and its position, approach, tilt, and the quantities of rolling, as far
        as the result contains them. `to_dataframe` has the values in SI.

    Raises
    ------
    InvalidInputError
        If the Dataset contains more than one case.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0e9], [2.0e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0]})
    >>> summary(xr.Dataset({"pressure": pressure, "hertz_max_pressure": 1.5e9}))
    Hertz pressure p0  1.5 GPa
    largest pressure   2 GPa    mean over the cell of largest pressure, error not estimated
    """
    return Summary(tuple(_create_rows(single_case(dataset))))


def _create_rows(case: xr.Dataset) -> Iterator[Quantity]:
    """Rows of a case."""
    for name, meaning in HERTZ_MEANINGS.items():
        if name in case:
            yield _create_row(case, name, meaning, None if f"{name}_error" in case else "")
    yield from _peak_pressure_rows(case)
    for suffix, end in ENDS.items():
        if f"end_pressure_{suffix}" in case:
            yield _create_row(case, f"end_pressure_{suffix}", f"pressure at {end} of the roller")
        name, exponent = f"end_intensity_{suffix}", float(case.get(f"end_exponent_{suffix}", np.nan))
        if np.isfinite(exponent):
            value, error = float(case[name]), float(case.get(f"{name}_error", np.nan))
            factor, units = 1e9 * 1e-3**exponent, f"Pa m^{exponent:.3g}"
            text = format_with_error(value / factor, error / factor, f"GPa mm^{exponent:.3g}")
            remark = f"p = K / d^{exponent:.3g} at the distance d from the end"
            yield Quantity(name, f"intensity K at {end}", value, error, units, text=text, remark=remark, mark="law")
        if f"end_load_{suffix}" in case:
            yield _create_row(case, f"end_load_{suffix}", f"load on the last half-width, {end}")
    for name in (*CORNER_NAMES, *FILM_NAMES):
        if not np.isnan(float(case.get(name, np.nan))):
            attributes = case[name].attrs
            comment = str(attributes.get("comment", "")) if name in CORNER_NAMES[:3] else None  # exact values
            yield _create_row(case, name, variable_of(name, attributes).long_name, comment)
    if {"pressure", "gap"} <= set(case.data_vars) and (case["pressure"] > 0).any() and not any(cut_ends(case)):
        case = case.assign(contact_length=contact_edges(case)["contact_length"])
    if "contact_length" in case:
        yield _create_row(case, "contact_length", "length of the contact")
    yield from _peak_stress_rows(case)
    yield from _edge_tension_rows(case)
    for name, meaning in SCALAR_MEANINGS.items():
        if abs(float(case.get(name, np.nan))) > 0:
            # In a study's case a residual above zero shows that the value was prescribed.
            has_rounding_error = name == BALANCED and float(case.get(f"{name}_error", 0.0)) > 0
            is_given = _prescribed_value(case, name) is not None or has_rounding_error or name not in OUTPUTS
            input_remark = "" if is_given and (name == BALANCED or f"{name}_error" not in case) else None
            row = _create_row(case.drop_vars(f"{BALANCED}_error", errors="ignore"), name, meaning, input_remark)
            yield _mark_rounding(case, row)
    yield from _slip_rows(case)


def _create_row(case: xr.Dataset, name: str, meaning: str, remark: str | None = None) -> Quantity:
    """Row of a scalar with its error, with the reason for a missing error, or with a remark instead."""
    value, error = float(case[name]), np.nan if remark is not None else float(case.get(f"{name}_error", np.nan))
    units, mark = variable_of(name, case[name].attrs).units, ""
    if remark is None:
        remark = str(case[f"{name}_error"].attrs.get("comment", "")) if f"{name}_error" in case else ""
        if np.isinf(value):
            remark, mark = SINGULAR if name.startswith("end_") else _describe_singularity(case), "singular"
        elif np.isnan(error):
            remark, mark = UNKNOWN_ERROR, NOT_ESTIMATED
        elif np.isinf(error):
            remark, mark = f"{UNKNOWN_ERROR}: {remark or 'two grids show no limit'}", NOT_ESTIMATED
        elif value == 0 and error == 0 and name.startswith("end_"):
            remark, mark = OPEN_END, "open"
    text = format_with_error(value, error, units)
    return Quantity(name, meaning, value, error, units, text=text, remark=remark, mark=mark)


def _describe_singularity(case: xr.Dataset) -> str:
    """Remark on an infinite peak: the corner or end at which the pressure is unbounded."""
    x = float(case.get("corner_x", np.nan))
    return SINGULAR if np.isnan(x) else f"singular: unbounded towards the corner at x = {format_quantity(x, 'm')}"


def _peak_pressure_rows(case: xr.Dataset) -> Iterator[Quantity]:
    """Row of the largest pressure: refined, or of a cell."""
    if "peak_pressure" not in case and "pressure" in case:
        case = case.assign(peak_pressure=float(case["pressure"].max()))
    if "peak_pressure" in case:
        is_refined = "peak_pressure_error" in case or np.isinf(float(case["peak_pressure"]))
        row = _create_row(case, "peak_pressure", "largest pressure")
        yield row if is_refined else row._replace(remark=CELL_MEAN)


def _peak_stress_rows(case: xr.Dataset) -> Iterator[Quantity]:
    """Rows of the largest von Mises stress and its position; unbounded at a singular end."""
    name, meaning = "peak_von_mises", "largest von Mises stress"
    singular = np.isinf(float(case.get("peak_pressure", np.nan)))
    if name not in case:
        if not all(component in case for component in STRESSES) or bool(case[STRESSES[0]].isnull().all()):
            return
        case = case if singular else case.assign(peak(case).data_vars)
    if singular:
        yield _create_row(case.assign({name: np.inf, f"{name}_error": np.nan}), name, meaning)
        return
    yield _create_row(case, name, meaning)
    for axis, coordinate in zip(AXES, ("position x", "position y", "depth"), strict=True):
        if f"{name}_{axis}" in case:
            row = _create_row(case, f"{name}_{axis}", f"{coordinate} of the {meaning}")
            end = _describe_nearest_end(case, row.value) if axis == "x" else ""
            yield row._replace(remark=", ".join(filter(None, (end, row.remark))))


def _edge_tension_rows(case: xr.Dataset) -> Iterator[Quantity]:
    """Row of the largest tension at the trailing edge of a sliding contact, the stress that opens cracks."""
    name = "peak_edge_tension"
    if name in case:
        row = _create_row(case, name, "largest tension at the trailing edge")
        position = ", ".join(f"{axis} = {format_quantity(float(case[f'{name}_{axis}']), 'm')}" for axis in "xy")
        yield row._replace(remark=", ".join(filter(None, (position, row.remark))))


def _describe_nearest_end(case: xr.Dataset, x: float) -> str:
    """Text: distance of a position from the nearest end of the contact; empty if the cells are not known."""
    if "pressure" not in case or not {"x", "y"} <= set(case["pressure"].dims) or not (case["pressure"] > 0).any():
        return ""
    loaded_x = case["x"].values[(case["pressure"] > 0).any("y").values]
    distances = {"end I": abs(x - loaded_x.min()), "end II": abs(x - loaded_x.max())}
    if abs(distances["end I"] - distances["end II"]) < 0.02 * float(np.ptp(loaded_x)):
        return "at mid-length"
    end = min(distances, key=distances.__getitem__)
    return f"{format_quantity(distances[end], 'm')} from {end} of the contact"


def _mark_rounding(case: xr.Dataset, row: Quantity) -> Quantity:
    """Row of a force or moment, with the text 0 if the value is below the tolerance of the iteration."""
    force = max((abs(float(case[name])) for name in ("force_x", "force_y") if name in case), default=0.0)
    lever_arms = {"force_x": 1.0, "force_y": 1.0, "moment_z": float(case.get("hertz_half_width", 0.0))}
    # The transverse force of a contact symmetric about y = 0 is up to 3e-8 of the largest force.
    rounding_limit = TOLERANCE * force * lever_arms.get(row.name, 0.0)
    # Show a value that exceeds its error, since it differs from zero, and a value whose error exceeds the limit.
    is_zero = np.isnan(row.error) or abs(row.value) <= row.error < rounding_limit
    if abs(row.value) < rounding_limit and is_zero and not _prescribed_value(case, row.name):
        remark = f"rounding: below {TOLERANCE:g} of the largest force{' times a' if row.name == 'moment_z' else ''}"
        return row._replace(text=f"0 {row.units}", remark=remark, mark="rounding")
    return row


def _slip_rows(case: xr.Dataset) -> Iterator[Quantity]:
    """Rows of stick and slip: sticking part of the contact, largest traction and slip."""
    if "sticking_part" in case:
        yield _create_row(case, "sticking_part", "part of the contact that sticks")
    if "stick" not in case:
        return
    for name, meaning in (("traction", "largest traction"), ("slip", "largest slip")):
        if {f"{name}_x", f"{name}_y", "pressure"} <= set(case.variables):
            x, y = case[f"{name}_x"], case[f"{name}_y"]
            value = float(((x**2 + y**2) ** 0.5).where(case["pressure"] > 0, 0.0).max())
            units = variable_of(f"{name}_y", y.attrs).units
            suffix = "" if units == "m" or name == "traction" else " per distance rolled"
            text, remark = f"{format_quantity(value, units)}{suffix}", f"of a cell, {UNKNOWN_ERROR}"
            row = Quantity(f"largest_{name}", meaning, value, np.nan, units, text=text, remark=remark)
            yield row._replace(mark=NOT_ESTIMATED)


def _prescribed_value(case: xr.Dataset, name: str) -> Any:
    """Value that the case prescribes for a number in `OUTPUTS`; None if the number follows from the solution."""
    inputs = attribute(case, INPUTS_ATTRIBUTE).get("case", {})
    motion = inputs.get("motion", {})
    return inputs.get(name, motion.get(name, motion.get(name.removeprefix("shift_"))))


Input = tuple[str, str]  # One row: meaning, and value with its unit


@dataclass(frozen=True, repr=False)
class CaseTable:
    """Rows of a case by subject, with a repr as text and as HTML."""

    subjects: dict[str, list[Input]]

    def __repr__(self) -> str:
        return "\n".join(
            f"{subject}: {meaning}: {text}" for subject, rows in self.subjects.items() for meaning, text in rows
        )

    def _repr_html_(self) -> str:
        return html_table(self.subjects.items())


def case_table(case: Case) -> CaseTable:
    """Return the inputs of a case as a table, for a notebook or a terminal.

    Parameters
    ----------
    case : Case
        Any case.

    Examples
    --------
    >>> from contactstudy import Case, HalfSpace, Material, Roller
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> table = case_table(Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9))
    >>> print(str(table).splitlines()[0])
    Roller: radius R: 5 mm
    """
    roller = case.roller
    model = "body with free ends" if roller.ends == "free" else "half-space without ends"
    drops = roller.profile.drop(np.array([0.45, 0.5]) * roller.length, roller.length).tolist()
    roller_rows = [
        ("radius R", format_quantity(roller.radius, "m")),
        ("length L", format_quantity(roller.length, "m")),
        ("profile", _profile_text(roller.profile)),
        ("material", describe_material(roller.material) if roller.material else "rigid"),
        *([("elastic model", model)] if roller.material else []),
        (f"drop at {format_quantity(0.45 * roller.length, 'm')} from mid-length", format_quantity(drops[0], "m")),
        ("drop at the very end", format_quantity(drops[1], "m")),
    ]
    position_rows = [("from end I of the body to the roller, e", format_quantity(case.roller_start, "m"))]
    if isinstance(case.body, FiniteLengthSpace):
        distance = case.body.length - case.roller_start - case.roller.length
        position_rows.append(("from the roller to end II", format_quantity(distance, "m")))
    subjects = {
        "Roller": roller_rows,
        "Body": [("kind", describe_body(case.body)), ("material", describe_material(case.body.material))],
        "Place": position_rows,
        "Load": _load_rows(case),
    }
    return CaseTable(subjects)


def _load_rows(case: Case) -> list[Input]:
    """Load, friction, tilt and motion."""
    if case.approach is not None:
        rows = [("approach, which determines the load", format_quantity(case.approach, "m"))]
    else:
        rows = [
            ("normal load W", format_quantity(case.normal_load, "N")),
            ("Hertz pressure p0 of the line contact", format_quantity(case.hertz_max_pressure, "Pa")),
            ("Hertz half-width a", format_quantity(case.hertz_half_width, "m")),
        ]
    if case.load_position is not None:
        rows.append(("the load acts at x =", format_quantity(case.load_position, "m")))
    if case.tilt:
        rows.append(("tilt, positive if larger x is pressed deeper", format_quantity(case.tilt, "rad")))
    if case.approach is not None or case.tilt:
        depths = reference_depths(case.body, case.counterbody)
        rows += [(SCALAR_MEANINGS[name], format_quantity(depth, "m")) for name, depth in depths.items()]
    friction = case.friction
    if isinstance(friction, AxialFriction):
        rows.append(("friction along the axis", f"{min(friction.values):g} to {max(friction.values):g}"))
    else:
        rows.append(("friction coefficient", f"{friction:g}{', coupled' if case.coupled else ''}"))
    if isinstance(case.motion, Sliding):
        rows.append(
            ("motion", "full sliding along +y" if friction else "sliding without friction, so without traction")
        )
    else:
        values = {entry.name: getattr(case.motion, entry.name) for entry in fields(case.motion)}
        values_text = ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in values.items() if value)
        rows.append(("motion", f"{type(case.motion).__name__.lower()}: {values_text or 'none'}"))
    if case.motion.speeds is not None:
        rows.append(("entrainment speed um", f"{case.motion.speeds.entrainment:g} m/s"))
    if case.lubricant is not None:
        rows.append(("lubricant", repr(case.lubricant).partition("(")[2].rstrip(")")))
    return rows


def _profile_text(profile: Profile) -> str:
    """Profile in words."""
    if profile == Cylinder():
        return "cylinder with sharp ends"
    text = describe_profile(profile)
    return text.replace("_", " ").replace("=", " ").replace("(", " (") if isinstance(profile, Shape) else text


def describe_material(material: Material) -> str:
    """Material in one line."""
    return f"E = {format_quantity(material.young, 'Pa')}, Poisson's ratio {material.poisson:g}"


def describe_body(body: Body) -> str:
    """Kind of a body in one line."""
    low, high = body.extent
    if math.isinf(low):
        return "half-space, no free end"
    model = getattr(body, "model", "exact")
    note = "" if model == "exact" else f", ends by the comparison model {model!r}"
    if math.isfinite(high):
        return f"two free ends, {format_quantity(high, 'm')} apart{note}"
    return f"one free end, at x = 0{note}"
