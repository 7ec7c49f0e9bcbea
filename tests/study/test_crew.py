"""Workers that cannot be used, that are not there, and schedulers that go away."""

import time

import pytest

from contactstudy.study import StudyFileError, run_study
from contactstudy.study.crew import Crew, introduce
from contactstudy.study.lock import LOCK_NAME
from contactstudy.study.work import circumstances, differences
from tests.small_study import as_toml, small_study
from tests.stand_in_solver import HELD, solve_fake
from tests.study.cluster import cluster
from tests.study.conftest import start_run, tickets_of


@pytest.fixture
def crew(tmp_path):
    (tmp_path / LOCK_NAME).write_text("this run")
    return Crew(None, str(tmp_path), 1.0, print)


def test_a_worker_says_its_versions_and_what_it_sees(crew, tmp_path):
    said = introduce(str(tmp_path / LOCK_NAME))
    assert said == {"versions": circumstances(), "read": "this run"}
    assert crew._unfit(said) == ""


def test_a_worker_that_sees_another_folder_is_unfit(crew, tmp_path):
    said = introduce(str(tmp_path / "elsewhere" / LOCK_NAME))
    assert "does not see this run's lock" in crew._unfit(said)
    assert "FileNotFoundError" in crew._unfit(said)


def test_a_worker_with_another_version_is_unfit(crew):
    said = {"versions": circumstances() | {"contactstudy": "0.0.1"}, "read": "this run"}
    assert crew._unfit(said).startswith("it has version 0.0.1 of contactstudy, not ")


def test_other_versions_of_libraries_are_named():
    assert differences(circumstances()) == ""
    assert differences(circumstances() | {"numpy": "0.1"}).startswith("numpy 0.1 instead of")


@pytest.mark.parametrize("wait", [-1.0, float("nan"), "long", True])
def test_a_wrong_wait(study, tmp_path, wait):
    with pytest.raises(ValueError, match="wait"):
        run_study(study, tmp_path, workers=0, wait=wait, solver=solve_fake)


def test_files_hold_the_versions_of_their_worker(study, tmp_path, monkeypatch):
    """And a run names them where they are not its own."""
    other = circumstances() | {"numpy": "0.1"}
    monkeypatch.setattr("contactstudy.study.run.differences", lambda run: "" if run["numpy"] != "0.1" else "numpy 0.1")
    monkeypatch.setattr("contactstudy.study.work.circumstances", lambda: other)
    report = run_study(study, tmp_path, workers=0, solver=solve_fake, progress=False)
    assert {entry.run["numpy"] for entry in report.entries} == {"0.1"}
    assert report.remarks == ("a worker solves with other versions than this process has: numpy 0.1",)
    assert "numpy 0.1" in (tmp_path / "run.log").read_text()


@pytest.mark.slow
def test_no_worker_at_all(study, tmp_path):
    with cluster(tmp_path, workers=0) as address, pytest.raises(StudyFileError, match="no worker is connected"):
        run_study(study, tmp_path / "out", scheduler=address, wait=1.0, solver=solve_fake)
    assert not (tmp_path / "out" / LOCK_NAME).exists()


@pytest.mark.slow
def test_a_worker_without_the_package(study, tmp_path):
    with cluster(tmp_path, workers=0, lame=1) as address:
        began = time.monotonic()
        with pytest.raises(StudyFileError, match=r"none of the 1 workers can be used: it cannot import .*contactstudy"):
            run_study(study, tmp_path / "out", scheduler=address, solver=solve_fake)
    assert time.monotonic() - began < 120


@pytest.mark.slow
def test_workers_that_can_be_used_solve_what_others_cannot(study, tmp_path):
    with cluster(tmp_path, workers=1, lame=1) as address:
        report = run_study(study, tmp_path / "out", scheduler=address, solver=solve_fake)
    assert report.counts == {"ok": 4}


@pytest.mark.slow
def test_a_scheduler_that_is_killed(tmp_path, monkeypatch):
    monkeypatch.setenv(HELD, str(tickets_of(tmp_path / "out")))  # the workers are started here, and hold cases too
    file = tmp_path / "long.toml"
    file.write_text(as_toml(small_study("long", sweep={"e_over_a": [0.0, 1.0, 2.0], "friction": [0.0, 0.1, 0.2, 0.3]})))
    with cluster(tmp_path, workers=1) as address:
        process = start_run(file, tmp_path / "out", "--scheduler", address, tickets=2)
        end = time.monotonic() + 200
        while not list((tmp_path / "out").glob("cases/*.nc")):
            assert time.monotonic() < end
            assert process.poll() is None, process.communicate()
            time.sleep(0.1)
        address.processes[0].kill()
        output, errors = process.communicate(timeout=150)
    assert process.returncode == 2, output + errors
    assert "scheduler has gone away" in errors
    assert "Traceback" not in errors
    assert not (tmp_path / "out" / LOCK_NAME).exists()
