"""Shared materials and contacts of the tests of heat."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, Material, Roller
from contactstudy.arrays.grid import Grid
from contactstudy.heat import ThermalProperties

STEEL = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
UNIT = ThermalProperties(conductivity=1.0, density=1.0, specific_heat=1.0)
CASE = Case(
    body=FiniteLengthSpace(length=1e-3, material=Material(210e9, 0.3)),
    roller=Roller(radius=5e-3, length=1e-3),
    max_pressure=1.5e9,
    friction=0.05,
)
LINE_GRID = Grid(x_range=(0.0, 1e-3), y_range=(-2 * 65e-6, 2 * 65e-6), cells_x=4, cells_y=128)


@pytest.fixture(scope="session")
def steel() -> ThermalProperties:
    return STEEL


@pytest.fixture(scope="session")
def unit() -> ThermalProperties:
    """All properties 1, diffusivity 1."""
    return UNIT


@pytest.fixture(scope="session")
def line_case() -> Case:
    """A roller as long as the body."""
    return CASE


@pytest.fixture(scope="session")
def create_line_result() -> Callable[..., xr.Dataset]:
    """Make the result of Hertz' line pressure along the whole of `line_case`, with a coefficient of friction."""

    def make_result(grid: Grid = LINE_GRID, friction: float = 0.05) -> xr.Dataset:
        pressure = 1.5e9 * np.sqrt(np.maximum(1 - (grid.y / CASE.hertz_half_width) ** 2, 0)) + 0 * grid.x[:, None]
        coords = {"x": grid.x, "y": grid.y, "x_width": ("x", grid.widths)}
        fields = {"pressure": (("x", "y"), pressure), "traction_y": (("x", "y"), friction * pressure)}
        scales = {"hertz_half_width": CASE.hertz_half_width, "hertz_max_pressure": 1.5e9}
        return xr.Dataset(fields | scales, coords=coords)

    return make_result
