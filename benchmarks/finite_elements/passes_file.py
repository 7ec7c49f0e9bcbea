"""The file of passes over an elastic-plastic half-plane: every case with an estimate of its error.

Every case is solved at the production resolution, with steps four times as long, and with these steps and one more
coarser approximation: width or height of the elements, size of the strip. The error is proportional to the length of
the steps and to the square of the size of the elements, so a third of their change is the remaining error. The sum of
the largest changes is stored as the error estimate."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.finite_elements.passes import TENSOR_COMPONENTS, YOUNG, PlasticStrip, Strip
from benchmarks.finite_elements.reference_files import append_case, create_file
from contactstudy.verification.problems import PASSES_CASES, PassesCase

PRODUCTION = Strip(length=20.0, depth=10.0, width=0.5, height=0.1, fine=2.2, step=1 / 32)
LONGER_STEPS = {"flowing": 1 / 16, "flowing_sliding": 1 / 16}
"""Steps of cases with plastic flow in most elements, where a step takes more iterations. Speed."""
COARSER_VARIANTS: dict[str, tuple[dict[str, float], float]] = {  # name: (changes, ratio of the error to the change)
    "width": ({"width": 1.0}, 1 / 3),
    "height": ({"height": 0.2}, 1 / 3),
    "strip": ({"length": 14.0, "depth": 7.0}, 1.0),
}
NAMES = ("sigma_xx", "sigma_yy", "plastic_strain_yy_young", "plastic_strain_yz_young")


def solve_reference(case: PassesCase, strip: Strip) -> xr.Dataset:
    """Passes on one mesh: means over the heights of its fine elements."""
    strains, stresses, _ = PlasticStrip(case, strip).roll_over()
    rows = round(strip.fine / strip.height)

    def average_columns(field: np.ndarray) -> np.ndarray:
        return np.asarray(0.5 * (field[..., 0 : 2 * rows : 2] + field[..., 1 : 2 * rows : 2]))

    stress = dict(zip(TENSOR_COMPONENTS, average_columns(stresses), strict=True))
    strain = dict(zip(TENSOR_COMPONENTS, np.moveaxis(average_columns(YOUNG * strains), 1, 0), strict=True))
    dataset = xr.Dataset(
        {f"sigma_{component}": ("z", stress[component], {"units": "p0"}) for component in ("xx", "yy")}
        | {
            f"plastic_strain_{component}_young": (("pass_number", "z"), strain[component], {"units": "p0"})
            for component in TENSOR_COMPONENTS
        },
        {
            "z": ("z", (np.arange(rows) + 0.5) * strip.height, {"units": "a"}),
            "pass_number": np.arange(1, case.passes + 1),
        },
    )
    return dataset


def compute_max_difference(coarse_result: xr.Dataset, fine: xr.Dataset, name: str) -> float:
    """Largest difference of two solutions in means over the coarser heights."""
    factor = fine.sizes["z"] // coarse_result.sizes["z"]
    return float(np.abs(fine[name].coarsen(z=factor).mean().values - coarse_result[name].values).max())


def write(path: Path) -> None:
    """Solve all cases at all resolutions and store the result."""
    create_file(
        path,
        "passes",
        title="Passes of a line contact over an elastic-plastic half-plane, by finite elements",
        body="z >= 0, plane strain along x; von Mises, perfectly plastic or kinematic hardening",
        load="Hertz' pressure of half-width a and peak p0, shear traction friction times it, moving along +y",
        units="lengths in a, stresses in p0; plastic strains, components of the tensor, times Young's modulus",
        method="step by step along the way on a closed strip, radial return, quadrilaterals with eight nodes",
        resolution=str(PRODUCTION),
    )
    for name in PASSES_CASES:
        append_reference(path, name)


def append_reference(path: Path, name: str) -> None:
    """Solve one case at all resolutions and add the case to the file."""
    start, case = time.perf_counter(), PASSES_CASES[name]
    strip = replace(PRODUCTION, step=LONGER_STEPS.get(name, PRODUCTION.step))
    lower_strip = replace(strip, step=4 * strip.step)
    fine_result, coarse_result = solve_reference(case, strip), solve_reference(case, lower_strip)
    estimates = {
        "step": {quantity: compute_max_difference(coarse_result, fine_result, quantity) / 3 for quantity in NAMES}
    }
    for variant, (changes, fraction) in COARSER_VARIANTS.items():
        coarser_result = solve_reference(case, replace(lower_strip, **changes))
        estimates[variant] = {
            quantity: fraction * compute_max_difference(coarser_result, coarse_result, quantity) for quantity in NAMES
        }
    fine_result.attrs = {
        "shear_yield_stress": case.shear_yield_stress,
        "friction": case.friction,
        "kinematic_hardening": case.kinematic_hardening,
        "poisson": case.poisson,
        "step": strip.step,
    }
    for quantity in NAMES:
        fine_result[quantity].attrs |= {
            f"change_{variant}": changes[quantity] for variant, changes in estimates.items()
        }
        fine_result[quantity].attrs["error_estimate"] = sum(changes[quantity] for changes in estimates.values())
    append_case(path, name, fine_result)
    maxima = {quantity: float(abs(fine_result[quantity]).max()) for quantity in NAMES}
    sizes = {
        quantity: f"{fine_result[quantity].attrs['error_estimate']:.1e} of {maximum:.1e}"
        for quantity, maximum in maxima.items()
    }
    print(f"{name}: {time.perf_counter() - start:.0f} s, largest error estimates: {sizes}", flush=True)
