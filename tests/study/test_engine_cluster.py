"""Runs on a scheduler and workers in separate processes; results are equal bit for bit."""

import socket
import time
from pathlib import Path
from unittest import mock

import pytest

from contactstudy.errors import InvalidInputError
from contactstudy.study import StudyFileError, engine, load_case, open_study, run_study
from contactstudy.study.folder import Folder
from contactstudy.study.settings import RunSettings
from tests.small_study import BASE, format_toml, identity, small_study
from tests.stand_in_solver import DIES, HELD, solve_fake
from tests.study.cluster import ENVIRONMENT, SCHEDULER, WORKER, cluster
from tests.study.conftest import locate_tickets, start_run

SHORT_ROLLER = {"roller_length": 0.2e-3}  # solved in half of the time
LARGE_SWEEP = {"e_over_a": [0.0, 0.5, 1.0, 1.5, 2.0], "friction": [0.0, 0.05, 0.1, 0.2]}


def load_dataset(folder):
    """Dataset of a study without the duration of the cases."""
    return open_study(folder).drop_vars("seconds").load()


ROOT = Path(__file__).resolve().parents[2]


def test_documentation_contains_cluster_commands():
    text = (ROOT / "docs" / "how-to" / "cluster.md").read_text()
    assert SCHEDULER in text
    assert WORKER in text
    for name, value in ENVIRONMENT.items():
        assert f"{name}={value}" in text


def test_missing_scheduler_is_announced_before_error(tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "RUN", RunSettings(start_seconds=0.2))
    with pytest.raises(StudyFileError, match="no dask scheduler answers"):
        run_study(small_study(), tmp_path, scheduler="tcp://127.0.0.1:1", solver=solve_fake)
    assert "connecting to the dask scheduler at tcp://127.0.0.1:1" in (tmp_path / "run.log").read_text()


def test_silent_listener_raises_scheduler_error(tmp_path, monkeypatch):
    """Dask would wait indefinitely for the end of the handshake."""
    monkeypatch.setattr(engine, "RUN", RunSettings(start_seconds=0.3, close_seconds=0.3))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = f"tcp://127.0.0.1:{listener.getsockname()[1]}"
        with pytest.raises(StudyFileError, match="no dask scheduler"):
            run_study(small_study(), tmp_path, scheduler=address, solver=solve_fake)


@pytest.mark.parametrize("scheduler", [3, ["tcp://127.0.0.1:1"]])
def test_invalid_scheduler_raises(tmp_path, scheduler):
    with pytest.raises(InvalidInputError, match="scheduler"):
        run_study(small_study(), tmp_path, scheduler=scheduler, solver=solve_fake)


@pytest.mark.slow
def test_cluster_without_worker_raises(study, tmp_path):
    with cluster(tmp_path, workers=0) as address, pytest.raises(StudyFileError, match="no worker is connected"):
        run_study(study, tmp_path / "out", scheduler=address, wait=1.0, solver=solve_fake)
    assert not Folder(tmp_path / "out").holders


@pytest.mark.slow
def test_worker_version_mismatch_is_reported(study, tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "RUN", RunSettings(announce_seconds=0.0))
    raises_version_error = pytest.raises(
        StudyFileError, match=r"none of the 1 workers can be used: it has version 0.0.0"
    )
    with cluster(tmp_path, workers=0, outdated_workers=1) as address, raises_version_error:
        run_study(study, tmp_path / "out", scheduler=address, solver=solve_fake)


@pytest.mark.slow
def test_worker_of_wrong_version_is_excluded(study, tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "RUN", RunSettings(announce_seconds=100.0))  # workers start slowly on a busy machine
    with cluster(tmp_path, workers=1, outdated_workers=1) as address:
        report = run_study(study, tmp_path / "out", scheduler=address, solver=solve_fake)
    assert report.counts == {"ok": 4}


@pytest.mark.slow
def test_killed_scheduler_ends_run(tmp_path, monkeypatch):
    monkeypatch.setenv(HELD, str(locate_tickets(tmp_path / "out")))  # workers inherit the variable and wait for tickets
    file = tmp_path / "long.toml"
    file.write_text(
        format_toml(small_study("long", sweep={"e_over_a": [0.0, 1.0, 2.0], "friction": [0.0, 0.1, 0.2, 0.3]}))
    )
    with cluster(tmp_path, workers=1) as address:
        process = start_run(file, tmp_path / "out", "--scheduler", address, tickets=2)
        deadline = time.monotonic() + 200
        while not list((tmp_path / "out").glob("batches/*.nc")):
            assert time.monotonic() < deadline
            assert process.poll() is None, process.communicate()
            time.sleep(0.1)
        address.processes[0].kill()
        output, errors = process.communicate(timeout=150)
    assert process.returncode == 2, output + errors
    assert "scheduler has gone away" in errors
    assert "Traceback" not in errors
    assert not Folder(tmp_path / "out").holders


@pytest.mark.system
def test_single_solution_equals_study_result(tmp_path):
    """Earlier cases of a worker do not change a bit of a result."""
    run_study(small_study(base=BASE | SHORT_ROLLER), tmp_path / "all", workers=0)
    single_case_study = small_study(base=BASE | SHORT_ROLLER, sweep={"e_over_a": [1.0], "friction": [0.1]})
    run_study(single_case_study, tmp_path / "alone", workers=1)
    results = [
        load_case(tmp_path / name, identity(**SHORT_ROLLER, e_over_a=1.0, friction=0.1)).drop_vars("seconds")
        for name in ("all", "alone")
    ]
    assert results[0].equals(results[1])


@pytest.fixture(scope="module")
def two_workers(tmp_path_factory):
    """Address of a shared cluster with two workers."""
    with cluster(tmp_path_factory.mktemp("cluster")) as address:
        yield address


@pytest.mark.system
def test_cluster_of_separate_processes(two_workers, tmp_path):
    """A run with the address of the scheduler or with a client; the run does not close the client."""
    from distributed import Client

    study = small_study("large", sweep=LARGE_SWEEP)
    run_study(study, tmp_path / "calm", workers=0, solver=solve_fake)
    with Client(str(two_workers)) as client, mock.patch.object(client, "submit", wraps=client.submit) as submit:
        for scheduler in (two_workers, client):
            folder = tmp_path / type(scheduler).__name__
            assert run_study(study, folder, scheduler=scheduler, solver=solve_fake).counts == {"ok": 20}
            assert load_dataset(folder).identical(load_dataset(tmp_path / "calm"))
        assert client.status == "running"
    # Cases are sent as bytes; otherwise the scheduler would store objects for every case of a task.
    assert {type(argument) for call in submit.call_args_list for argument in call.args[1:]} == {bytes}


@pytest.mark.system
def test_dead_cluster_worker_fails_one_case(two_workers, tmp_path):
    """The cluster replaces the worker for the next tests."""
    study = small_study(
        sweep={"e_over_a": [0, 1, 2], "friction": [0, DIES]}, exclude=[{"e_over_a": [0, 1], "friction": DIES}]
    )
    report = run_study(study, tmp_path / "out", scheduler=two_workers, solver=solve_fake)
    assert report.counts == {"ok": 3, "failed": 1}
    assert all(reason.startswith("WorkerDied") for _, reason in report.failures)


@pytest.mark.system
def test_results_do_not_depend_on_workers(two_workers, tmp_path):
    """Results are equal bit for bit in this process, with two workers, and on a cluster."""
    study = small_study(base=BASE | SHORT_ROLLER, sweep={"e_over_a": [0.0, 1.0], "friction": [0.1]})
    for workers in (0, 2):
        assert run_study(study, tmp_path / str(workers), workers=workers).counts == {"ok": 2}
    run_study(study, tmp_path / "cluster", scheduler=two_workers)
    first_dataset = load_dataset(tmp_path / "0")
    assert float(first_dataset["von_mises"].max()) > 1e8
    for name in ("2", "cluster"):
        assert load_dataset(tmp_path / name).identical(first_dataset), name
