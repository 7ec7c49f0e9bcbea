"""Studies of tiny cases with the stand-in solver, in processes that can be killed, and the same without faults."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import xarray as xr

from contactstudy import ContactStudyError
from contactstudy.study import open_study, run_study
from contactstudy.study.store import read_header
from tests.small_study import as_toml, small_study
from tests.stand_in_solver import HELD, solve_fake
from tests.study.conftest import ROOT

SWEEP = {"e_over_a": [0.0, 0.5, 1.0, 1.5], "friction": [0.0, 0.1, 0.2, 0.3, 0.4]}
STUDY = small_study("faults", sweep=SWEEP)
CASES = 20
SECONDS = 300.0
"""Longest wait for another process."""


@contextmanager
def place() -> Iterator[Path]:
    """A folder of its own, with the study as a file in it."""
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = Path(name)
        (folder / "study.toml").write_text(as_toml(STUDY))
        yield folder


def start(folder: Path, *more: str, largest_file: int | None = None) -> subprocess.Popen[str]:
    """Start the study, in a new group of processes; files may have at most `largest_file` bytes."""

    def limited() -> None:
        assert largest_file is not None
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))

    command = ["run", str(folder / "study.toml"), "--out", str(folder / "out"), "--no-figure", *more]
    return subprocess.Popen(
        [sys.executable, "-m", "tests.study.fake_run", *command],
        cwd=ROOT,
        env={name: value for name, value in os.environ.items() if name != HELD},
        start_new_session=True,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=limited if largest_file is not None else None,
    )


def finished(folder: Path) -> list[Path]:
    """Files of the cases that are done."""
    return sorted((folder / "out" / "cases").glob("*.nc"))


def unreadable(folder: Path) -> int:
    """Number of files of cases that are not whole."""
    count = 0
    for path in finished(folder):
        try:
            read_header(path, verify=True)
        except ContactStudyError:
            count += 1
    return count


def resume(folder: Path) -> dict[str, int]:
    """Run the study to its end, in this process; counts by state."""
    return dict(run_study(STUDY, folder / "out", workers=0, solver=solve_fake).counts)


def values(folder: Path) -> xr.Dataset:
    """What the study holds, but for the times."""
    return open_study(folder / "out").drop_vars("seconds").load()


def left_over(folder: Path) -> list[Path]:
    """What a run must not leave behind: its lock and parts of files."""
    out = folder / "out"
    return [*out.glob("**/*.part-*"), *([out / "run.lock"] if (out / "run.lock").exists() else [])]


def calm_values() -> xr.Dataset:
    """What the study holds if nothing happens."""
    with place() as folder:
        assert resume(folder) == {"ok": CASES}
        return values(folder)


def wait(process: subprocess.Popen[str], condition: Callable[[], object]) -> None:
    """Wait until something is the case; an error if the process ends before, but with success."""
    end = time.monotonic() + SECONDS
    while not condition():
        if process.poll() is not None:
            assert process.returncode == 0, process.communicate()
            return
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.005)
