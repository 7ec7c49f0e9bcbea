"""One roller on raceways of two widths, by profile and by model of the ends.

Usage: ``python studies/real_roller.py [--out FOLDER] [--accuracy A]``; about a minute on two cores. Prints Markdown
tables and writes ``real_roller.nc``. Radius 5 mm, length 10 mm, steel on steel, 1.5 GPa Hertz pressure; raceways 14 mm
wide and as wide as the roller.

Each profile is pressed with the same load and the same contact modulus: half-space on half-space; as a rigid roller on
a raceway with free ends and half of Young's modulus; as an elastic half-space on a raceway of steel; and
with both bodies of finite length. Columns are refined until every pressure has converged; a singular end has its
intensity instead.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

import contactstudy as cs
from contactstudy.bodies import Body

RADIUS, LENGTH, PRESSURE = 5e-3, 10e-3, 1.5e9
RACEWAYS = (14e-3, 10e-3)
STEEL, SOFT_STEEL = cs.Material(210e9, 0.3), cs.Material(105e9, 0.3)
MODULUS = 0.5 * STEEL.plane_strain_modulus
HALF_WIDTH = 2 * PRESSURE * RADIUS / MODULUS
DESIGN = {"radius": RADIUS, "modulus": MODULUS}

PROFILES: dict[str, cs.profiles.Profile] = {
    "cylinder, fillet 0.2 mm": cs.profiles.Cylinder(fillet_radius=0.2e-3),
    "cylinder, fillet 2 mm": cs.profiles.Cylinder(fillet_radius=2e-3),
    "tapered 2 deg, fillet 2 mm": cs.profiles.Tapered(np.deg2rad(2.0), fillet_radius=2e-3),
    "Lundberg": cs.profiles.Lundberg.for_pressure(PRESSURE, **DESIGN),
    "Johns-Gohar": cs.profiles.JohnsGohar.for_pressure(PRESSURE, **DESIGN),
    "Fujiwara-Kawase, K2 = 0.5": cs.profiles.FujiwaraKawase.for_pressure(PRESSURE, **DESIGN, edge_drop=10e-6, k2=0.5),
    "ISO/TS 16281": cs.profiles.IsoCylindrical(2 * RADIUS),
    "full crown 2 m": cs.profiles.FullCrown(2.0),
    "partial crown": cs.profiles.PartialCrown(6e-3, 0.6),
}
MODELS = ("half-spaces", "finite raceway, rigid roller", "finite raceway, half-space roller", "both finite")
QUANTITIES = (
    *("peak_pressure", "peak_pressure_error", "end_pressure", "end_pressure_error"),
    *("end_intensity", "end_intensity_error", "end_exponent", "end_load", "end_load_error"),
    *("peak_von_mises", "peak_von_mises_error"),
)
PRESSURES = (
    *("peak_pressure", "peak_pressure_error", "end_pressure", "end_pressure_error"),
    *("peak_von_mises", "peak_von_mises_error"),
)
"""Quantities over p0; loads are over the load of a half-width, intensities over p0 a^m."""


def create_case(profile: cs.profiles.Profile, model: str, raceway: float, length: float = LENGTH) -> cs.Case:
    """Case of a profile and a model, all with the same Hertz contact; lengths in metres."""
    is_rigid = model == "finite raceway, rigid roller"
    material = SOFT_STEEL if is_rigid else STEEL
    if model == "half-spaces":
        body: Body = cs.HalfSpace(material=material)
    else:
        body = cs.FiniteLengthSpace(length=raceway, material=material)
    roller = cs.Roller(
        radius=RADIUS,
        length=length,
        profile=profile,
        material=None if is_rigid else STEEL,
        ends="free" if model == "both finite" else "none",
    )
    return cs.Case(body=body, roller=roller, max_pressure=PRESSURE, end_distance=0.5 * (raceway - length))


def evaluate_case(case: cs.Case, accuracy: float) -> dict[str, float]:
    """Peak, pressure and load at the end with their errors, law of a singular end, largest von Mises stress."""
    # The largest stress does not depend on the positions of the stresses.
    result = cs.solve(case, accuracy=accuracy, x=[0.0], y=[0.0], z=[HALF_WIDTH])
    exponent = float(result.get("end_exponent_first", np.nan))
    intensity_scale = PRESSURE * HALF_WIDTH ** np.nan_to_num(exponent)
    load_scale = case.normal_load * HALF_WIDTH / case.contact_length
    missing = xr.DataArray(np.nan)

    def scale_scalar(name: str, scale: float) -> float:
        return float(result.get(name, missing)) / scale

    return {
        "peak_pressure": scale_scalar("peak_pressure", PRESSURE),
        "peak_pressure_error": scale_scalar("peak_pressure_error", PRESSURE),
        "end_pressure": scale_scalar("end_pressure_first", PRESSURE),
        "end_pressure_error": scale_scalar("end_pressure_first_error", PRESSURE),
        "end_intensity": scale_scalar("end_intensity_first", intensity_scale),
        "end_intensity_error": scale_scalar("end_intensity_first_error", intensity_scale),
        "end_exponent": exponent,
        "end_load": scale_scalar("end_load_first", load_scale),
        "end_load_error": scale_scalar("end_load_first_error", load_scale),
        "peak_von_mises": scale_scalar("peak_von_mises", PRESSURE),
        "peak_von_mises_error": scale_scalar("peak_von_mises_error", PRESSURE),
    }


def solve_profiles(
    profiles: Mapping[str, cs.profiles.Profile], accuracy: float, length: float, raceway: float, model: str
) -> list[dict[str, float]]:
    """All profiles with one raceway and model, which share the end correction."""
    with threadpool_limits(1):
        return [evaluate_case(create_case(profile, model, raceway, length), accuracy) for profile in profiles.values()]


def solve_all(
    profiles: Mapping[str, cs.profiles.Profile], accuracy: float, length: float = LENGTH, *, workers: int | None = None
) -> xr.Dataset:
    """Every quantity (raceway, profile, model); raceways keep their distance from a shorter roller.

    `workers` is the number of processes, by default one per core; 0 solves in this process.
    """
    raceways = [width - LENGTH + length for width in RACEWAYS]
    pairs = list(itertools.product(raceways, MODELS))
    solve_column = partial(solve_profiles, profiles, accuracy, length)
    if workers == 0:
        columns = list(itertools.starmap(solve_column, pairs))
    else:
        with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
            columns = list(pool.map(solve_column, *zip(*pairs, strict=True)))
    solution = dict(zip(pairs, columns, strict=True))
    rows = [
        [[solution[raceway, model][number] for model in MODELS] for number in range(len(profiles))]
        for raceway in raceways
    ]
    dims = ("raceway", "profile", "model")
    return xr.Dataset(
        {
            name: (
                dims,
                [[[cell[name] for cell in row] for row in table] for table in rows],
                {"units": "1", "long_name": f"{name.replace('_', ' ')}{' over p0' if name in PRESSURES else ''}"},
            )
            for name in QUANTITIES
        },
        coords={
            "raceway": ("raceway", raceways, {"units": "m", "long_name": "width of the raceway"}),
            "profile": list(profiles),
            "model": list(MODELS),
        },
        attrs={"Conventions": "CF-1.11", "title": "one real roller: profiles and models of the ends"},
    )


def format_value(value: float, error: float) -> str:
    """Value with its error."""
    return f"{value:.3f} ± {error:.3f}"


def describe_end(row: Mapping[str, float]) -> str:
    """Pressure at the roller's end, the law of a singular end, or "open" without contact."""
    if row["end_pressure"] == 0:
        return "open"
    if np.isfinite(row["end_pressure"]):
        return format_value(row["end_pressure"], row["end_pressure_error"])
    if not np.isfinite(row["end_intensity"]):
        return "singular (logarithm)"
    return (
        f"singular, K = {format_value(row['end_intensity'], row['end_intensity_error'])}, m = {row['end_exponent']:.2f}"
    )


def format_table(solution: xr.Dataset) -> str:
    """Markdown, one table: a row for each profile, pressures and stresses over p0."""
    names = " | ".join(f"{model}: peak, end, von Mises" for model in solution["model"].values)
    lines = [f"| profile | {names} |", "|---" * (solution.sizes["model"] + 1) + "|"]
    for profile in solution["profile"].values:
        cells = []
        for model in solution["model"].values:
            row = {name: float(solution[name].sel(profile=profile, model=model)) for name in QUANTITIES}
            singular = np.isinf(row["peak_pressure"])
            peak = "singular" if singular else format_value(row["peak_pressure"], row["peak_pressure_error"])
            stress = "" if singular else f", {format_value(row['peak_von_mises'], row['peak_von_mises_error'])}"
            cells.append(f"{peak}, {describe_end(row)}{stress}")
        lines.append(f"| {profile} | {' | '.join(cells)} |")
    return "\n".join(lines)


def load_table(solution: xr.Dataset) -> str:
    """Markdown: load on the last half-width of the roller, over the mean load of a half-width."""
    lines = [f"| profile | {' | '.join(solution['model'].values)} |", "|---" * (solution.sizes["model"] + 1) + "|"]
    for profile in solution["profile"].values:
        row = solution.sel(profile=profile)
        pairs = zip(row["end_load"].values, row["end_load_error"].values, strict=True)
        lines.append(f"| {profile} | {' | '.join(format_value(*pair) for pair in pairs)} |")
    return "\n".join(lines)


def main() -> None:
    """Solve, print and write."""
    parser = argparse.ArgumentParser(description="One real roller: profiles and models of the ends.")
    parser.add_argument("--out", type=Path, default=Path("results/real_roller"))
    parser.add_argument("--accuracy", type=float, default=0.01, help="accuracy of the pressures; default 0.01")
    options = parser.parse_args()
    solution = solve_all(PROFILES, options.accuracy)
    for raceway in solution["raceway"].values:
        row = solution.sel(raceway=raceway)
        print(f"Raceway {1e3 * raceway:g} mm wide\n\n{format_table(row)}\n\nLoad on the last a:\n\n{load_table(row)}\n")
    options.out.mkdir(parents=True, exist_ok=True)
    solution.to_netcdf(options.out / "real_roller.nc")


if __name__ == "__main__":
    main()
