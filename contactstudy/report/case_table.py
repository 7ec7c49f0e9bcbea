"""Table of the inputs of a case: geometry, materials, load, motion."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from contactstudy.arrays.engineering import format_quantity, html_table
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, FiniteLengthSpace
from contactstudy.case.case import Case
from contactstudy.case.motion import AxialFriction, Sliding
from contactstudy.profiles import Cylinder, Profile, Shape
from contactstudy.profiles.base import describe_profile

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
    roller_rows = [
        ("radius R", format_quantity(roller.radius, "m")),
        ("length L", format_quantity(roller.length, "m")),
        ("profile", _profile(roller.profile)),
        ("material", describe_material(roller.material) if roller.material else "rigid"),
    ]
    if roller.material is not None:
        roller_rows.append(
            ("elastic model", "body with free ends" if roller.ends == "free" else "half-space without ends")
        )
    drops = roller.profile.drop(np.array([0.45, 0.5]) * roller.length, roller.length).tolist()
    roller_rows.append(
        (f"drop at {format_quantity(0.45 * roller.length, 'm')} from mid-length", format_quantity(drops[0], "m"))
    )
    roller_rows.append(("drop at the very end", format_quantity(drops[1], "m")))
    position_rows = [("from end I of the body to the roller, e", format_quantity(case.roller_start, "m"))]
    if isinstance(case.body, FiniteLengthSpace):
        distance = case.body.length - case.roller_start - case.roller.length
        position_rows.append(("from the roller to end II", format_quantity(distance, "m")))
    subjects = {
        "Roller": roller_rows,
        "Body": [("kind", describe_body(case.body)), ("material", describe_material(case.body.material))],
        "Place": position_rows,
        "Load": _load(case),
    }
    return CaseTable(subjects)


def _load(case: Case) -> list[Input]:
    """Load, friction, tilt and motion."""
    if case.approach is not None:
        rows = [("approach, which takes the load that results", format_quantity(case.approach, "m"))]
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


def _profile(profile: Profile) -> str:
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
