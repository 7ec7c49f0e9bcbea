"""One real roller on one real raceway: what each profile and each model of the ends makes of it.

Usage: ``python studies/real_roller.py [--out FOLDER] [--cells N]``; some minutes on two cores. Prints a Markdown table
and writes ``real_roller.nc``. Radius 5 mm, length 10 mm, raceway 14 mm wide, steel on steel, 1.5 GPa Hertz pressure.

Each profile is pressed with the same load: on a half-space as a half-space; rigid, on a raceway with free ends of half
Young's modulus (the same contact modulus); and with both bodies of finite length.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import xarray as xr

import contactstudy as cs

RADIUS, LENGTH, RACEWAY, PRESSURE = 5e-3, 10e-3, 14e-3, 1.5e9
STEEL, HALF_STIFF = cs.Material(210e9, 0.3), cs.Material(105e9, 0.3)
MODULUS = 0.5 * STEEL.plane_strain_modulus
HALF_WIDTH = 2 * PRESSURE * RADIUS / MODULUS
DESIGN = {"radius": RADIUS, "modulus": MODULUS}

PROFILES: dict[str, cs.profiles.Profile] = {
    "cylinder, fillet 2 mm": cs.profiles.Cylinder(fillet_radius=2e-3),
    "tapered 2 deg, fillet 2 mm": cs.profiles.Tapered(np.deg2rad(2.0), fillet_radius=2e-3),
    "Lundberg": cs.profiles.Lundberg.for_pressure(PRESSURE, **DESIGN),
    "Johns-Gohar": cs.profiles.JohnsGohar.for_pressure(PRESSURE, **DESIGN),
    "Fujiwara-Kawase, K2 = 0.5": cs.profiles.FujiwaraKawase.for_pressure(PRESSURE, **DESIGN, edge_drop=10e-6, k2=0.5),
    "ISO/TS 16281": cs.profiles.IsoCylindrical(2 * RADIUS),
    "full crown 2 m": cs.profiles.FullCrown(2.0),
    "partial crown": cs.profiles.PartialCrown(6e-3, 0.6),
}
MODELS = ("half-space", "finite raceway, rigid roller", "both finite")


def case_of(profile: cs.profiles.Profile, model: str) -> cs.Case:
    """Case of a profile and a model, all with the same Hertz contact."""
    if model == "finite raceway, rigid roller":
        body: cs.Body = cs.FiniteLengthSpace(length=RACEWAY, material=HALF_STIFF)
        roller = cs.Roller(radius=RADIUS, length=LENGTH, profile=profile)
    else:
        free = model == "both finite"
        body = cs.FiniteLengthSpace(length=RACEWAY, material=STEEL) if free else cs.HalfSpace(material=STEEL)
        ends = "free" if free else "none"
        roller = cs.Roller(radius=RADIUS, length=LENGTH, profile=profile, material=STEEL, ends=ends)
    return cs.Case(body=body, roller=roller, max_pressure=PRESSURE, end_distance=0.5 * (RACEWAY - LENGTH))


def measured(profile: cs.profiles.Profile, model: str, cells: float) -> dict[str, float]:
    """Peak pressure with its error, pressure half a width from the roller's end, and largest von Mises stress."""
    case = case_of(profile, model)
    grid = cs.choose_grid(case, cells_x=cells, cells_y=2 * cells, window=2.2)
    start = case.roller_start
    x = start + HALF_WIDTH * np.concatenate([np.linspace(0.0, 20.0, 81), [0.5 * LENGTH / HALF_WIDTH]])
    result = cs.solve(case, grid, x=x, y=[0.0], z=HALF_WIDTH * np.linspace(0.1, 1.2, 23), error_estimate=True)
    along = result["pressure"].max("y")
    return {
        "peak_pressure": float(result["peak_pressure"]) / PRESSURE,
        "peak_pressure_error": float(result["peak_pressure_error"]) / PRESSURE,
        "edge_pressure": float(along.sel(x=slice(start, start + 0.5 * HALF_WIDTH)).max()) / PRESSURE,
        "peak_von_mises": float(result["von_mises"].max()) / PRESSURE,
    }


def table(found: xr.Dataset) -> str:
    """Markdown: a row for each profile; pressures and stresses over p0."""
    names = " | ".join(f"{model}: peak, edge, von Mises" for model in MODELS)
    lines = [f"| profile | {names} |", "|---" * (len(MODELS) + 1) + "|"]
    for profile in found["profile"].values:
        cells = []
        for model in MODELS:
            one = found.sel(profile=profile, ends=model)
            error = float(one["peak_pressure_error"])
            bound = f" ± {error:.3f}" if np.isfinite(error) else " (grid)"
            cells.append(
                f"{float(one['peak_pressure']):.3f}{bound}, {float(one['edge_pressure']):.2f}, "
                f"{float(one['peak_von_mises']):.3f}"
            )
        lines.append(f"| {profile} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Solve, print and write."""
    parser = argparse.ArgumentParser(description="One real roller: profiles and models of the ends.")
    parser.add_argument("--out", type=Path, default=Path("results/real_roller"))
    parser.add_argument("--cells", type=float, default=8, help="cells per half-width along x; default 8")
    options = parser.parse_args()
    rows = [[measured(profile, model, options.cells) for model in MODELS] for profile in PROFILES.values()]
    found = xr.Dataset(
        {
            name: (
                ("profile", "ends"),
                [[cell[name] for cell in row] for row in rows],
                {"units": "1", "long_name": f"{name.replace('_', ' ')} over p0"},
            )
            for name in rows[0][0]
        },
        coords={"profile": list(PROFILES), "ends": list(MODELS)},
        attrs={"Conventions": "CF-1.11", "title": "one real roller: profiles and models of the ends"},
    )
    options.out.mkdir(parents=True, exist_ok=True)
    found.to_netcdf(options.out / "real_roller.nc")
    print(table(found))


if __name__ == "__main__":
    main()
