"""Engine of a run: this process, local worker processes, or a dask cluster."""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contactstudy import checks
from contactstudy.errors import InvalidInputError
from contactstudy.study.errors import StudyFileError
from contactstudy.study.settings import RUN
from contactstudy.study.worker import Solver

if TYPE_CHECKING:
    from distributed import Client, LocalCluster
    from tornado.ioloop import IOLoop

WAIT_SECONDS = 300.0  # Longest wait for a worker while a scheduler has none

WORKER_ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "PYFFTW_NUM_THREADS": "1",
    "MALLOC_MMAP_THRESHOLD_": str(32 * 2**20),
    "MALLOC_TRIM_THRESHOLD_": str(512 * 2**20),
}
"""Environment of a worker: one thread, and freed memory of arrays stays with the process (half the time of a case)."""

# Dask's logs of messages, tasks and records grow with the number of cases.
SHORT_LOGS = {"distributed.admin.log-length": 20, "distributed.admin.low-level-log-length": 20}

SCHEDULER_LOST = "the dask scheduler has gone away or was restarted; finished cases remain, run again to continue"

START = (
    "A script that runs a study needs the guard `if __name__ == '__main__':` around the run, because worker processes "
    "import the script; every worker needs about 20 open files (ulimit -n); workers=0 solves in one process"
)


def refuse_in_a_worker() -> None:
    """End a worker process that imports a script without a guard, and would run the script's study."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(1)


@dataclass(frozen=True, kw_only=True)
class Engine:
    """Processes that solve the tasks of a run."""

    workers: int | None = None  # local processes; 0: this process; None: one per core
    scheduler: str | Client | None = None  # address of a dask scheduler, or a client of it, instead of local processes
    wait: float = WAIT_SECONDS  # longest wait for a worker while a scheduler has none, seconds
    solver: Solver | None = None  # called instead of `contactstudy.solve`

    def __post_init__(self) -> None:
        """Check the values."""
        if self.workers is not None:
            checks.count("workers", self.workers, least=0)
        if isinstance(self.wait, bool) or not isinstance(self.wait, (int, float)) or not self.wait >= 0:
            raise InvalidInputError("wait", self.wait, "a number of seconds >= 0")
        if self.scheduler is not None and not isinstance(self.scheduler, str):
            from distributed import Client

            checks.instance("scheduler", self.scheduler, Client, "a distributed.Client, or an address tcp://host:port")
            if self.scheduler.asynchronous:
                raise InvalidInputError("scheduler", self.scheduler, "a client that is not asynchronous")

    @property
    def processes(self) -> int:
        """Number of local processes."""
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        return cores if self.workers is None else self.workers

    @contextlib.contextmanager
    def client(self, cases: int, notify: Callable[[str], None]) -> Iterator[Client]:
        """Client of the scheduler, or of local processes for some `cases`, which end with the block."""
        if self.scheduler is None:
            with _local_client(min(self.processes, cases)) as client:
                yield client
        elif isinstance(self.scheduler, str):
            notify(f"connecting to the dask scheduler at {self.scheduler}, for up to {RUN.start_seconds:g} s")
            with _silent_libraries():
                client = _connect(self.scheduler)
                try:
                    with _lost_connections():
                        yield client
                finally:
                    with contextlib.suppress(Exception):
                        client.close(timeout=RUN.close_seconds)
        else:
            with _lost_connections():
                yield self.scheduler


@contextlib.contextmanager
def _lost_connections() -> Iterator[None]:
    """Errors of a connection that ends become :class:`StudyFileError`."""
    from distributed.comm.core import CommClosedError

    try:
        yield
    except (CommClosedError, TimeoutError) as error:
        raise StudyFileError(SCHEDULER_LOST) from error


def _connect(scheduler: str) -> Client:
    """Client of a scheduler, within a time limit: dask waits endlessly for a listener that does not answer."""
    import dask
    from distributed import Client

    clients: list[Client] = []
    errors: list[Exception] = []

    def connect() -> None:
        try:
            with dask.config.set(SHORT_LOGS):
                clients.append(Client(scheduler, timeout=RUN.start_seconds))
        except Exception as error:
            errors.append(error)

    thread = threading.Thread(target=connect, daemon=True)
    thread.start()
    thread.join(RUN.start_seconds + RUN.close_seconds)
    if clients:
        return clients[0]
    if not errors:
        raise StudyFileError(f"no dask scheduler at {scheduler}: the listener did not answer")
    (error,) = errors
    if isinstance(error, (OSError, ValueError)):
        raise StudyFileError(f"no dask scheduler answers at {scheduler}: {error}") from error
    raise StudyFileError(f"no dask scheduler at {scheduler}: {type(error).__name__}") from error


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
    from distributed import LocalCluster

    older = set(_clusters())
    try:
        return LocalCluster(
            n_workers=workers,
            loop=loop,
            processes=True,
            threads_per_worker=1,
            dashboard_address=None,
            # The default is one fixed port, on which two studies collide.
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
    except BaseException as error:
        # At the end of the process dask would close the half-started cluster, and fail.
        for cluster in set(_clusters()) - older:
            cluster.shutdown_on_close = False
        if isinstance(error, RuntimeError | OSError):
            raise StudyFileError(f"the worker processes did not start: {error} {START}") from None
        raise


def _clusters() -> list[Any]:
    """Dask clusters of this process."""
    from distributed import SpecCluster

    return list(getattr(SpecCluster, "_instances", ()))


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
    """Event loop in a thread that blocks SIGINT, as do its processes: a terminal sends Ctrl-C to the whole group."""
    from multiprocessing import resource_tracker

    from distributed.utils import LoopRunner

    resource_tracker.ensure_running()  # the first process would start it, and unblock the signal
    runner = LoopRunner()
    if not hasattr(signal, "pthread_sigmask"):  # Windows
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
