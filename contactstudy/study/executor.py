"""Distribution of tasks over the workers of an engine.

Every worker has one task. The death of a worker costs its task only: the cases of the task are solved again one by
one, and a case during which a second worker dies fails.
"""

from __future__ import annotations

import contextlib
import queue
import time
from collections import deque
from collections.abc import Callable, Generator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from contactstudy.arrays.variables import package_version
from contactstudy.study.engine import SCHEDULER_LOST, Engine
from contactstudy.study.errors import StudyFileError
from contactstudy.study.plan import Plan
from contactstudy.study.settings import RUN
from contactstudy.study.user_profiles import user_profiles
from contactstudy.study.worker import Job, Outcome, Solver, Task, perform

if TYPE_CHECKING:
    from distributed import Client, Future


class Tasks:
    """Queue of tasks: groups in the order of their operators, divided by the measured time of a case."""

    def __init__(self, plan: Plan, groups: list[list[int]], template: Task) -> None:
        self._plan, self._template = plan, template
        self._groups = deque(groups)
        self._returned: deque[Task] = deque()
        self._suspects: set[str] = set()
        self.remaining = sum(map(len, groups))
        self._seconds, self._cases = 0.0, 0

    def __bool__(self) -> bool:
        return bool(self._groups or self._returned)

    def next_task(self, workers: int) -> Task:
        """Return the next task for one of several workers."""
        if self._returned:
            task = self._returned.popleft()
        else:
            jobs: list[Job] = []
            limit = self._limit(workers)
            while self._groups and (not jobs or len(jobs) + len(self._groups[0]) <= limit):
                jobs += [self._job(index) for index in self._groups.popleft()]
            profiles = user_profiles([job.parameters for job in jobs])
            task = replace(self._template, jobs=tuple(jobs), profiles=profiles)
        self.remaining -= len(task.jobs)
        return task

    def _limit(self, workers: int) -> int:
        """Largest number of cases of the next task, such that all workers end at about the same time."""
        if not self._cases:
            return 1
        cases = RUN.task_seconds * self._cases / max(self._seconds, 1e-9)
        return int(min(cases, self.remaining / (2 * max(workers, 1))))

    def _job(self, index: int) -> Job:
        """Job of a case."""
        plan = self._plan
        return Job(plan.ids[index].decode(), plan.words(index), plan.parameters(index), int(plan.groups[index]))

    def record(self, cases: int, seconds: float) -> None:
        """Add the time of a finished task."""
        self._seconds, self._cases = self._seconds + seconds, self._cases + cases

    def return_task(self, task: Task, *, died: bool) -> list[Job]:
        """Return a task to the queue, after the death of its worker case by case; returns the jobs that died twice."""
        failed = [job for job in task.jobs if died and job.id in self._suspects]
        jobs = [job for job in task.jobs if job not in failed]
        if died:
            self._suspects.update(job.id for job in jobs)
        parts = [(job,) for job in jobs] if died else [tuple(jobs)]
        self._returned.extend(replace(task, jobs=part) for part in parts if part)
        self.remaining += len(jobs)
        return failed


Results = Generator[tuple[list[Job], list[Outcome]], None, None]


def execute(tasks: Tasks, engine: Engine, notify: Callable[[str], None] = print) -> Results:
    """Solve tasks and yield the jobs and outcomes of each as it finishes; `notify` takes messages for the user."""
    if not tasks:
        return
    if engine.scheduler is None and engine.workers == 0:
        while tasks:
            task = tasks.next_task(1)
            began = time.monotonic()
            outcomes = perform(task, engine.solver)
            tasks.record(len(outcomes), time.monotonic() - began)
            yield list(task.jobs), outcomes
        return
    with engine.client(tasks.remaining, notify) as client:
        yield from _distribute(client, Workers(client, engine.wait, notify), tasks, engine.solver)


class Workers:
    """Workers of a scheduler that have this version of the package; `wait` is the longest wait for one, seconds."""

    def __init__(self, client: Client, wait: float, notify: Callable[[str], None]) -> None:
        self._client, self._wait, self._notify = client, wait, notify
        self._faults: dict[str, str] = {}  # of every checked worker; empty for a usable one
        self._last_present = time.monotonic()
        self._announced = False

    def usable(self, busy: bool) -> set[str]:
        """Addresses of the usable workers now; raises if all have another version, or none came for too long."""
        present = set(self._client.nthreads())
        if present - set(self._faults):
            self._check(present)
        usable = {worker for worker in present if self._faults.get(worker) == ""}
        if usable or busy:
            self._last_present, self._announced = time.monotonic(), False
        else:
            self._wait_for_one(present)
        return usable

    def _check(self, present: set[str]) -> None:
        """Compare the package's version on new workers with this one."""
        versions: Any = self._client.get_versions(packages=["contactstudy"])
        for worker in present - set(self._faults):
            answer = dict(versions["workers"]).get(worker)
            if answer is not None:
                version, expected = answer["packages"].get("contactstudy"), package_version()
                if version == expected:
                    self._faults[worker] = ""
                else:
                    self.exclude(worker, f"it has version {version} of contactstudy, not {expected}")

    def exclude(self, worker: str, reason: str) -> None:
        """Give a worker no further task."""
        self._faults[worker] = reason
        self._notify(f"worker {worker} is left out: {reason}")

    def _wait_for_one(self, present: set[str]) -> None:
        """Inform the user about the lack of workers; raise if all are excluded or the wait was too long."""
        excluded = {worker for worker in present if self._faults.get(worker)}
        if present and excluded == present:
            raise StudyFileError(f"none of the {len(excluded)} workers can be used: {self._faults[min(excluded)]}")
        waited = time.monotonic() - self._last_present
        if waited > self._wait:
            state = "has answered" if present else "is connected to the dask scheduler"
            raise StudyFileError(
                f"no worker {state} after {waited:.0f} s: start workers, or wait longer (--wait SECONDS)"
            )
        if waited > RUN.announce_seconds and not self._announced:
            self._announced = True
            self._notify(f"no worker yet; waiting for one up to {self._wait:g} s (--wait SECONDS)")


def _distribute(client: Client, workers: Workers, tasks: Tasks, solver: Solver | None) -> Results:
    """Keep every worker busy with one task until the queue is empty."""
    from distributed import KilledWorker

    finished: queue.SimpleQueue[Future[list[Outcome]]] = queue.SimpleQueue()
    running: dict[Future[list[Outcome]], tuple[str, Task, float]] = {}
    try:
        while tasks or running:
            usable = workers.usable(bool(running))
            busy = {worker for worker, _, _ in running.values()}
            for worker in sorted(usable - busy):
                if tasks:
                    task = tasks.next_task(len(usable))
                    future = client.submit(
                        perform,
                        task,
                        solver,
                        key=f"task-{id(task):x}-{time.monotonic_ns():x}",
                        workers=[worker],
                        pure=False,
                        retries=0,
                    )
                    running[future] = (worker, task, time.monotonic())
                    future.add_done_callback(finished.put)
            if lost := next((future for future, (worker, _, _) in running.items() if worker not in usable), None):
                future = lost
            else:
                try:
                    future = finished.get(timeout=RUN.poll_seconds)
                except queue.Empty:
                    continue
            if future not in running:
                continue
            worker, task, began = running.pop(future)
            error = future.exception() if future.status == "error" else None
            if future.status == "finished":
                outcomes = future.result()
                tasks.record(len(outcomes), time.monotonic() - began)
                yield list(task.jobs), outcomes
            elif future.status in ("cancelled", "lost"):
                raise StudyFileError(SCHEDULER_LOST)
            elif isinstance(error, ImportError):
                workers.exclude(worker, f"it cannot import contactstudy ({type(error).__name__}: {error})")
                tasks.return_task(task, died=False)
            elif error is not None and not isinstance(error, KilledWorker):
                raise error
            else:
                message = "WorkerDied: a second worker process died while it solved this case alone"
                jobs = tasks.return_task(task, died=True)
                yield jobs, [Outcome(job.id, "failed", 0.0, message) for job in jobs]
            future.release()
    finally:
        with contextlib.suppress(Exception):
            client.cancel(list(running), force=True)
