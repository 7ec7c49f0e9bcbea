"""Rows on refined columns: a roller with an edge radius, against uniform cells."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import xarray as xr

from benchmarks.performance.problems import STEEL
from benchmarks.performance.timing import Report, Row, compute_medians, format_time, nudge
from contactstudy import Case, FiniteLengthSpace, Roller, choose_grid, profiles, solve

RADIUS, LENGTH, FILLET, PEAK = 5e-3, 10e-3, 0.2e-3, 1.5e9
CELLS = 16
"""Uniform cells per half-width."""


def make_roller_case() -> Case:
    """A roller as long as the body; every call makes a body without kept kernels."""
    # Bodies that differ by rounding alone share their kernels.
    length = LENGTH * (1 + 1e6 * (nudge() - 1))
    roller = Roller(radius=RADIUS, length=length, profile=profiles.Cylinder(FILLET))
    return Case(body=FiniteLengthSpace(length=length, material=STEEL), roller=roller, max_pressure=PEAK, friction=0.1)


def solve_roller(*, uniform: bool) -> xr.Dataset:
    """Contact and stresses at 41 x 1 x 25 points."""
    case = make_roller_case()
    half_width = case.hertz_half_width
    x, z = np.linspace(0.0, 0.5 * case.roller.length, 41), np.linspace(0.0, 3.0, 25) * half_width
    grid = choose_grid(case, cells_x=CELLS, cells_y=CELLS) if uniform else None
    return solve(case, grid, x=x, y=[0.0], z=z)


def refined_columns(repeats: int, report: Report) -> Iterator[Row]:
    """Peak with columns refined to 1 %, against uniform cells."""
    timed_functions: dict[str, Callable[[], object]] = {
        "refined": partial(solve_roller, uniform=False),
        "uniform": partial(solve_roller, uniform=True),
    }
    seconds = compute_medians(timed_functions, min(repeats, 3))
    result = solve_roller(uniform=False)
    peak, error = float(result["peak_pressure"]), float(result["peak_pressure_error"])
    if error > 0.01 * peak:
        report.add_remark("the refined peak has not converged to 1 %")
    yield Row(
        work="real roller, 10 mm, edge radius 0.2 mm, with stresses, nothing kept",
        ours=format_time(seconds["refined"]),
        peers=f"{CELLS} uniform cells per a: {format_time(seconds['uniform'])}",
        ratio=f"{seconds['refined'] / seconds['uniform']:.2f}",
        notes=f"peak {peak / 1e9:.3f} +- {error / 1e9:.3f} GPa on {result.sizes['x']} columns",
    )
