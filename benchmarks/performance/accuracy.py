"""Coverage of the stated errors: random cases, solved with a loose and a tight accuracy.

Usage: ``python -m benchmarks.performance.accuracy [--cases 60] [--seed 1] [--first 0] [--accuracy 0.02]
[--reference 0.002] [--markdown FILE]``.

Each case has a random body, roller length, profile, tilt or load position, end distance, roller material and load. It
is solved to `accuracy` and to `reference`. A value is covered if the two values differ by no more than the error stated
at `accuracy`. A singular end is covered if both pressures are infinite; its intensity K has a row of its own. Case
``n`` of a seed does not depend on the number of cases: ``--first n --cases 1`` repeats it.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Material, QuarterSpace, Roller, profiles
from contactstudy.bodies.models import Body
from contactstudy.contact.refinement.refined_contact import refine_contact, refined_values
from contactstudy.errors import ContactStudyError
from contactstudy.threads import one_blas_thread

STEEL, BRONZE = Material(210e9, 0.3), Material(110e9, 0.34)
RADIUS = 5e-3
VALUES = ("peak_pressure", "end_pressure_first", "end_pressure_last")
LOADS = ("end_load_first", "end_load_last")
INTENSITIES = ("end_intensity_first", "end_intensity_last")


@dataclass(frozen=True)
class RandomCase:
    """A random case and its description; None and the reason for a refused case."""

    number: int
    name: str
    case: Case | None


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One value of one case, over the Hertz pressure (an intensity: over that and the root of the half-width; a load:
    over that of a half-width under the mean load per length)."""

    random_case: RandomCase
    value: str
    loose: float
    error: float
    tight: float

    @property
    def is_covered(self) -> bool:
        """Whether the stated error covers the difference, or both pressures are infinite."""
        if np.isinf(self.loose) or np.isinf(self.tight):
            return bool(self.loose == self.tight)
        return abs(self.loose - self.tight) <= self.error


def _draw_log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def draw_case(seed: int, number: int) -> RandomCase:
    """Draw case `number` of a seed."""
    rng = np.random.default_rng([seed, number])
    p0 = rng.uniform(0.8e9, 3e9)
    material = [None, None, None, STEEL, BRONZE][rng.integers(5)]
    steel_modulus = STEEL.plane_strain_modulus
    modulus = steel_modulus if material is None else 1 / (1 / steel_modulus + 1 / material.plane_strain_modulus)
    half_width = 4 * p0 * RADIUS / (2 * modulus)
    length = half_width * _draw_log_uniform(rng, 8, 200)
    kind, profile = draw_profile(rng, p0, length, modulus)
    roller = Roller(
        radius=RADIUS, length=length, profile=profile, material=material, ends=("free", "none")[rng.integers(2)]
    )
    body_kind = ("half", "quarter", "finite", "finite")[rng.integers(4)]
    distance = 0.0
    if body_kind != "half":
        distance = float(
            (0.0, half_width * _draw_log_uniform(rng, 0.1, 5), -half_width * rng.uniform(0.1, 2))[
                rng.choice(3, p=[0.5, 0.4, 0.1])
            ]
        )
    body: Body = HalfSpace(material=STEEL)
    if body_kind == "quarter":
        body = QuarterSpace(material=STEEL)
    elif body_kind == "finite":
        second_distance = distance if rng.random() < 0.5 else half_width * rng.uniform(0.0, 5)
        body = FiniteLengthSpace(length=length + distance + second_distance, material=STEEL)
    inclination: dict[str, float] = {}
    slope = min(1.0, 20 * half_width / length)
    if (draw := rng.random()) < 0.3:
        inclination = {"tilt": float(rng.uniform(-1e-3, 1e-3) * slope)}
    elif draw < 0.4:
        inclination = {"load_position": distance + length * (0.5 + 0.05 * float(rng.uniform(-1, 1)))}
    name = (
        f"{kind}, L {length / half_width:.0f}a, {p0 / 1e9:.2f} GPa, {body_kind}, e {distance / half_width:.2f}a, "
        f"{'rigid' if material is None else 'steel' if material is STEEL else 'bronze'}"
        + (f" ends {roller.ends}" if material is not None else "")
        + "".join(f", {key} {value:.2e}" for key, value in inclination.items())
    )
    try:
        return RandomCase(
            number,
            name,
            Case(
                body=body,
                roller=roller,
                max_pressure=p0,
                end_distance=None if body_kind == "half" else distance,
                **inclination,
            ),
        )
    except ContactStudyError as error:
        return RandomCase(number, f"{name}: {error}", None)


def draw_profile(rng: np.random.Generator, p0: float, length: float, modulus: float) -> tuple[str, profiles.Profile]:
    """Draw a profile and its name."""
    fillet = min(_draw_log_uniform(rng, 0.02e-3, 0.5e-3), 0.3 * length)
    sag = _draw_log_uniform(rng, 0.2e-6, 20e-6) * min(1.0, length / 10e-3)
    crown = profiles.FullCrown(crown_radius=length**2 / (8 * sag))
    rounded_cylinder = profiles.Cylinder(fillet_radius=fillet)
    kind = ("sharp", "fillet", "crown", "crown + fillet", "lundberg", "partial crown", "measured")[rng.integers(7)]
    detail = {"fillet": f" {1e3 * fillet:.3f} mm", "crown": f" {1e6 * sag:.1f} um"}
    name = kind + "".join(text for word, text in detail.items() if word in kind and kind != "partial crown")
    if kind == "sharp":
        return name, profiles.Cylinder()
    if kind == "fillet":
        return name, rounded_cylinder
    if kind == "crown":
        return name, crown
    if kind == "crown + fillet":
        return name, crown + rounded_cylinder
    if kind == "lundberg":
        pressure = p0 * rng.uniform(0.6, 1.2)
        return name, profiles.Lundberg.for_pressure(pressure, radius=RADIUS, modulus=modulus)
    if kind == "partial crown":
        straight_length = length * rng.uniform(0.3, 0.8)
        radius = _draw_log_uniform(rng, 0.1, 3.0)
        return f"{name} {straight_length / length:.2f} L, R {radius:.2f} m", profiles.PartialCrown(
            straight_length, radius
        )
    x = np.linspace(-0.5 * length, 0.5 * length, 401)
    drops = (crown + rounded_cylinder).drop(x, length)
    return f"{name} crown {1e6 * sag:.1f} um + fillet {1e3 * fillet:.3f} mm", profiles.Measured(
        x.tolist(), drops.tolist()
    )


def compare_values(random_case: RandomCase, accuracy: float, reference: float) -> Iterator[Comparison]:
    """Solve a case at both accuracies and compare its values."""
    assert random_case.case is not None
    case = random_case.case
    loose, tight = (compute_refined_values(case, accuracy_value) for accuracy_value in (accuracy, reference))
    scale = case.hertz_max_pressure
    for value in VALUES:
        error = float(loose[f"{value}_error"]) / scale
        yield Comparison(
            random_case=random_case,
            value=value,
            loose=float(loose[value]) / scale,
            error=error,
            tight=float(tight[value]) / scale,
        )
    mean_end_load = case.normal_load * case.hertz_half_width / case.contact_length
    for value in LOADS:
        error = float(loose[f"{value}_error"]) / mean_end_load
        yield Comparison(
            random_case=random_case,
            value=value,
            loose=float(loose[value]) / mean_end_load,
            error=error,
            tight=float(tight[value]) / mean_end_load,
        )
    for value in INTENSITIES:
        power = float(loose.get(value.replace("intensity", "exponent"), 0.0))
        if value in loose and value in tight and case.roller.material is None and power:
            unit = scale * case.hertz_half_width**power
            error = float(loose[f"{value}_error"]) / unit
            yield Comparison(
                random_case=random_case,
                value=value,
                loose=float(loose[value]) / unit,
                error=error,
                tight=float(tight[value]) / unit,
            )


def compute_refined_values(case: Case, accuracy: float) -> xr.Dataset:
    return refined_values(case, refine_contact(case, accuracy, 1e-6))


def format_table(comparisons: list[Comparison], refused: list[str], seconds_per_case: dict[str, float]) -> str:
    """Markdown table of the coverage, and every value that is not covered."""
    lines = [
        "| value | cases | covered | % | median difference / p0 | median error / p0 |",
        "|---|---|---|---|---|---|",
    ]
    for value in (*VALUES, *LOADS, *INTENSITIES):
        rows = [row for row in comparisons if row.value == value]
        finite_rows = [row for row in rows if np.isfinite([row.loose, row.tight]).all() and row.loose]
        if rows:
            covered_count = sum(row.is_covered for row in rows)
            median_difference = (
                np.median([abs(row.loose - row.tight) for row in finite_rows]) if finite_rows else np.nan
            )
            error = np.median([row.error for row in finite_rows]) if finite_rows else np.nan
            percentage = 100 * covered_count / len(rows)
            lines.append(
                f"| {value} | {len(rows)} | {covered_count} | {percentage:.1f} | {median_difference:.4f} "
                f"| {error:.4f} |"
            )
    case_numbers = sorted({row.random_case.number for row in comparisons})
    missed_cases = {row.random_case.number for row in comparisons if not row.is_covered and row.value in VALUES}
    lines += [
        "",
        f"{len(case_numbers) - len(missed_cases)} of {len(case_numbers)} cases have all three pressures covered.",
    ]
    lines += [
        f"Seconds per case: {', '.join(f'{name} {value:.2f}' for name, value in seconds_per_case.items())}.",
        "",
        "Misses:",
    ]
    lines += [
        f"* {row.random_case.number}: {row.random_case.name}: {row.value} {row.loose:.4f} +- {row.error:.4f}, "
        f"tight accuracy {row.tight:.4f}"
        for row in comparisons
        if not row.is_covered
    ]
    return "\n".join([*lines, "", f"Refused: {len(refused)}", *(f"* {row}" for row in refused)])


def main() -> None:
    """Read the options, compare and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--accuracy", type=float, default=0.02)
    parser.add_argument("--reference", type=float, default=0.002)
    parser.add_argument("--markdown", type=Path)
    options = parser.parse_args()
    comparisons: list[Comparison] = []
    refused: list[str] = []
    start = time.perf_counter()
    for number in range(options.first, options.first + options.cases):
        random_case = draw_case(options.seed, number)
        if random_case.case is None:
            refused.append(f"{number}: {random_case.name}")
            continue
        try:
            with one_blas_thread():
                rows = list(compare_values(random_case, options.accuracy, options.reference))
        except ContactStudyError as error:
            refused.append(f"{number}: {random_case.name}: {type(error).__name__}: {error}")
            print(refused[-1], flush=True)
            continue
        comparisons += rows
        comparison_text = ", ".join(
            f"{row.value} {row.loose:.4f} +- {row.error:.4f} / {row.tight:.4f}{'' if row.is_covered else ' MISSED'}"
            for row in rows
        )
        print(f"{number}: {random_case.name}: {comparison_text}", flush=True)
    table = format_table(comparisons, refused, {"both": (time.perf_counter() - start) / max(options.cases, 1)})
    print(table)
    if options.markdown:
        options.markdown.write_text(table + "\n")


if __name__ == "__main__":
    main()
