"""The file of passes over an elastic-plastic half-plane: every case, and how much each approximation changes it.

Every case is solved at the production resolution, with steps of four times the length, and with these and one thing
more made worse: width or height of the elements, size of the strip. Steps err in proportion to their length, elements
like the square of their size, so a third of their change is the remaining error. The sum of the largest changes
is stored as the error estimate.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.finite_elements.passes import PAIRS, YOUNG, PlasticStrip, Strip
from benchmarks.finite_elements.reference_files import append_case, create_file
from contactstudy.verification.problems import PASSES_CASES, PassesCase

PRODUCTION = Strip(length=20.0, depth=10.0, width=0.5, height=0.1, fine=2.2, step=1 / 32)
LONGER_STEPS = {"flowing": 1 / 16, "flowing_sliding": 1 / 16}
"""Steps of cases in which most elements flow, and each step takes more iterations. Speed."""
COARSER_VARIANTS: dict[str, tuple[dict[str, float], float]] = {  # name: (changes, remaining part)
    "width": ({"width": 1.0}, 1 / 3),
    "height": ({"height": 0.2}, 1 / 3),
    "strip": ({"length": 14.0, "depth": 7.0}, 1.0),
}
NAMES = ("sigma_xx", "sigma_yy", "plastic_strain_yy_young", "plastic_strain_yz_young")


def solve_reference(case: PassesCase, strip: Strip) -> xr.Dataset:
    """Passes on one mesh: means over the heights of its fine elements."""
    strains, stresses, _ = PlasticStrip(case, strip).roll()
    rows = round(strip.fine / strip.height)

    def average(field: np.ndarray) -> np.ndarray:
        return np.asarray(0.5 * (field[..., 0 : 2 * rows : 2] + field[..., 1 : 2 * rows : 2]))

    stress = dict(zip(PAIRS, average(stresses), strict=True))
    strain = dict(zip(PAIRS, np.moveaxis(average(YOUNG * strains), 1, 0), strict=True))
    data = xr.Dataset(
        {f"sigma_{pair}": ("z", stress[pair], {"units": "p0"}) for pair in ("xx", "yy")}
        | {f"plastic_strain_{pair}_young": (("pass_number", "z"), strain[pair], {"units": "p0"}) for pair in PAIRS},
        {
            "z": ("z", (np.arange(rows) + 0.5) * strip.height, {"units": "a"}),
            "pass_number": np.arange(1, case.passes + 1),
        },
    )
    return data


def change(worse: xr.Dataset, better: xr.Dataset, name: str) -> float:
    """Largest change, of means over the coarser heights."""
    factor = better.sizes["z"] // worse.sizes["z"]
    return float(np.abs(better[name].coarsen(z=factor).mean().values - worse[name].values).max())


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
        add(path, name)


def add(path: Path, name: str) -> None:
    """Solve one case at all resolutions and add the case to the file."""
    start, case = time.perf_counter(), PASSES_CASES[name]
    strip = replace(PRODUCTION, step=LONGER_STEPS.get(name, PRODUCTION.step))
    lower = replace(strip, step=4 * strip.step)
    reference, coarse = solve_reference(case, strip), solve_reference(case, lower)
    estimates = {"step": {of: change(coarse, reference, of) / 3 for of in NAMES}}
    for variant, (changes, fraction) in COARSER_VARIANTS.items():
        worse = solve_reference(case, replace(lower, **changes))
        estimates[variant] = {of: fraction * change(worse, coarse, of) for of in NAMES}
    reference.attrs = {
        "shear_yield_stress": case.shear_yield_stress,
        "friction": case.friction,
        "kinematic_hardening": case.kinematic_hardening,
        "poisson": case.poisson,
        "step": strip.step,
    }
    for of in NAMES:
        reference[of].attrs |= {f"change_{variant}": changes[of] for variant, changes in estimates.items()}
        reference[of].attrs["error_estimate"] = sum(changes[of] for changes in estimates.values())
    append_case(path, name, reference)
    sizes = {
        of: f"{reference[of].attrs['error_estimate']:.1e} of {float(abs(reference[of]).max()):.1e}" for of in NAMES
    }
    print(f"{name}: {time.perf_counter() - start:.0f} s, largest error estimates: {sizes}", flush=True)
