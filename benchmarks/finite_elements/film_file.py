"""The file of films: every case on the cells of the package's coarsest level, with the error of the finite elements."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.finite_elements.film import compute_compliance, solve
from benchmarks.finite_elements.reference_files import append_case, create_file
from benchmarks.finite_elements.superpose import Resolution
from contactstudy.film.levels import create_cells
from contactstudy.verification.film import coarse_film
from contactstudy.verification.problems import FILM_CASES

PRODUCTION = Resolution(order=4, growth=1.8, smallest=0.02, nodes=5)
COARSE_RESOLUTION = replace(PRODUCTION, order=3, growth=2.4, smallest=0.04, nodes=4)


def solve_reference(name: str) -> xr.Dataset:
    """The film, and its largest change from coarser finite elements."""
    case, film = FILM_CASES[name], coarse_film(name)
    cells = create_cells(film, film.coarsest_level)[0]
    edges = cells.x_edges, cells.y_edges
    reference_film, coarse_solution = (
        solve(case, compute_compliance(case, *edges, resolution), *edges)
        for resolution in (PRODUCTION, COARSE_RESOLUTION)
    )
    return xr.Dataset(
        {
            "pressure": (("x", "y"), reference_film[0], {"units": "p0"}),
            "film": (("x", "y"), reference_film[1], {"units": "a^2 / R"}),
        },
        coords={"x": ("x", cells.x, {"units": "a"}), "y": ("y", cells.y, {"units": "a"})},
        attrs=vars(case)
        | {
            "pressure_error": float(np.abs(coarse_solution[0] - reference_film[0]).max()),
            "film_error": float(np.abs(coarse_solution[1] / reference_film[1] - 1).max()),
        },
    )


def write(path: Path) -> None:
    """Solve all films and store them."""
    create_file(
        path,
        "film",
        title="Films under rollers between two free ends, by finite elements and a dense Newton method",
        body="0 <= x <= length, y infinite, z >= 0; free ends x = 0 and x = length; isotropic",
        film="Reynolds' equation in finite volumes, Barus oil of constant density, entrained along +y",
        units="lengths in a, films in a^2 / R, pressure in p0",
        resolution=str(PRODUCTION),
    )
    for name in FILM_CASES:
        start = time.perf_counter()
        solution = solve_reference(name)
        append_case(path, name, solution)
        errors = {key: solution.attrs[f"{key}_error"] for key in ("film", "pressure")}
        print(f"{name}: {time.perf_counter() - start:.0f} s, error estimates {errors}", flush=True)
