"""Atlas of logarithmic rollers between free ends: the study behind `contactstudy.atlas`.

Usage: ``python studies/atlas.py [--points 512] [--out FOLDER]``; about 1.5 s of processor time per point. Solves the
points of a Sobol sequence in three dimensionless groups and writes ``atlas.nc``, the package's ``data/atlas.nc``: one
row per point. A repeated call with more points adds to the finished ones. The options ``--seed 2 --compare`` solve the
points of another sequence, into another folder, and compare the package's atlas with them.
"""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.stats import qmc

import contactstudy as cs
from contactstudy.bearing.atlas import GROUPS, QUANTITIES, AtlasTable
from contactstudy.bodies.hertz import line_half_width

MATERIAL, RADIUS, PRESSURE = cs.Material(210e9, 0.3), 5e-3, 1e9
"""Scales, which the dimensionless results do not depend on; but Poisson's ratio is fixed at 0.3."""

LENGTH, DISTANCE, CROWN = (30.0, 200.0), (0.0, 5.0), (0.06, 0.6)
"""Ranges of the groups ``L/a``, ``e/a`` and ``A R/a**2``."""

SCALES = (0.3, 0.5, 1.0, 2.0)
"""Scales of the first two coordinates over the third that are tried."""

COVERED = 0.95
"""Part of the points whose error the stated one covers."""

SOLVER_ERRORS = {
    "peak_pressure_ratio": 1e-4,
    "peak_von_mises_ratio": 1.3e-3,
    "approach_ratio": 1e-4,
    "end_load_ratio": 1e-3,
}
"""Errors of the solver: changes of the first points by columns refined to 0.002 instead of 0.01, rounded up."""


def groups(count: int, seed: int) -> dict[str, np.ndarray]:
    """Return the groups of the first points of a Sobol sequence."""
    unit = qmc.Sobol(3, seed=seed).random_base2(int(np.ceil(np.log2(count))))[:count].T
    return {
        "length_over_a": LENGTH[0] * (LENGTH[1] / LENGTH[0]) ** unit[0],
        "e_over_a": DISTANCE[1] * unit[1] ** 2,
        "crown": CROWN[0] * (CROWN[1] / CROWN[0]) ** unit[2],
    }


def hertz_half_width() -> float:
    """Half-width of the line contact, metres."""
    return line_half_width(PRESSURE, RADIUS, MATERIAL.plane_strain_modulus)


def make_study(count: int, seed: int) -> cs.Study:
    """Study of the points."""
    a = hertz_half_width()
    points = groups(count, seed)
    return cs.Study(
        name="atlas",
        description="Logarithmic rollers between free ends: length, end distance, crown",
        level="summary",
        base={
            "young": MATERIAL.young,
            "poisson": MATERIAL.poisson,
            "radius": RADIUS,
            "max_pressure": PRESSURE,
            "accuracy": 0.01,
            "field_x_over_a": [0.0],
            "field_y_over_a": [0.0],
            "field_z_over_a": [0.0],
        },
        zip={
            "roller_length": (a * points["length_over_a"]).tolist(),
            "e_over_a": points["e_over_a"].tolist(),
            "profile": [
                {"kind": "lundberg", "amplitude": float(crown * a**2 / RADIUS), "name": f"point {number}"}
                for number, crown in enumerate(points["crown"])
            ],
        },
    )


def table_of(study: xr.Dataset, count: int, seed: int) -> xr.Dataset:
    """Return groups and dimensionless quantities of the solved points."""
    solved = study["status"].values == "ok"
    points = {name: values[solved] for name, values in groups(count, seed).items()}
    a, p0 = hertz_half_width(), PRESSURE
    values = {name: study[name].values[solved] for name in study}
    mean = values["normal_load"] / points["length_over_a"]
    columns = {
        "peak_pressure_ratio": values["peak_pressure"] / p0,
        "peak_von_mises_ratio": values["peak_von_mises"] / p0,
        "approach_ratio": values["approach"] * RADIUS / a**2,
        "end_load_ratio": values["end_load_first"] / mean,
    }
    table = xr.Dataset({name: ("point", column) for name, column in (points | columns).items()})
    for name, limits in (("length_over_a", LENGTH), ("e_over_a", DISTANCE), ("crown", CROWN)):
        table[name].attrs["valid_range"] = limits
    for name, error in SOLVER_ERRORS.items():
        table[name].attrs = {"solver_error": error, "scales": [1.0, 1.0, 1.0]}
    # Over the half-length, from mid-length.
    start, half = points["e_over_a"] * a, 0.5 * points["length_over_a"] * a
    for name in ("peak_pressure", "peak_von_mises"):
        at_end = np.abs(values[f"{name}_x"] - start - half) > 0.5 * half
        table[f"{name}_ratio_at_end"] = ("point", at_end.astype(np.int8))
    return table


def with_residuals(table: xr.Dataset) -> xr.Dataset:
    """Add scales, residuals of each point without itself, and the factors of the stated errors."""
    atlas = AtlasTable(table)
    for name in QUANTITIES:
        trials = {}
        for scales in itertools.product(SCALES, SCALES, (1.0,)):
            table[name].attrs["scales"] = list(scales)
            trials[scales] = left_out(atlas, name)
        best = min(trials, key=lambda scales: float(np.abs(trials[scales][0]).mean()))
        residuals, branch = trials[best]
        table[f"{name}_residual"] = ("point", residuals)
        local = atlas.local_residual(name, atlas.points, branch)
        beyond = np.sqrt(np.maximum(residuals**2 - table[name].attrs["solver_error"] ** 2, 0.0))
        table[name].attrs |= {
            "scales": list(best),
            "coverage_factor": float(np.quantile(beyond / local, COVERED, method="higher")),
        }
    return table


def left_out(atlas: AtlasTable, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Difference of each point from the interpolation between the others, and its branch."""
    samples = atlas.samples(name)
    results = [
        atlas.interpolate(name, point[None], atlas.interpolators(name, number))
        for number, point in enumerate(atlas.points)
    ]
    values, branch = (np.concatenate(column) for column in zip(*results, strict=True))
    return samples - values, branch


def compare(solved: xr.Dataset) -> None:
    """Print actual and stated errors of the atlas at solved points."""
    result = cs.atlas(*(solved[name] for name in GROUPS))
    for name in QUANTITIES:
        scale = solved[name] if name != "end_load_ratio" else 1.0
        actual = (np.abs(result[name] - solved[name]) / scale).values
        stated = (result[f"{name}_error"] / scale).values
        print(
            f"{name}: {actual.size} points, median error {np.median(actual):.1e}, stated {np.median(stated):.1e} "
            f"({np.median(stated) / np.median(actual):.1f} times), covered {(actual <= stated).mean():.0%}"
        )


def main() -> None:
    """Solve the points and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=512, help="points of the sequence")
    parser.add_argument("--seed", type=int, default=1, help="seed of the sequence")
    parser.add_argument("--out", type=Path, default=Path("results/atlas"), help="folder of the study")
    parser.add_argument("--workers", type=int, default=None, help="processes; default: one per core")
    parser.add_argument("--share", type=int, nargs=2, default=None, help="part of the points, such as 1 2")
    parser.add_argument("--compare", action="store_true", help="compare the package's atlas with the points")
    options = parser.parse_args()
    study = make_study(options.points, options.seed)
    cs.run_study(study, options.out, workers=options.workers, share=options.share and tuple(options.share))
    solved = table_of(cs.open_study(options.out), options.points, options.seed)
    if options.compare:
        compare(solved)
    else:
        with_residuals(solved).to_netcdf(options.out / "atlas.nc")


if __name__ == "__main__":
    main()
