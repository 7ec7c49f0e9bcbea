"""The file of contacts: every case, and how much each approximation changes it.

The finite elements are made worse in one way at a time (element order, mesh, depth of the body, quadrature in k), and
the pressure is found on hats of twice the width along y and along x. Hats err like the square of their width, so a
third of each change is the error of the finer mesh; the sum is the estimate.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.finite_elements.contact import SolvedContact, flexibility, solve
from benchmarks.finite_elements.reference_files import append_case, create_file
from benchmarks.finite_elements.superpose import Resolution
from contactstudy.verification.problems import CONTACT_CASES, ContactCase

PRODUCTION = Resolution(order=4, growth=1.8, smallest=0.02, nodes=5)
LOWER = replace(PRODUCTION, order=3)
VARIANTS = {  # name: (variant, reference)
    "order": (LOWER, PRODUCTION),
    "mesh": (replace(LOWER, growth=2.4, smallest=0.04), LOWER),
    "depth": (replace(LOWER, depth=7e3), LOWER),
    "wavenumbers": (replace(LOWER, nodes=4), LOWER),
}
STEP, WINDOW = 1 / 16, 1.75


def solve_reference(case: ContactCase) -> xr.Dataset:
    """The contact with its error estimate."""
    flexibilities = {
        r: flexibility(case, r) for r in dict.fromkeys([PRODUCTION, LOWER, *(v for v, _ in VARIANTS.values())])
    }
    best = solve(case, flexibilities[PRODUCTION], STEP, WINDOW)

    def on_nodes(solution: SolvedContact) -> np.ndarray:
        axial = np.array([np.interp(best.x, solution.x, row) for row in solution.pressure.T])
        return np.array([np.interp(best.y, solution.y, row) for row in axial.T])

    def line_load(pressure: np.ndarray) -> np.ndarray:
        return np.asarray(2 * np.trapezoid(pressure, best.y, axis=1))

    changes = {
        name: on_nodes(solve(case, flexibilities[worse], STEP, WINDOW))
        - on_nodes(solve(case, flexibilities[better], STEP, WINDOW))
        for name, (worse, better) in VARIANTS.items()
    }
    changes["hats_y"] = (on_nodes(solve(case, flexibilities[PRODUCTION], 2 * STEP, WINDOW)) - best.pressure) / 3
    changes["hats_x"] = (on_nodes(solve(case, flexibilities[PRODUCTION], STEP, WINDOW, stride=2)) - best.pressure) / 3
    fields = {
        "pressure": best.pressure,
        "pressure_error": sum(np.abs(change) for change in changes.values()),
    }
    loads = {
        "line_load": line_load(best.pressure),
        "line_load_error": sum(np.abs(line_load(change)) for change in changes.values()),
    }
    data = xr.Dataset(
        {name: (("x", "y"), values, {"units": "p0"}) for name, values in fields.items()}
        | {name: (("x",), values, {"units": "p0 a"}) for name, values in loads.items()},
        coords={"x": ("x", best.x, {"units": "a"}), "y": ("y", best.y, {"units": "a"})},
        attrs={"length": case.length, "distance": case.distance, "crown": case.crown, "poisson": case.poisson},
    )
    data.attrs |= {f"change_{name}_median": float(np.median(np.abs(change))) for name, change in changes.items()}
    return data


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
        worst = float(solution["pressure_error"].sel(y=0).max())
        print(f"{name}: {time.perf_counter() - start:.0f} s, largest error estimate at y = 0: {worst:.1e}", flush=True)
