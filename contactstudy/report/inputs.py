"""What was solved, as a reader wants to check it: geometry, materials, load, motion, settings."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, solved_case
from contactstudy.arrays.engineering import quantity
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import EndedBody, FiniteLengthSpace, HalfSpace
from contactstudy.case.case import Case
from contactstudy.case.friction import AxialFriction
from contactstudy.case.motion import Sliding
from contactstudy.case.stored import Sampled
from contactstudy.errors import InvalidInputError
from contactstudy.profiles import Halves, Measured, Profile
from contactstudy.profiles.base import Sum
from contactstudy.study.setup import build_setup
from contactstudy.study.store import CASE_ATTRIBUTE

UNITS = {"half_angle": "rad", "delta": "1", "k1": "1", "k2": "1"}
"""Units of the numbers of profiles that are no lengths."""


class Input(NamedTuple):
    """One row: what it is, and its value with its unit."""

    meaning: str
    text: str


def case_of(dataset: xr.Dataset) -> Case | None:
    """Case of a result, from what `solve` or a study wrote into it; None if nothing did.

    Examples
    --------
    >>> case_of(xr.Dataset()) is None
    True
    """
    if INPUTS_ATTRIBUTE in dataset.attrs:
        return solved_case(dataset)
    parameters = attribute(dataset, CASE_ATTRIBUTE)
    if not parameters:
        return None
    try:
        return build_setup(parameters).case
    except InvalidInputError:  # a file of a version that knew other parameters
        return None


def profile_words(profile: Profile) -> str:
    """Profile in words, its numbers in engineers' units.

    Examples
    --------
    >>> from contactstudy.profiles import Cylinder, Lundberg
    >>> profile_words(Lundberg(2e-7) + Cylinder(fillet_radius=3e-4))
    'Lundberg (amplitude 0.2 µm) + Cylinder (fillet radius 0.3 mm)'
    """
    if isinstance(profile, Sum):
        return " + ".join(profile_words(term) for term in profile.terms)
    if isinstance(profile, Halves):
        return f"left half: {profile_words(profile.left)}; right half: {profile_words(profile.right)}"
    if isinstance(profile, Measured):
        length = profile.positions[-1] - profile.positions[0]
        depth = quantity(max(profile.drops), "m")
        return f"measured at {len(profile.positions)} points over {quantity(length, 'm')}, drop up to {depth}"
    if isinstance(profile, Sampled):
        return profile.says
    name, said = type(profile).__name__, []
    for entry in _fields(profile):
        value = getattr(profile, entry.name)
        if isinstance(value, float) and value != entry.default:
            unit = UNITS.get(entry.name, "m")
            said.append(f"{entry.name.replace('_', ' ')} {quantity(value, unit)}")
    return f"{name} ({', '.join(said)})" if said else f"{name}, sharp ends" if name == "Cylinder" else name


def _fields(part: Any) -> tuple[Any, ...]:
    """Fields of a dataclass; none of anything else."""
    return fields(part) if is_dataclass(part) else ()


def inputs(case: Case) -> dict[str, list[Input]]:
    """Rows on a case, by subject.

    Parameters
    ----------
    case : Case
        What was solved.

    Examples
    --------
    >>> from contactstudy import Roller
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> inputs(Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9))["Roller"][0].text
    '5 mm'
    """
    roller = case.roller
    edge = roller.length / 2
    found = {
        "Roller": [
            Input("radius R", quantity(roller.radius, "m")),
            Input("length L", quantity(roller.length, "m")),
            Input("profile", profile_words(roller.profile)),
            Input("material", _material(roller.material) if roller.material else "rigid"),
        ],
        "Body": [Input("kind", _body_words(case)), Input("material", _material(case.body.material))],
        "Place": [
            Input("from end I of the body to the roller, e", quantity(case.roller_start, "m")),
            *_second_distance(case),
        ],
        "Load": _load(case),
    }
    if roller.material is not None:
        ends = "its own free ends" if roller.ends == "free" else "a half-space, without ends"
        found["Roller"].append(Input("elastic as", ends))
    drops = roller.profile.drop(np.array([0.45, 0.5]) * roller.length, roller.length).tolist()
    found["Roller"].append(Input(f"drop at {quantity(0.9 * edge, 'm')} from mid-length", quantity(drops[0], "m")))
    found["Roller"].append(Input("drop at the very end", quantity(drops[1], "m")))
    return found


def _material(material: Material) -> str:
    """Material in words."""
    return f"E = {quantity(material.young, 'Pa')}, Poisson's ratio {material.poisson:g}"


def _body_words(case: Case) -> str:
    """Body in words."""
    body = case.body
    if isinstance(body, HalfSpace):
        return "half-space, no free end"
    model = f", ends by the comparison model {body.model!r}" if isinstance(body, EndedBody) else ""
    model = "" if getattr(body, "model", "exact") == "exact" else model
    if isinstance(body, FiniteLengthSpace):
        return f"two free ends, {quantity(body.length, 'm')} apart{model}"
    return f"one free end, at x = 0{model}"


def _second_distance(case: Case) -> list[Input]:
    """Distance at end II, where there is one."""
    if not isinstance(case.body, FiniteLengthSpace):
        return []
    distance = case.body.length - case.roller_start - case.roller.length
    return [Input("from the roller to end II", quantity(distance, "m"))]


def _load(case: Case) -> list[Input]:
    """Load, friction, tilt and motion."""
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
