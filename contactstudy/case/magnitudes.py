"""Doubtful magnitudes of a case, and tilted rollers whose contact would lie within one half-width of an end."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from typing import NamedTuple, TypeVar

import numpy as np
import xarray as xr

from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import FiniteLengthSpace
from contactstudy.case.case import Case
from contactstudy.case.motion import Friction
from contactstudy.checks import UNIT_SIZES, FloatArray
from contactstudy.errors import InvalidInputError, MagnitudeWarning
from contactstudy.profiles.base import Shape, checked_drop
from contactstudy.profiles.crowned import FullCrown, PartialCrown
from contactstudy.profiles.logarithmic import Logarithmic

LEAST_CONTACT = 1.0  # Length over the Hertz half-width that a tilted roller has to touch on, if it touches at its end
LEAST_ARM = 0.25
"""Distance of the load from the roller's end, over the Hertz half-width, below which no such contact balances it."""


def inclination(case: Case) -> str:
    """Return the argument that inclines the roller of a case, for messages."""
    if case.load_position is not None:
        return f"load_position = {case.load_position:g} m"
    return f"tilt = {case.tilt:g} rad"


def check_balanced(case: Case) -> None:
    """Raise if the load acts so near to the roller's end that the contact could not reach far from it."""
    if case.load_position is None:
        return
    start, stop = case.contact_range
    distance = min(case.load_position - start, stop - case.load_position)
    if distance < LEAST_ARM * case.hertz_half_width < LEAST_ARM * case.contact_length:
        raise _end_contact_error(case, f"where a load at {distance:.3g} m from the end is not balanced")


def check_on_its_length(case: Case, grid: Grid, gap: FloatArray, pressure: FloatArray) -> None:
    """Raise if a tilted roller left its length under a pressure (x, y); its gap is finite where it faces the body."""
    if not case.tilt and case.load_position is None:
        return
    facing = np.flatnonzero(np.isfinite(gap).any(axis=1))
    touching = np.flatnonzero(pressure.any(axis=1))
    touches_end = touching[0] == facing[0] or touching[-1] == facing[-1]
    length = float(grid.widths[touching].sum())
    if touches_end and length < LEAST_CONTACT * case.hertz_half_width < case.contact_length:
        raise _end_contact_error(case, f"not {length:.3g} m")


def _end_contact_error(case: Case, actual: str) -> InvalidInputError:
    """Error of a roller that has left its length and stands on its end."""
    name = "tilt" if case.load_position is None else "load_position"
    return InvalidInputError(
        name,
        getattr(case, name),
        f"such that the contact reaches further from the roller's end than {LEAST_CONTACT:g} half-width a, "
        f"{case.hertz_half_width:.3g} m, {actual}",
        "tilt the roller less or load it nearer to its middle",
    )


SILENCE = "if intended: warnings.filterwarnings('ignore', category=contactstudy.MagnitudeWarning)"


class Range(NamedTuple):
    """Usual range of a quantity, its SI unit, and units of a number outside the range, in order of likelihood."""

    least: float
    most: float
    unit: str
    units: tuple[str, ...] = ()


LENGTH = Range(1e-5, 3.0, "m", ("mm", "µm"))  # From a pin of a watch to the roll of a mill
STRENGTH = Range(1e5, 1e10, "Pa", ("GPa", "MPa"))  # From soft lead to hard metal

RANGES = {
    "young": Range(1e6, 1.5e12, "Pa", ("GPa", "MPa")),  # soft rubber to diamond
    "radius": LENGTH._replace(most=1.5),
    "length": LENGTH,
    "friction": Range(0.0, 1.5, "1", ("%",)),  # clean metals reach about 1
    "tilt": Range(0.0, 0.01, "rad", ("deg", "mrad")),  # bearings take a few mrad
    # Over the roller's radius: half-widths of 1e-5 are 1 MPa on steel, those of 0.1 yield in every metal.
    "half_width": Range(1e-5, 0.1, "1"),
    # Over the roller's radius: an approach of a tenth is the limit of the theory, in rubber.
    "approach": Range(0.0, 0.1, "m", ("mm", "µm")),
    "drop": Range(0.0, 0.15, "m", ("mm", "µm")),  # crowns are micrometres, balls are cut short
    "end drop": Range(0.0, 0.5, "m", ("mm", "µm")),  # with corners
    "bending": STRENGTH,
    "torsion": STRENGTH,
    "yield_stress": STRENGTH,
    "dynamic_rating": Range(500.0, 1e8, "N", ("kN",)),  # from needles to the bearings of a mill
    "roughness": Range(0.0, 2e-4, "m", ("mm", "µm")),  # from peak to valley
    "viscosity": Range(1e-4, 1e3, "Pa s", ("mPa s",)),  # from petrol to grease
    "pressure_viscosity": Range(1e-9, 1e-7, "1/Pa", ("1/GPa", "mm2/N")),
    "eyring_stress": Range(1e5, 1e9, "Pa", ("MPa",)),
    "conductivity": Range(0.01, 5e3, "W/(m K)"),
    "density": Range(10.0, 3e4, "kg/m3", ("g/cm3",)),
    "specific_heat": Range(50.0, 1e4, "J/(kg K)", ("J/(g K)",)),
}
"""Usual ranges in engineering contacts, by quantity."""

DROP_POSITIONS = {"drop": 0.4, "end drop": 0.49}
"""Distances from mid-length over the length at which the drop is checked."""

FLATTEST_CROWN, FLATTEST_FRACTION = 1e-7, 1e-5
"""A crown is doubtful if its arc, over half the roller's length, drops by less than both this length (metres) and this
fraction of the roller's length. Usual crown radii range from 0.1 to some 100 m."""

Profiles = TypeVar("Profiles", bound=Shape)


def doubts(case: Case) -> tuple[str, ...]:
    """Doubtful magnitudes of a case, each with the usual range and the unit that would put the value into it."""
    roller, body = case.roller, case.body
    messages = [_doubt("radius", "roller.radius", roller.radius), _doubt("length", "roller.length", roller.length)]
    if isinstance(body, FiniteLengthSpace):
        messages.append(_doubt("length", "body.length", body.length))
    messages += [
        _doubt("young", "body.material.young", body.material.young),
        "" if roller.material is None else _doubt("young", "roller.material.young", roller.material.young),
        friction_doubt(case.friction),
        _doubt("tilt", "tilt", abs(case.tilt)),
        _crown_doubt(case),
        _flat_crown_doubt(case),
        _design_doubt(case),
        _load_doubt(case),
    ]
    if case.lubricant is not None:
        names = ("viscosity", "pressure_viscosity", "eyring_stress", "density", "conductivity")
        values = ((name, getattr(case.lubricant, name)) for name in names)
        messages += [_doubt(name, f"lubricant.{name}", value) for name, value in values if value is not None]
    return tuple(filter(None, messages))


def warn_doubtful(case: Case) -> None:
    """Warn once of all doubtful magnitudes of a case; the warning points to the caller of the calling function."""
    _warn(doubts(case), stacklevel=4)


def warn_doubtful_values(*, stacklevel: int = 3, **values: float | FloatArray) -> None:
    """Warn of doubtful magnitudes by name, for arrays of the smallest and largest value."""
    extremes = ((name, end) for name, value in values.items() for end in np.unique([np.min(value), np.max(value)]))
    _warn((_doubt(name, name, float(end)) for name, end in extremes), stacklevel + 1)


def _warn(messages: Iterable[str], stacklevel: int) -> None:
    """Warn of the messages that are not empty."""
    if text := "; ".join(filter(None, messages)):
        warnings.warn(f"doubtful magnitudes in SI units: {text}; {SILENCE}", MagnitudeWarning, stacklevel=stacklevel)


def _doubt(quantity_name: str, name: str, value: float, radius: float | None = None) -> str:
    """Message on a value outside its usual range, of a depth over the roller's radius; empty inside."""
    usual = RANGES[quantity_name]
    least, most = (usual.least, usual.most) if radius is None else (-np.inf, usual.most * radius)
    if least <= value <= most:
        return ""
    unit = "" if usual.unit == "1" else f" {usual.unit}"
    limits = f"up to {most:.2g} m on a roller of this radius" if radius else f"{least:g} to {most:g}{unit}"
    text = f"{name} = {value:g}{unit}, usual are {limits}"
    for other in usual.units:
        if least <= (converted := value * UNIT_SIZES[usual.unit][other]) <= most:
            return f"{text}; {value:g} {other} is {converted:g}{unit}"
    return text


def _crown_doubt(case: Case) -> str:
    """Message on the drop of the crown, or of the ends of a roller without crown."""
    roller = case.roller
    for quantity_name, fraction in DROP_POSITIONS.items():
        x = fraction * roller.length
        drop = checked_drop(roller.profile, np.array([-x, x]), roller.length)
        deepest = float(np.max(drop, where=np.isfinite(drop), initial=0.0))
        name = f"drop of roller.profile at {fraction:g} of the length from the middle"
        if message := _doubt(quantity_name, name, deepest, roller.radius):
            return message
    return ""


def friction_doubt(friction: Friction | xr.DataArray) -> str:
    """Message on the largest magnitude of the friction, a number or values along the axis; empty if usual."""
    values = getattr(friction, "values", friction)
    return _doubt("friction", "friction", float(np.max(np.abs(np.asarray(values, dtype=np.float64)))))


def _components(profile: object, kind: type[Profiles]) -> Iterator[Profiles]:
    """Profiles of a kind in a profile: the profile itself, or the terms and halves of a composite."""
    if isinstance(profile, kind):
        yield profile
    elif isinstance(profile, tuple):
        for term in profile:
            yield from _components(term, kind)
    elif isinstance(profile, Shape):
        yield from _components(tuple(vars(profile).values()), kind)


def _flat_crown_doubt(case: Case) -> str:
    """Message on a crown radius too large for a ground crown."""
    half, profile = 0.5 * case.roller.length, case.roller.profile
    crowns: list[FullCrown | PartialCrown] = [*_components(profile, FullCrown), *_components(profile, PartialCrown)]
    for crown in crowns:
        radius = crown.crown_radius
        drop = 0.5 * half**2 / radius
        if drop < min(FLATTEST_CROWN, FLATTEST_FRACTION * case.roller.length):
            name = f"{type(crown).__name__}.crown_radius = {radius:g} m"
            conversion = f"; {radius:g} mm is {1e-3 * radius:g} m" if 1e-3 * radius >= half else ""
            return f"{name} drops by {drop:.2g} m over half the roller's length, less than is ground{conversion}"
    return ""


def _design_doubt(case: Case) -> str:
    """Message on the design load of a logarithmic crown."""
    usual, radius = RANGES["half_width"], case.roller.radius
    for profile in _components(case.roller.profile, Logarithmic):
        amplitude = profile.amplitude
        # A = R (p0 / E*)**2, so the half-width of the design load is 2 (A R)**0.5.
        half_width = 2 * np.sqrt(amplitude / radius)
        if amplitude and not usual.least <= half_width <= usual.most:
            word = "low" if half_width < usual.least else "high"
            return (
                f"{type(profile).__name__}.amplitude = {amplitude:.3g} m belongs to a very {word} design load, "
                f"half-width {half_width:.1g} of the roller's radius: pressures and moduli are in Pa, "
                "1500 MPa is 1.5e9 Pa"
            )
    return ""


def _load_doubt(case: Case) -> str:
    """Message on load or pressure by the Hertz half-width, or on the approach."""
    if case.approach is not None:
        return _doubt("approach", "approach", case.approach - case.first_touch, case.roller.radius)
    usual, half_width = RANGES["half_width"], case.hertz_half_width / case.roller.radius
    if usual.least <= half_width <= usual.most:
        return ""
    word = "low" if half_width < usual.least else "high"
    prescribed = f"load = {case.load:g} N" if case.max_pressure is None else f"max_pressure = {case.max_pressure:g} Pa"
    pressure = format_quantity(case.hertz_max_pressure, "Pa")
    return f"{prescribed} is very {word}: Hertz pressure {pressure}, half-width {half_width:.1g} of the roller's radius"
