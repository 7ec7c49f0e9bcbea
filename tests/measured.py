"""Measure what the README states of the accuracy, and print it as the table that stands there.

Run ``python -m tests.measured`` in an environment with the development extra.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import numpy as np
import xarray as xr

from contactstudy import (
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    Material,
    QuarterSpace,
    Study,
    solve,
    solve_contact,
    stress_field,
)
from contactstudy.dataset import STRESSES
from contactstudy.overlapping.axial import axial_modes
from contactstudy.overlapping.displacement import build_end_correction
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.stress import end_traction_residual
from contactstudy.study.setup import build_setup
from contactstudy.surface import surface_operator
from contactstudy.verification import closed_forms as ref
from tests import finite_elements

T = TypeVar("T")
LINE_LOAD = 0.5 * np.pi
MATERIAL = Material(1 - 0.3**2, 0.3)


def cells(function, x_range, y_range, counts) -> xr.DataArray:  # type: ignore[no-untyped-def]
    """DataArray of a function of (x, y) on cell centres."""
    grid = Grid(x_range, y_range, *counts)
    values = np.broadcast_to(function(grid.x[:, None], grid.y[None, :]), grid.shape)
    return xr.DataArray(values, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))


def strip(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Hertz line pressure of half-width and peak 1."""
    return np.sqrt(np.maximum(1 - y**2, 0)) + 0 * x


def half_space() -> Iterator[tuple[str, str]]:
    """Closed forms."""
    body = HalfSpace(material=MATERIAL)
    gap = cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.5, 1.5), (-1.5, 1.5), (129, 129))
    contact = solve_contact(body, gap, 4 / 3)
    _, peak, approach = ref.hertz_point(4 / 3, 1.0, 1.0)
    error = float(contact["pressure"].max()) / peak - 1
    yield "Hertz point contact, 129 x 129 cells: peak pressure", f"{100 * error:+.3f} %"
    yield "... approach", f"{100 * (float(contact['approach']) / approach - 1):+.4f} %"
    gap = cells(lambda x, y: y**2 + 0 * x, (0, 60), (-2, 2), (240, 129))
    contact = solve_contact(body, gap.where(abs(gap.x - 30) < 28, np.inf), 56 * LINE_LOAD)
    middle = contact["pressure"].sel(x=30, method="nearest")
    _, peak = ref.hertz_line(float(middle.sum()) * 4 / 129, 0.5, 1.0)
    yield (
        "Hertz line contact, middle of a long roller: peak pressure",
        f"{100 * (float(middle.max()) / peak - 1):+.3f} %",
    )
    circle = cells(lambda x, y: np.sqrt(np.maximum(1 - x**2 - y**2, 0)), (-1.25, 1.25), (-1.25, 1.25), (120, 120))
    z = np.linspace(0, 3, 31)
    stress = stress_field(body, circle, x=[0.0], y=[0.0], z=z).isel(x=0, y=0)
    axial, radial = ref.hertz_circle_axis(z, 1.0, 1.0, 0.3)
    worst = max(float(abs(stress["sigma_zz"] - axial).max()), float(abs(stress["sigma_xx"] - radial).max()))
    yield "stresses on the axis under a circular Hertz pressure, largest difference", f"{100 * worst:.2f} % of p0"
    x, y, z = np.array([0.0, 0.5, 1.2]), np.linspace(-1.5, 1.5, 13), np.array([0.1, 0.25, 0.5, 1.0, 2.0])
    stress = stress_field(body, circle, 0.25, x=x, y=y, z=z)
    exact = ref.hertz_circle(*np.meshgrid(x, y, z, indexing="ij"), 1.0, 1.0, 0.3, 0.25)
    worst = max(float(abs(stress[name] - exact[name]).max()) for name in STRESSES)
    yield "sliding (f = 0.25) circular contact against Hamilton's solution, z >= 0.1a", f"{100 * worst:.2f} % of p0"


def free_ends() -> Iterator[tuple[str, str]]:
    """What only a body with ends can show."""
    for length in (8.0, 2.5):
        pressure = cells(strip, (0, length), (-2, 2), (round(16 * length), 64))
        grid = Grid.from_centres(pressure.x.values, pressure.y.values)
        body = FiniteLengthSpace(length=length, material=MATERIAL)
        for depths, label in (((0.02, 0.05), "z = 0.02a, 0.05a"), ((0.1, 0.3, 1.0, 5.0), "z >= 0.1a")):
            residual = end_traction_residual(body, pressure.values, 0.3, grid, grid.y[::5], np.array(depths))
            yield f"traction left on loaded ends, L = {length:g}a, f = 0.3, {label}", f"{residual:.1e} p0"
    worst, median = 0.0, 0.0
    for name, case in finite_elements.CASES.items():
        reference = finite_elements.load(name)
        pressure = cells(
            lambda x, y, case=case: case.pressure(x[:, 0], y[0]),
            (0, case.length),
            (-1, 1),
            (int(32 * case.length), 128),
        )
        points = {axis: reference.stress[axis].values for axis in "xyz"}
        body = FiniteLengthSpace(length=case.length, material=Material(1.0, case.poisson))
        stress = stress_field(body, pressure, case.friction, **points)
        difference = np.stack([abs(stress[n] - reference.stress[n]).transpose("x", "y", "z") for n in STRESSES])
        worst = max(worst, float(difference[..., points["z"] >= 0.1].max()))
        median = max(median, float(np.median(difference)))
    yield (
        f"stresses against finite elements, {len(finite_elements.CASES)} load cases, z >= 0.1a: largest difference",
        f"{worst:.1e} p0",
    )
    yield "... median of the worst case", f"{median:.1e} p0"
    body = FiniteLengthSpace(length=8.0, material=MATERIAL)
    gap = cells(lambda x, y: y**2 + 0 * x, (0, 8), (-2, 2), (129, 65))
    contact = solve_contact(body, gap, 8 * LINE_LOAD)
    pressure = contact["pressure"]
    yield "total load, relative error", f"{abs(float(contact['load_error'])):.0e}"
    asymmetry = max(
        float(abs(pressure - pressure.values[::-1]).max()), float(abs(pressure - pressure.values[:, ::-1]).max())
    )
    yield "asymmetry along x and y of a symmetric contact without friction", f"{asymmetry:.0e} p0"
    along = pressure.max("y")
    yield (
        "rigid cylinder on a body of its own length (8a): pressure at the end, in the middle",
        f"{float(along[0]):.3f} p0, {float(along[64]):.3f} p0",
    )
    for count in (64, 129):
        on_half = cells(lambda x, y: y**2 + 0 * x, (-0.5, 8.5), (-2, 2), (round(count * 9 / 8), 65))
        on_half = on_half.where(abs(on_half.x - 4) < 4, np.inf)
        peak = float(solve_contact(HalfSpace(material=MATERIAL), on_half, 8 * LINE_LOAD)["pressure"].max())
        yield f"... the half-space model's pressure there with {count} cells", f"{peak:.2f} p0"


def limits() -> Iterator[tuple[str, str]]:
    """Agreement between the bodies, and of the solution with Hetenyi's iteration."""
    points = {"y": [0.0, 0.5], "z": [0.1, 0.3, 1.0]}
    bump = cells(lambda x, y: np.maximum(1 - (x - 20) ** 2 - y**2, 0), (0, 40), (-1.5, 1.5), (320, 24))
    x = [19.0, 20.0, 20.5]
    finite = stress_field(FiniteLengthSpace(length=40.0, material=MATERIAL), bump, 0.2, x=x, **points)
    half = stress_field(HalfSpace(material=MATERIAL), bump, 0.2, x=x, **points)
    worst = max(float(abs(finite[n] - half[n]).max()) for n in STRESSES)
    yield "long body (40a) loaded in its middle against the half-space", f"{worst:.0e} p0"
    near = {"x": [0.0, 0.1, 1.0, 2.5], **points}
    load = lambda x, y: strip(x, y) * (x < 2)  # noqa: E731 - used as a value twice
    quarter = stress_field(QuarterSpace(material=MATERIAL), cells(load, (0, 10), (-2, 2), (80, 48)), 0.2, **near)
    for length in (20.0, 40.0):
        pressure = cells(load, (0, length), (-2, 2), (round(8 * length), 48))
        finite = stress_field(FiniteLengthSpace(length=length, material=MATERIAL), pressure, 0.2, **near)
        worst = max(float(abs(finite[n] - quarter[n]).max()) for n in STRESSES)
        yield f"end loaded over 2a: body of length {length:g}a against the quarter space", f"{worst:.0e} p0"
    grid = Grid((0.0, 8.0), (-2.0, 2.0), 32, 16)
    correction = build_end_correction(8.0, MATERIAL, grid, reference=80.0, tangential=False, resolution=Resolution())
    worst = max(float(np.abs(k - k.transpose(0, 2, 1)).max() / np.abs(k).max()) for k in correction.normal)
    yield "asymmetry of the correction operator (reciprocity)", f"{worst:.0e}"
    modes = axial_modes(8.0, 2.0, 0.05, Resolution())[0]
    system = EquationSet.build(modes, 2.0, 0.3, 0.05, Resolution())
    asked = system.from_pressure(modes.load_weights * modes.cell_integrals(np.array([0.0, 3.0]))[:, 0])
    explicit, face_load = system.solve(asked), asked.copy()
    for _ in range(200):
        face_load = asked + system.from_pressure(modes.on_end * system.on_top(system.scale * face_load))
    error = np.abs(system.scale * face_load - explicit).max() / np.abs(explicit).max()
    yield "Hetenyi's alternation, 200 rounds, against the explicit solution", f"{error:.0e}"


def parts_of_the_main_job() -> Iterator[tuple[str, str]]:
    """Seconds of the parts of one case of ``studies/edge_effect.toml``, on one core."""
    plan = Study.from_toml(Path(__file__).parents[1] / "studies" / "edge_effect.toml").plan()
    setup = build_setup(next(c.parameters for c in plan.cases if c.parameters.get("e_over_a") == 1.0))
    case, grid = setup.case, setup.grid

    def timed(work: Callable[[], T]) -> tuple[float, T]:
        began = time.perf_counter()
        found = work()
        return time.perf_counter() - began, found

    yield (
        f"grid of one case, L/a = {case.body.extent[1] / case.hertz_half_width:.0f}",
        f"{grid.shape[0]} x {grid.shape[1]} cells",
    )
    seconds, _ = timed(lambda: surface_operator(case.body, grid, tangential=False))
    yield "building the operator", f"{seconds:.1f} s"
    seconds, result = timed(lambda: solve(case, grid, stresses=False))
    yield "contact, and the traction left on the ends", f"{seconds:.1f} s"
    seconds, _ = timed(lambda: stress_field(case.body, result["pressure"], 0.0, setup.x, setup.y, setup.z))
    yield f"six stresses at {len(setup.x)} x {len(setup.y)} x {len(setup.z)} points", f"{seconds:.1f} s"
    seconds, _ = timed(lambda: stress_field(case.body, result["pressure"], 0.1, setup.x, setup.y, setup.z))
    yield "... with friction, the first time", f"{seconds:.1f} s"
    seconds, _ = timed(lambda: stress_field(case.body, result["pressure"], 0.2, setup.x, setup.y, setup.z))
    yield "... with any further friction", f"{seconds:.2f} s"


def main() -> None:
    """Print the table."""
    print("| quantity | measured |\n|---|---|")
    for part in (half_space, free_ends, limits, parts_of_the_main_job):
        for quantity, value in part():
            print(f"| {quantity} | {value} |", flush=True)


if __name__ == "__main__":
    main()
