"""Unusual magnitudes of a case, and tilted rollers in contact within one half-width of an end only."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from types import UnionType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import FiniteLengthSpace
from contactstudy.case.case import Case
from contactstudy.case.motion import Friction
from contactstudy.checks import UNIT_SIZES, FloatArray
from contactstudy.errors import InvalidInputError, MagnitudeWarning
from contactstudy.profiles.base import Shape, check_drop
from contactstudy.profiles.geometric import FullCrown, PartialCrown
from contactstudy.profiles.logarithmic import Logarithmic

MIN_CONTACT_RATIO = 1.0  # Minimum contact length of a tilted roller at its end over the half-width. Limit.
MIN_ARM_RATIO = 0.25  # Minimum distance of a balanced load from the roller's end over the half-width. Limit.


def check_balanced(case: Case) -> None:
    """Raise if the load is so near to the roller's end that the contact would be limited to the end."""
    if case.load_position is None:
        return
    start, stop = case.contact_range
    distance = min(case.load_position - start, stop - case.load_position)
    if distance < MIN_ARM_RATIO * case.hertz_half_width < MIN_ARM_RATIO * case.contact_length:
        raise _create_end_contact_error(case, f"where a load at {distance:.3g} m from the end is not balanced")


def check_contact_length(case: Case, grid: Grid, gap: FloatArray, pressure: FloatArray) -> None:
    """Raise if a pressure (x, y) of a tilted roller is limited to its end; the gap is finite under the roller."""
    if not case.tilt and case.load_position is None:
        return
    roller_columns = np.flatnonzero(np.isfinite(gap).any(axis=1))
    loaded_columns = np.flatnonzero(pressure.any(axis=1))
    touches_end = loaded_columns[0] == roller_columns[0] or loaded_columns[-1] == roller_columns[-1]
    length = float(grid.widths[loaded_columns].sum())
    if touches_end and length < MIN_CONTACT_RATIO * case.hertz_half_width < case.contact_length:
        raise _create_end_contact_error(case, f"not {length:.3g} m")


def _create_end_contact_error(case: Case, actual_reach: str) -> InvalidInputError:
    """Return the error of a roller in contact at its end only."""
    name = "tilt" if case.load_position is None else "load_position"
    return InvalidInputError(
        name,
        getattr(case, name),
        f"such that the contact reaches further from the roller's end than {MIN_CONTACT_RATIO:g} half-width a, "
        f"{case.hertz_half_width:.3g} m, {actual_reach}",
        "tilt the roller less or load it nearer to its middle",
    )


REMEDY = "if intended: warnings.filterwarnings('ignore', category=contactstudy.MagnitudeWarning)"


class UsualRange(NamedTuple):
    """Usual range of a quantity, its SI unit, and likely units of a number outside the range."""

    minimum: float
    maximum: float
    unit: str
    units: tuple[str, ...] = ()


LENGTH_RANGE = UsualRange(1e-5, 3.0, "m", ("mm", "µm"))  # From a pin of a watch to the roll of a mill
STRENGTH_RANGE = UsualRange(1e5, 1e10, "Pa", ("GPa", "MPa"))  # From soft lead to hard metal
SPEED_RANGE = UsualRange(0.0, 150.0, "m/s", ("mm/s", "km/h"))  # Up to the main shafts of aircraft engines
USUAL_RANGES = {  # in engineering contacts, by quantity
    "young": UsualRange(1e6, 1.5e12, "Pa", ("GPa", "MPa")),  # soft rubber to diamond
    "radius": LENGTH_RANGE._replace(maximum=1.5),
    "length": LENGTH_RANGE,
    "friction": UsualRange(0.0, 1.5, "1", ("%",)),  # clean metals reach about 1
    "tilt": UsualRange(0.0, 0.01, "rad", ("deg", "mrad")),  # bearings take a few mrad
    # Over the roller's radius: 1e-5 is 1 MPa on steel; 0.1 exceeds the yield stress of metals.
    "half_width": UsualRange(1e-5, 0.1, "1"),
    # Over the roller's radius: 0.1 is the limit of the theory; only rubber reaches it.
    "approach": UsualRange(0.0, 0.1, "m", ("mm", "µm")),
    "drop": UsualRange(0.0, 0.15, "m", ("mm", "µm")),  # crowns drop by micrometres, ball-shaped rollers are truncated
    "end drop": UsualRange(0.0, 0.5, "m", ("mm", "µm")),  # with rounded or chamfered corners
    "bending": STRENGTH_RANGE,
    "torsion": STRENGTH_RANGE,
    "yield_stress": STRENGTH_RANGE,
    "dynamic_rating": UsualRange(500.0, 1e8, "N", ("kN",)),  # from needles to the bearings of a mill
    "roughness": UsualRange(0.0, 2e-4, "m", ("mm", "µm")),  # from peak to valley
    "entrainment_speed": SPEED_RANGE,
    "sliding_speed": SPEED_RANGE,
    "viscosity": UsualRange(1e-4, 1e3, "Pa s", ("mPa s",)),  # from petrol to grease
    "pressure_viscosity": UsualRange(1e-9, 1e-7, "1/Pa", ("1/GPa", "mm2/N")),
    "eyring_stress": UsualRange(1e5, 1e9, "Pa", ("MPa",)),
    "conductivity": UsualRange(0.01, 5e3, "W/(m K)"),
    "density": UsualRange(10.0, 3e4, "kg/m3", ("g/cm3",)),
    "specific_heat": UsualRange(50.0, 1e4, "J/(kg K)", ("J/(g K)",)),
}
DROP_POSITIONS = {"drop": 0.4, "end drop": 0.49}  # where the drop is checked: from mid-length, over the length
# A crown is unusual if its drop over half the roller's length is below both this length (metres) and this fraction of
# the roller's length. Usual crown radii range from 0.1 to some 100 m. Physics.
MIN_CROWN_DROP, MIN_CROWN_FRACTION = 1e-7, 1e-5


def list_unusual_magnitudes(case: Case) -> tuple[str, ...]:
    """List the unusual magnitudes of a case, with the usual range and the unit of a value within this range."""
    roller, body = case.roller, case.body
    values: list[tuple[str, str, float | None]] = [
        ("radius", "roller.radius", roller.radius),
        ("length", "roller.length", roller.length),
        ("length", "body.length", body.length if isinstance(body, FiniteLengthSpace) else None),
        ("young", "body.material.young", body.material.young),
        ("young", "roller.material.young", roller.material.young if roller.material else None),
        ("tilt", "tilt", abs(case.tilt)),
    ]
    names = ("viscosity", "pressure_viscosity", "eyring_stress", "density", "conductivity") if case.lubricant else ()
    values += [(name, f"lubricant.{name}", getattr(case.lubricant, name)) for name in names]
    messages = [_describe(quantity, name, value) for quantity, name, value in values if value is not None]
    if (speeds := case.motion.speeds) is not None:
        messages.append(describe_unusual("entrainment_speed", speeds.entrainment))
        messages.append(describe_unusual("sliding_speed", speeds.roller - speeds.body))
    messages += [
        describe_unusual("friction", case.friction),
        _describe_unusual_crown(case),
        _describe_flat_crown(case),
        _describe_unusual_design(case),
        _describe_unusual_load(case),
    ]
    return tuple(filter(None, messages))


def warn_of_magnitudes(case: Case) -> None:
    """Warn once of the unusual magnitudes of a case, at the caller of the calling function."""
    _warn(list_unusual_magnitudes(case), stacklevel=4)


def warn_of_values(*, stacklevel: int = 3, **values: float | FloatArray) -> None:
    """Warn of unusual magnitudes by name; arrays are checked by their smallest and largest value."""
    limits = ((name, limit) for name, value in values.items() for limit in np.unique([np.min(value), np.max(value)]))
    _warn((_describe(name, name, float(limit)) for name, limit in limits), stacklevel + 1)


def _warn(messages: Iterable[str], stacklevel: int) -> None:
    """Warn of the messages that are not empty."""
    if text := "; ".join(filter(None, messages)):
        warnings.warn(f"doubtful magnitudes in SI units: {text}; {REMEDY}", MagnitudeWarning, stacklevel=stacklevel)


def _describe(quantity_name: str, name: str, value: float, radius: float | None = None) -> str:
    """Message on a value outside its usual range (for depths over the roller's radius); empty inside."""
    usual = USUAL_RANGES[quantity_name]
    minimum, maximum = (usual.minimum, usual.maximum) if radius is None else (-np.inf, usual.maximum * radius)
    if minimum <= value <= maximum:
        return ""
    unit = "" if usual.unit == "1" else f" {usual.unit}"
    limits = f"up to {maximum:.2g} m on a roller of this radius" if radius else f"{minimum:g} to {maximum:g}{unit}"
    message = f"{name} = {value:g}{unit}, usual are {limits}"
    for unit_name in usual.units:
        if minimum <= (converted := value * UNIT_SIZES[usual.unit][unit_name]) <= maximum:
            return f"{message}; {value:g} {unit_name} is {converted:g}{unit}"
    return message


def _describe_unusual_crown(case: Case) -> str:
    """Message on the drop of the crown, or of the ends of a roller without crown."""
    roller = case.roller
    for quantity_name, fraction in DROP_POSITIONS.items():
        x = fraction * roller.length
        drop = check_drop(roller.profile, np.array([-x, x]), roller.length)
        max_drop = float(np.max(drop, where=np.isfinite(drop), initial=0.0))
        name = f"drop of roller.profile at {fraction:g} of the length from the middle"
        if message := _describe(quantity_name, name, max_drop, roller.radius):
            return message
    return ""


def describe_unusual(name: str, value: Friction | xr.DataArray) -> str:
    """Message on the largest magnitude of a quantity, a number or values along the axis; empty if usual."""
    values = getattr(value, "values", value)
    return _describe(name, name, float(np.max(np.abs(np.asarray(values, dtype=np.float64)))))


def _find_components(profile: object, kind: type | UnionType) -> Iterator[Any]:
    """Profiles of a kind in a profile: the profile itself, or the terms and halves of a composite."""
    if isinstance(profile, kind):
        yield profile
    elif isinstance(profile, tuple):
        for term in profile:
            yield from _find_components(term, kind)
    elif isinstance(profile, Shape):
        yield from _find_components(tuple(vars(profile).values()), kind)


def _describe_flat_crown(case: Case) -> str:
    """Message on a crown radius too large for a ground crown."""
    half_length = 0.5 * case.roller.length
    for crown in _find_components(case.roller.profile, FullCrown | PartialCrown):
        radius = crown.crown_radius
        drop = 0.5 * half_length**2 / radius
        if drop < min(MIN_CROWN_DROP, MIN_CROWN_FRACTION * case.roller.length):
            name = f"{type(crown).__name__}.crown_radius = {radius:g} m"
            conversion = f"; {radius:g} mm is {1e-3 * radius:g} m" if 1e-3 * radius >= half_length else ""
            return f"{name} drops by {drop:.2g} m over half the roller's length, less than is ground{conversion}"
    return ""


def _describe_half_width(subject: str, half_width: float, detail: str) -> str:
    """Message on an unusual half-width over the roller's radius; "low" or "high" fills the braces of `subject`."""
    usual_range = USUAL_RANGES["half_width"]
    if usual_range.minimum <= half_width <= usual_range.maximum:
        return ""
    rating = "low" if half_width < usual_range.minimum else "high"
    return f"{subject.format(rating)}: half-width {half_width:.1g} of the roller's radius, {detail}"


def _describe_unusual_design(case: Case) -> str:
    """Message on the design load of a logarithmic crown."""
    for profile in _find_components(case.roller.profile, Logarithmic):
        # A = R (p0 / E*)**2, so the half-width of the design load is 2 (A R)**0.5.
        half_width = 2 * np.sqrt(profile.amplitude / case.roller.radius)
        subject = f"{type(profile).__name__}.amplitude = {profile.amplitude:.3g} m belongs to a very {{}} design load"
        hint = "pressures and moduli are in Pa, 1500 MPa is 1.5e9 Pa"
        if half_width and (message := _describe_half_width(subject, half_width, hint)):
            return message
    return ""


def _describe_unusual_load(case: Case) -> str:
    """Message on load or pressure by the Hertz half-width, or on the approach."""
    if case.approach is not None:
        return _describe("approach", "approach", case.approach - case.first_touch, case.roller.radius)
    prescribed = f"load = {case.load:g} N" if case.max_pressure is None else f"max_pressure = {case.max_pressure:g} Pa"
    pressure = f"Hertz pressure {format_quantity(case.hertz_max_pressure, 'Pa')}"
    return _describe_half_width(f"{prescribed} is very {{}}", case.hertz_half_width / case.roller.radius, pressure)
