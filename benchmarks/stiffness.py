"""Stiffness of a roller of 12 x 12 mm in a ring of 18 mm under 8 kN, against half-spaces and formulas for bearings.

``python -m benchmarks.stiffness`` prints the table of docs/how-to/contact_law.md.
"""

from __future__ import annotations

import numpy as np

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Roller, materials, profiles, solve

STEEL, LENGTH, LOAD = materials.BEARING_STEEL, 12e-3, 8e3
RING_LENGTH, EFFECTIVE_LENGTH, END_DROP = 18e-3, 11.2e-3, 10e-6
AMPLITUDE = 2 * LOAD / LENGTH / np.pi / STEEL.plane_strain_modulus
CROWN = profiles.EffectiveLength(profiles.FujiwaraKawase(AMPLITUDE, END_DROP), EFFECTIVE_LENGTH)
LOAD_STEP = 0.02  # relative change of the load for the central difference


def make_case(load: float, depths: tuple[float, float] | None) -> Case:
    """Contact between free ends with reference depths in ring and roller; None: contact of half-spaces."""
    ring_depth, roller_depth = depths or (None, None)
    roller = Roller(
        radius=Roller.combined_radius(6e-3, 40e-3),
        length=LENGTH,
        profile=CROWN,
        material=STEEL,
        ends="free" if depths else "none",
        reference_depth=roller_depth,
    )
    body = (
        FiniteLengthSpace(length=RING_LENGTH, material=STEEL, reference_depth=ring_depth)
        if depths
        else HalfSpace(material=STEEL)
    )
    return Case(body=body, roller=roller, load=load)


def solve_stiffness(depths: tuple[float, float] | None) -> float:
    """Stiffness (N/um) by a central difference over the load."""
    loads = [(1 + sign * LOAD_STEP) * LOAD for sign in (-1, 1)]
    approaches = [float(solve(make_case(load, depths), stresses=False)["approach"]) for load in loads]
    return 1e-6 * (loads[1] - loads[0]) / (approaches[1] - approaches[0])


def compute_palmgren_stiffness() -> float:
    """Stiffness (N/um) of the approach ``3.84e-5 Q**0.9 / L**0.8`` (N, mm) of one contact."""
    approach_mm = 3.84e-5 * LOAD**0.9 / (1e3 * EFFECTIVE_LENGTH) ** 0.8
    return 1e-3 * LOAD / (0.9 * approach_mm)


def compute_iso_stiffness() -> float:
    """Stiffness (N/um) of half the approach of both contacts, ``(Q / (35948 L**(8/9)))**0.9`` (N, mm)."""
    approach_mm = 0.5 * (LOAD / (35948 * (1e3 * EFFECTIVE_LENGTH) ** (8 / 9))) ** 0.9
    return 1e-3 * LOAD / (0.9 * approach_mm)


def main() -> None:
    """Print one row per model."""
    rows = {
        "free ends, one length each": solve_stiffness((RING_LENGTH, LENGTH)),
        "free ends, 18 and 6 mm": solve_stiffness((18e-3, 6e-3)),
        "half-spaces, far away": solve_stiffness(None),
        "Palmgren": compute_palmgren_stiffness(),
        "ISO/TS 16281": compute_iso_stiffness(),
    }
    for model, stiffness in rows.items():
        print(f"| {model} | {stiffness:.0f} |")


if __name__ == "__main__":
    main()
