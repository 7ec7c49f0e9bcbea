"""Settings of the test runs: plugins, hypothesis' profiles, and limits on the environment."""

from __future__ import annotations

import os
from collections.abc import Generator
from pathlib import Path

import pytest
from _pytest.doctest import DoctestModule
from hypothesis import settings

pytest_plugins = ("tests.no_silent_skip", "tests.documentation.blocks", "tests.documentation.notebooks")

# The tests run in parallel, one process on each core, so each process has one thread of BLAS.
for prefix in ("OMP", "OPENBLAS", "MKL", "PYFFTW"):
    os.environ.setdefault(f"{prefix}_NUM_THREADS", "1")
# Figures are drawn to files, with and without a screen.
os.environ.setdefault("MPLBACKEND", "Agg")
# Long timeouts of dask: no test depends on the load of the machine.
for name in ("COMM__TIMEOUTS__CONNECT", "COMM__TIMEOUTS__TCP", "DEPLOY__LOST_WORKER_TIMEOUT"):
    os.environ.setdefault(f"DASK_DISTRIBUTED__{name}", "300s")
# dask silences numpy's warnings about empty slices with `warnings.catch_warnings`, which is not safe between threads.
os.environ.setdefault("DASK_SCHEDULER", "synchronous")

# Examples have no deadline, because times depend on the machine. CI is reproducible: its examples are constant.
settings.register_profile("local", max_examples=20, deadline=None)
settings.register_profile("CI", max_examples=60, deadline=None, derandomize=True)
settings.load_profile("CI" if os.environ.get("CI") else "local")


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path: Path) -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
    """Exclude modules without examples from doctest, which would import them."""
    collectors = yield
    if file_path.suffix == ".py" and ">>>" not in file_path.read_text(encoding="utf-8"):
        return [collector for collector in collectors if not isinstance(collector, DoctestModule)]
    return collectors
