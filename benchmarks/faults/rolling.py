"""A study of rolling cases, killed and resumed, against an undisturbed run, bit for bit.

``python -m benchmarks.faults.rolling --cases 500`` compares every case, with one process and with several.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr

from contactstudy.study import Study, open_study
from contactstudy.study.folder import Folder
from tests.small_study import BASE, format_toml
from tests.study.conftest import ROOT

LONGITUDINAL_CREEPAGES, LATERAL_CREEPAGES = 25, 5
"""Numbers of creepages; the number of frictions completes the number of cases."""

SECONDS = 3600.0
"""Longest wait for a run."""


def rolling_study(cases: int) -> Study:
    """Return a study of this many cases of steady rolling on a half-space, without the slow certificate of ends."""
    creepages = min(cases, LONGITUDINAL_CREEPAGES)
    lateral = min(LATERAL_CREEPAGES, cases // creepages)
    frictions = cases // (creepages * lateral)
    return Study(
        name="rolling",
        level="surface",
        base={name: value for name, value in BASE.items() if not name.startswith("field_")}
        | {"cells_x": 8, "cells_y": 16, "motion": "rolling", "e_over_a": 0.5, "stresses": False, "body": "half-space"},
        sweep={
            "longitudinal_creepage": np.linspace(0.0, 3e-3, creepages).tolist(),
            "lateral_creepage": np.linspace(0.0, 1e-3, lateral).tolist(),
            "friction": np.linspace(0.1, 0.4, frictions).tolist(),
        },
    )


def start_process(folder: Path, workers: int) -> subprocess.Popen[str]:
    """Start or resume the study in a folder, in a new group of processes."""
    command = ["run", str(folder / "study.toml"), "--out", str(folder / "out"), "--no-figure"]
    return subprocess.Popen(
        [sys.executable, "-m", "contactstudy.cli", *command, "--workers", str(workers)],
        cwd=ROOT,
        start_new_session=True,
        text=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )


def count_finished(folder: Path) -> int:
    """Number of cases that are done."""
    return len(Folder(folder / "out").results().cases)


def run_study(study: Study, folder: Path, workers: int, kill_at: int | None = None) -> xr.Dataset:
    """Values of a study without the times; the run is killed after `kill_at` cases, and resumed."""
    folder.mkdir()
    (folder / "study.toml").write_text(format_toml(study))
    if kill_at is not None:
        process = start_process(folder, workers)
        deadline = time.monotonic() + SECONDS
        while count_finished(folder) < kill_at and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        assert kill_at <= count_finished(folder) < study.size, "the run ended before it was killed"
    process = start_process(folder, workers)
    _, errors = process.communicate(timeout=SECONDS)
    assert process.returncode == 0, errors
    return open_study(folder / "out").drop_vars("seconds").load()


def list_differing_variables(dataset: xr.Dataset, other_dataset: xr.Dataset) -> list[str]:
    """Variables in which two studies differ in any bit."""
    names = {*dataset.variables, *other_dataset.variables}
    return sorted(
        str(name)
        for name in names
        if name not in dataset or name not in other_dataset or not dataset[name].identical(other_dataset[name])
    )


def main() -> int:
    """Compare the requested runs."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults.rolling", description=__doc__)
    parser.add_argument("--cases", type=int, default=500, help="number of cases")
    study = rolling_study(parser.parse_args().cases)
    differences: list[str] = []
    with tempfile.TemporaryDirectory(prefix="rolling-") as name:
        undisturbed_dataset = run_study(study, Path(name) / "undisturbed", 0)
        print(f"{study.size} cases, {int(undisturbed_dataset['converged'].sum())} converged", flush=True)
        for workers in (0, 2, 3):
            resumed_study = run_study(study, Path(name) / f"workers-{workers}", workers, study.size // 2)
            differing_names = list_differing_variables(undisturbed_dataset, resumed_study)
            differences += differing_names
            print(
                f"killed in the middle and resumed, workers = {workers}: {differing_names or 'all bits equal'}",
                flush=True,
            )
    return int(bool(differences))


if __name__ == "__main__":
    raise SystemExit(main())
