"""A study in a folder that two systems share: another host, or another container of this host."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
from pathlib import Path

import xarray as xr

from benchmarks.faults import studies
from benchmarks.faults.studies import CASES, SECONDS
from benchmarks.faults.table import Row
from tests.stand_in_solver import give_tickets
from tests.study.conftest import locate_tickets, start_run


def _format_host_command(host_name: str) -> list[str]:
    """Prefix of a command that runs in a system with the host's `name` and separate process numbers."""
    separation = ["unshare", "--uts", "--pid", "--fork", "--kill-child", "--mount-proc"]
    return [*separation, "sh", "-c", 'hostname "$0" && exec "$@"', host_name]


def run_on_two_hosts(undisturbed: xr.Dataset, count: int) -> Row:
    """A second run on this system during the first run on another; the first run ends, or is killed."""
    fault = "a run in another host or container that shares the folder"
    host_names = ["another-host", socket.gethostname()]
    is_possible = (
        shutil.which("unshare")
        and not subprocess.run(
            [*_format_host_command(host_names[0]), "true"], capture_output=True, check=False
        ).returncode
    )
    if not is_possible:
        return Row(fault, 0, 0, "not tried: no right to make a system with another name")
    passed_count = sum(_survives(undisturbed, host_names[index % 2], killed=index % 4 > 1) for index in range(count))
    description = "code 2, its host named, it ends bit for bit; after a kill its lock is free, resumed bit for bit"
    return Row(fault, count, passed_count, description)


def _survives(undisturbed: xr.Dataset, host_name: str, *, killed: bool) -> bool:
    """Whether each case is solved once, to the last bit of an undisturbed run."""
    with studies.make_study_folder() as folder:
        outputs, study = folder / "out", folder / "study.toml"
        first_run = start_run(study, outputs, "--workers", "0", tickets=2, prefix=_format_host_command(host_name))
        studies.wait(first_run, lambda: len(studies.list_finished_cases(folder)) == 2)
        is_right = _is_refused(folder, host_name)
        if killed:
            os.killpg(first_run.pid, signal.SIGKILL)
            first_run.communicate()
            is_right = is_right and len(studies.list_finished_cases(folder)) == 2
            is_right = is_right and studies.resume_study(folder) == {"ok": CASES}
        else:
            give_tickets(locate_tickets(outputs), CASES)
            first_run.communicate(timeout=SECONDS)
            is_right = is_right and first_run.returncode == 0 and not studies.list_leftovers(folder)
        return is_right and studies.read_values(folder).identical(undisturbed)


def _is_refused(folder: Path, host_name: str) -> bool:
    """Whether a run on this system is refused with a message that names the lock's holder."""
    second_run = studies.start(folder, "--workers", "0")
    _, errors = second_run.communicate(timeout=SECONDS)
    return second_run.returncode == 2 and f" on {host_name} since" in errors and "Traceback" not in errors
