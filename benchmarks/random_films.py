"""Solve random films and count those that converge: ``python -m benchmarks.random_films --cases 100``.

Crowned rollers with numbers M from 5 to 2000 and L from 2 to 16. Where the film of smooth surfaces closes, asperities
carry the load. ``--first N --cases 1`` runs one seed; the peak memory is that of all seeds so far. ``--finer`` compares
the stated errors with the change by three further refinements along y and two of the columns, of films with M up to 80
on contacts of up to 90 a.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections import Counter
from dataclasses import replace
from random import Random

import numpy as np

import contactstudy as cs
from benchmarks.fuzz.shapes import draw_magnitude
from benchmarks.performance.memory import measure_peak_memory
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute
from contactstudy.film import Asperities, solve_film
from contactstudy.film.levels import Level, continue_solution, film_on_level, moes_line
from contactstudy.film.newton import SETTINGS
from contactstudy.film.solve import FILM_NAMES, compute_films, create_film_case

STEEL = cs.Material(210e9, 0.3)
RADIUS = 5e-3
VISCOSITY = 0.05
MAX_LOAD, MAX_LENGTH = 80.0, 90.0  # Number M and length over a of films that are compared with finer cells
FURTHER_CELLS, FURTHER_COLUMNS = 3, 2  # Refinements of the films for comparison beyond the last level


def draw_profile(rng: Random, amplitude: float, half_width: float, length: float) -> cs.profiles.Profile:
    """A profile with a drop of the order of a design for the pressure."""
    drop = amplitude * draw_magnitude(rng, 0.5, 3.0)
    kind = rng.choice(("Lundberg", "logarithmic", "crown", "partial crown"))
    if kind == "Lundberg":
        return cs.profiles.Lundberg(amplitude=drop, delta=rng.choice((0.0, 1.0)))
    if kind == "logarithmic":
        return cs.profiles.JohnsGohar(amplitude=drop, half_width=half_width)
    depth = 4 * drop
    if kind == "crown":
        return cs.profiles.FullCrown(length**2 / (8 * depth))
    straight_length = rng.uniform(0.3, 0.8) * length
    return cs.profiles.PartialCrown(straight_length, (length - straight_length) ** 2 / (8 * depth))


def draw_case(rng: Random) -> cs.Case:
    """A case with speed and lubricant."""
    half_width = draw_magnitude(rng, 30e-6, 90e-6)
    is_rigid = rng.random() < 0.5
    modulus = STEEL.plane_strain_modulus / (1 if is_rigid else 2)
    pressure = half_width * modulus / (2 * RADIUS)
    length = half_width * draw_magnitude(rng, 8.0, 250.0)
    profile = draw_profile(rng, half_width**2 / (4 * RADIUS), half_width, length)
    distance = rng.choice((0.0, 0.0, rng.uniform(0.0, 5.0))) * half_width
    tilt = rng.choice((0.0, 0.0, rng.uniform(-0.3, 0.3))) * half_width**2 / RADIUS / length
    roller = cs.Roller(radius=RADIUS, length=length, profile=profile, material=None if is_rigid else STEEL)
    case = cs.Case(
        body=cs.FiniteLengthSpace(length=length + 2 * distance, material=STEEL),
        roller=roller,
        end_distance=distance,
        tilt=tilt,
        max_pressure=pressure,
    )
    load, lubricant = draw_magnitude(rng, 5.0, 2000.0), rng.uniform(2.0, 16.0)
    stiffness = 2 * case.modulus
    speed_root = case.normal_load / (case.contact_length * stiffness * RADIUS * load)
    speed = 0.5 * speed_root**2 * stiffness * RADIUS / VISCOSITY
    oil = cs.Lubricant(
        viscosity=VISCOSITY,
        pressure_viscosity=lubricant / (stiffness * speed_root**0.5),
        viscosity_law=rng.choice(("barus", "roelands")),
        density_law=rng.choice(("constant", "dowson-higginson")),
    )
    return replace(case, lubricant=oil, motion=cs.Sliding(body_speed=speed, roller_speed=speed))


def compute_moes_numbers(case: cs.Case) -> tuple[float, float, float]:
    """Moes' numbers M and L of the mean load per length, and the scale of dimensionless films, metres."""
    assert case.lubricant is not None
    assert isinstance(case.motion, cs.Sliding)
    stiffness = 2 * case.modulus
    speed_root = float(np.sqrt(2 * VISCOSITY * case.motion.body_speed / (stiffness * RADIUS)))
    load = case.normal_load / case.contact_length / (stiffness * RADIUS * speed_root)
    return load, case.lubricant.pressure_viscosity * stiffness * speed_root**0.5, RADIUS * speed_root


def solve_seed(seed: int, accuracy: float) -> tuple[str, str]:
    """Solve one seed; return its kind and its line of output."""
    case = draw_case(Random(seed))
    start_time = time.perf_counter()
    kind, text = "smooth", ""
    try:
        try:
            film = solve_film(case, accuracy=accuracy)
        except cs.FilmError as error:
            if "closes" not in str(error):
                raise
            kind = "rough"
            load, lubricant, height = compute_moes_numbers(case)
            central = float(moes_line(load, lubricant)) * height
            film = solve_film(case, accuracy=accuracy, asperities=Asperities(rms=0.1 * central))
        central = float(film.central_film)
        text = (
            f"M {float(film.moes_load):.0f} L {float(film.moes_lubricant):.1f} central {1e6 * central:.4g} um "
            f"+- {100 * float(film.central_film_error) / central:.2g} %, least {float(film.least_film) / central:.3f} "
            f"+- {float(film.least_film_error) / central:.2g}, {int(film.film_levels)} levels, "
            f"{int(film.newton_steps)} and {int(film.linear_steps)} steps"
        )
    except cs.FilmError as error:
        kind, text = "failed", f"{kind}: {error}"
    except cs.InvalidInputError as error:
        kind, text = "refused", str(error)
    return kind, f"{text}, {time.perf_counter() - start_time:.1f} s, peak memory {measure_peak_memory():.0f} MB"


def compare_errors(seed: int, accuracy: float) -> dict[str, tuple[float, float]] | None:
    """Stated error of each film and its change on finer cells; None for a case with a costly finer film."""
    case = draw_case(Random(seed))
    if compute_moes_numbers(case)[0] > MAX_LOAD or case.contact_length > MAX_LENGTH * case.hertz_half_width:
        return None
    result, film = solve_film(case, accuracy=accuracy), create_film_case(case)
    level = Level(**attribute(result, INPUTS_ATTRIBUTE)["settings"]["level"])
    finer_level = level._replace(cells=level.cells + FURTHER_CELLS, columns=level.columns + FURTHER_COLUMNS)
    finer_films = compute_films(
        film, continue_solution(film, film_on_level(film, finer_level, SETTINGS, result), SETTINGS)
    )
    return {
        name: (float(result[f"{name}_error"]), abs(film.height_scale * thickness - float(result[name])))
        for name, thickness in zip(FILM_NAMES, finer_films.thicknesses.tolist(), strict=True)
    }


def report_errors(seeds: range, accuracy: float) -> int:
    """Print the films whose stated errors cover the change to finer cells, and the medians of error over change."""
    compared_rows = []
    for seed in seeds:
        try:
            errors = compare_errors(seed, accuracy)
        except cs.ContactStudyError as error:
            print(f"seed {seed}: {error}", flush=True)
            continue
        if errors is not None:
            compared_rows.append(errors)
            texts = (
                f"{name} {stated_error:.2g} m against {change:.2g}" for name, (stated_error, change) in errors.items()
            )
            print(f"seed {seed}: {', '.join(texts)}", flush=True)
    for name in FILM_NAMES:
        stated_and_changes = [errors[name] for errors in compared_rows]
        covered_count = sum(change <= stated_error for stated_error, change in stated_and_changes)
        median = np.median([stated_error / max(change, 1e-12) for stated_error, change in stated_and_changes])
        print(
            f"{name}: {covered_count} of {len(stated_and_changes)} covered, median of stated error over change "
            f"{median:.1f}"
        )
    return 0


def main() -> int:
    """Run the selected cases."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.random_films", description=__doc__)
    parser.add_argument("--cases", type=int, default=100, help="number of seeds")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--accuracy", type=float, default=0.02, help="accuracy of the films")
    parser.add_argument("--finer", action="store_true", help="compare the stated errors with finer cells")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    if options.finer:
        return report_errors(range(options.first, options.first + options.cases), options.accuracy)
    kinds: Counter[str] = Counter()
    failed_rows = []
    for seed in range(options.first, options.first + options.cases):
        kind, text = solve_seed(seed, options.accuracy)
        kinds[kind] += 1
        failed_rows += [seed] if kind == "failed" else []
        print(f"seed {seed}: {kind}: {text}", flush=True)
    solved_count = options.cases - kinds["refused"]
    print(", ".join(f"{count} {kind}" for kind, count in kinds.most_common()))
    print(
        f"converged: {100 * (solved_count - kinds['failed']) / max(solved_count, 1):.1f} %; failed seeds: {failed_rows}"
    )
    return int(bool(failed_rows))


if __name__ == "__main__":
    raise SystemExit(main())
