"""Studies of films: parameters, invalid values, warm starts, equal results after interrupts and deaths of workers."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from contactstudy import Case, InvalidInputError, Sliding, solve_film
from contactstudy.film import Asperities
from contactstudy.study import Study, open_study, run_study
from contactstudy.study.case_setup import build_setup
from contactstudy.study.engine import Tasks
from contactstudy.study.worker import Task
from tests.small_study import case_id

BASE: dict[str, Any] = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 0.2e-3,
    "e_over_a": 0.0,
    "max_pressure": 1e9,
    "profile": {"kind": "lundberg", "design_pressure": 1e9},
    "viscosity": 0.004,
    "pressure_viscosity": 1.5e-8,
    "accuracy": 0.1,
}
SPEEDS = [1.0, 2.0]
STUDY = Study(
    name="film",
    base=BASE,
    sweep={"body": ["finite-length", "half-space"], "entrainment_speed": SPEEDS},
    exclude=[{"body": "half-space", "entrainment_speed": 1.0}],
)


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    """Films at two speeds on a body with free ends, and at the higher speed on a half-space."""
    folder = tmp_path_factory.mktemp("films")
    assert run_study(STUDY, folder, workers=0, progress=False).counts == {"ok": 3}
    return open_study(folder)


def test_setup_of_film_has_speeds_and_lubricant() -> None:
    setup = build_setup(BASE | {"entrainment_speed": 2.0, "slide_roll_ratio": 0.1, "roughness_rms": 1e-7})
    assert setup.case.motion == Sliding(body_speed=1.9, roller_speed=2.1)
    assert setup.case.lubricant is not None
    assert setup.case.lubricant.viscosity == 0.004
    assert setup.options == {"accuracy": 0.1, "asperities": Asperities(rms=1e-7)}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({}, "entrainment_speed"),
        ({"entrainment_speed": 0.0}, "entrainment_speed"),
        ({"entrainment_speed": 1.0, "lubricant": "spindle oil"}, "lubricant, viscosity"),
        ({"entrainment_speed": 1.0, "temperature": 60.0}, "temperature"),
        ({"entrainment_speed": 1.0, "pressure_viscosity": None}, "pressure_viscosity"),
        ({"entrainment_speed": 1.0, "viscosity": None}, "pressure_viscosity"),
        ({"entrainment_speed": 1.0, "field_z_over_a": [0.5]}, "field_z_over_a"),
        ({"entrainment_speed": 1.0, "motion": "rolling"}, "entrainment_speed"),
    ],
)
def test_invalid_film_parameter_raises(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        build_setup(BASE | changes)


def test_film_parameter_of_dry_case_raises() -> None:
    dry_parameters = {name: value for name, value in BASE.items() if "viscosity" not in name}
    assert build_setup(dry_parameters).case.motion == Sliding()
    assert build_setup(dry_parameters).case.lubricant is None
    assert "stresses" in build_setup(dry_parameters).options
    assert case_id(dry_parameters) != case_id(BASE)
    with pytest.raises(InvalidInputError, match="entrainment_speed"):
        build_setup(dry_parameters | {"entrainment_speed": 1.0})


@pytest.mark.slow
def test_warm_start_is_faster_and_within_error(films: xr.Dataset) -> None:
    fast_setup = build_setup(BASE | {"entrainment_speed": 2.0})
    cold_film = solve_film(fast_setup.case, **fast_setup.options)
    warm_film = films.sel(body="finite-length", entrainment_speed=2.0)
    assert abs(float(warm_film.least_film - cold_film.least_film)) < float(warm_film.least_film_error)
    assert float(warm_film.newton_steps) < float(cold_film.newton_steps)
    fast_film = films.end_film_ratio.sel(entrainment_speed=2.0)
    assert fast_film.sel(body="half-space") < fast_film.sel(body="finite-length")
    assert {"central_film_error", "least_film_error", "end_film_ratio_error"} <= set(films)


def assert_bit_identical(folder: Path, films: xr.Dataset) -> None:
    """Compare two studies except the durations."""
    xr.testing.assert_identical(open_study(folder).drop_vars("seconds").load(), films.drop_vars("seconds").load())


@pytest.mark.slow
@pytest.mark.parametrize("finished_count", [1, 2])
def test_films_after_interrupt_are_bit_identical(films: xr.Dataset, tmp_path: Path, finished_count: int) -> None:
    """The interrupt is within a group or between two groups."""
    solved_films: list[xr.Dataset] = []

    def solve_or_fail(case: Case, **options: Any) -> xr.Dataset:
        if len(solved_films) == finished_count:
            raise KeyboardInterrupt
        solved_films.append(solve_film(case, **options))
        return solved_films[-1]

    with pytest.raises(KeyboardInterrupt, match=f"{finished_count} of 3 cases are kept"):
        run_study(STUDY, tmp_path, workers=0, progress=False, solver=solve_or_fail)
    run_study(STUDY, tmp_path, workers=0, progress=False)
    assert_bit_identical(tmp_path, films)


MARKER_VARIABLE = "CONTACTSTUDY_TEST_DEATH"
"""Environment variable with the path of a marker file of `solve_after_death`."""


def solve_after_death(case: Case, **options: Any) -> xr.Dataset:
    """Solve a film; the first film of the higher speed makes the marker file and kills its process."""
    marker = Path(os.environ[MARKER_VARIABLE])
    if case.motion.speeds is not None and case.motion.speeds.entrainment == SPEEDS[-1] and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return solve_film(case, **options)


@pytest.mark.slow
def test_films_after_worker_death_are_bit_identical(
    films: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MARKER_VARIABLE, str(tmp_path / "dead"))
    folder = tmp_path / "out"
    run_study(STUDY, folder, workers=1, progress=False, solver=solve_after_death)
    assert (tmp_path / "dead").exists()
    assert_bit_identical(folder, films)


def test_second_death_returns_whole_group() -> None:
    """Films of a group are one task and fail together."""
    plan = Study(name="film", base=BASE, sweep={"max_pressure": [0.8e9, 1e9], "entrainment_speed": SPEEDS}).plan()
    tasks = Tasks(plan, [[0, 1, 2, 3]], Task(cases=(), folder=""))
    assert tasks.return_task(tasks.next_task(1), died=True) == []
    returned_tasks = [tasks.next_task(1) for _ in range(2)]
    assert [[case.index for case in task.cases] for task in returned_tasks] == [[0, 1], [2, 3]]
    assert [case.index for case in tasks.return_task(returned_tasks[0], died=True)] == [0, 1]
    assert not tasks
