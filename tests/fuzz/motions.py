"""Random shifts and rolling, and the same seen from the other end or in other units."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from contactstudy import Case, Rolling, Shift
from contactstudy.case.motion import Motion

OF_X = ("lateral_creepage", "spin", "moment_z", "force_x", "x")
"""What changes its sign if it is seen from the other end."""

UNITS = {"force_x": (2, 1), "force_y": (2, 1), "moment_z": (3, 1), "spin": (-1, 0), "x": (1, 0), "y": (1, 0)}
"""Powers of length and modulus in the unit of each."""


def random_motion(chance: Random, case: Case, friction: float) -> Motion:
    """From hardly any slip to full sliding."""
    half_width, radius, whole = case.hertz_half_width, case.roller.radius, friction * case.normal_load
    if chance.random() < 0.35:
        shift = 0.5 * friction * half_width**2 / radius
        return Shift(
            **{name: value for axis in "xy" for name, value in _either(chance, axis, f"force_{axis}", shift, whole)}
        )
    creepage, spin = friction * half_width / radius, friction / radius
    turns = whole * 0.25 * case.roller.length
    given = dict(
        [
            *_either(chance, "longitudinal_creepage", "force_y", creepage, whole),
            *_either(chance, "lateral_creepage", "force_x", creepage, whole),
            *_either(chance, "spin", "moment_z", spin, turns),
        ]
    )
    if chance.random() < 0.1:
        given = {name: value for name, value in given.items() if name.endswith("creepage") or name == "spin"}
        return Rolling(**given, model="fastsim")
    return Rolling(**given)


def _either(chance: Random, move: str, force: str, of_move: float, of_force: float) -> list[tuple[str, float]]:
    """A move or the force that it makes, or neither."""
    chosen = chance.random()
    if chosen < 0.3:
        return []
    if chosen < 0.75:
        return [(move, chance.choice((0.1, 1.0, 3.0)) * chance.uniform(-1.0, 1.0) * of_move)]
    return [(force, chance.uniform(-0.5, 0.5) * of_force)]


def turned_motion(motion: Motion) -> Motion:
    """The same seen from the other end."""
    return replace(motion, **{name: -value for name, value in _given(motion).items() if name in OF_X})


def scaled_motion(motion: Motion, length: float, modulus: float) -> Motion:
    """The same with every length and every modulus multiplied."""
    given = {name: value for name, value in _given(motion).items() if name in UNITS}
    return replace(
        motion, **{name: value * length ** UNITS[name][0] * modulus ** UNITS[name][1] for name, value in given.items()}
    )


def _given(motion: Motion) -> dict[str, float]:
    """What is prescribed, by name."""
    return {name: value for name, value in vars(motion).items() if isinstance(value, float)}
