"""The file of contacts: every case with an estimate of its error.

Variants of the finite elements are coarser in one approximation each (element order, mesh, depth of the body,
quadrature in k); two further variants have hats of twice the width along y and along x. The error of hats is
proportional to the square of their width, so a third of their change is the error of the finer mesh. The estimate is
the sum of the changes.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.finite_elements.contact import SolvedContact, compute_flexibility, solve
from benchmarks.finite_elements.reference_files import append_case, create_file
from benchmarks.finite_elements.superpose import Resolution
from contactstudy.verification.problems import CONTACT_CASES, ContactCase

PRODUCTION = Resolution(order=4, growth=1.8, smallest=0.02, nodes=5)
LOWER_ORDER = replace(PRODUCTION, order=3)
VARIANTS = {  # name: (variant, reference)
    "order": (LOWER_ORDER, PRODUCTION),
    "mesh": (replace(LOWER_ORDER, growth=2.4, smallest=0.04), LOWER_ORDER),
    "depth": (replace(LOWER_ORDER, depth=7e3), LOWER_ORDER),
    "wavenumbers": (replace(LOWER_ORDER, nodes=4), LOWER_ORDER),
}
STEP, WINDOW = 1 / 16, 1.75


def solve_reference(case: ContactCase) -> xr.Dataset:
    """The contact with its error estimate."""
    flexibilities = {
        resolution: compute_flexibility(case, resolution)
        for resolution in dict.fromkeys(
            [PRODUCTION, LOWER_ORDER, *(changed_resolution for changed_resolution, _ in VARIANTS.values())]
        )
    }
    production = solve(case, flexibilities[PRODUCTION], STEP, WINDOW)

    def evaluate_on_nodes(solution: SolvedContact) -> np.ndarray:
        resampled_rows = np.array([np.interp(production.x, solution.x, row) for row in solution.pressure.T])
        return np.array([np.interp(production.y, solution.y, row) for row in resampled_rows.T])

    def compute_line_load(pressure: np.ndarray) -> np.ndarray:
        return np.asarray(2 * np.trapezoid(pressure, production.y, axis=1))

    changes = {
        name: evaluate_on_nodes(solve(case, flexibilities[changed_resolution], STEP, WINDOW))
        - evaluate_on_nodes(solve(case, flexibilities[reference_resolution], STEP, WINDOW))
        for name, (changed_resolution, reference_resolution) in VARIANTS.items()
    }
    changes["hats_y"] = (
        evaluate_on_nodes(solve(case, flexibilities[PRODUCTION], 2 * STEP, WINDOW)) - production.pressure
    ) / 3
    changes["hats_x"] = (
        evaluate_on_nodes(solve(case, flexibilities[PRODUCTION], STEP, WINDOW, stride=2)) - production.pressure
    ) / 3
    fields = {
        "pressure": production.pressure,
        "pressure_error": sum(np.abs(change) for change in changes.values()),
    }
    loads = {
        "line_load": compute_line_load(production.pressure),
        "line_load_error": sum(np.abs(compute_line_load(change)) for change in changes.values()),
    }
    dataset = xr.Dataset(
        {name: (("x", "y"), values, {"units": "p0"}) for name, values in fields.items()}
        | {name: (("x",), values, {"units": "p0 a"}) for name, values in loads.items()},
        coords={"x": ("x", production.x, {"units": "a"}), "y": ("y", production.y, {"units": "a"})},
        attrs={"length": case.length, "distance": case.distance, "crown": case.crown, "poisson": case.poisson},
    )
    dataset.attrs |= {f"change_{name}_median": float(np.median(np.abs(change))) for name, change in changes.items()}
    return dataset


def write(path: Path) -> None:
    """Solve all contacts and store them."""
    create_file(
        path,
        "contact",
        title="Contact of rigid rollers with a finite-length space, by finite elements",
        body="0 <= x <= length, y infinite, z >= 0; free ends x = 0 and x = length; isotropic",
        contact="gap y^2 + crown (x - length / 2)^2 over distance < x < length - distance; E* = 1; "
        "load pi / 2 per length of contact",
        units="lengths in a, pressure in p0: half-width and peak of the line contact under the load per length",
        method="Fourier integral in y, tensor-product elements of high order in x and z; pressure on products "
        "of hats, complementarity problem by active sets (scipy.optimize.nnls)",
        resolution=str(PRODUCTION),
    )
    for name, case in CONTACT_CASES.items():
        start = time.perf_counter()
        solution = solve_reference(case)
        append_case(path, name, solution)
        max_error = float(solution["pressure_error"].sel(y=0).max())
        print(
            f"{name}: {time.perf_counter() - start:.0f} s, largest error estimate at y = 0: {max_error:.1e}", flush=True
        )
