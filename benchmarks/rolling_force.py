"""Errors of the force of rolling between unlike bodies: ``python -m benchmarks.rolling_force [--cases 10]``.

The table has the force at mid-length of a rigid roller on rows at several positions, less the force on 128 rows across
the contact. ``--cases`` compares random rollers between free ends at accuracies 0.02 and 0.005 with 0.001, and counts
the covered differences.
"""

from __future__ import annotations

import argparse
from itertools import product
from random import Random

import numpy as np

import contactstudy as cs

RADIUS, PRESSURE, FRICTION = 5e-3, 1.5e9, 0.3
STEEL = cs.Material(young=210e9, poisson=0.3)
HALF_WIDTH = 2 * PRESSURE * RADIUS / STEEL.plane_strain_modulus
LENGTH = 40 * HALF_WIDTH
CREEPAGES = (-0.3, 0.1, 0.4, 0.7)
"""Longitudinal creepages over ``f a / R``."""


def compute_middle_force(creepage: float, rows: int, position: float) -> float:
    """Force at mid-length of a long rigid roller over that of full sliding; `rows` across the contact, offset by
    `position` rows."""
    case = cs.Case(
        body=cs.FiniteLengthSpace(length=LENGTH, material=STEEL),
        roller=cs.Roller(radius=RADIUS, length=LENGTH),
        end_distance=0.0,
        max_pressure=PRESSURE,
        friction=FRICTION,
        motion=cs.Rolling(longitudinal_creepage=creepage * FRICTION * HALF_WIDTH / RADIUS),
    )
    row_width, count = 2 * HALF_WIDTH / rows, rows + 10
    start = (position - 0.5 * count) * row_width
    grid = cs.Grid.between(np.linspace(0, LENGTH, 4), (start, start + count * row_width), count)
    middle_column = cs.solve(case, grid=grid, stresses=False).isel(x=1)
    return float(middle_column["traction_y"].sum() / (FRICTION * middle_column["pressure"].sum()))


def draw_case(rng: Random) -> cs.Case:
    """A rigid roller that rolls on a body with free ends."""
    pressure, friction = rng.uniform(0.8e9, 2e9), rng.uniform(0.05, 0.4)
    half_width = 2 * pressure * RADIUS / STEEL.plane_strain_modulus
    length, distance = rng.uniform(4, 15) * half_width, rng.choice((0.0, rng.uniform(0.2, 2))) * half_width
    creepage = rng.choice((-1, 1, 1)) * rng.uniform(0.05, 1) * friction * half_width / RADIUS
    return cs.Case(
        body=cs.FiniteLengthSpace(length=length + 2 * distance, material=STEEL),
        roller=cs.Roller(radius=RADIUS, length=length),
        end_distance=distance,
        max_pressure=pressure,
        friction=friction,
        motion=cs.Rolling(longitudinal_creepage=creepage),
    )


def compare_with_finer_cells(case: cs.Case, accuracies: tuple[float, ...] = (0.02, 0.005)) -> list[tuple[float, float]]:
    """Differences of the force from that at accuracy 0.001, and sums of both stated errors, over the force of full
    sliding."""
    reference_result, *results = (
        cs.solve(case, accuracy=accuracy, stresses=False) for accuracy in (0.001, *accuracies)
    )
    full_sliding = case.friction * float(reference_result["normal_load"])
    return [
        (
            float(result.force_y - reference_result.force_y) / full_sliding,
            float(result.force_y_error + reference_result.force_y_error) / full_sliding,
        )
        for result in results
    ]


def main(arguments: list[str] | None = None) -> int:
    """Print the table or the comparisons; return 1 if the stated errors cover fewer than 95 % of the differences."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.rolling_force", description=__doc__)
    parser.add_argument("--cases", type=int, default=0, help="random cases; default: the table")
    parser.add_argument("--first", type=int, default=0, help="seed of the first case")
    options = parser.parse_args(arguments)
    comparisons: list[tuple[float, float]] = []
    for seed in range(options.first, options.first + options.cases):
        comparisons += compare_with_finer_cells(draw_case(Random(seed)))
        print(
            f"{seed}: " + ", ".join(f"{change:+.4f} of {error:.4f}" for change, error in comparisons[-2:]), flush=True
        )
    if comparisons:
        changes, errors = np.abs(comparisons).T
        covered_fraction = (changes <= errors).mean()
        print(f"covered {covered_fraction:.0%}, median stated over actual error {np.median(errors / changes):.1f}")
        return int(covered_fraction < 0.95)
    for creepage, rows in product(CREEPAGES, (16, 32, 64)):
        forces = np.array([compute_middle_force(creepage, rows, position) for position in np.arange(-0.5, 0.5, 0.125)])
        difference = forces - compute_middle_force(creepage, 128, 0.0)
        print(f"creepage {creepage:4.1f}, {rows:3d} rows: {np.sqrt(np.mean(difference**2)):.4f} (root mean square)")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
