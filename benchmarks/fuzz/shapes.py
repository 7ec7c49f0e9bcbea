"""Random profiles, and the profile of a roller turned end for end."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random

import numpy as np

from contactstudy.profiles import (
    Chamfer,
    Cylinder,
    Ellipsoid,
    FujiwaraKawase,
    FullCrown,
    Halves,
    IsoCylindrical,
    IsoTapered,
    JohnsGohar,
    Lundberg,
    Measured,
    PartialCrown,
    Profile,
    Sphere,
    Sum,
    Tapered,
)


def magnitude(chance: Random, low: float, high: float) -> float:
    """A number whose logarithm is uniform."""
    return math.exp(chance.uniform(math.log(low), math.log(high)))


def random_profile(chance: Random, radius: float, length: float, depth: float) -> Profile:
    """A profile that a roller of these dimensions can have; `depth` is how far a cylinder sinks."""
    kind = chance.choice(("cylinder", "one", "one", "one", "sum", "halves"))
    if kind == "cylinder":
        return Cylinder()
    profile = _single_profile(chance, radius, length, depth)
    if kind == "one":
        return profile
    other = _single_profile(chance, radius, length, depth)
    if kind == "sum":
        return Sum((profile, other))
    return Halves(_level(profile), _level(other))


def _single_profile(chance: Random, radius: float, length: float, depth: float) -> Profile:
    """A profile of one of the kinds."""
    drop = depth * magnitude(chance, 0.1, 10.0)
    arc = max(length**2 / (8 * drop), 0.6 * length)
    makers: dict[str, Callable[[], Profile]] = {
        "fillet": lambda: Cylinder(chance.uniform(0.0, 0.5) * length),
        "crown": lambda: FullCrown(2 * arc, centre=chance.uniform(-0.4, 0.4) * length),
        "partial crown": lambda: PartialCrown(chance.uniform(0.0, 1.0) * length, arc),
        "dub-off": lambda: PartialCrown(0.4 * length, 4 * arc, 0.1 * length, arc),
        "ellipsoid": lambda: Ellipsoid(arc),
        "sphere": lambda: Sphere(radius),
        "Lundberg": lambda: Lundberg(0.5 * drop, chance.choice((0.0, 0.5, 1.0, 2.0))),
        "Johns and Gohar": lambda: JohnsGohar(0.5 * drop, chance.uniform(0.0, 1.0) * length),
        "Fujiwara and Kawase": lambda: FujiwaraKawase(
            0.5 * drop, drop, chance.uniform(0.5, 2.0), chance.uniform(0.1, 1)
        ),
        "ISO cylindrical": lambda: IsoCylindrical(2 * radius),
        "ISO tapered": lambda: IsoTapered(2 * radius),
        "taper": lambda: Tapered(0.8 * chance.uniform(-1, 1) * min(0.1, radius / length), 0.05 * length),
        "measured": lambda: _measured(chance, length, drop),
        "roof": lambda: _roof(chance, length, drop),
        "burr": lambda: _burr(chance, length, drop),
        "chamfer": lambda: Chamfer(depth=drop, width=chance.uniform(0.05, 0.3) * length),
    }
    return makers[chance.choice(tuple(makers))]()


def _measured(chance: Random, length: float, drop: float) -> Measured:
    """A crown with a skew, as if it had been measured."""
    x = np.linspace(-0.5, 0.5, 41)
    shape = (2 * x) ** 2 + chance.uniform(-0.5, 0.5) * x
    return Measured(positions=tuple(x * length), drops=tuple(drop * (shape - shape.min())))


def _roof(chance: Random, length: float, drop: float) -> Measured:
    """Two planes with a convex corner between them."""
    x, corner = np.linspace(-0.5, 0.5, 41), chance.uniform(-0.3, 0.3)
    return Measured(positions=tuple(x * length), drops=tuple(drop * np.abs(x - corner)))


def _burr(chance: Random, length: float, drop: float) -> Measured:
    """A crown with a narrow ridge of a tenth of its drop."""
    x, crest = np.linspace(-0.5, 0.5, 401), chance.uniform(-0.4, 0.4)
    shape = (2 * x) ** 2 - 0.1 * np.exp(-(((x - crest) / 0.01) ** 2))
    return Measured(positions=tuple(x * length), drops=tuple(drop * (shape - shape.min())))


def _level(profile: Profile) -> Profile:
    """The profile, or a cylinder if it does not begin with drop 0 at mid-length, where halves have to meet."""
    try:
        lowest = float(profile.drop(np.zeros(1), 1.0)[0])
    except ValueError:
        lowest = math.inf
    return profile if lowest == 0 and not isinstance(profile, Measured) else Cylinder()


def mirrored(profile: Profile) -> Profile:
    """The profile of the same roller turned end for end."""
    match profile:
        case Sum(terms):
            return Sum(tuple(mirrored(term) for term in terms))
        case Halves(left, right):
            return Halves(mirrored(right), mirrored(left))
        case FullCrown(crown_radius, centre):
            return FullCrown(crown_radius, -centre)
        case Tapered(half_angle, fillet_radius):
            return Tapered(-half_angle, fillet_radius)
        case Measured(positions, drops):
            return Measured(tuple(-x for x in reversed(positions)), tuple(reversed(drops)))
    return profile


def stretched(profile: Profile, factor: float) -> Profile:
    """The profile with every length multiplied."""
    match profile:
        case Sum(terms):
            return Sum(tuple(stretched(term, factor) for term in terms))
        case Halves(left, right):
            return Halves(stretched(left, factor), stretched(right, factor))
        case Tapered(half_angle, fillet_radius):
            return Tapered(half_angle, factor * fillet_radius)
        case Chamfer(depth=float(depth), width=float(width)):
            return Chamfer(depth=factor * depth, width=factor * width)
        case Lundberg(amplitude, delta):
            return Lundberg(factor * amplitude, delta)
        case FujiwaraKawase(amplitude, edge_drop, k1, k2):
            return FujiwaraKawase(factor * amplitude, factor * edge_drop, k1, k2)
        case Measured(positions, drops):
            return Measured(tuple(factor * x for x in positions), tuple(factor * d for d in drops))
        case PartialCrown(straight, crown, dub, dub_radius):
            return PartialCrown(
                factor * straight, factor * crown, factor * dub, None if dub_radius is None else factor * dub_radius
            )
    return type(profile)(*(factor * value for value in vars(profile).values()))
