"""A dask cluster whose scheduler and workers are separate processes, started as docs/how-to/cluster.md says."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from contactstudy.study.executor import WORKER_ENVIRONMENT
from tests.study.conftest import ROOT

ENVIRONMENT = WORKER_ENVIRONMENT | {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
SCHEDULER = "dask scheduler --port 0 --no-dashboard --scheduler-file scheduler.json"
WORKER = "dask worker --nthreads 1 --memory-limit 0 --no-dashboard --scheduler-file scheduler.json"


@contextlib.contextmanager
def cluster(folder: Path, workers: int = 2) -> Iterator[str]:
    """Start a scheduler and workers with `folder` as their working folder; yield the scheduler's address."""
    quiet = {
        "stdout": subprocess.DEVNULL,
        "stderr": subprocess.DEVNULL,
        "cwd": folder,
        "env": os.environ | ENVIRONMENT | {"PYTHONPATH": str(ROOT)},  # workers import the tests' stand-in solver
    }
    commands = [[sys.executable, "-m", *command.split()] for command in (SCHEDULER, *[WORKER] * workers)]
    processes = [subprocess.Popen(command, **quiet) for command in commands]
    try:
        file, end = folder / "scheduler.json", time.monotonic() + 60
        while not file.exists():
            assert time.monotonic() < end, "the scheduler did not start"
            time.sleep(0.05)
        yield json.loads(file.read_text())["address"]
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            process.wait(timeout=30)
