"""Random profiles, and profiles mirrored about mid-length or in other units."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Polyline:
    """A user's class of straight segments."""

    positions: tuple[float, ...]
    drops: tuple[float, ...]

    def drop(self, x: np.ndarray, length: float) -> np.ndarray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return np.interp(x, self.positions, self.drops)


def draw_magnitude(rng: Random, low: float, high: float) -> float:
    """A number whose logarithm is uniform."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def draw_profile(rng: Random, radius: float, length: float, depth: float) -> Profile:
    """A profile that a roller of these dimensions can have; `depth` is the approach of a cylinder."""
    kind = rng.choice(("cylinder", "one", "one", "one", "sum", "halves"))
    if kind == "cylinder":
        return Cylinder()
    profile = _draw_single_profile(rng, radius, length, depth)
    if kind == "one":
        return profile
    second_profile = _draw_single_profile(rng, radius, length, depth)
    if kind == "sum":
        return Sum((profile, second_profile))
    return Halves(_remove_offset(profile), _remove_offset(second_profile))


def _draw_single_profile(rng: Random, radius: float, length: float, depth: float) -> Profile:
    """A profile of a random kind."""
    drop = depth * draw_magnitude(rng, 0.1, 10.0)
    crown_radius = max(length**2 / (8 * drop), 0.6 * length)
    constructors: dict[str, Callable[[], Profile]] = {
        "fillet": lambda: Cylinder(rng.uniform(0.0, 0.5) * length),
        "crown": lambda: FullCrown(2 * crown_radius, centre=rng.uniform(-0.4, 0.4) * length),
        "partial crown": lambda: PartialCrown(rng.uniform(0.0, 1.0) * length, crown_radius),
        "dub-off": lambda: PartialCrown(0.4 * length, 4 * crown_radius, 0.1 * length, crown_radius),
        "ellipsoid": lambda: Ellipsoid(crown_radius),
        "sphere": lambda: Sphere(radius),
        "Lundberg": lambda: Lundberg(0.5 * drop, rng.choice((0.0, 0.5, 1.0, 2.0))),
        "Johns and Gohar": lambda: JohnsGohar(0.5 * drop, rng.uniform(0.0, 1.0) * length),
        "Fujiwara and Kawase": lambda: FujiwaraKawase(0.5 * drop, drop, rng.uniform(0.5, 2.0), rng.uniform(0.1, 1)),
        "ISO cylindrical": lambda: IsoCylindrical(2 * radius),
        "ISO tapered": lambda: IsoTapered(2 * radius),
        "taper": lambda: Tapered(0.8 * rng.uniform(-1, 1) * min(0.1, radius / length), 0.05 * length),
        "measured": lambda: _draw_measured_profile(rng, length, drop),
        "roof": lambda: _draw_roof(rng, length, drop),
        "burr": lambda: _draw_burr(rng, length, drop),
        "polyline": lambda: _draw_polyline(rng, length, drop),
        "chamfer": lambda: Chamfer(depth=drop, width=rng.uniform(0.05, 0.3) * length),
    }
    return constructors[rng.choice(tuple(constructors))]()


def _draw_measured_profile(rng: Random, length: float, drop: float) -> Measured:
    """A skewed crown as measured points."""
    x = np.linspace(-0.5, 0.5, 41)
    shape = (2 * x) ** 2 + rng.uniform(-0.5, 0.5) * x
    return Measured(positions=tuple(x * length), drops=tuple(drop * (shape - shape.min())))


def _draw_roof(rng: Random, length: float, drop: float) -> Measured:
    """Two planes with a convex corner between them."""
    x, corner = np.linspace(-0.5, 0.5, 41), rng.uniform(-0.3, 0.3)
    return Measured(positions=tuple(x * length), drops=tuple(drop * np.abs(x - corner)))


def _draw_polyline(rng: Random, length: float, drop: float) -> Polyline:
    """A user's profile with two to four bends, 1e-4 to 1e-2 of the length apart."""
    distances = [draw_magnitude(rng, 1e-4, 1e-2) for _ in range(rng.randint(1, 3))]
    bends = rng.uniform(-0.4, 0.4) + np.cumsum([0.0, *distances])
    jumps = np.array([rng.choice((-1, 1)) * draw_magnitude(rng, 1.0, 1e2) for _ in bends])
    x = np.concatenate([[-0.5], bends, [0.5]])
    shape = np.maximum(x[:, None] - bends, 0.0) @ jumps - 0.5 * jumps.sum() * x
    return Polyline(tuple((x * length).tolist()), tuple((drop * (shape - shape.min())).tolist()))


def _draw_burr(rng: Random, length: float, drop: float) -> Measured:
    """A crown with a narrow ridge of a tenth of its drop."""
    x, ridge_position = np.linspace(-0.5, 0.5, 401), rng.uniform(-0.4, 0.4)
    shape = (2 * x) ** 2 - 0.1 * np.exp(-(((x - ridge_position) / 0.01) ** 2))
    return Measured(positions=tuple(x * length), drops=tuple(drop * (shape - shape.min())))


def _remove_offset(profile: Profile) -> Profile:
    """The profile, or a cylinder if the drop at mid-length is not 0, because halves must meet."""
    try:
        min_drop = float(profile.drop(np.zeros(1), 1.0)[0])
    except ValueError:
        min_drop = math.inf
    return profile if min_drop == 0 and not isinstance(profile, Measured) else Cylinder()


def mirror_profile(profile: Profile) -> Profile:
    """The profile mirrored about mid-length."""
    match profile:
        case Sum(terms):
            return Sum(tuple(mirror_profile(term) for term in terms))
        case Halves(left, right):
            return Halves(mirror_profile(right), mirror_profile(left))
        case FullCrown(crown_radius, centre):
            return FullCrown(crown_radius, -centre)
        case Tapered(half_angle, fillet_radius):
            return Tapered(-half_angle, fillet_radius)
        case Measured(positions, drops) | Polyline(positions, drops):
            return type(profile)(tuple(-x for x in reversed(positions)), tuple(reversed(drops)))
    return profile


def stretch_profile(profile: Profile, factor: float) -> Profile:
    """The profile with every length multiplied."""
    match profile:
        case Sum(terms):
            return Sum(tuple(stretch_profile(term, factor) for term in terms))
        case Halves(left, right):
            return Halves(stretch_profile(left, factor), stretch_profile(right, factor))
        case Tapered(half_angle, fillet_radius):
            return Tapered(half_angle, factor * fillet_radius)
        case Chamfer(depth=float(depth), width=float(width)):
            return Chamfer(depth=factor * depth, width=factor * width)
        case Lundberg(amplitude, delta):
            return Lundberg(factor * amplitude, delta)
        case FujiwaraKawase(amplitude, edge_drop, k1, k2):
            return FujiwaraKawase(factor * amplitude, factor * edge_drop, k1, k2)
        case Measured(positions, drops) | Polyline(positions, drops):
            return type(profile)(
                tuple(factor * x for x in positions), tuple(factor * drop_value for drop_value in drops)
            )
        case PartialCrown(straight, crown, dub, dub_radius):
            return PartialCrown(
                factor * straight, factor * crown, factor * dub, None if dub_radius is None else factor * dub_radius
            )
    return type(profile)(*(factor * value for value in vars(profile).values()))
