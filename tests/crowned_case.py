"""Cases of a short crowned steel roller on a body of 20 half-widths."""

from __future__ import annotations

from contactstudy import Case, FiniteLengthSpace, Material, Roller, profiles

STEEL = Material(210e9, 0.3)
HALF_WIDTH = 65e-6
LENGTH = 20 * HALF_WIDTH
BODY = FiniteLengthSpace(length=LENGTH, material=STEEL)
CROWNED = profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=STEEL.plane_strain_modulus)


def make_crowned_case(**arguments) -> Case:
    """The crowned roller at 1 GPa, changed by `arguments`."""
    roller = Roller(radius=5e-3, length=16 * HALF_WIDTH, profile=CROWNED)
    return Case(**({"body": BODY, "roller": roller, "max_pressure": 1e9} | arguments))
