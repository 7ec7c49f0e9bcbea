"""Tasks and their sizes; death of workers."""

import asyncio
import gc
from unittest import mock

import pytest

from contactstudy.study import StudyFileError
from contactstudy.study.engine import Engine, Tasks, Workers, _loop_without_interrupts, execute
from contactstudy.study.settings import RUN
from contactstudy.study.worker import Task
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake


def make_tasks(study, groups, folder=""):
    return Tasks(study.plan(), groups, Task(cases=(), folder=str(folder)))


def list_names(task):
    return [case.name for case in task.cases]


@pytest.fixture
def many_cases():
    return small_study(sweep={"e_over_a": [0.0, 1.0, 2.0, 3.0], "friction": [0.0, 0.1]})


def test_group_contains_frictions_of_contact(many_cases):
    assert many_cases.plan().groups.tolist() == [0, 0, 1, 1, 2, 2, 3, 3]
    coupled_study = small_study(base=dict(many_cases.base) | {"coupled": True}, sweep=dict(many_cases.sweep))
    assert coupled_study.plan().groups.tolist() == list(range(8))


@pytest.mark.parametrize(("workers", "expected_count"), [(1, 6), (2, 2)])
def test_task_size_follows_measured_time(many_cases, workers, expected_count):
    tasks = make_tasks(many_cases, [[0, 1], [2, 3], [4, 5], [6, 7]])
    first_task = tasks.next_task(workers)
    assert len(first_task.cases) == 2
    tasks.finish(first_task, [(case.id, "ok", "") for case in first_task.cases], 0.1)
    assert (
        len(tasks.next_task(workers).cases) == expected_count
    )  # one worker: all six; two workers: a third, in whole groups
    assert tasks.remaining == 6 - expected_count


def test_one_worker_receives_tasks_of_full_length(many_cases):
    """Halving the remaining cases would cause many small tasks, with one file each."""
    tasks = make_tasks(many_cases, [[0], [1], [2], [3], [4], [5], [6], [7]])
    task = tasks.next_task(1)
    tasks.finish(task, [(task.cases[0].id, "ok", "")], RUN.task_seconds / 3)
    assert [len(tasks.next_task(1).cases) for _ in range(3)] == [3, 3, 1]


def test_case_fails_at_second_worker_death(many_cases):
    tasks = make_tasks(many_cases, [[0, 1]])
    task = tasks.next_task(1)
    assert tasks.return_task(task, died=True) == []
    single_tasks = [tasks.next_task(1) for _ in range(2)]
    assert [len(task.cases) for task in single_tasks] == [1, 1]
    assert [case.name for case in tasks.return_task(single_tasks[0], died=True)] == list_names(single_tasks[0])
    assert not tasks


def test_execution_in_process_yields_outcomes(many_cases, tmp_path):
    tasks = make_tasks(many_cases, [[0, 1], [2, 3]], tmp_path)
    outcomes = [
        outcome for task_outcomes in execute(tasks, Engine(workers=0, solver=solve_fake)) for outcome in task_outcomes
    ]
    assert [outcome.status for outcome in outcomes] == ["ok"] * 4
    assert len(list(tmp_path.glob("*.nc"))) == 2


@pytest.mark.parametrize("wait", [-1.0, float("nan"), "long", True])
def test_invalid_wait_raises(wait):
    with pytest.raises(ValueError, match="wait"):
        Engine(wait=wait)


class FakeClient:
    """Client of a scheduler with given workers."""

    def __init__(self, versions):
        self.versions = versions

    def nthreads(self):
        return dict.fromkeys(self.versions, 1)

    def get_versions(self, packages):
        workers = {name: {"packages": {"contactstudy": version}} for name, version in self.versions.items()}
        return {"workers": workers}


def test_workers_of_other_version_are_excluded():
    from contactstudy.arrays.variables import package_version

    messages = []
    workers = Workers(FakeClient({"old": "0.0.1", "none": None, "new": package_version()}), 1.0, messages.append)
    assert workers.find_usable(busy=False) == {"new"}
    assert len(messages) == 2
    with pytest.raises(StudyFileError, match=r"none of the 1 workers can be used: it has version 0\.0\.1"):
        Workers(FakeClient({"old": "0.0.1"}), 0.0, messages.append).find_usable(busy=False)


@pytest.mark.parametrize("method", ["nthreads", "get_versions"])
@pytest.mark.parametrize("error", [OSError("Timed out trying to connect"), TimeoutError()])
def test_connection_error_names_scheduler(monkeypatch, method, error):
    """Dask raises OSError itself if the scheduler ends before a message, and a subclass if it ends during one."""
    client = FakeClient({"worker": "0.0.1"})
    monkeypatch.setattr(client, method, mock.Mock(side_effect=error))
    with pytest.raises(StudyFileError, match="scheduler has gone away"):
        Workers(client, 1.0, print).find_usable(busy=True)


def test_errors_of_deleted_tasks_are_silent(caplog):
    """A worker that an interrupt ends at its start leaves a task with an error that nobody retrieves."""

    async def fail():
        raise RuntimeError("Nanny failed to start.")

    async def leave_task():
        await asyncio.wait([asyncio.create_task(fail())])

    with _loop_without_interrupts() as loop:
        asyncio.run_coroutine_threadsafe(leave_task(), loop.asyncio_loop).result(10)
    gc.collect()
    assert not caplog.records
