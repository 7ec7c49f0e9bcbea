"""A solved case for tests and pages, once per process."""

from __future__ import annotations

import functools

import numpy as np
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, Material, Roller, choose_grid, solve
from contactstudy.profiles import Cylinder


@functools.cache
def _solve_case() -> xr.Dataset:
    material = Material(young=210e9, poisson=0.3)
    half_width = 65e-6
    case = Case(
        body=FiniteLengthSpace(length=0.52e-3, material=material),
        roller=Roller(radius=5e-3, length=0.39e-3, profile=Cylinder(fillet_radius=0.1e-3)),
        max_pressure=1.5e9,
        friction=0.1,
    )
    return solve(
        case,
        choose_grid(case, cells_x=6, cells_y=12),
        x=np.linspace(0, 0.52e-3, 13),
        y=half_width * np.linspace(-2, 2, 17),
        z=half_width * np.array([0.0, 0.25, 0.5, 0.75, 1.0, 1.5]),
    )


def solved_case() -> xr.Dataset:
    """Steel with two free ends, a roller that begins one half-width inside, friction: the real solver."""
    return _solve_case().copy(deep=True)
