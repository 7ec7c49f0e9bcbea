"""The file of stresses under prescribed loads: every case with an estimate of its error.

Every case is solved at the production resolution and at resolutions with one coarser approximation each: element order,
mesh, depth of the body, quadrature in k. The sum of the largest changes is stored as the error estimate of
the case.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.finite_elements.harmonics import COMPONENTS
from benchmarks.finite_elements.reference_files import append_case, create_file
from benchmarks.finite_elements.superpose import (
    PANELS,
    Harmonics,
    Resolution,
    harmonics,
    superpose_displacement,
    superpose_stresses,
)
from contactstudy.verification.problems import LOAD_CASES, LoadCase, quartic

Z = (0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.8, 1.25, 2.0, 3.0, 5.0)
Y = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25)
X = {
    8.0: (0.0, 0.02, 0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0, 7.75, 8.0),
    4.0: (0.0, 0.02, 0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 3.75, 3.98, 4.0),
    2.5: (0.0, 0.02, 0.1, 0.25, 0.5, 0.8, 1.25, 2.0, 2.5),
    0.5: (0.0, 0.02, 0.05, 0.1, 0.25, 0.4, 0.5),
}
PRODUCTION = Resolution()
LOWER_ORDER = replace(PRODUCTION, order=5)
VARIANTS = {  # name: (variant, reference)
    "order": (LOWER_ORDER, PRODUCTION),
    "mesh": (replace(LOWER_ORDER, growth=2.2, smallest=0.05), LOWER_ORDER),
    "depth": (replace(LOWER_ORDER, depth=7e3), LOWER_ORDER),
    "wavenumbers": (replace(LOWER_ORDER, nodes=5, panels=(0, 0.02, *PANELS[2:-1], 80)), LOWER_ORDER),
}


def make_coordinates(case: LoadCase) -> dict[str, Sequence[float]]:
    """Points of a case; with friction on both sides of y = 0."""
    y = Y if case.friction == 0 else tuple(-value for value in Y[:0:-1]) + Y
    return {"x": X[case.length], "y": y, "z": Z}


def evaluate(case: LoadCase, harmonics_of_body: Harmonics, shapes: list[tuple[object, bool]]) -> xr.Dataset:
    """Stresses, and the displacement where defined, from the harmonics of a body."""
    positions = make_coordinates(case)
    normal = shapes.index((case.g, "z"))
    tangential = shapes.index((case.g, "y")) if case.friction else None
    fields = superpose_stresses(harmonics_of_body, normal, tangential, case.friction, positions["y"])
    units = {"units": "p0"}
    dataset = xr.Dataset(
        {n: (("x", "y", "z"), fields[n], units) for n in COMPONENTS}, coords={k: list(v) for k, v in positions.items()}
    )
    for name in positions:
        dataset[name].attrs["units"] = "a"
    if case.symmetric:
        reference_index = positions["x"].index(case.length / 2)
        displacement_z = superpose_displacement(
            harmonics_of_body, case, normal, tangential, positions["y"], reference=reference_index
        )
        attrs = {
            "long_name": "displacement of the top into the body times Young's modulus, less that of the reference",
            "units": "p0 a",
            "reference_x": case.length / 2,
            "reference_y": 0.0,
        }
        dataset["displacement_z_young"] = (("x", "y"), displacement_z, attrs)
    return dataset


def compute_max_changes(coarse: xr.Dataset, fine: xr.Dataset) -> tuple[float, float, float]:
    """Largest and median change of the stresses, largest change of the displacement."""
    stress = np.array([np.abs(coarse[n] - fine[n]) for n in COMPONENTS])
    name = "displacement_z_young"
    difference = float(np.abs(coarse[name] - fine[name]).max()) if name in fine else 0.0
    return float(stress.max()), float(np.median(stress)), difference


def write(path: Path) -> None:
    """Solve all cases at all resolutions and store the result."""
    create_file(
        path,
        "stress",
        title="Stresses in a finite-length space under prescribed loads, by finite elements",
        body="0 <= x <= length, y infinite, z >= 0; free ends x = 0 and x = length; isotropic",
        load="on z = 0: sigma_zz = -p, tau_yz = -friction p, tau_xz = 0 with p = p0 g(x) h(y)",
        h=str(quartic.__doc__),
        units="lengths in a, the half-width of h; stresses in p0, positive in tension",
        method="Fourier integral in y, tensor-product elements of high order in x and z",
        resolution=str(PRODUCTION),
    )
    for (length, poisson), group in groupby(LOAD_CASES.items(), key=lambda item: (item[1].length, item[1].poisson)):
        cases = dict(group)
        shapes = list(
            dict.fromkeys([(c.g, "z") for c in cases.values()] + [(c.g, "y") for c in cases.values() if c.friction])
        )
        results: dict[Resolution, dict[str, xr.Dataset]] = {}
        for resolution in dict.fromkeys(
            [PRODUCTION, LOWER_ORDER, *(changed_resolution for changed_resolution, _ in VARIANTS.values())]
        ):
            start = time.perf_counter()
            harmonics_of_body = harmonics(length, poisson, shapes, X[length], Z, resolution=resolution)
            results[resolution] = {
                name: evaluate(case, harmonics_of_body, list(shapes)) for name, case in cases.items()
            }
            print(f"length {length}: {resolution} in {time.perf_counter() - start:.0f} s", flush=True)
        for name, case in cases.items():
            estimates = {
                variant: compute_max_changes(results[changed_resolution][name], results[resolution][name])
                for variant, (changed_resolution, resolution) in VARIANTS.items()
            }
            dataset = results[PRODUCTION][name]
            dataset.attrs = {"length": length, "poisson": poisson, "friction": case.friction, "g": str(case.g)}
            for variant, (largest, median, _) in estimates.items():
                dataset.attrs |= {f"change_{variant}": largest, f"change_{variant}_median": median}
            dataset.attrs["error_estimate"] = sum(changes[0] for changes in estimates.values())
            dataset.attrs["error_estimate_median"] = sum(changes[1] for changes in estimates.values())
            if "displacement_z_young" in dataset:
                dataset["displacement_z_young"].attrs["error_estimate"] = sum(
                    changes[2] for changes in estimates.values()
                )
            dataset = dataset.assign_coords(
                {axis: list(positions) for axis, positions in make_coordinates(case).items()}
            )
            append_case(path, name, dataset)
            print(
                name,
                dataset.attrs["error_estimate"],
                {
                    variant: f"{changes[0]:.1e}, {changes[1]:.1e}, {changes[2]:.1e}"
                    for variant, changes in estimates.items()
                },
                flush=True,
            )
