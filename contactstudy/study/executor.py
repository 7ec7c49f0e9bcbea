"""Where jobs are solved: in this process, on local worker processes, or on a cluster that runs already.

Every worker has one case at a time, so the death of a worker costs that one case.
"""

from __future__ import annotations

import contextlib
import logging
import os
import queue
import signal
import threading
from collections.abc import Callable, Generator, Iterator
from typing import TYPE_CHECKING, Any

from contactstudy import checks
from contactstudy.errors import InvalidInputError
from contactstudy.study.crew import Crew
from contactstudy.study.dispatch import Dispatcher
from contactstudy.study.errors import StudyFileError
from contactstudy.study.guard import UNGUARDED
from contactstudy.study.work import Job, Record, Solver, perform

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster
    from tornado.ioloop import IOLoop

# How often to look for workers that came or went while no case finishes.
POLL_SECONDS = 0.5

# How long a scheduler, and a new local worker, may take to answer.
START_SECONDS = 60.0

# How long to wait for a worker while a scheduler has none.
WAIT_SECONDS = 300.0

WORKER_ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "PYFFTW_NUM_THREADS": "1",
    "MALLOC_MMAP_THRESHOLD_": str(32 * 2**20),
    "MALLOC_TRIM_THRESHOLD_": str(512 * 2**20),
}
"""One thread per worker; and memory that arrays gave back is kept for the next ones.

Dask's own setting returns it to the system at once, which made cases twice as slow as in the parent's process.
"""

GONE = "the dask scheduler has gone away or was restarted; finished cases are kept, run again to go on"
CLOSE_SECONDS = 2.0
NOISY = ("distributed", "tornado", "asyncio")

SHORT_LOGS = {"distributed.admin.log-length": 20, "distributed.admin.low-level-log-length": 20}
"""Dask keeps its last thousands of messages, jobs and records in them, for its developers: 20 kB for every case."""


def execute(
    jobs: list[Job],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    wait: float = WAIT_SECONDS,
    solver: Solver | None = None,
    say: Callable[[str], None] = print,
) -> Generator[Record, None, None]:
    """Solve jobs and yield each one's record as it finishes.

    Parameters
    ----------
    jobs : list of Job
        What to solve.
    workers : int, optional
        Local processes; 0: this process; default: one per core that may be used.
    scheduler : str, optional
        Address of a dask scheduler instead.
    wait : float
        How long to wait for a worker while there is none, seconds.
    solver : callable, optional
        Called instead of the package's solver.
    say : callable
        Takes what the user should know while the run goes on.

    Raises
    ------
    StudyFileError
        If the scheduler does not answer, goes away, or has no worker that can be used.
    Exception
        Whatever a job raised that is no failure of a case; a note says which case it was.
    """
    if workers is not None:
        workers = checks.count("workers", workers, least=0)
    if isinstance(wait, bool) or not isinstance(wait, (int, float)) or not wait >= 0:
        raise InvalidInputError("wait", wait, "a number of seconds not below zero")
    if scheduler is not None:
        checks.instance("scheduler", scheduler, str, "the address of a dask scheduler, tcp://host:port")
    if not jobs:
        return
    if scheduler is None and workers == 0:
        for job in Dispatched(jobs):
            yield _perform_here(job, solver)
        return
    with _client(len(jobs), workers, scheduler, say) as client:
        yield from _drive(client, Crew(client, jobs[0].folder, wait, say), jobs, solver)


class Dispatched:
    """Jobs in the order in which a single worker takes them."""

    def __init__(self, jobs: list[Job]) -> None:
        self._dispatcher = Dispatcher(jobs)

    def __iter__(self) -> Iterator[Job]:
        """Yield every job once."""
        while (job := self._dispatcher.next_job("here")) is not None:
            yield job


def _perform_here(job: Job, solver: Solver | None) -> Record:
    try:
        return perform(job, solver)
    except Exception as error:
        error.add_note(f"while solving the case {job.name} ({job.id[:16]})")
        raise


@contextlib.contextmanager
def _client(jobs: int, workers: int | None, scheduler: str | None, say: Callable[[str], None]) -> Iterator[Client]:
    """Client of the given scheduler, or of local processes that end with the block."""
    if scheduler is not None:
        say(f"connecting to the dask scheduler at {scheduler}, for up to {START_SECONDS:g} s")
        with _client_of(scheduler) as client:
            yield client
        return
    import dask
    from distributed import Client

    settings = {
        **SHORT_LOGS,
        "distributed.scheduler.allowed-failures": 0,
        "distributed.comm.timeouts.connect": START_SECONDS,
        "distributed.worker.daemon": True,
        "distributed.nanny.pre-spawn-environ": WORKER_ENVIRONMENT,
    }
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    with (
        _silence(),
        dask.config.set(settings),
        _deaf_loop() as loop,
        _started(min(workers or cores, jobs), loop) as cluster,
        Client(cluster) as client,
    ):
        try:
            yield client
        except BaseException:
            _kill(cluster)
            raise


def _started(workers: int, loop: IOLoop) -> LocalCluster:
    """Return a cluster of local processes."""
    from distributed import LocalCluster

    older = set(_clusters())
    try:
        return LocalCluster(
            n_workers=workers,
            loop=loop,
            processes=True,
            threads_per_worker=1,
            dashboard_address=None,
            # Without an address of its own the scheduler insists on one port, and two studies at once collide.
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
            memory_limit=0,
            # A dying worker is a failed case with a reason of its own; pages of log would bury it.
            silence_logs=logging.CRITICAL,
        )
    except BaseException as error:
        # At the end of the process dask would close the cluster that has only begun to start, and fail.
        for cluster in set(_clusters()) - older:
            cluster.shutdown_on_close = False
        if isinstance(error, RuntimeError):
            raise StudyFileError(f"the worker processes did not start: {error} {UNGUARDED}") from None
        raise


def _clusters() -> list[Any]:
    """Clusters of this process that dask knows."""
    from distributed import SpecCluster

    return list(getattr(SpecCluster, "_instances", ()))


@contextlib.contextmanager
def _client_of(scheduler: str) -> Iterator[Client]:
    """Client of a scheduler that runs already."""
    from distributed.comm.core import CommClosedError

    with _silence():
        client = _connected(scheduler)
        try:
            yield client
        except (CommClosedError, TimeoutError) as error:
            raise StudyFileError(GONE) from error
        finally:
            with contextlib.suppress(Exception):
                client.close(timeout=CLOSE_SECONDS)


def _connected(scheduler: str) -> Client:
    """Client of a scheduler, or an error within its time: dask waits without end for what listens and says nothing."""
    import dask
    from distributed import Client

    found: list[Client] = []
    failed: list[Exception] = []

    def connect() -> None:
        try:
            with dask.config.set(SHORT_LOGS):
                found.append(Client(scheduler, timeout=START_SECONDS))
        except Exception as error:
            failed.append(error)

    thread = threading.Thread(target=connect, daemon=True)
    thread.start()
    thread.join(START_SECONDS + CLOSE_SECONDS)
    if found:
        return found[0]
    if not failed:
        raise StudyFileError(f"what listens at {scheduler} is no dask scheduler: it did not answer")
    (error,) = failed
    if isinstance(error, (OSError, ValueError)):
        raise StudyFileError(f"no dask scheduler answers at {scheduler}: {error}") from error
    raise StudyFileError(f"what answers at {scheduler} is no dask scheduler: {type(error).__name__}") from error


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keep the libraries' logs from the screen: what goes wrong is an error with a reason here."""
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] in NOISY]
    former = {name: logging.getLogger(name).level for name in names}
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for name, level in former.items():
            logging.getLogger(name).setLevel(level)


def _kill(cluster: LocalCluster) -> None:
    """End the workers of a local cluster at once: dask itself waits for the cases that they are solving."""
    for nanny in cluster.workers.values():
        with contextlib.suppress(Exception):
            nanny.auto_restart = False
            os.kill(nanny.pid, signal.SIGKILL)


@contextlib.contextmanager
def _deaf_loop() -> Iterator[IOLoop]:
    """Event loop in a thread that Ctrl-C does not reach, nor the processes that are started from it.

    A terminal sends Ctrl-C to all of them; only the process that was called is to deal with it.
    """
    from multiprocessing import resource_tracker

    from distributed.utils import LoopRunner

    resource_tracker.ensure_running()  # otherwise started with the first process, which it would make hear again
    runner = LoopRunner()
    if not hasattr(signal, "pthread_sigmask"):  # not on Windows
        runner.start()
    else:
        former = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            runner.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, former)
    try:
        yield runner.loop
    finally:
        runner.stop()


def _drive(client: Client, crew: Crew, jobs: list[Job], solver: Solver | None) -> Generator[Record, None, None]:
    """Keep every worker busy with one job until none is left."""
    from distributed import KilledWorker

    dispatcher = Dispatcher(jobs)
    finished: queue.SimpleQueue[Future[Record]] = queue.SimpleQueue()
    running: dict[Future[Record], tuple[str, Job]] = {}
    try:
        while dispatcher.waiting or running:
            _feed(client, crew, dispatcher, finished, running, solver)
            try:
                future = finished.get(timeout=POLL_SECONDS)
            except queue.Empty:
                continue
            worker, job = running.pop(future)
            error = future.exception() if future.status == "error" else None
            if future.status in ("cancelled", "lost"):
                raise StudyFileError(GONE)
            if error is None:
                yield future.result()
            elif isinstance(error, KilledWorker):
                dispatcher.forget(worker)
                message = "the worker process died while it solved this case"
                yield Record(job.id, "failed", 0.0, error="WorkerDied", message=message)
            else:
                error.add_note(f"while solving the case {job.name} ({job.id[:16]})")
                raise error
            future.release()
    finally:
        with contextlib.suppress(Exception):
            client.cancel(list(running), force=True)


def _feed(
    client: Client,
    crew: Crew,
    dispatcher: Dispatcher,
    finished: queue.SimpleQueue[Future[Record]],
    running: dict[Future[Record], tuple[str, Job]],
    solver: Solver | None,
) -> None:
    """Give a job to every worker that has none."""
    busy = {worker for worker, _ in running.values()}
    present = crew.ready(busy)
    for lost in dispatcher.owners - present:
        dispatcher.forget(lost)
    for worker in sorted(present - busy) if dispatcher.waiting else ():
        job = dispatcher.next_job(worker)
        if job is None:
            return
        # Were the worker gone by now, another one may take the job.
        future = client.submit(
            perform,
            job,
            solver,
            key=f"case-{job.id[:16]}-{id(dispatcher):x}",
            workers=[worker],
            allow_other_workers=True,
            pure=False,
            retries=0,
        )
        running[future] = (worker, job)
        future.add_done_callback(finished.put)
