"""Two threads that share cached factorisations, kernels and transforms compute the same results as one thread."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from dataclasses import replace
from threading import Event

import numpy as np
import pytest
import xarray as xr
from threadpoolctl import threadpool_limits

import contactstudy as cs
from contactstudy import cache, threads

ROUNDS = 2

STEEL = cs.Material(young=210e9, poisson=0.3)
BODY = cs.FiniteLengthSpace(length=0.5e-3, material=STEEL)
CASE = cs.Case(
    body=BODY,
    roller=cs.Roller(radius=5e-3, length=0.5e-3, profile=cs.profiles.Lundberg(1e-6), material=STEEL),
    max_pressure=1e9,
    friction=0.2,
    motion=cs.Sliding(body_speed=-1.0, roller_speed=1.0),
)
ROLLING_CASE = cs.Case(
    body=cs.QuarterSpace(material=STEEL),
    roller=cs.Roller(radius=5e-3, length=0.2e-3),
    max_pressure=1e9,
    friction=0.2,
    motion=cs.Rolling(lateral_creepage=1e-3),
)
LUBRICATED_CASE = replace(
    CASE,
    max_pressure=4e8,
    lubricant=cs.Lubricant(viscosity=0.01, pressure_viscosity=1e-8, viscosity_law="roelands"),
    motion=cs.Sliding(body_speed=1.0, roller_speed=1.0),
)
FILM_CELLS = cs.film.FilmResolution(finest=1.1, finest_share=0.24, inner=0.32, growth=0.2, columns=0.24)
CROWNED_CASE = cs.Case(
    body=cs.HalfSpace(material=STEEL),
    roller=cs.Roller(radius=5e-3, length=0.3e-3, profile=cs.profiles.FullCrown(crown_radius=5e-3)),
    load=20.0,
)
GRID = cs.choose_grid(CASE, cells_x=8, cells_y=8)
ROLLING_GRID = cs.choose_grid(ROLLING_CASE, cells_x=6, cells_y=8)
POINTS = {"x": [0.0, 1e-4], "y": [0.0, 2e-5], "z": [0.0, 1e-5, 5e-5]}
PASSAGE_POINTS = {"x": np.linspace(0.0, 0.5e-3, 3), "y": np.linspace(-2e-4, 2e-4, 9), "z": [1e-5, 3e-5, 6e-5]}
APPROACHES, TILTS = 1e-6 * np.geomspace(0.5, 2.0, 5), np.linspace(-2e-3, 2e-3, 5)


class Controller:
    """Stand-in for the controller of a BLAS library with two threads."""

    def __init__(self) -> None:
        self.threads = 2

    def limit(self, *, limits: int, user_api: str) -> AbstractContextManager[None]:
        assert user_api == "blas"
        return Limiter(self, limits)


class Limiter(AbstractContextManager[None]):
    """Limit of the number of threads; the exit restores the original number."""

    def __init__(self, controller: Controller, limit: int) -> None:
        self.controller, self.original = controller, controller.threads
        controller.threads = limit

    def __exit__(self, *_: object) -> None:
        self.controller.threads = self.original


@pytest.mark.parametrize("last_index", [0, 1])
def test_blas_limit_lasts_from_first_entry_to_last_exit(monkeypatch: pytest.MonkeyPatch, last_index: int) -> None:
    controller = Controller()
    monkeypatch.setattr(threads, "_controller", lambda: controller)
    entry_events, exit_events = (Event(), Event()), (Event(), Event())

    def hold_limit(index: int) -> None:
        with threads.one_blas_thread():
            entry_events[index].set()
            assert exit_events[index].wait(10)

    with ThreadPoolExecutor(2) as executor:
        futures = []
        for index in (0, 1):
            futures.append(executor.submit(hold_limit, index))
            assert entry_events[index].wait(10)
        assert controller.threads == 1
        for index, remaining_threads in ((1 - last_index, 1), (last_index, 2)):
            exit_events[index].set()
            futures[index].result(10)
            assert controller.threads == remaining_threads


@pytest.fixture
def fast_switching() -> Iterator[None]:
    """Switch between threads every ten microseconds; limit BLAS to one thread."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    with threadpool_limits(1, user_api="blas"):
        yield
    sys.setswitchinterval(interval)


def make_calculations() -> dict[str, Callable[[], xr.Dataset | xr.DataArray]]:
    """Public calculations on small grids, by name."""
    solution = cs.solve(CASE, GRID, **POINTS)
    pressure = solution["pressure"]
    gap = solution["initial_gap"]
    passage = cs.solve(CASE, GRID, **PASSAGE_POINTS)
    film = cs.solve_film(LUBRICATED_CASE, accuracy=0.2, resolution=FILM_CELLS)
    elastic_plastic = cs.plasticity.ElasticPlastic(yield_stress=4e8)
    limits = cs.fatigue.FatigueLimits(torsion=4e8, bending=6e8)
    thermal = cs.heat.ThermalProperties(conductivity=50.0, density=7850.0, specific_heat=460.0)
    return {
        "solve": lambda: cs.solve(CASE, GRID, **POINTS),
        "solve_refined": lambda: cs.solve(CASE, **POINTS),
        "solve_rolling": lambda: cs.solve(ROLLING_CASE, ROLLING_GRID, stresses=False),
        "solve_contact": lambda: cs.solve_contact(BODY, gap, load=10.0),
        "stress_field": lambda: cs.stress_field(BODY, pressure, friction=0.2, **POINTS),
        "displacement_field": lambda: cs.displacement_field(BODY, pressure, friction=0.2, **POINTS),
        "surface_displacement": lambda: cs.surface_displacement(BODY, pressure, 0.2),
        "equivalent_loads": lambda: cs.equivalent_loads(BODY, pressure, 0.2),
        "roller_stress": lambda: cs.roller_stress(CASE, pressure, **POINTS),
        "wear_in": lambda: cs.wear.wear_in(CASE, 1e-17, distance=1e3, grid=GRID),
        "solve_film": lambda: cs.solve_film(LUBRICATED_CASE, accuracy=0.2, resolution=FILM_CELLS),
        "film_traction": lambda: cs.film.film_traction(LUBRICATED_CASE, film, [0.01, 0.1]),
        "contact_law": lambda: cs.bearing.contact_law(CROWNED_CASE, TILTS, APPROACHES, accuracy=0.1).table,
        "slice_model": lambda: cs.bearing.slice_model(CASE),
        "lamina_factors": lambda: cs.bearing.lamina_factors(solution),
        "shakedown": lambda: cs.fatigue.shakedown(passage),
        "dang_van": lambda: cs.fatigue.dang_van(passage, limits),
        "crossland": lambda: cs.fatigue.crossland(passage, limits),
        "findley": lambda: cs.fatigue.findley(passage, limits),
        "principal_stresses": lambda: cs.stress.principal_stresses(passage),
        "von_mises": lambda: cs.stress.von_mises(passage),
        "residual_stress": lambda: cs.plasticity.residual_stress(passage, BODY, elastic_plastic, passes=1),
        "flash_temperature": lambda: cs.heat.flash_temperature(CASE, solution, body=thermal, roller=thermal),
    }


@pytest.mark.slow
@pytest.mark.usefixtures("fast_switching")
def test_threads_get_serial_results() -> None:
    calculations = make_calculations()
    names = list(calculations)
    expected = {name: calculations[name]() for name in names}
    cache.clear()  # the first round fills the cache for later rounds

    def list_different_results(start: int) -> list[str]:
        order = names[start:] + names[:start]
        return [name for name in order if not calculations[name]().equals(expected[name])]

    with ThreadPoolExecutor(2) as executor:
        for start in range(ROUNDS):
            assert list(executor.map(list_different_results, (start, start))) == [[], []]
