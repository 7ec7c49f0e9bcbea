"""Rows on the body: construction of the operator, stresses, and rollers of many half-widths."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import xarray as xr

from benchmarks.performance.peers import solve_peer_contact
from benchmarks.performance.problems import HALF_WIDTH, STEEL, roller
from benchmarks.performance.timing import Report, Row, compute_medians, format_time, nudge
from contactstudy import FiniteLengthSpace, Grid, HalfSpace, cache, stress_field
from contactstudy.bodies import Body
from contactstudy.fields.surface import SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load

LONG_CELLS = (250, 500, 1000)
MEMORY_BAR = 2000.0  # megabytes


def build_bodies(repeats: int, _: Report) -> Iterator[Row]:
    """Operator of a body with ends, and the time of a second case."""
    grid = Grid(x_range=(0.0, 8 * HALF_WIDTH), y_range=(-1.5 * HALF_WIDTH, 1.5 * HALF_WIDTH), cells_x=128, cells_y=64)
    body = FiniteLengthSpace(length=8 * HALF_WIDTH, material=STEEL)
    previous_bytes = cache.info().nbytes
    surface_operator(body, grid)
    megabytes = (cache.info().nbytes - previous_bytes) / 1e6
    timed_functions: dict[str, Callable[[], object]] = {
        "cold": lambda: SurfaceOperator.of(body, grid),
        "friction": lambda: SurfaceOperator.of(body, grid, (Load.NORMAL, Load.ALONG_Y)),
        "kept": lambda: surface_operator(body, grid),
    }
    seconds = compute_medians(timed_functions, repeats, warm_up=False)
    yield Row(
        work="building the operator, 128 x 64, L = 8a",
        ours=format_time(seconds["cold"]),
        bar="1 s",
        met=seconds["cold"] <= 1.0,
        notes=f"with traction {format_time(seconds['friction'])}; reused by a second case in "
        f"{1e6 * seconds['kept']:.0f} µs; {megabytes:.0f} MB",
    )


def stresses(repeats: int, _: Report) -> Iterator[Row]:
    """Six stresses on 128 x 128 x 32 points: without kept kernels, and for a new pressure on the same cells."""
    length, window = 8 * HALF_WIDTH, 4 * HALF_WIDTH
    z = np.linspace(0.0, 3 * HALF_WIDTH, 32)
    bodies: dict[str, Body] = {
        "half-space": HalfSpace(material=STEEL),
        "finite-length": FiniteLengthSpace(length=length, material=STEEL),
    }
    grid = Grid(x_range=(0.0, length), y_range=(-window / 2, window / 2), cells_x=128, cells_y=128)
    line_pressure = 1e9 * np.sqrt(np.maximum(1 - (grid.y / HALF_WIDTH) ** 2, 0.0)) * np.ones((128, 1))
    # An ellipse of the same width: the pressure is no product of functions of x and y.
    axial = 2 * grid.x[:, None] / length - 1
    elliptic_pressure = 1e9 * np.sqrt(np.maximum(1 - axial**2 - (grid.y / HALF_WIDTH) ** 2, 0.0))

    def compute_stresses(body: Body, friction: float, load: np.ndarray, first_call: bool) -> xr.Dataset:
        pressure = xr.DataArray(load * nudge(), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
        # New depths have no kept kernels.
        return stress_field(
            body, pressure, friction=friction, z=z * nudge() if first_call else z, inside_cells=pressure
        )

    def time_stresses(friction: float, load: np.ndarray, first_call: bool) -> dict[str, float]:
        timed_functions: dict[str, Callable[[], object]] = {
            name: partial(compute_stresses, body, friction, load, first_call) for name, body in bodies.items()
        }
        return compute_medians(timed_functions, repeats)

    sliding_seconds = time_stresses(0.3, line_pressure, False)
    first_call = time_stresses(0.0, line_pressure, True)
    for name, seconds, bar in (
        ("", first_call, 0.26),
        ("..., same cells", time_stresses(0.0, line_pressure, False), 0.11),
    ):
        yield Row(
            work=f"six stresses 128 x 128 x 32, uniform along x, half-space{name}",
            ours=format_time(seconds["half-space"]),
            bar=f"{bar} s",
            met=seconds["half-space"] <= bar,
            notes="with friction " + format_time(sliding_seconds["half-space"]) if name else "",
        )
        yield compare_with_half_space(f"... finite-length{name}", seconds)
    for name, is_cold in (("", True), ("..., same cells", False)):
        yield compare_with_half_space(
            f"... under an elliptic pressure, finite-length{name}", time_stresses(0.0, elliptic_pressure, is_cold)
        )


def compare_with_half_space(work: str, seconds: dict[str, float]) -> Row:
    """Row of a body with ends; its bar is twice the time of the half-space."""
    ratio = seconds["finite-length"] / seconds["half-space"]
    seconds_finite, peer_text = (
        format_time(seconds["finite-length"]),
        "our half-space " + format_time(seconds["half-space"]),
    )
    return Row(
        work=work,
        ours=seconds_finite,
        peers=peer_text,
        ratio=f"{ratio:.2f}",
        bar="2x the half-space",
        met=ratio <= 2,
    )


def long_rollers(repeats: int, report: Report) -> Iterator[Row]:
    """Contact on 1000 x 48 cells, L = 100a, and the growth of the cost up to this size."""
    contact_seconds, build_seconds, application_counts = {}, {}, {}
    for cells in LONG_CELLS:
        problem = roller((cells, 48), cells / 10, free_ends=True)
        grid = Grid.from_centres(problem.make_gap_array()["x"].values, problem.make_gap_array()["y"].values)
        build_operator = partial(SurfaceOperator.of, problem.body, grid)
        build_seconds[cells] = compute_medians({"build": build_operator}, min(repeats, 3), warm_up=False)["build"]
        contact_seconds[cells] = compute_medians({"contact": partial(solve_peer_contact, problem)}, repeats)["contact"]
        application_counts[cells] = int(solve_peer_contact(problem)["iterations"])
    shortest, longest = LONG_CELLS[0], LONG_CELLS[-1]
    growth = contact_seconds[longest] / contact_seconds[shortest] / (longest / shortest)
    growth_per_application = growth * application_counts[shortest] / application_counts[longest]
    times = ", ".join(
        f"{cells}: {format_time(seconds)} ({application_counts[cells]} applications)"
        for cells, seconds in contact_seconds.items()
    )
    yield Row(
        work="contact 1000 x 48, L = 100a, built",
        ours=format_time(contact_seconds[longest]),
        bar="1.5 s",
        met=contact_seconds[longest] <= 1.5,
        notes=times,
    )
    yield Row(
        work="growth from 250 to 1000 cells, over linear",
        ours=f"{growth:.2f}",
        bar="1.2",
        met=growth <= 1.2,
        notes=f"per operator application {growth_per_application:.2f}",
    )
    yield Row(
        work="building the operator, 1000 x 48, L = 100a",
        ours=format_time(build_seconds[longest]),
        notes=", ".join(f"{cells}: {format_time(build_seconds[cells])}" for cells in LONG_CELLS),
    )
    yield from memory(report)


def memory(report: Report) -> Iterator[Row]:
    """Peak memory of a process that builds the operator, solves the contact and takes stresses in one section."""
    process = subprocess.run(
        [sys.executable, "-m", "benchmarks.performance.memory"], capture_output=True, text=True, check=False
    )
    if process.returncode:
        report.add_remark(f"the measurement of memory failed: {process.stderr.strip().splitlines()[-1]}")
        return
    idle, contact, stress = (float(word) for word in process.stdout.split())
    yield Row(
        work="peak memory, 1000 x 48, L = 100a",
        ours=f"{stress:.0f} MB",
        bar="2 GB",
        met=stress <= MEMORY_BAR,
        notes=f"process with its imports {idle:.0f} MB, after the contact {contact:.0f} MB, after stresses in y = 0",
    )
