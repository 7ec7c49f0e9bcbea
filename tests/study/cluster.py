"""A dask cluster with separate processes of scheduler and workers, as in docs/how-to/cluster.md."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from contactstudy.study.engine import WORKER_ENVIRONMENT
from tests.study.conftest import ROOT

ENVIRONMENT = WORKER_ENVIRONMENT | {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
SCHEDULER = "dask scheduler --port 0 --no-dashboard --scheduler-file scheduler.json"
WORKER = "dask worker --nthreads 1 --memory-limit 0 --no-dashboard --scheduler-file scheduler.json"


class Cluster(str):
    """Address of a scheduler, with the processes of the cluster; the first one is the scheduler."""

    processes: list[subprocess.Popen[bytes]]


@contextlib.contextmanager
def cluster(folder: Path, workers: int = 2, *, outdated_workers: int = 0) -> Iterator[Cluster]:
    """Start a scheduler and workers with `folder` as their working folder; yield the scheduler's address.

    Outdated workers have version 0.0.0 of the package.
    """
    metadata = folder / "lame" / "contactstudy-0.0.0.dist-info" / "METADATA"
    metadata.parent.mkdir(parents=True, exist_ok=True)
    metadata.write_text("Metadata-Version: 2.1\nName: contactstudy\nVersion: 0.0.0\n")

    def start(command: str, path: Path) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", *command.split()],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=folder,
            env=os.environ | ENVIRONMENT | {"PYTHONPATH": str(path)},  # workers import the tests' stand-in solver
            start_new_session=True,
        )

    processes = [start(SCHEDULER, ROOT), *(start(WORKER, ROOT) for _ in range(workers))]
    processes += [start(WORKER, folder / "lame") for _ in range(outdated_workers)]
    try:
        address = Cluster(_read_address(folder / "scheduler.json"))
        address.processes = processes
        yield address
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            # A nanny that is restarting its worker ignores SIGTERM: its whole group ends.
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(timeout=20)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def _read_address(file: Path) -> str:
    """Address in a scheduler's file, which is absent or incomplete until the scheduler has started."""
    deadline = time.monotonic() + 300
    while True:
        with contextlib.suppress(FileNotFoundError, json.JSONDecodeError):
            return str(json.loads(file.read_text())["address"])
        assert time.monotonic() < deadline, "the scheduler did not start"
        time.sleep(0.05)
