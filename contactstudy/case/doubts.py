"""Magnitudes that are mostly a mistake in the unit: questioned, not refused.

The theory has no scale: with lengths in half-widths and a modulus of 1 it holds as well. So no magnitude is wrong by
itself, and a warning asks where an error would forbid. Whoever means it silences the warning; whoever wants scripts to
stop makes it an error.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from contactstudy.arrays.engineering import quantity
from contactstudy.bodies.models import FiniteLengthSpace
from contactstudy.caller import warn
from contactstudy.checks import FloatArray
from contactstudy.errors import MagnitudeWarning
from contactstudy.profiles.base import Shape, checked_drop
from contactstudy.profiles.crowned import FullCrown, PartialCrown
from contactstudy.profiles.logarithmic import Logarithmic

if TYPE_CHECKING:
    from contactstudy.bodies.material import Material
    from contactstudy.case.case import Case

SILENCE = "if it is meant: warnings.filterwarnings('ignore', category=contactstudy.MagnitudeWarning)"

_QUESTIONED: ContextVar[bool] = ContextVar("questioned", default=True)


class Usual(NamedTuple):
    """Range of what is usual, its unit, and units that a number beyond it may be in: name and size in SI."""

    least: float
    most: float
    unit: str
    meant: tuple[tuple[str, float], ...] = ()


LENGTH = Usual(1e-5, 3.0, "m", (("mm", 1e-3), ("µm", 1e-6)))
"""From a pin of a watch to the roll of a mill."""

STRENGTH = Usual(1e5, 1e10, "Pa", (("GPa", 1e9), ("MPa", 1e6)))
"""From soft lead to hard metal."""

USUAL = {
    "young": Usual(1e6, 1.5e12, "Pa", (("GPa", 1e9), ("MPa", 1e6))),  # soft rubber to diamond
    "radius": LENGTH._replace(most=1.5),
    "length": LENGTH,
    "friction": Usual(0.0, 1.5, "1", (("%", 0.01),)),  # clean metals reach about 1
    "tilt": Usual(0.0, 0.01, "rad", (("deg", np.pi / 180), ("mrad", 1e-3))),  # bearings take a few mrad
    # Over the roller's radius: half-widths of 1e-5 are 1 MPa on steel, those of 0.1 yield in every metal.
    "half_width": Usual(1e-5, 0.1, "1"),
    # Over the roller's radius: rubber that is pressed in by a tenth of its radius is at the limit of the theory.
    "approach": Usual(0.0, 0.1, "m", (("mm", 1e-3), ("µm", 1e-6))),
    "drop": Usual(0.0, 0.15, "m", (("mm", 1e-3), ("µm", 1e-6))),  # crowns are micrometres, balls are cut short
    "end drop": Usual(0.0, 0.5, "m", (("mm", 1e-3), ("µm", 1e-6))),  # with corners
    "bending": STRENGTH,
    "torsion": STRENGTH,
    "yield_stress": STRENGTH,
    "dynamic_rating": Usual(500.0, 1e8, "N", (("kN", 1e3),)),  # from needles to the bearings of a mill
    "roughness": Usual(0.0, 2e-4, "m", (("mm", 1e-3), ("µm", 1e-6))),  # from peak to valley
    "conductivity": Usual(0.01, 5e3, "W/(m K)"),
    "density": Usual(10.0, 3e4, "kg/m3", (("g/cm3", 1e3),)),
    "specific_heat": Usual(50.0, 1e4, "J/(kg K)", (("J/(g K)", 1e3),)),
}
"""What is usual for a contact of engineering, by name."""

DROP_AT = {"drop": 0.4, "end drop": 0.49}
"""Distances from mid-length over the length where a profile's drop is looked at."""

FLATTEST_CROWN, FLATTEST_SHARE = 1e-7, 1e-5
"""A crown is doubtful if its arc, over half the roller's length, drops by less than this (metres), and by less than
this share of the length: no grinder holds the one on a roller of 10 mm and more, nor the other on a shorter one. The
radius alone says little, for real ones are from 0.1 to some 100 m."""

Part = TypeVar("Part", bound=Shape)


def doubts(case: Case) -> tuple[str, ...]:
    """Questions on a case: each names a value, what is usual, and what it may have been meant to be.

    Examples
    --------
    >>> from contactstudy import Case, HalfSpace, Material, Roller
    >>> with unquestioned():
    ...     case = Case(body=HalfSpace(material=Material(206e9, 0.3)), roller=Roller(radius=6, length=1.4), load=9e3)
    >>> doubts(case)
    ('roller.radius = 6 m, usual are 1e-05 to 1.5 m; 6 mm is 0.006 m',)
    """
    found = [
        _doubt("radius", "roller.radius", case.roller.radius),
        _doubt("length", "roller.length", case.roller.length),
        _of_material("body.material", case.body.material),
        _of_material("roller.material", case.roller.material),
        _doubt("friction", "friction", _largest(case.friction)),
        _doubt("tilt", "tilt", abs(case.tilt)),
        _of_crown(case),
        _of_flat_crown(case),
        _of_design(case),
        _of_load(case),
    ]
    if isinstance(case.body, FiniteLengthSpace):
        found.insert(2, _doubt("length", "body.length", case.body.length))
    return tuple(question for question in found if question)


def question(case: Case) -> None:
    """Warn of doubtful magnitudes of a case, once for all of them; the warning points to where the case is made."""
    if _QUESTIONED.get():
        _warn(doubts(case))


def question_values(**values: float | FloatArray) -> None:
    """Warn of doubtful magnitudes by name, of arrays by their smallest and largest."""
    if _QUESTIONED.get():
        ends = ((name, end) for name, value in values.items() for end in np.unique([np.min(value), np.max(value)]))
        _warn([_doubt(name, name, float(end)) for name, end in ends])


def _warn(questions: Iterable[str]) -> None:
    """Warn of the questions that there are."""
    if found := "; ".join(question for question in questions if question):
        warn(f"doubtful, for units are SI: {found}; {SILENCE}", MagnitudeWarning)


def changed(case: Case, **changes: Any) -> Case:
    """Copy of a case with other values, made without questions."""
    with unquestioned():
        return replace(case, **changes)


@contextmanager
def unquestioned() -> Iterator[None]:
    """Let cases be made without questions: they were asked before, or are asked elsewhere."""
    token = _QUESTIONED.set(False)
    try:
        yield
    finally:
        _QUESTIONED.reset(token)


def _doubt(kind: str, name: str, value: float) -> str:
    """Return the question on a value; empty if it is usual."""
    usual = USUAL[kind]
    if usual.least <= value <= usual.most:
        return ""
    unit = "" if usual.unit == "1" else f" {usual.unit}"
    text = f"{name} = {value:g}{unit}, usual are {usual.least:g} to {usual.most:g}{unit}"
    fitting = [(other, size) for other, size in usual.meant if usual.least <= value * size <= usual.most]
    return f"{text}; {value:g} {fitting[0][0]} is {value * fitting[0][1]:g}{unit}" if fitting else text


def _of_depth(kind: str, name: str, value: float, radius: float) -> str:
    """Return the question on a depth, for which the roller's radius says what is usual."""
    usual = USUAL[kind]
    most = usual.most * radius
    if value <= most:
        return ""
    text = f"{name} = {value:.3g} m, usual are up to {most:.2g} m on a roller of this radius"
    fitting = [(unit, size) for unit, size in usual.meant if value * size <= most]
    return f"{text}; {value:.3g} {fitting[0][0]} is {value * fitting[0][1]:.3g} m" if fitting else text


def _of_crown(case: Case) -> str:
    """Return the question on the depth of the roller's crown, or of its ends where it has none."""
    roller = case.roller
    for kind, part in DROP_AT.items():
        x = part * roller.length
        drop = checked_drop(roller.profile, np.array([-x, x]), roller.length)
        deepest = float(np.max(drop, where=np.isfinite(drop), initial=0.0))
        name = f"drop of roller.profile at {part:g} of the length from the middle"
        if asked := _of_depth(kind, name, deepest, roller.radius):
            return asked
    return ""


def _of_material(name: str, material: Material | None) -> str:
    """Return the question on a material; empty for a rigid body."""
    return "" if material is None else _doubt("young", f"{name}.young", material.young)


def _largest(friction: object) -> float:
    """Largest coefficient of friction, a number or values along the axis."""
    values = getattr(friction, "values", friction)
    return float(np.max(np.abs(np.asarray(values, dtype=np.float64))))


def _parts(profile: object, kind: type[Part]) -> Iterator[Part]:
    """Profiles of a kind that a profile is, or is made of."""
    if isinstance(profile, kind):
        yield profile
    elif isinstance(profile, tuple):
        for part in profile:
            yield from _parts(part, kind)
    elif isinstance(profile, Shape):
        yield from _parts(tuple(vars(profile).values()), kind)


def _of_flat_crown(case: Case) -> str:
    """Return the question on the radius of a crown that is flatter than any that is made."""
    half, profile = 0.5 * case.roller.length, case.roller.profile
    crowns: list[FullCrown | PartialCrown] = [*_parts(profile, FullCrown), *_parts(profile, PartialCrown)]
    for crown in crowns:
        radius = crown.crown_radius
        drop = 0.5 * half**2 / radius
        if drop < min(FLATTEST_CROWN, FLATTEST_SHARE * case.roller.length):
            name = f"{type(crown).__name__}.crown_radius = {radius:g} m"
            meant = f"; {radius:g} mm is {1e-3 * radius:g} m" if 1e-3 * radius >= half else ""
            return f"{name} drops by {drop:.2g} m over half the roller's length, less than is ground{meant}"
    return ""


def _of_design(case: Case) -> str:
    """Return the question on the load that the roller's logarithmic crown is designed for."""
    usual, radius = USUAL["half_width"], case.roller.radius
    for profile in _parts(case.roller.profile, Logarithmic):
        amplitude = profile.amplitude
        # A = R (p0 / E*)**2, and so the half-width of the design is 2 (A R)**0.5.
        over = 2 * np.sqrt(amplitude / radius)
        if amplitude and not usual.least <= over <= usual.most:
            word = "low" if over < usual.least else "high"
            return (
                f"{type(profile).__name__}.amplitude = {amplitude:.3g} m is that of a very {word} design load, "
                f"half-width {over:.1g} of the roller's radius: pressures and moduli are in Pa, 1500 MPa is 1.5e9 Pa"
            )
    return ""


def _of_load(case: Case) -> str:
    """Return the question on load or pressure: what it makes of the half-width; or on the approach."""
    if case.approach is not None:
        return _of_depth("approach", "approach", case.approach - case.first_touch, case.roller.radius)
    usual, over = USUAL["half_width"], case.hertz_half_width / case.roller.radius
    if usual.least <= over <= usual.most:
        return ""
    word = "low" if over < usual.least else "high"
    given = f"load = {case.load:g} N" if case.max_pressure is None else f"max_pressure = {case.max_pressure:g} Pa"
    pressure = quantity(case.hertz_max_pressure, "Pa")
    return f"{given} is very {word}: Hertz pressure {pressure}, half-width {over:.1g} of the roller's radius"
