"""Shared fixtures: contacts of profiles on a steel half-space, and positions along a roller."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, HalfSpace, Material, Roller, choose_grid, solve
from contactstudy.profiles import Profile

LENGTH = 10e-3
RADIUS = 5e-3
PRESSURE = 1.5e9


@pytest.fixture(scope="session")
def steel() -> Material:
    return Material(young=210e9, poisson=0.3)


@pytest.fixture(scope="session")
def positions() -> np.ndarray:
    """Distances from mid-length of a roller of length LENGTH, both ends and mid-length among them."""
    return LENGTH * (np.arange(201) - 100) / 200


@pytest.fixture(scope="session")
def solve_profile(steel: Material) -> Callable[..., xr.Dataset]:
    """Solve the contact of a profile on a half-space, at the Hertz pressure PRESSURE or under a load."""

    def solve_roller(
        profile: Profile, length: float, *, load: float | None = None, cells: float = 8, **grid
    ) -> xr.Dataset:
        roller = Roller(radius=RADIUS, length=length, profile=profile)
        case = Case(
            body=HalfSpace(material=steel), roller=roller, max_pressure=None if load else PRESSURE, load=load or None
        )
        cells_grid = choose_grid(case, cells_x=cells, cells_y=2 * cells, **grid)
        return solve(case, cells_grid, stresses=False).assign_attrs(length=length)

    return solve_roller


def list_axial_results(result: xr.Dataset) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance from mid-length over half the length, largest pressure over p0, and load per length over its mean."""
    half_length = 0.5 * result.attrs["length"]
    step = float(result["y"][1] - result["y"][0])
    mean_load = float(result["normal_load"]) / result.attrs["length"]
    pressure = result["pressure"]
    peak = pressure.max("y").values / float(result["hertz_max_pressure"])
    return (result["x"].values - half_length) / half_length, peak, pressure.sum("y").values * step / mean_load
