"""A case in words, as a reader wants to check it: geometry, materials, load, motion."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.html_table import html_table
from contactstudy.bodies.models import FiniteLengthSpace
from contactstudy.bodies.words import body_words, material_words
from contactstudy.case.friction import AxialFriction
from contactstudy.case.motion import Sliding
from contactstudy.profiles import Cylinder, Profile, Shape
from contactstudy.profiles.base import in_words
from contactstudy.profiles.sketch import sketch

if TYPE_CHECKING:
    from contactstudy.case.case import Case
    from contactstudy.case.roller import Roller


class Input(NamedTuple):
    """One row: what it is, and its value with its unit."""

    meaning: str
    text: str


def inputs(case: Case) -> dict[str, list[Input]]:
    """Rows on a case, by subject.

    Parameters
    ----------
    case : Case
        What was solved.

    Examples
    --------
    >>> from contactstudy import Case, HalfSpace, Material, Roller
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> inputs(Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9))["Roller"][0].text
    '5 mm'
    """
    return {
        "Roller": roller_rows(case.roller),
        "Body": [Input("kind", body_words(case.body)), Input("material", material_words(case.body.material))],
        "Place": [
            Input("from end I of the body to the roller, e", quantity(case.roller_start, "m")),
            *_second_distance(case),
        ],
        "Load": _load(case),
    }


def roller_rows(roller: Roller) -> list[Input]:
    """Rows on a roller: geometry, material, and how far its profile drops."""
    rows = [
        Input("radius R", quantity(roller.radius, "m")),
        Input("length L", quantity(roller.length, "m")),
        Input("profile", _profile(roller.profile)),
        Input("material", material_words(roller.material) if roller.material else "rigid"),
    ]
    if roller.material is not None:
        ends = "its own free ends" if roller.ends == "free" else "a half-space, without ends"
        rows.append(Input("elastic as", ends))
    drops = roller.profile.drop(np.array([0.45, 0.5]) * roller.length, roller.length).tolist()
    rows.append(Input(f"drop at {quantity(0.45 * roller.length, 'm')} from mid-length", quantity(drops[0], "m")))
    rows.append(Input("drop at the very end", quantity(drops[1], "m")))
    return rows


def _second_distance(case: Case) -> list[Input]:
    """Distance at end II, where there is one."""
    if not isinstance(case.body, FiniteLengthSpace):
        return []
    distance = case.body.length - case.roller_start - case.roller.length
    return [Input("from the roller to end II", quantity(distance, "m"))]


def _load(case: Case) -> list[Input]:
    """Load, friction, tilt and motion."""
    if case.approach is not None:
        rows = [Input("approach, which takes the load that results", quantity(case.approach, "m"))]
    else:
        rows = [
            Input("normal load W", quantity(case.normal_load, "N")),
            Input("Hertz pressure p0 of the line contact", quantity(case.hertz_max_pressure, "Pa")),
            Input("Hertz half-width a", quantity(case.hertz_half_width, "m")),
        ]
    if case.load_position is not None:
        rows.append(Input("the load acts at x =", quantity(case.load_position, "m")))
    if case.tilt:
        rows.append(Input("tilt, positive if larger x is pressed deeper", quantity(case.tilt, "rad")))
    friction = case.friction
    if isinstance(friction, AxialFriction):
        rows.append(Input("friction along the axis", f"{min(friction.values):g} to {max(friction.values):g}"))
    else:
        rows.append(Input("friction coefficient", f"{friction:g}{', coupled' if case.coupled else ''}"))
    if isinstance(case.motion, Sliding):
        rows.append(
            Input("motion", "full sliding along +y" if friction else "sliding without friction, so without traction")
        )
    else:
        values = {entry.name: getattr(case.motion, entry.name) for entry in fields(case.motion)}
        said = ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in values.items() if value)
        rows.append(Input("motion", f"{type(case.motion).__name__.lower()}: {said or 'none'}"))
    return rows


def _profile(profile: Profile) -> str:
    """Profile in words."""
    if profile == Cylinder():
        return "cylinder with sharp ends"
    text = in_words(profile)
    return text.replace("_", " ").replace("=", " ").replace("(", " (") if isinstance(profile, Shape) else text


def in_lines(case: Case) -> str:
    """Return what an engineer wants first of a case, in a few lines.

    Examples
    --------
    >>> from contactstudy import Case, HalfSpace, Material, Roller
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> print(in_lines(Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9, friction=0.1)))
    Case: W = 153.2 N, p0 = 1.5 GPa, a = 65 µm, e = 0 µm
      Roller(R = 5 mm, L = 1 mm, Cylinder(), end drop 0 µm, rigid)
      HalfSpace(E = 210 GPa, nu = 0.3)
      friction 0.1, full sliding along +y
    """
    if case.approach is not None:
        sizes = {"approach": (case.approach, "m")}
    else:
        p0, a = case.hertz_max_pressure, case.hertz_half_width
        sizes = {"W": (case.normal_load, "N"), "p0": (p0, "Pa"), "a": (a, "m")}
    said = ", ".join(f"{name} = {quantity(*size)}" for name, size in sizes.items())
    motion = "full sliding along +y" if isinstance(case.motion, Sliding) else repr(case.motion)
    if isinstance(case.friction, AxialFriction):
        friction = f"friction from {min(case.friction.values):g} to {max(case.friction.values):g}"
    else:
        friction = f"friction {case.friction:g}"
    more = [f"{friction}{', coupled' if case.coupled else ''}, {motion}"]
    if case.tilt:
        more.append(f"tilt {quantity(case.tilt, 'rad')}")
    if case.load_position is not None:
        more.append(f"load at x = {quantity(case.load_position, 'm')}")
    first = f"Case: {said}, e = {quantity(case.roller_start, 'm')}"
    return "\n  ".join([first, repr(case.roller), repr(case.body), "; ".join(more)])


def as_html(case: Case) -> str:
    """Table of a case for a notebook."""
    return html_table(inputs(case).items())


def roller_as_html(roller: Roller) -> str:
    """Table of a roller for a notebook, with its profile drawn."""
    title = f"Roller: {_profile(roller.profile)}"
    return html_table([("Roller", roller_rows(roller))]) + sketch(roller.profile, roller.length, title)
