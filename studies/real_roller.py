"""One real roller on real raceways: what each profile and each model of the ends makes of it.

Usage: ``python studies/real_roller.py [--out FOLDER] [--cells N]``; about three minutes. Prints Markdown
tables and writes ``real_roller.nc``. Radius 5 mm, length 10 mm, steel on steel, 1.5 GPa Hertz pressure; raceways 14 mm
wide and as wide as the roller.

Each profile is pressed with the same load and the same contact modulus: half-space on half-space; as a rigid roller on
a raceway with free ends, which then has half of Young's modulus; as an elastic half-space on a raceway of steel; and
with both bodies of finite length. A second table follows the pressure at the roller's end as the cells shrink.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

import contactstudy as cs

RADIUS, LENGTH, PRESSURE = 5e-3, 10e-3, 1.5e9
RACEWAYS = (14e-3, 10e-3)
STEEL, HALF_STIFF = cs.Material(210e9, 0.3), cs.Material(105e9, 0.3)
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
QUANTITIES = ("peak_pressure", "peak_pressure_error", "edge_pressure", "edge_pressure_error", "peak_von_mises")
UNRESOLVED = 0.2
"""Two grids that differ by more than this fraction say nothing about the limit."""

FOLLOWED = "Lundberg"
"""Profile whose edge pressure is followed as the cells shrink."""


def case_of(profile: cs.profiles.Profile, model: str, raceway: float, length: float = LENGTH) -> cs.Case:
    """Case of a profile and a model, all with the same Hertz contact; lengths in metres."""
    rigid = model == "finite raceway, rigid roller"
    material = HALF_STIFF if rigid else STEEL
    if model == "half-spaces":
        body: cs.Body = cs.HalfSpace(material=material)
    else:
        body = cs.FiniteLengthSpace(length=raceway, material=material)
    roller = cs.Roller(
        radius=RADIUS,
        length=length,
        profile=profile,
        material=None if rigid else STEEL,
        ends="free" if model == "both finite" else "none",
    )
    return cs.Case(body=body, roller=roller, max_pressure=PRESSURE, end_distance=0.5 * (raceway - length))


def edge_pressure(result: xr.Dataset) -> float:
    """Largest pressure within half a width of the roller's ends, over p0."""
    along = result["pressure"].max("y")
    facing = result["x"][np.isfinite(result["initial_gap"]).any("y")]
    near = (result["x"] < facing[0] + 0.5 * HALF_WIDTH) | (result["x"] > facing[-1] - 0.5 * HALF_WIDTH)
    return float(along.where(near).max()) / PRESSURE


def edge_error(case: cs.Case, grid: cs.Grid, result: xr.Dataset) -> float:
    """Error of the edge pressure from a contact on half the cells; infinite if a sharp end carries load there.

    Two grids may agree by chance, so it is never less, relatively, than the peak's.
    """
    for end in ("first", "last"):
        if float(result[f"end_pressure_{end}"]) > 0 and np.isinf(result[f"end_pressure_{end}_error"]):
            return np.inf
    fine, coarse = edge_pressure(result), edge_pressure(cs.solve(case, grid.coarsened(), stresses=False))
    if fine == 0 and coarse == 0:
        return 0.0
    least = fine * float(result["peak_pressure_error"] / result["peak_pressure"])
    return max(abs(fine - coarse), least) if abs(fine - coarse) <= UNRESOLVED * fine else np.inf


def measured(case: cs.Case, cells: float) -> dict[str, float]:
    """Peak and edge pressure with their errors and the largest von Mises stress in the body, over p0."""
    grid = cs.choose_grid(case, cells_x=cells, cells_y=2 * cells, window=2.2)
    from_end = HALF_WIDTH * np.linspace(0.0, 20.0, 81)
    from_end = np.append(from_end[from_end < 0.5 * case.roller.length], 0.5 * case.roller.length)
    x = case.roller_start + np.unique(np.concatenate([from_end, case.roller.length - from_end]))
    z = HALF_WIDTH * np.linspace(0.1, 1.2, 23)
    result = cs.solve(case, grid, x=np.clip(x, *case.body.extent), y=[0.0], z=z, error_estimate=True)
    return {
        "peak_pressure": float(result["peak_pressure"]) / PRESSURE,
        "peak_pressure_error": float(result["peak_pressure_error"]) / PRESSURE,
        "edge_pressure": edge_pressure(result),
        "edge_pressure_error": edge_error(case, grid, result),
        "peak_von_mises": float(result["von_mises"].max()) / PRESSURE,
    }


def solved(profiles: Mapping[str, cs.profiles.Profile], cells: float, length: float = LENGTH) -> xr.Dataset:
    """Every quantity (raceway, profile, model); raceways keep their distance from a shorter roller."""
    raceways = [each - LENGTH + length for each in RACEWAYS]
    rows = [
        [
            [measured(case_of(profile, model, raceway, length), cells) for model in MODELS]
            for profile in profiles.values()
        ]
        for raceway in raceways
    ]
    dims = ("raceway", "profile", "model")
    return xr.Dataset(
        {
            name: (
                dims,
                [[[cell[name] for cell in row] for row in table] for table in rows],
                {"units": "1", "long_name": f"{name.replace('_', ' ')} over p0"},
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


def convergence(
    profile: cs.profiles.Profile, counts: tuple[float, ...], raceway: float, length: float = LENGTH
) -> xr.DataArray:
    """Edge pressure over p0 (model, cells) on ever smaller cells along x."""
    found = []
    for model in MODELS:
        case = case_of(profile, model, raceway, length)
        grids = [cs.choose_grid(case, cells_x=cells, cells_y=16, window=2.2) for cells in counts]
        found.append([edge_pressure(cs.solve(case, grid, stresses=False)) for grid in grids])
    coords = {"model": list(MODELS), "cells": ("cells", list(counts), {"long_name": "cells per half-width along x"})}
    attributes = {"units": "1", "long_name": "edge pressure over p0"}
    return xr.DataArray(found, coords, ("model", "cells"), name="edge_pressure_by_cells", attrs=attributes)


def with_error(value: float, error: float) -> str:
    """Value with its error, "grid" where the cells decide, "open" where nothing touches."""
    if value == 0:
        return "open"
    return f"{value:.3f} ± {error:.3f}" if np.isfinite(error) else f"{value:.2f} (grid)"


def table(found: xr.Dataset) -> str:
    """Markdown, one table: a row for each profile, pressures and stresses over p0."""
    names = " | ".join(f"{model}: peak, edge, von Mises" for model in found["model"].values)
    lines = [f"| profile | {names} |", "|---" * (found.sizes["model"] + 1) + "|"]
    for profile in found["profile"].values:
        cells = []
        for model in found["model"].values:
            one = {name: float(found[name].sel(profile=profile, model=model)) for name in QUANTITIES}
            pressures = (with_error(one[name], one[f"{name}_error"]) for name in ("peak_pressure", "edge_pressure"))
            cells.append(f"{', '.join(pressures)}, {one['peak_von_mises']:.3f}")
        lines.append(f"| {profile} | {' | '.join(cells)} |")
    return "\n".join(lines)


def convergence_table(found: xr.DataArray) -> str:
    """Markdown: edge pressure over p0, a column for each number of cells."""
    counts = " | ".join(f"{count:g} cells per a" for count in found["cells"].values)
    lines = [f"| {FOLLOWED}: edge pressure | {counts} |", "|---" * (found.sizes["cells"] + 1) + "|"]
    for model in found["model"].values:
        lines.append(f"| {model} | {' | '.join(f'{value:.3f}' for value in found.sel(model=model).values)} |")
    return "\n".join(lines)


def main() -> None:
    """Solve, print and write."""
    parser = argparse.ArgumentParser(description="One real roller: profiles and models of the ends.")
    parser.add_argument("--out", type=Path, default=Path("results/real_roller"))
    parser.add_argument("--cells", type=float, default=8, help="cells per half-width along x; default 8")
    options = parser.parse_args()
    found = solved(PROFILES, options.cells)
    for raceway in found["raceway"].values:
        print(f"Raceway {1e3 * raceway:g} mm wide\n\n{table(found.sel(raceway=raceway))}\n")
    counts = (0.5 * options.cells, options.cells, 2 * options.cells)
    found["edge_pressure_by_cells"] = convergence(PROFILES[FOLLOWED], counts, RACEWAYS[0])
    print(convergence_table(found["edge_pressure_by_cells"]))
    options.out.mkdir(parents=True, exist_ok=True)
    found.to_netcdf(options.out / "real_roller.nc")


if __name__ == "__main__":
    main()
