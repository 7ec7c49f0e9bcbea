"""Print the table of docs/explanation/accuracy.md: checks of the verification suite, and computing times.

Run ``python -m tests.measured`` in an environment with the development extra; `contactstudy verify --level full` prints
all checks.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import numpy as np
import xarray as xr

from contactstudy import FiniteLengthSpace, HalfSpace, Study, solve, solve_contact, stress_field
from contactstudy.study.case_setup import build_setup
from contactstudy.verification import run
from contactstudy.verification.problems import LINE_LOAD, on_cells, unit_material

T = TypeVar("T")
ROWS = {  # label in the table: group, part of the case's name, part of the quantity's name, unit
    "Hertz point contact, 129 x 129 cells: peak pressure": ("half-space", "point contact", "peak pressure", ""),
    "... approach": ("half-space", "point contact", "approach", ""),
    "Hertz elliptic contact, axes 2.5 to 1: peak pressure": ("half-space", "elliptic", "peak pressure", ""),
    "Hertz line contact: peak pressure": ("half-space", "Hertz line contact", "peak pressure", ""),
    "stresses on the axis under a circular Hertz pressure": ("half-space", "on the axis", "sigma", "p0"),
    "sliding (f = 0.25) circular contact against Hamilton's solution, z >= 0.1a": (
        "half-space",
        "sliding",
        "six",
        "p0",
    ),
    "sliding (f = 0.3) line contact against McEwen's, z = 0, beside the contact's last cell": (
        "half-space",
        "z = 0, beside",
        "six",
        "p0",
    ),
    "... z = 0.02a and 0.05a": ("half-space", "z = 0.02a", "six", "p0"),
    "... z >= 0.1a": ("half-space", "0.3, z >= 0.1a", "six", "p0"),
    "thin body (0.05a) against plane stress": ("limits", "0.05a", "six", "p0"),
    "point load on the edge of a quarter space: 3.363 times the half-space's displacement": (
        "quarter space",
        "point load on the edge",
        "along the edge",
        "",
    ),
    "stresses against finite elements, 8 load cases, z >= 0.02a: largest difference": (
        "finite elements",
        "",
        "six stresses / p0, z >= 0.02a, largest",
        "p0",
    ),
    "... median of the worst case": ("finite elements", "", "median", "p0"),
    "contact pressure against finite elements, flush roller, away from the last cell": (
        "finite elements",
        "flush",
        "away from the last cell",
        "p0",
    ),
    "... roller longer than the body": ("finite elements", "overhanging", "away from the last cell", "p0"),
    "... in the last cell at the free end": ("finite elements", "roller from -2a", "in the last cell", "p0"),
    "... of a sharp roller inside the face (e = a), 0.5a and more from its end": (
        "finite elements",
        "inside",
        "0.5a and more",
        "p0",
    ),
    "... nearer to its end, except in the last cell": ("finite elements", "inside", "away from the last cell", "p0"),
    "residual traction on loaded ends, z >= 0.02a": ("consistency", "both ends", "traction", "p0"),
    "reciprocity (Betti)": ("consistency", "two loads", "work", ""),
    "Hetenyi's alternation, 200 rounds, against the explicit solution": ("consistency", "alternations", "", ""),
    "quadratures: stresses and displacement against much finer ones": ("convergence", "smooth load", "settings", "p0"),
}


def measure_accuracy() -> Iterator[tuple[str, str]]:
    """Largest difference among the checks of each row."""
    verification = run("full")
    assert verification.passed
    for label, (group, case, quantity, unit) in ROWS.items():
        checks = [c for c in verification.groups[group] if case in c.case and quantity in c.quantity]
        yield label, f"{max(abs(check.difference) for check in checks):.1e} {unit}".strip()
    yield "checks of `contactstudy verify --level full`, all passed", str(len(verification.checks))


def measure_end_effects() -> Iterator[tuple[str, str]]:
    """Effects of free ends on the pressure."""
    gap = on_cells(lambda x, y: y**2 + 0 * x, (0, 8), (-2, 2), (129, 65))
    body = FiniteLengthSpace(length=8.0, material=unit_material())
    axial_pressure = solve_contact(body, gap, load=8 * LINE_LOAD)["pressure"].max("y")
    yield (
        "rigid cylinder on a body of equal length (8a): pressure at the end, in the middle",
        f"{float(axial_pressure[0]):.3f} p0, {float(axial_pressure[64]):.3f} p0",
    )
    for count in (64, 129):
        half_space_gap = on_cells(lambda x, y: y**2 + 0 * x, (-0.5, 8.5), (-2, 2), (round(count * 9 / 8), 65))
        half_space_gap = half_space_gap.where(abs(half_space_gap["x"] - 4) < 4, np.inf)
        peak = float(
            solve_contact(HalfSpace(material=unit_material()), half_space_gap, load=8 * LINE_LOAD)["pressure"].max()
        )
        yield f"... the half-space model's pressure there with {count} cells", f"{peak:.2f} p0"


def measure_times() -> Iterator[tuple[str, str]]:
    """Computing times of one case of ``studies/edge_effect.toml``, on one core."""
    plan = Study.from_toml(Path(__file__).parents[1] / "studies" / "edge_effect.toml").plan()
    setup = build_setup(next(c.parameters for c in plan if c.parameters.get("e_over_a") == 1.0))
    case = setup.case
    positions = {name: setup.options[name] for name in ("x", "y", "z")}

    def time_call(function: Callable[[], T]) -> tuple[float, T]:
        start_time = time.perf_counter()
        output = function()
        return time.perf_counter() - start_time, output

    seconds, result = time_call(lambda: solve(case, stresses=False))
    yield (
        f"refined cells of one case, L/a = {case.body.extent[1] / case.hertz_half_width:.0f}",
        f"{result.sizes['x']} x {result.sizes['y']} cells",
    )
    yield "contact converged to 1 %, and the residual traction on the ends", f"{seconds:.1f} s"
    pressure = result["pressure"]

    def compute_stresses(friction: float) -> xr.Dataset:
        return stress_field(case.body, pressure, friction=friction, **positions, inside_cells=pressure)

    seconds, _ = time_call(lambda: compute_stresses(0.0))
    yield f"six stresses at {' x '.join(str(len(axis)) for axis in positions.values())} points", f"{seconds:.1f} s"
    seconds, _ = time_call(lambda: compute_stresses(0.1))
    yield "... with friction, the first time", f"{seconds:.1f} s"
    seconds, _ = time_call(lambda: compute_stresses(0.2))
    yield "... with any further friction", f"{seconds:.2f} s"


def main() -> None:
    """Print the table."""
    print("| quantity | measured |\n|---|---|")
    for section in (measure_accuracy, measure_end_effects, measure_times):
        for quantity, value in section():
            print(f"| {quantity} | {value} |", flush=True)


if __name__ == "__main__":
    main()
