"""Shared bodies, pressures and results; lengths are in units of the Hertz half-width, E* is 1."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy import FiniteLengthSpace, HalfSpace, Material
from contactstudy.stress import von_mises
from contactstudy.study import open_study, run_study, worker
from contactstudy.study.settings import RunSettings
from contactstudy.verification import closed_forms as ref
from contactstudy.verification import problems
from tests.small_study import BASE, small_study
from tests.solved_case import solved_case
from tests.stand_in_solver import FAILS, solve_fake


@pytest.fixture(autouse=True)
def _restore_run_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Restore the settings of runs after a test that changes `worker.RUN`."""
    monkeypatch.setattr(worker, "RUN", RunSettings())


@pytest.fixture(scope="session")
def unit_material() -> Material:
    """Contact modulus 1 and Poisson's ratio 0.3."""
    return problems.unit_material(0.3)


@pytest.fixture(scope="session")
def half_space(unit_material: Material) -> HalfSpace:
    return HalfSpace(material=unit_material)


@pytest.fixture(scope="session")
def short_body(unit_material: Material) -> FiniteLengthSpace:
    """A body eight half-widths long with two free ends."""
    return FiniteLengthSpace(length=8.0, material=unit_material)


@pytest.fixture(scope="session")
def on_cells() -> Callable[..., xr.DataArray]:
    """Make a DataArray on cell centres from a function of (x, y)."""
    return problems.on_cells


@pytest.fixture(scope="session")
def strip_pressure(on_cells: Callable[..., xr.DataArray]) -> Callable[..., xr.DataArray]:
    """Hertz line pressure of half-width and peak 1, uniform along x over a whole body."""

    def make_pressure(length: float, cells: tuple[int, int], window: float = 2.0) -> xr.DataArray:
        return on_cells(problems.strip, (0.0, length), (-window, window), cells)

    return make_pressure


@pytest.fixture(scope="session")
def cylinder_gap(on_cells: Callable[..., xr.DataArray]) -> Callable[..., xr.DataArray]:
    """Gap of a sharp-ended cylinder over a whole body; Hertz' half-width and peak pressure are 1."""

    def make_gap(length: float, cells: tuple[int, int], window: float = 2.0) -> xr.DataArray:
        return on_cells(lambda x, y: y**2 + 0 * x, (0.0, length), (-window, window), cells)

    return make_gap


LINE_LOAD = 0.5 * np.pi
"""Load per length of the line contact of half-width and peak pressure 1."""


@pytest.fixture(scope="session")
def strip_result() -> Callable[..., xr.Dataset]:
    """Make a result of Hertz' line contact in closed form, the same in every cross-section of a roller of length 4a.

    The body extends 1a beyond either end of the roller.
    """

    def make_result(
        half_width: float = 1.0, max_pressure: float = 1.0, friction: float = 0.0, window: float = 3.0
    ) -> xr.Dataset:
        x = half_width * (np.arange(24) + 0.5) / 4
        y = half_width * window * ((np.arange(96) + 0.5) / 48 - 1)
        x_field = half_width * np.linspace(1.0, 5.0, 9)
        y_field = half_width * np.linspace(-window, window, 121)
        z = half_width * np.linspace(0.1, 2.0, 39)
        is_under_roller = (x > half_width) & (x < 5 * half_width)
        profile = max_pressure * np.sqrt(np.maximum(1 - (y / half_width) ** 2, 0))
        gap = np.where(is_under_roller[:, None], y**2 / half_width, np.inf)
        stress = ref.hertz_strip(y_field[:, None], z, half_width, max_pressure, 0.3, friction)
        fields = {name: np.broadcast_to(value, (x_field.size, *value.shape)) for name, value in stress.items()}
        result = xr.Dataset(
            {
                "pressure": (
                    ("x", "y"),
                    np.outer(is_under_roller, profile),
                    {"units": "Pa", "long_name": "contact pressure"},
                ),
                "initial_gap": (("x", "y"), gap, {"units": "m"}),
                "hertz_half_width": half_width,
                "hertz_max_pressure": max_pressure,
            }
            | {name: (("x_field", "y_field", "z"), value, {"units": "Pa"}) for name, value in fields.items()},
            coords={"x": x, "y": y, "x_field": x_field, "y_field": y_field, "z": z},
        )
        return result.assign(von_mises=von_mises(result))

    return make_result


@pytest.fixture(scope="session")
def case_result() -> xr.Dataset:
    """Solved case with friction: a steel body with two free ends, the roller one half-width inside."""
    return solved_case()


@pytest.fixture(scope="session")
def study_dataset(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    """Study of the stand-in solver over e/a, two frictions (one fails) and two bodies; the half-space for e = 0
    only."""
    folder = tmp_path_factory.mktemp("results")
    study = small_study(
        sweep={"e_over_a": [0.0, 1.0, 2.0], "friction": [0.1, FAILS], "body": ["finite-length", "half-space"]},
        base=BASE | {"max_pressure": 1.5e9},
        exclude=[{"body": "half-space", "e_over_a": [1, 2]}],
    )
    run_study(study, folder, workers=0, solver=solve_fake)
    return open_study(folder)
