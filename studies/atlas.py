"""Atlas of logarithmic rollers between free ends: the study behind `contactstudy.atlas`.

Usage: ``python studies/atlas.py [--points 1024] [--out FOLDER]``; about 2.3 s of processor time per point. Solves the
points of a Sobol sequence in five dimensionless groups, each under three loads for the stiffness, and writes
``atlas.nc``, the package's ``data/atlas.nc``: one row per point. A repeated call with more points solves the new points
only. The options ``--seed 2 --compare`` solve the points of another sequence, into another folder, and compare the
package's atlas with them.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.spatial.distance import cdist
from scipy.stats import qmc

import contactstudy as cs
from contactstudy.bearing.atlas import GROUPS, QUANTITIES, AtlasTable, transform_groups

YOUNG, RADIUS, PRESSURE = 210e9, 5e-3, 1e9
"""Scales without influence on the dimensionless results."""

RANGES = {
    "length_over_a": (30.0, 200.0),
    "e_over_a": (0.0, 5.0),
    "crown": (0.06, 0.6),
    "tilt_ratio": (0.0, 1.5),
    "poisson": (0.2, 0.4),
}
"""Ranges of the groups ``L/a``, ``e/a``, ``A R/a**2`` and ``theta L R/(2 a**2)``, and of Poisson's ratio."""

SCALES = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Tried scales of a coordinate, over the scale of the first coordinate."""

HALF_WIDTH_FACTORS = (1.0, 0.95, 1.05)
"""Factors of pressure and half-width: the stiffness follows from the second and third, without stresses."""

NEAR_END = 2.0
"""Distance from the end over the half-width within which the largest value belongs to the end."""

COVERED = 0.92
"""Fraction of the points whose residual the stated error covers; of other points it covers 95 % and more."""

SOLVER_ERRORS = {
    "peak_pressure_ratio": 9e-4,
    "peak_von_mises_ratio": 3e-3,
    "approach_ratio": 7e-5,
    "stiffness_ratio": 2.2e-4,
    "end_load_ratio": 8e-4,
}
"""Errors of the solver: nine tenths of the changes of the first 32 points at an accuracy of 0.002 instead of 0.01, as
``--points 32 --accuracy 0.002 --compare`` prints them."""


def sample_groups(count: int, seed: int) -> dict[str, np.ndarray]:
    """Return the groups of the first points of a Sobol sequence, even in the coordinates of the atlas."""
    unit_points = qmc.Sobol(len(GROUPS), seed=seed).random_base2(int(np.ceil(np.log2(count))))[:count]
    low, high = transform_groups(np.array([RANGES[name] for name in GROUPS]).T)
    length, distance, crown, tilt, poisson = (low + unit_points * (high - low)).T
    return dict(zip(GROUPS, (np.exp(length), distance**2, np.exp(crown), tilt, poisson), strict=True))


def compute_half_widths(points: dict[str, np.ndarray]) -> np.ndarray:
    """Half-widths of the line contacts, metres."""
    return 2 * PRESSURE * RADIUS * (1 - points["poisson"] ** 2) / YOUNG


def make_study(count: int, seed: int, accuracy: float) -> cs.Study:
    """Study of the points, each under three pressures: equal rollers in metres."""
    points = {name: np.repeat(values, len(HALF_WIDTH_FACTORS)) for name, values in sample_groups(count, seed).items()}
    a, factor = compute_half_widths(points), np.tile(HALF_WIDTH_FACTORS, count)
    length = a * points["length_over_a"]
    return cs.Study(
        name="atlas",
        description="Logarithmic rollers between free ends: length, end distance, crown, tilt, Poisson's ratio",
        level="summary",
        base={
            "young": YOUNG,
            "radius": RADIUS,
            "accuracy": accuracy,
            "field_x_over_a": [0.0],
            "field_y_over_a": [0.0],
            "field_z_over_a": [0.0],
        },
        zip={
            "roller_length": length.tolist(),
            "max_pressure": (PRESSURE * factor).tolist(),
            "e_over_a": (points["e_over_a"] / factor).tolist(),
            "tilt": (2 * points["tilt_ratio"] * a**2 / (length * RADIUS)).tolist(),
            "poisson": points["poisson"].tolist(),
            "stresses": (factor == 1.0).tolist(),
            "profile": [
                {
                    "kind": "lundberg",
                    "amplitude": float(amplitude),
                    "name": f"point {number // len(HALF_WIDTH_FACTORS)}",
                }
                for number, amplitude in enumerate(points["crown"] * a**2 / RADIUS)
            ],
        },
    )


def create_table(study: xr.Dataset, count: int, seed: int) -> xr.Dataset:
    """Return groups and dimensionless quantities of the points."""
    cases = {name: study[name].values.reshape(count, -1) for name in study}
    is_solved = (cases["status"] == "ok").all(axis=1)
    points = {name: values[is_solved] for name, values in sample_groups(count, seed).items()}
    a, p0 = compute_half_widths(points), PRESSURE
    values, approaches = {name: column[is_solved, 0] for name, column in cases.items()}, cases["approach"][is_solved].T
    mean_load = values["normal_load"] / points["length_over_a"]
    # Slope of the approach over the load, in logarithms of both
    slope = np.log(approaches[2] / approaches[1]) / (2 * np.log(HALF_WIDTH_FACTORS[2] / HALF_WIDTH_FACTORS[1]))
    columns = {
        "peak_pressure_ratio": values["peak_pressure"] / p0,
        "peak_von_mises_ratio": values["peak_von_mises"] / p0,
        "approach_ratio": values["approach"] * RADIUS / a**2,
        "stiffness_ratio": np.pi * a**2 / (4 * values["approach"] * RADIUS * slope),
        "end_load_ratio": values["end_load_last"] / mean_load,
    }
    table = xr.Dataset({name: ("point", column) for name, column in (points | columns).items()})
    for name, limits in RANGES.items():
        table[name].attrs["valid_range"] = limits
    for name, error in SOLVER_ERRORS.items():
        table[name].attrs = {"solver_error": error, "scales": [1.0] * len(GROUPS)}
    # Distance from the nearer end
    stop = (points["e_over_a"] + points["length_over_a"]) * a
    for name in ("peak_pressure", "peak_von_mises"):
        at_end = np.abs(stop - values[f"{name}_x"]) < NEAR_END * a
        table[f"{name}_ratio_at_end"] = ("point", at_end.astype(np.int8))
    return table


def add_residuals(table: xr.Dataset) -> xr.Dataset:
    """Add scales, leave-one-out residuals of the points, and the factors of the stated errors."""
    for name in QUANTITIES:
        scales = [1.0] * len(GROUPS)
        trials: dict[tuple[float, ...], tuple[np.ndarray, np.ndarray]] = {}
        # One scale varies at a time; only the ratios of the scales have an influence.
        for group in [*range(1, len(GROUPS))] * 2:
            for scale in SCALES:
                trial = (*scales[:group], scale, *scales[group + 1 :])
                if trial not in trials:
                    table[name].attrs["scales"] = list(trial)
                    trials[trial] = leave_one_out(AtlasTable(table), name)
            scales = list(min(trials, key=lambda trial: float(np.abs(trials[trial][0]).mean())))
        residuals, branch = trials[tuple(scales)]
        table[name].attrs["scales"] = scales
        table[f"{name}_residual"] = ("point", residuals)
        atlas = AtlasTable(table)
        local_residual = atlas.local_residual(name, atlas.points, branch, omitted_count=1)
        excess = np.sqrt(np.maximum(residuals**2 - table[name].attrs["solver_error"] ** 2, 0.0))
        table[name].attrs["coverage_factor"] = float(np.quantile(excess / local_residual, COVERED, method="higher"))
    return table


def leave_one_out(atlas: AtlasTable, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Difference of each point from the interpolation between the others, and its branch."""
    samples, coordinates = atlas.interpolated_samples(name), atlas.scale(name, atlas.points)
    values = atlas.branch_values(name, atlas.points)
    for row, mask in zip(values, atlas.branches(name), strict=True):
        row[mask] -= compute_leave_one_out_residuals(coordinates[mask], samples[mask])
    return samples - values.max(axis=0), values.argmax(axis=0)


def compute_leave_one_out_residuals(points: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Difference of each sample from the cubic radial functions and parabola through the others (Rippa, 1999)."""
    count = len(points)
    monomials = [
        points[:, list(factors)].prod(axis=1) for degree in range(3) for factors in monomial_indices(points, degree)
    ]
    matrix = np.zeros((count + len(monomials),) * 2)
    matrix[:count, :count] = cdist(points, points) ** 3
    matrix[:count, count:] = np.transpose(monomials)
    matrix[count:, :count] = monomials
    inverse = np.linalg.inv(matrix)[:count, :count]
    return np.asarray(inverse @ samples / inverse.diagonal())


def monomial_indices(points: np.ndarray, degree: int) -> Iterator[tuple[int, ...]]:
    """Yield the indices of the coordinates in each monomial of the degree."""
    return itertools.combinations_with_replacement(range(points.shape[1]), degree)


def compare(solved: xr.Dataset) -> None:
    """Print actual and stated errors of the atlas at solved points."""
    result = cs.atlas(*(solved[name] for name in GROUPS))
    for name in QUANTITIES:
        scale = solved[name] if name != "end_load_ratio" else 1.0
        actual = (np.abs(result[name] - solved[name]) / scale).values
        stated = (result[f"{name}_error"] / scale).values
        print(
            f"{name}: {actual.size} points, median error {np.median(actual):.1e}, nine tenths below "
            f"{np.quantile(actual, 0.9):.1e}, stated {np.median(stated):.1e} "
            f"({np.median(stated) / np.median(actual):.1f} times), covered {(actual <= stated).mean():.0%}"
        )


def main() -> None:
    """Solve the points and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=1024, help="points of the sequence")
    parser.add_argument("--seed", type=int, default=1, help="seed of the sequence")
    parser.add_argument("--accuracy", type=float, default=0.01, help="accuracy of the solutions")
    parser.add_argument("--out", type=Path, default=Path("results/atlas"), help="folder of the study")
    parser.add_argument("--workers", type=int, default=None, help="processes; default: one per core")
    parser.add_argument("--share", type=int, nargs=2, default=None, help="part of the points, such as 1 2")
    parser.add_argument("--compare", action="store_true", help="compare the package's atlas with the points")
    options = parser.parse_args()
    study = make_study(options.points, options.seed, options.accuracy)
    cs.run_study(study, options.out, workers=options.workers, share=options.share and tuple(options.share))
    solved = create_table(cs.open_study(options.out), options.points, options.seed)
    if options.compare:
        compare(solved)
    else:
        add_residuals(solved).to_netcdf(options.out / "atlas.nc")


if __name__ == "__main__":
    main()
