"""Compare the largest von Mises stress under rolling and its error: ``python -m benchmarks.rolling_stress --cases 10``.

Random rollers between free ends at accuracy 0.1, against the same columns with rows a quarter as wide. ``--carter``
compares 32 cases of equal cylinders at accuracy 0.01 with the closed stresses of Carter's traction.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import product
from random import Random
from typing import NamedTuple

import numpy as np
import xarray as xr

import contactstudy as cs
from benchmarks.fuzz.shapes import draw_magnitude
from tests.closed_forms import compute_largest_von_mises_under_carter

RADIUS = 5e-3
STEEL = cs.Material(young=210e9, poisson=0.28)
LENGTH, PRESSURE = 3e-3, 5e8
FRICTIONS, FORCE_FRACTIONS = (0.3, 0.5, 0.7, 1.0), (0.05, 0.14, 0.25, 0.5, 0.8, 0.93, 0.95, 0.98)


class Comparison(NamedTuple):
    """Difference of the largest von Mises stress from its reference and stated error, over the reference."""

    change: float
    error: float
    result: xr.Dataset

    @classmethod
    def of(cls, result: xr.Dataset, reference: float) -> Comparison:
        """Compare a result with a reference, Pa."""
        value, error = float(result.peak_von_mises), float(result.peak_von_mises_error)
        return cls(value / reference - 1, error / reference, result)


def draw_case(rng: Random) -> cs.Case:
    """A short roller on a body with free ends, mostly of equal materials, that rolls with partial slip."""
    steel = cs.Material(210e9, rng.choice((0.3, 0.3, rng.uniform(0.1, 0.49))))
    roller_material = rng.choice((None, steel, steel, cs.Material(rng.uniform(50e9, 400e9), rng.uniform(0.1, 0.45))))
    half_width = RADIUS * draw_magnitude(rng, 3e-3, 2e-2)
    length = half_width * draw_magnitude(rng, 1.5, 4.0)
    compliance = sum(1 / body.plane_strain_modulus for body in (steel, roller_material) if body is not None)
    pressure = half_width / (2 * RADIUS * compliance)
    profile: cs.profiles.Profile = rng.choice(
        (
            cs.profiles.Cylinder(fillet_radius=length * rng.uniform(0.1, 0.3)),
            cs.profiles.Ellipsoid(crown_radius=length**2 * RADIUS / (8 * half_width**2 * rng.uniform(0.3, 1.0))),
            cs.profiles.Lundberg.for_pressure(pressure, radius=RADIUS, modulus=1 / compliance, delta=2),
        )
    )
    roller = cs.Roller(radius=RADIUS, length=length, material=roller_material, profile=profile)
    distance = rng.choice((0.0, 0.0, rng.uniform(0.2, 3.0))) * half_width
    case = cs.Case(
        body=cs.FiniteLengthSpace(length=length + 2 * distance, material=steel),
        roller=roller,
        friction=rng.uniform(0.3, 1.0),
        max_pressure=pressure,
        end_distance=distance,
    )
    creepage = case.friction * half_width / RADIUS
    motion = {"longitudinal_creepage": rng.choice((-1, 1)) * rng.uniform(0.03, 0.9) * creepage}
    if rng.random() < 0.3:
        motion = {"force_y": rng.choice((-1, 1)) * rng.uniform(0.1, 0.97) * case.friction * case.normal_load}
    if rng.random() < 0.2:
        motion["lateral_creepage"] = rng.uniform(-0.3, 0.3) * creepage
    if rng.random() < 0.2:
        motion["spin"] = rng.uniform(-0.3, 0.3) * case.friction / RADIUS
    return replace(case, motion=cs.Rolling(**motion))


def compare_with_finer_rows(case: cs.Case, accuracy: float) -> Comparison | None:
    """Solve a case on its columns and on four times the rows; None where the pressure is singular."""
    result = cs.solve(case, accuracy=accuracy, y=[0.0], z=[0.0])
    if not np.isfinite(result.peak_pressure):
        return None
    edges = np.append(result.x_bounds.values[:, 0], result.x_bounds.values[-1, 1])
    half_step = 0.5 * float(result.y[1] - result.y[0])
    window = (float(result.y[0]) - half_step, float(result.y[-1]) + half_step)
    fine_result = cs.solve(case, cs.Grid.between(edges, window, 4 * result.sizes["y"]), y=[0.0], z=[0.0])
    return Comparison.of(result, float(fine_result.peak_von_mises))


def compare_with_carter(friction: float, force_fraction: float) -> Comparison:
    """Solve a long roller on a half-space of the same material; at mid-length it is in plane strain."""
    modulus = STEEL.plane_strain_modulus / 2
    profile = cs.profiles.Lundberg.for_pressure(PRESSURE, radius=RADIUS, modulus=modulus, delta=2)
    roller = cs.Roller(radius=RADIUS, length=LENGTH, profile=profile, material=STEEL, ends="none")
    body = cs.HalfSpace(material=STEEL)
    case = cs.Case(body=body, roller=roller, max_pressure=PRESSURE, friction=friction)
    creepage = friction * case.hertz_half_width / RADIUS * (1 - force_fraction)
    result = cs.solve(replace(case, motion=cs.Rolling(longitudinal_creepage=creepage)), y=[0.0], z=[0.0])
    middle_column = result.isel(x=int(abs(result.x.values - LENGTH / 2).argmin()))
    peak_pressure, step = float(result.peak_pressure), float(result.y[1] - result.y[0])
    half_width = 2 * step * float(middle_column.pressure.sum()) / (np.pi * peak_pressure)
    stick_ratio = 1 - creepage * RADIUS / (friction * half_width)
    return Comparison.of(
        result, peak_pressure * compute_largest_von_mises_under_carter(friction, stick_ratio, STEEL.poisson)
    )


def main(arguments: list[str] | None = None) -> int:
    """Compare the selected cases; the status is 1 if a stated error does not hold."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.rolling_stress", description=__doc__)
    parser.add_argument("--cases", type=int, default=10, help="number of seeds")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--carter", action="store_true", help="compare with Carter's traction instead")
    options = parser.parse_args(arguments)
    warnings.simplefilter("ignore")
    comparisons: dict[str, Callable[[], Comparison | None]] = {
        f"seed {seed}": partial(compare_with_finer_rows, draw_case(Random(seed)), 0.1)
        for seed in range(options.first, options.first + options.cases)
    }
    if options.carter:
        parameter_pairs = product(FRICTIONS, FORCE_FRACTIONS)
        comparisons = {
            f"friction {parameters[0]}, force {parameters[1]}": partial(compare_with_carter, *parameters)
            for parameters in parameter_pairs
        }
    comparison_results = []
    for name, compare in comparisons.items():
        comparison = compare()
        if comparison is None:
            print(f"{name}: the pressure is singular", flush=True)
            continue
        comparison_results.append(comparison)
        region = "top" if comparison.result.peak_von_mises_z == 0 else "below"
        print(f"{name}: {comparison.change:+.2%}, stated {comparison.error:.2%}, {region}", flush=True)
    changes, errors = np.array([(abs(comparison.change), comparison.error) for comparison in comparison_results]).T
    covered_count = int((changes <= errors).sum())
    print(
        f"{len(comparison_results)} cases, {covered_count} stated errors hold; "
        f"difference: median {np.median(changes):.2%}, largest {changes.max():.2%}; "
        f"stated error: median {np.median(errors):.2%}"
    )
    return int(covered_count < len(comparison_results))


if __name__ == "__main__":
    raise SystemExit(main())
