"""A stand-in for the solver: Hertz' pressure with a made-up end effect, without delay; and failures on demand.

Tests of the study layer use this solver: its result has the form of a result, not the physics.
"""

from __future__ import annotations

import os
import signal
import time
import uuid
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import STRESSES, describe
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.errors import WindowError
from contactstudy.stress import von_mises_of
from contactstudy.study import worker
from contactstudy.study.settings import RunSettings

FAILS, DIES, WRONG_FRICTION, IS_LARGE = 0.66, 0.77, 0.88, 0.99
"""Friction at which the case fails, kills its process, meets an error of the program, or requests too much memory."""


def solve_fake(
    case: Case,
    grid: Grid | None,
    *,
    x,
    y,
    z,
    stresses: bool,
    tolerance: float,
    accuracy: float = 0.01,
) -> xr.Dataset:
    if grid is None:
        grid = choose_grid(case, cells_x=2, cells_y=8)
    if case.friction == FAILS:
        raise WindowError("this friction fails in tests")
    if case.friction == DIES:
        os.kill(os.getpid(), signal.SIGKILL)
    if case.friction == WRONG_FRICTION:
        raise ZeroDivisionError("a bug")
    if case.friction == IS_LARGE:
        raise MemoryError("Unable to allocate 7 EiB")
    half_width, peak = case.hertz_half_width, case.hertz_max_pressure
    start, stop = case.contact_range
    in_contact = (grid.x > start) & (grid.x < stop)
    profile = np.sqrt(np.clip(1 - (grid.y / half_width) ** 2, 0, None))
    pressure = peak * np.outer(in_contact * (1 + 0.1 * np.cos(grid.x / half_width)), profile)
    variables: dict[str, Any] = {
        "pressure": (("x", "y"), pressure),
        "gap": (("x", "y"), np.where(pressure > 0, 0.0, 1e-6)),
        "hertz_half_width": half_width,
        "hertz_max_pressure": peak,
        "normal_load": case.normal_load,
        "iterations": 7,
        "converged": True,
        "end_traction_residual": 1e-5,
    }
    coordinates: dict[str, Any] = {"x": grid.x, "y": grid.y}
    if stresses:
        points = {
            "x_field": grid.x if x is None else x,
            "y_field": grid.y if y is None else y,
            "z": half_width * np.array([0.0, 1.0]) if z is None else z,
        }
        shape = tuple(axis.size for axis in points.values())
        depth = np.broadcast_to(points["z"] / half_width, shape)
        # The maximum lies in the middle of the points, not at their border.
        x, y = (np.linspace(-1, 1, size) if size > 1 else np.zeros(1) for size in shape[:2])
        shape_factor = (1 - 0.1 * x[:, None, None] ** 2) * (1 - 0.1 * y[:, None] ** 2)
        stress = [-peak * shape_factor * np.exp(-depth) / (1 + index) for index in range(len(STRESSES))]
        fields = dict(zip((*STRESSES, "von_mises"), [*stress, von_mises_of(*stress)], strict=True))
        peak_index = np.unravel_index(fields["von_mises"].argmax(), shape)
        variables |= {name: (tuple(points), values) for name, values in fields.items()}
        variables["peak_von_mises"] = fields["von_mises"][peak_index]
        for axis, positions, index in zip("xyz", points.values(), peak_index, strict=True):
            variables[f"peak_von_mises_{axis}"] = positions[index]
        variables["peak_von_mises_error"] = 0.01 * variables["peak_von_mises"]
        coordinates |= points
    # One call: every change of a Dataset copies all of its variables.
    return describe(xr.Dataset(variables, coordinates), "made up for tests")


HELD = "CONTACTSTUDY_TEST_HELD"
"""Environment variable with a folder of tickets: each file permits `solve_held` to solve one case."""


def solve_held(case: Case, grid: Grid | None, **settings) -> xr.Dataset:
    """Solve a case per ticket; further cases wait for new tickets."""
    folder = Path(os.environ[HELD])
    worker.RUN = RunSettings(save_seconds=0.0)  # every case is written at once, so that tests can count the cases
    while not _take_ticket(folder):
        time.sleep(0.02)
    return solve_fake(case, grid, **settings)


def give_tickets(folder: Path, count: int) -> None:
    """Let the solver solve a number of further cases."""
    folder.mkdir(exist_ok=True)
    for _ in range(count):
        (folder / uuid.uuid4().hex).touch()


def _take_ticket(folder: Path) -> bool:
    """Take a ticket; removing a file is atomic among processes."""
    for ticket in folder.iterdir():
        try:
            ticket.unlink()
        except FileNotFoundError:
            continue
        return True
    return False
