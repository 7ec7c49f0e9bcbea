"""Where jobs are solved: in this process, on local worker processes, or on a cluster that runs already.

Every worker has one case at a time, so the death of a worker costs that one case.
"""

from __future__ import annotations

import contextlib
import os
import queue
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from contactstudy import checks
from contactstudy.study.dispatch import Dispatcher
from contactstudy.study.errors import StudyFileError
from contactstudy.study.work import Job, Record, Solver, perform

if TYPE_CHECKING:
    from distributed import Client, Future, WorkerPlugin

POLL_SECONDS = 0.5
"""How often to look for workers that came or went while no case finishes."""
START_SECONDS = 60.0
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

SHORT_LOGS = {"distributed.admin.log-length": 20, "distributed.admin.low-level-log-length": 20}
"""Dask keeps its last thousands of messages, jobs and records in them, for its developers: 20 kB for every case."""


def execute(
    jobs: list[Job], *, workers: int | None = None, scheduler: str | None = None, solver: Solver | None = None
) -> Iterator[Record]:
    """Solve jobs and yield each one's record as it finishes.

    Parameters
    ----------
    jobs : list of Job
        What to solve.
    workers : int, optional
        Local processes; 0: this process; default: one per core that may be used.
    scheduler : str, optional
        Address of a dask scheduler instead.
    solver : callable, optional
        Called instead of the package's solver.

    Raises
    ------
    Exception
        Whatever a job raised that is no failure of a case; a note says which case it was.
    """
    if workers is not None:
        workers = checks.count("workers", workers, least=0)
    if not jobs:
        return
    if scheduler is None and workers == 0:
        for job in Dispatched(jobs):
            yield _perform_here(job, solver)
        return
    with _client(len(jobs), workers, scheduler) as client:
        yield from _drive(client, jobs, solver)


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
def _client(jobs: int, workers: int | None, scheduler: str | None) -> Iterator[Client]:
    """Client of the given scheduler, or of local processes that end with the block."""
    import logging

    import dask
    from distributed import Client, LocalCluster

    if scheduler is not None:
        try:
            with dask.config.set(SHORT_LOGS):
                client = Client(scheduler, timeout=START_SECONDS)
        except (OSError, ValueError) as error:
            raise StudyFileError(f"no dask scheduler answers at {scheduler}: {error}") from error
        with client:
            yield client
        return
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    settings = {
        **SHORT_LOGS,
        "distributed.scheduler.allowed-failures": 0,
        "distributed.comm.timeouts.connect": START_SECONDS,
        "distributed.worker.daemon": True,
        "distributed.nanny.pre-spawn-environ": WORKER_ENVIRONMENT,
    }
    # A dying worker is a failed case with a reason of its own; the libraries' pages of log would bury it.
    quiet = logging.CRITICAL
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=min(workers or cores, jobs),
            processes=True,
            threads_per_worker=1,
            dashboard_address=None,
            # Without an address of its own the scheduler insists on one port, and two studies at once collide.
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
            memory_limit=0,
            silence_logs=quiet,
        ) as cluster,
        Client(cluster) as client,
    ):
        client.register_plugin(_interrupt_plugin())
        yield client


def _interrupt_plugin() -> WorkerPlugin:
    """Leave Ctrl-C, which a terminal sends to the workers as well, to the process that started them."""
    import signal

    from distributed import WorkerPlugin

    class LeaveInterrupts(WorkerPlugin):
        def setup(self, worker: Any) -> None:
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    return LeaveInterrupts()


def _drive(client: Client, jobs: list[Job], solver: Solver | None) -> Iterator[Record]:
    """Keep every worker busy with one job until none is left."""
    from distributed import KilledWorker

    dispatcher = Dispatcher(jobs)
    finished: queue.SimpleQueue[Future[Record]] = queue.SimpleQueue()
    running: dict[Future[Record], tuple[str, Job]] = {}
    try:
        while dispatcher.waiting or running:
            _feed(client, dispatcher, finished, running, solver)
            try:
                future = finished.get(timeout=POLL_SECONDS)
            except queue.Empty:
                continue
            worker, job = running.pop(future)
            error = future.exception() if future.status == "error" else None
            if future.status == "cancelled":
                raise StudyFileError("the dask scheduler dropped a case: has it been restarted?")
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
    dispatcher: Dispatcher,
    finished: queue.SimpleQueue[Future[Record]],
    running: dict[Future[Record], tuple[str, Job]],
    solver: Solver | None,
) -> None:
    """Give a job to every worker that has none."""
    if not dispatcher.waiting:
        return
    busy = {worker for worker, _ in running.values()}
    present: dict[str, Any] = client.nthreads()
    for lost in dispatcher.owners - set(present):
        dispatcher.forget(lost)
    for worker in sorted(set(present) - busy):
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
