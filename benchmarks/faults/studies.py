"""Studies of the stand-in solver in processes for the faults, and the values of an undisturbed study."""

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

from contactstudy.cli import main
from contactstudy.study import open_study, run_study, worker
from contactstudy.study.batches import batch_paths, find_damage
from contactstudy.study.folder import Folder
from contactstudy.study.settings import RunSettings
from tests.small_study import format_toml, small_study
from tests.stand_in_solver import HELD, solve_fake
from tests.study.conftest import ROOT

SWEEP = {"e_over_a": [0.0, 0.5, 1.0, 1.5], "friction": [0.0, 0.1, 0.2, 0.3, 0.4]}
STUDY = small_study("faults", sweep=SWEEP)
CASES = 20
SECONDS = 300.0
"""Longest wait for another process."""


@contextmanager
def make_study_folder() -> Iterator[Path]:
    """Folder with the study as a file."""
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = Path(name)
        (folder / "study.toml").write_text(format_toml(STUDY))
        yield folder


def start(folder: Path, *options: str, largest_file: int | None = None) -> subprocess.Popen[str]:
    """Start the study, in a new group of processes; files may have at most `largest_file` bytes."""

    def limit_file_size() -> None:
        assert largest_file is not None
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))

    command = ["run", str(folder / "study.toml"), "--out", str(folder / "out"), "--no-figure", *options]
    return subprocess.Popen(
        [sys.executable, "-m", "tests.study.fake_run", *command],
        cwd=ROOT,
        env={name: value for name, value in os.environ.items() if name != HELD},
        start_new_session=True,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=limit_file_size if largest_file is not None else None,
    )


class Forked:
    """Run of the study in a fork of this process, which has imported the package already."""

    returncode: int | None = None

    def __init__(self, folder: Path) -> None:
        self.pid = os.fork()
        if self.pid:
            return
        os.setsid()
        null_device = os.open(os.devnull, os.O_RDWR)
        os.dup2(null_device, 1)
        os.dup2(null_device, 2)
        worker.RUN = RunSettings(save_seconds=0.0)  # type: ignore[attr-defined] # an import of the module
        command = ["run", str(folder / "study.toml"), "--out", str(folder / "out"), "--no-figure", "--workers", "0"]
        os._exit(main(command, solver=solve_fake))

    def poll(self, options: int = os.WNOHANG) -> int | None:
        """Return the exit code, or None while the process runs."""
        if self.returncode is None:
            pid, status = os.waitpid(self.pid, options)
            self.returncode = os.waitstatus_to_exitcode(status) if pid else None
        return self.returncode

    def communicate(self, timeout: float | None = None) -> tuple[str, str]:
        """Wait for the end of the process."""
        self.poll(0)
        return "", ""


def batches(folder: Path) -> list[Path]:
    """Batches of the study."""
    return batch_paths(folder / "out" / "batches")


def list_finished_cases(folder: Path) -> dict[str, int]:
    """Identities of the cases that are done, with the number of the run that solved them."""
    return Folder(folder / "out").results().cases["run"].to_dict()


def count_damaged_batches(folder: Path) -> int:
    """Number of damaged batches."""
    return sum(bool(find_damage(path)) for path in batches(folder))


def resume_study(folder: Path) -> dict[str, int]:
    """Run the study to its end, in this process; counts by state."""
    return dict(run_study(STUDY, folder / "out", workers=0, solver=solve_fake).counts)


def read_values(folder: Path) -> xr.Dataset:
    """Return the opened study without its times."""
    return open_study(folder / "out").drop_vars("seconds").load()


def list_leftovers(folder: Path) -> list[Path | str]:
    """Partial files and held locks, absent after a run."""
    out = folder / "out"
    return [*out.glob("**/*.part"), *Folder(out).holders]


def compute_undisturbed_values() -> xr.Dataset:
    """Return the opened study of a run without faults."""
    with make_study_folder() as folder:
        assert resume_study(folder) == {"ok": CASES}
        return read_values(folder)


def wait(process: subprocess.Popen[str] | Forked, condition: Callable[[], object]) -> None:
    """Wait for a condition, or for the successful end of the process."""
    deadline = time.monotonic() + SECONDS
    while not condition():
        if process.poll() is not None:
            assert process.returncode == 0, process.communicate()
            return
        assert time.monotonic() < deadline, "waited too long"
        time.sleep(0.02)  # shorter intervals would slow the other process on a single core
