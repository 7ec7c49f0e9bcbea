"""Engine of a run: this process, local worker processes, or a dask cluster, and the distribution of tasks over them.

Every worker has one task. After the death of a worker the cases of its task are solved again one by one, films with
the other films of their group; a case, or a group of films, that ends a second worker fails.
"""

from __future__ import annotations

import contextlib
import logging
import os
import queue
import signal
import threading
import time
import zlib
from collections import deque
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, Any

from contactstudy import checks
from contactstudy.arrays.variables import package_version
from contactstudy.errors import InvalidInputError, StudyFileError
from contactstudy.study.plan import Plan, PlannedCase
from contactstudy.study.profile_tables import user_profiles
from contactstudy.study.settings import RUN
from contactstudy.study.worker import Outcome, Record, Solver, Task, solve_compressed_task, solve_task

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster
    from tornado.ioloop import IOLoop

WAIT_SECONDS = 300.0  # Longest wait for a worker while a scheduler has none
WORKER_ENVIRONMENT = {  # one thread; keeping the freed memory of arrays halves the time of a case
    **dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "PYFFTW_NUM_THREADS"), "1"),
    "MALLOC_MMAP_THRESHOLD_": str(32 * 2**20),
    "MALLOC_TRIM_THRESHOLD_": str(512 * 2**20),
}

# Without limits dask's logs of messages, tasks and records grow with the number of cases.
SHORT_LOGS = {"distributed.admin.log-length": 20, "distributed.admin.low-level-log-length": 20}

SCHEDULER_LOST = "the dask scheduler has gone away or was restarted; finished cases remain, run again to continue"

GUARD_REMEDY = (
    "A script that runs a study needs the guard `if __name__ == '__main__':` around the run, because worker processes "
    "import the script; every worker needs about 20 open files (ulimit -n); workers=0 solves in one process"
)


@dataclass(frozen=True, kw_only=True)
class Engine:
    """Processes that solve the tasks of a run."""

    workers: int | None = None  # local processes; 0: this process; None: one per core
    scheduler: str | Client | None = None  # address of a dask scheduler, or a client of it, instead of local processes
    wait: float = WAIT_SECONDS  # longest wait for a worker while a scheduler has none, seconds
    solver: Solver | None = None  # called instead of `contactstudy.solve`

    def __post_init__(self) -> None:
        if self.workers is not None:
            checks.count("workers", self.workers, minimum=0)
        if isinstance(self.wait, bool) or not isinstance(self.wait, (int, float)) or not self.wait >= 0:
            raise InvalidInputError("wait", self.wait, "a number of seconds >= 0")
        if self.scheduler is not None and not isinstance(self.scheduler, str):
            from distributed import Client

            checks.instance("scheduler", self.scheduler, Client, "a distributed.Client, or an address tcp://host:port")
            if self.scheduler.asynchronous:
                raise InvalidInputError("scheduler", self.scheduler, "a client that is not asynchronous")

    @contextlib.contextmanager
    def client(self, cases: int, notify: Callable[[str], None]) -> Iterator[Client]:
        """Client of the scheduler, or of local processes, which end with the block; few `cases` need few processes."""
        from dask.system import CPU_COUNT

        if self.scheduler is None:
            with _local_client(min(CPU_COUNT if self.workers is None else self.workers, cases)) as local_client:
                yield local_client
            return
        if isinstance(self.scheduler, str):
            notify(f"connecting to the dask scheduler at {self.scheduler}, for up to {RUN.start_seconds:g} s")
            remote_client: contextlib.AbstractContextManager[Client] = _remote_client(self.scheduler)
        else:
            remote_client = contextlib.nullcontext(self.scheduler)
        with remote_client as client:
            yield client


@contextlib.contextmanager
def _report_lost_scheduler() -> Iterator[None]:
    """Convert errors of the connection; errors of tasks, which may be errors of files, arise outside this block."""
    try:
        yield
    except OSError as error:  # dask raises OSError itself, or one of its subclasses, depending on the moment
        raise StudyFileError(SCHEDULER_LOST) from error


@contextlib.contextmanager
def _remote_client(scheduler: str) -> Iterator[Client]:
    """Client of a scheduler, within a time limit: dask waits endlessly for a listener that does not answer."""
    import dask
    from distributed import Client

    answers: queue.SimpleQueue[Client | Exception] = queue.SimpleQueue()

    def connect() -> None:
        try:
            with dask.config.set(SHORT_LOGS):
                answers.put(Client(scheduler, timeout=RUN.start_seconds))
        except Exception as error:
            answers.put(error)

    with _silent_libraries():
        threading.Thread(target=connect, daemon=True).start()
        try:
            client = answers.get(timeout=RUN.start_seconds + RUN.close_seconds)
        except queue.Empty:
            raise StudyFileError(f"no dask scheduler at {scheduler}: the listener did not answer") from None
        if isinstance(client, Exception):
            reason = client if isinstance(client, (OSError, ValueError)) else type(client).__name__
            raise StudyFileError(f"no dask scheduler answers at {scheduler}: {reason}") from client
        try:
            yield client
        finally:
            with contextlib.suppress(Exception):
                client.close(timeout=RUN.close_seconds)


@contextlib.contextmanager
def _local_client(workers: int) -> Iterator[Client]:
    """Client of local processes that end with the block."""
    import dask
    from distributed import Client

    settings = {
        **SHORT_LOGS,
        "distributed.scheduler.allowed-failures": 0,
        "distributed.comm.timeouts.connect": RUN.start_seconds,
        "distributed.worker.daemon": True,
        "distributed.nanny.pre-spawn-environ": WORKER_ENVIRONMENT,
    }
    with (
        _silent_libraries(),
        dask.config.set(settings),
        _loop_without_interrupts() as loop,
        _local_cluster(workers, loop) as cluster,
        Client(cluster) as client,
    ):
        try:
            yield client
        except BaseException:
            # Dask waits for running cases.
            for nanny in cluster.workers.values():
                with contextlib.suppress(Exception):
                    nanny.auto_restart = False
                    os.kill(nanny.pid, signal.SIGKILL)
            raise


def _local_cluster(workers: int, loop: IOLoop) -> LocalCluster:
    """Cluster of local processes."""
    from distributed import LocalCluster, SpecCluster

    older_clusters = set(getattr(SpecCluster, "_instances", ()))
    try:
        return LocalCluster(
            n_workers=workers,
            loop=loop,
            processes=True,
            threads_per_worker=1,
            dashboard_address=None,
            # Dask's default is one fixed port, on which two studies collide.
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
    except BaseException as error:
        # Otherwise dask would close the half-started cluster at the end of the process, and fail.
        for cluster in set(getattr(SpecCluster, "_instances", ())) - older_clusters:
            cluster.shutdown_on_close = False
        if isinstance(error, RuntimeError | OSError):
            raise StudyFileError(f"the worker processes did not start: {error} {GUARD_REMEDY}") from None
        raise


@contextlib.contextmanager
def _silent_libraries() -> Iterator[None]:
    """Silence the logs of dask and tornado, whose failures become errors of the package."""
    import distributed  # noqa: F401  # creates the loggers that are silenced

    libraries = ("distributed", "tornado", "asyncio")
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] in libraries]
    levels = {name: logging.getLogger(name).level for name in names}
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for name, level in levels.items():
            logging.getLogger(name).setLevel(level)


@contextlib.contextmanager
def _loop_without_interrupts() -> Iterator[IOLoop]:
    """Event loop in a thread that blocks SIGINT, also for its processes: Ctrl-C reaches the whole process group."""
    from multiprocessing import resource_tracker

    from distributed.utils import LoopRunner

    resource_tracker.ensure_running()  # otherwise the first process starts the tracker, which unblocks the signal
    runner = LoopRunner()
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        runner.start()
    else:
        previous_mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            runner.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, previous_mask)
    # asyncio reports the errors of workers that an interrupt ended at their start when it deletes their tasks.
    runner.loop.asyncio_loop.set_exception_handler(lambda loop, context: None)
    try:
        yield runner.loop
    finally:
        runner.stop()


class Tasks:
    """Queue of tasks: groups in the order of their operators, divided by the measured time of a case."""

    def __init__(self, plan: Plan, groups: list[list[int]], template: Task) -> None:
        self._plan, self._template = plan, template
        self._groups = deque(groups)
        self._returned: deque[Task] = deque()
        self._suspect_cases: set[str] = set()
        self.remaining = sum(map(len, groups))
        self._seconds, self._cases = 0.0, 0

    def __bool__(self) -> bool:
        return bool(self._groups or self._returned)

    def next_task(self, workers: int) -> Task:
        """Return the next task, sized for the number of workers."""
        if self._returned:
            task = self._returned.popleft()
        else:
            plan, cases = self._plan, list[PlannedCase]()
            # Tasks of this size let all workers end at about the same time; one worker needs no balance.
            size = RUN.task_seconds * self._cases / max(self._seconds, 1e-9)
            max_cases = int(min(size, self.remaining / (2 * workers - 1))) if self._cases else 1
            while self._groups and (not cases or len(cases) + len(self._groups[0]) <= max_cases):
                cases += [plan[index] for index in self._groups.popleft()]
            profiles = user_profiles([case.parameters for case in cases])
            task = replace(self._template, cases=tuple(cases), profiles=profiles)
        self.remaining -= len(task.cases)
        return task

    def finish(self, task: Task, records: list[Record], seconds: float) -> list[Outcome]:
        """Add the time of a finished task; return its outcomes."""
        self._seconds, self._cases = self._seconds + seconds, self._cases + len(records)
        case_of = {case.id: case for case in task.cases}
        return [Outcome(case_of[identity], status, message) for identity, status, message in records]

    def return_task(self, task: Task, *, died: bool) -> list[PlannedCase]:
        """Return a task to the queue, divided if its worker died; returns cases with which two workers died."""
        failed_cases = [case for case in task.cases if died and case.id in self._suspect_cases]
        cases = [case for case in task.cases if case not in failed_cases]
        if died:
            self._suspect_cases.update(case.id for case in cases)

        def group_key(case: PlannedCase) -> int | str:  # a film starts from the other films of its group
            return case.group if "entrainment_speed" in case.parameters else case.id

        case_lists = [list(case_list) for _, case_list in groupby(cases, group_key)] if died else [cases]
        self._returned.extend(replace(task, cases=tuple(case_list)) for case_list in case_lists if case_list)
        self.remaining += len(cases)
        return failed_cases


TaskResults = Generator[list[Outcome], None, None]


def execute(tasks: Tasks, engine: Engine, notify: Callable[[str], None] = print) -> TaskResults:
    """Solve tasks and yield the outcomes of each finished task; `notify` takes messages for the user."""
    if not tasks:
        return
    if engine.scheduler is None and engine.workers == 0:
        while tasks:
            task = tasks.next_task(1)
            start_time = time.monotonic()
            yield tasks.finish(task, solve_task(task, engine.solver), time.monotonic() - start_time)
        return
    with engine.client(tasks.remaining, notify) as client:
        yield from _distribute(client, Workers(client, engine.wait, notify), tasks, engine.solver)


class Workers:
    """Workers of a scheduler that have this version of the package; `wait`: longest wait for a worker, seconds."""

    def __init__(self, client: Client, wait: float, notify: Callable[[str], None]) -> None:
        self._client, self._wait, self._notify = client, wait, notify
        self._faults: dict[str, str] = {}  # fault of every checked worker; empty for a usable worker
        self._last_present = time.monotonic()
        self._announced = False

    @_report_lost_scheduler()
    def find_usable(self, busy: bool) -> set[str]:
        """Addresses of the usable workers now; raises if all are excluded, or no worker came for too long."""
        connected_workers = set(self._client.nthreads())
        if new_workers := connected_workers - set(self._faults):
            versions: Any = self._client.get_versions(packages=["contactstudy"])
            for worker in new_workers & set(versions["workers"]):
                version, own_version = versions["workers"][worker]["packages"].get("contactstudy"), package_version()
                self._faults[worker] = ""
                if version != own_version:
                    self.exclude(worker, f"it has version {version} of contactstudy, not {own_version}")
        usable_workers = {worker for worker in connected_workers if self._faults.get(worker) == ""}
        if usable_workers or busy:
            self._last_present, self._announced = time.monotonic(), False
        else:
            self._wait_for_worker(connected_workers)
        return usable_workers

    def exclude(self, worker: str, reason: str) -> None:
        """Give a worker no further task."""
        self._faults[worker] = reason
        self._notify(f"worker {worker} is left out: {reason}")

    def _wait_for_worker(self, connected: set[str]) -> None:
        """Inform the user about the lack of workers; raise after the wait, a short wait if all workers are excluded."""
        waiting_time = time.monotonic() - self._last_present
        excluded = {worker for worker in connected if self._faults.get(worker)}
        if connected and excluded == connected and waiting_time > min(self._wait, RUN.announce_seconds):
            raise StudyFileError(f"none of the {len(excluded)} workers can be used: {self._faults[min(excluded)]}")
        if waiting_time > self._wait:
            condition = "has answered" if connected else "is connected to the dask scheduler"
            raise StudyFileError(
                f"no worker {condition} after {waiting_time:.0f} s: start workers, or wait longer (--wait SECONDS)"
            )
        if waiting_time > RUN.announce_seconds and not self._announced:
            self._announced = True
            self._notify(f"no worker yet; waiting for one up to {self._wait:g} s (--wait SECONDS)")


def _distribute(client: Client, workers: Workers, tasks: Tasks, solver: Solver | None) -> TaskResults:
    """Keep every worker busy with one task until the queue is empty."""
    from distributed import KilledWorker
    from distributed.protocol.pickle import dumps

    finished_futures: queue.SimpleQueue[Future[list[Record]]] = queue.SimpleQueue()
    running: dict[Future[list[Record]], tuple[str, Task, float]] = {}
    try:
        while tasks or running:
            usable_workers = workers.find_usable(bool(running))
            busy = {worker for worker, _, _ in running.values()}
            for worker in sorted(usable_workers - busy):
                if tasks:
                    task = tasks.next_task(len(usable_workers))
                    compressed_task = zlib.compress(dumps((task, solver)))
                    future = client.submit(solve_compressed_task, compressed_task, workers=[worker], pure=False)
                    running[future] = (worker, task, time.monotonic())
                    future.add_done_callback(finished_futures.put)
            lost_futures = [future for future, (worker, _, _) in running.items() if worker not in usable_workers]
            try:
                future = lost_futures[0] if lost_futures else finished_futures.get(timeout=RUN.poll_seconds)
                worker, task, start_time = running.pop(future)
            except (queue.Empty, KeyError):  # KeyError: the future of a lost worker
                continue
            error = future.exception() if future.status == "error" else None
            if future.status == "finished":
                with _report_lost_scheduler():
                    records = future.result()
                yield tasks.finish(task, records, time.monotonic() - start_time)
            elif future.status in ("cancelled", "lost"):
                raise StudyFileError(SCHEDULER_LOST)
            elif isinstance(error, ImportError):
                workers.exclude(worker, f"it cannot import contactstudy ({type(error).__name__}: {error})")
                tasks.return_task(task, died=False)
            elif error is not None and not isinstance(error, KilledWorker):
                raise error
            else:
                message = "WorkerDied: a second worker process died of this case, or of a film of its group"
                yield [Outcome(case, "failed", message, stored=False) for case in tasks.return_task(task, died=True)]
            future.release()
    finally:
        with contextlib.suppress(Exception):
            client.cancel(list(running), force=True)
