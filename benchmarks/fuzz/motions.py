"""Random shifts and rolling, mirrored about mid-length or in other units."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from contactstudy import Case, Rolling, Shift
from contactstudy.case.motion import Motion

SIGNED_QUANTITIES = ("lateral_creepage", "spin", "moment_z", "force_x", "x")
"""Quantities that change sign for a roller turned end for end."""

UNITS = {"force_x": (2, 1), "force_y": (2, 1), "moment_z": (3, 1), "spin": (-1, 0), "x": (1, 0), "y": (1, 0)}
"""Powers of length and modulus in the unit of each quantity."""


def draw_motion(rng: Random, case: Case, friction: float) -> Motion:
    """Random shift or rolling, from little slip to full sliding."""
    half_width, radius, full_sliding = case.hertz_half_width, case.roller.radius, friction * case.normal_load
    if rng.random() < 0.35:
        shift = 0.5 * friction * half_width**2 / radius
        return Shift(
            **{
                name: value
                for axis in "xy"
                for name, value in _draw_move_or_force(rng, axis, f"force_{axis}", shift, full_sliding)
            }
        )
    creepage, spin = friction * half_width / radius, friction / radius
    full_moment = full_sliding * 0.25 * case.roller.length
    values = dict(
        [
            *_draw_move_or_force(rng, "longitudinal_creepage", "force_y", creepage, full_sliding),
            *_draw_move_or_force(rng, "lateral_creepage", "force_x", creepage, full_sliding),
            *_draw_move_or_force(rng, "spin", "moment_z", spin, full_moment),
        ]
    )
    if rng.random() < 0.1:
        values = {name: value for name, value in values.items() if name.endswith("creepage") or name == "spin"}
        return Rolling(**values, model="fastsim")
    return Rolling(**values)


def _draw_move_or_force(
    rng: Random, kinematic_name: str, force_name: str, kinematic_scale: float, force_scale: float
) -> list[tuple[str, float]]:
    """Random prescribed value: a creepage or displacement, or the force in its direction, or none."""
    draw = rng.random()
    if draw < 0.3:
        return []
    if draw < 0.75:
        return [(kinematic_name, rng.choice((0.1, 1.0, 3.0)) * rng.uniform(-1.0, 1.0) * kinematic_scale)]
    return [(force_name, rng.uniform(-0.5, 0.5) * force_scale)]


def mirror_motion(motion: Motion) -> Motion:
    """The motion mirrored about mid-length."""
    return replace(
        motion, **{name: -value for name, value in _draw_prescribed_values(motion).items() if name in SIGNED_QUANTITIES}
    )


def scale_motion(motion: Motion, length: float, modulus: float) -> Motion:
    """The motion with every length and every modulus multiplied."""
    values = {name: value for name, value in _draw_prescribed_values(motion).items() if name in UNITS}
    return replace(
        motion, **{name: value * length ** UNITS[name][0] * modulus ** UNITS[name][1] for name, value in values.items()}
    )


def _draw_prescribed_values(motion: Motion) -> dict[str, float]:
    """Prescribed values by name."""
    return {name: value for name, value in vars(motion).items() if isinstance(value, float)}
