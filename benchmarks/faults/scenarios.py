"""Faults of a study, and checks of the state after each fault."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from unittest import mock

import xarray as xr

from benchmarks.faults import studies
from benchmarks.faults.studies import CASES, SECONDS, STUDY
from benchmarks.faults.table import Row
from contactstudy.study import run_study
from contactstudy.study.batches import read_batch
from contactstudy.study.folder import Folder
from tests.small_study import format_toml
from tests.stand_in_solver import HELD, give_tickets, solve_fake
from tests.study.cluster import cluster
from tests.study.conftest import locate_tickets, start_run

rng = random.Random(17)


def kill_runs(undisturbed: xr.Dataset, count: int, *, workers: int = 0) -> Row:
    """SIGKILL to the run and its workers, at a random time."""
    passed_count = kept_count = 0
    run_seconds = _measure_run_seconds(workers)
    with studies.make_study_folder() as folder:
        for _ in range(count):
            if len(studies.list_finished_cases(folder)) > 0.7 * CASES:  # cases remain unsolved until the last kill
                shutil.rmtree(folder / "out" / "batches")
            cases_before = studies.list_finished_cases(folder)
            process = _start_until_batch(folder, workers)
            studies.wait(process, partial(_holds_the_lock, process.pid, folder / "out"))
            time.sleep(rng.uniform(0.0, run_seconds))
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            cases_after = studies.list_finished_cases(folder)
            kept_count += len(set(cases_after) - set(cases_before))
            lost_cases = [identity for identity, run in cases_before.items() if cases_after.get(identity) != run]
            passed_count += not lost_cases and not studies.count_damaged_batches(folder)
        complete = studies.resume_study(folder) == {"ok": CASES}
        complete &= studies.read_values(folder).identical(undisturbed)
        complete &= not studies.list_leftovers(folder) and not (folder / "out" / "set-aside").exists()
    worker_text = "alone" if workers == 0 else f"with {workers} workers"
    result = (
        f"no written case lost or solved again ({kept_count} between the kills), every batch intact; resumed "
        f"{'bit for bit, nothing left behind' if complete else 'WRONGLY'}"
    )
    return Row(f"run {worker_text}: SIGKILL at a random moment", count, passed_count if complete else 0, result)


def _start_until_batch(folder: Path, workers: int) -> subprocess.Popen[str] | studies.Forked:
    """Begin a run: alone in a fork of this process, or with its workers in new processes."""
    return studies.start(folder, "--workers", str(workers)) if workers else studies.Forked(folder)


def _measure_run_seconds(workers: int) -> float:
    """Time from the lock to the end of an undisturbed run, on this machine."""
    with studies.make_study_folder() as folder:
        process = _start_until_batch(folder, workers)
        studies.wait(process, partial(_holds_the_lock, process.pid, folder / "out"))
        start_time = time.monotonic()
        process.communicate(timeout=SECONDS)
        return time.monotonic() - start_time


def fill_disks(undisturbed: xr.Dataset, count: int) -> Row:
    """A full file system; without the right to mount one, a limit on the size of files."""
    passed_count = cases = 0
    is_mounted = False
    for _ in range(count):
        with studies.make_study_folder() as folder:
            disk = folder / "out"
            disk.mkdir()
            size = rng.randint(150, 500)
            mount = ["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", str(disk)]
            can_mount = shutil.which("mount") and not subprocess.run(mount, capture_output=True, check=False).returncode
            is_mounted = is_mounted or bool(can_mount)
            try:
                process = studies.start(
                    folder, "--workers", "0", largest_file=None if can_mount else rng.randint(3000, 9000)
                )
                _, errors = process.communicate(timeout=SECONDS)
                is_reported = process.returncode == 2 and "Traceback" not in errors
                cases += len(studies.list_finished_cases(folder))
                is_correct = (
                    is_reported and not studies.list_leftovers(folder) and not studies.count_damaged_batches(folder)
                )
                if can_mount:
                    subprocess.run(["mount", "-o", "remount,size=50m", str(disk)], check=True)
                is_correct = is_correct and studies.resume_study(folder) == {"ok": CASES}
                passed_count += is_correct and studies.read_values(folder).identical(undisturbed)
            finally:
                if can_mount:
                    subprocess.run(["umount", "-l", str(disk)], check=True)
    medium = "file system of 150 to 500 kB" if is_mounted else "limit on the size of files (no right to mount)"
    return Row(
        f"full disk: {medium}",
        count,
        passed_count,
        f"code 2 and a message, no traceback, no lock held and no torn file left, {cases} cases kept in all; "
        "resumed with room, bit for bit",
    )


def kill_schedulers(undisturbed: xr.Dataset, count: int) -> Row:
    """The scheduler of a cluster is killed while its worker solves."""
    passed_count = 0
    for _ in range(count):
        with studies.make_study_folder() as folder:
            outputs = folder / "out"
            with (
                mock.patch.dict(os.environ, {HELD: str(locate_tickets(outputs))}),
                cluster(folder, workers=1) as address,
            ):
                tickets = rng.randint(1, 20)
                process = start_run(folder / "study.toml", outputs, "--scheduler", address, tickets=tickets)
                studies.wait(process, partial(studies.list_finished_cases, folder))
                time.sleep(rng.uniform(0.0, 1.0))
                address.processes[0].kill()
                _, errors = process.communicate(timeout=SECONDS)
            is_correct = process.returncode == 2 and "scheduler has gone away" in errors and "Traceback" not in errors
            is_correct = is_correct and not Folder(outputs).holders and not studies.count_damaged_batches(folder)
            is_correct = is_correct and studies.resume_study(folder) == {"ok": CASES}
            passed_count += is_correct and studies.read_values(folder).identical(undisturbed)
    return Row(
        "scheduler of a cluster killed", count, passed_count, "code 2, message, no lock held; resumed bit for bit"
    )


def damage_batches(undisturbed: xr.Dataset, count: int) -> Row:
    """Files of batches are cut off, changed, exchanged, or replaced by other files."""
    passed_count = 0
    with studies.make_study_folder() as folder:
        set_aside_folder = folder / "out" / "set-aside"
        for index in range(count):
            shutil.rmtree(folder / "out", ignore_errors=True)
            with mock.patch.object(Folder, "compact", return_value=None):
                studies.resume_study(folder)  # without joining, the folder contains several batches
            path, second_path = rng.sample(studies.batches(folder), 2)
            lost_cases = len(read_batch(path))
            DAMAGES[index % len(DAMAGES)](path, second_path)
            report = run_study(STUDY, folder / "out", workers=0, solver=solve_fake)
            is_correct = (
                report.counts == {"ok": CASES}
                and report.solved == lost_cases
                and not studies.count_damaged_batches(folder)
            )
            passed_count += (
                is_correct
                and len(list(set_aside_folder.iterdir())) == 1
                and studies.read_values(folder).identical(undisturbed)
            )
    return Row(
        "a batch torn, with changed bytes, empty, a text, a folder, exchanged with another or a dangling link",
        count,
        passed_count,
        "set aside with a message, its cases alone solved again, bit for bit",
    )


def _tear_file(path: Path, other_batch_path: Path) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: rng.randrange(len(data))])


def _change_bytes(path: Path, other_batch_path: Path) -> None:
    data = bytearray(path.read_bytes())
    for _ in range(8):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    path.write_bytes(bytes(data))


def _write_foreign_text(path: Path, other_batch_path: Path) -> None:
    path.write_text("not ours")


def _write_empty(path: Path, other_batch_path: Path) -> None:
    path.write_bytes(b"")


def _exchange_files(path: Path, other_batch_path: Path) -> None:
    shutil.copy(other_batch_path, path)


def _make_dangling_link(path: Path, other_batch_path: Path) -> None:
    path.unlink()
    path.symlink_to(path.with_name("nowhere"))


def _make_folder(path: Path, other_batch_path: Path) -> None:
    path.unlink()
    path.mkdir()


DAMAGES: tuple[Callable[[Path, Path], None], ...] = (
    _tear_file,
    _change_bytes,
    _write_foreign_text,
    _write_empty,
    _exchange_files,
    _make_dangling_link,
    _make_folder,
)


def damage_records(undisturbed: xr.Dataset, count: int) -> Row:
    """Files of the output folder beside the batches (log, lock) are changed and cut off."""
    passed_count = 0
    with studies.make_study_folder() as folder:
        studies.resume_study(folder)
        outputs = folder / "out"
        records = [
            path for path in outputs.iterdir() if path.is_file() and path.name not in ("study.json", "study.toml")
        ]
        for index in range(count):
            path = records[index % len(records)]
            data = bytearray(path.read_bytes()) or bytearray(b"x")
            for _ in range(20):
                data[rng.randrange(len(data))] = rng.randrange(256)
            path.write_bytes(bytes(data[: rng.randrange(1, len(data) + 1)]))
            report = run_study(STUDY, outputs, workers=0, solver=solve_fake)
            passed_count += report.counts == {"ok": CASES} and studies.read_values(folder).identical(undisturbed)
    names = ", ".join(f"`{path.name}`" for path in sorted(records))
    return Row(f"changed and torn bytes in {names}", count, passed_count, "all cases found again, bit for bit")


def start_second_runs(undisturbed: xr.Dataset, count: int) -> Row:
    """Further runs begin during a run."""
    passed_count = 0
    with studies.make_study_folder() as folder:
        outputs = folder / "out"
        holder_run = start_run(folder / "study.toml", outputs, "--workers", "0", tickets=2)
        studies.wait(holder_run, lambda: len(studies.list_finished_cases(folder)) == 2)
        refused_runs = [start_run(folder / "study.toml", outputs, "--workers", "0", tickets=0) for _ in range(count)]
        for refused_run in refused_runs:
            _, errors = refused_run.communicate(timeout=SECONDS)
            passed_count += (
                refused_run.returncode == 2 and f"process {holder_run.pid} on " in errors and "Traceback" not in errors
            )
        give_tickets(locate_tickets(outputs), CASES)
        holder_run.communicate(timeout=SECONDS)
        is_complete = holder_run.returncode == 0 and studies.read_values(folder).identical(undisturbed)
    return Row(
        "a second run while the first goes on",
        count,
        passed_count if is_complete else 0,
        "code 2, the holder named; the first run ends bit for bit",
    )


def run_simultaneously(undisturbed: xr.Dataset, count: int) -> Row:
    """Two runs begin at the same moment."""
    passed_count = 0
    for _ in range(count):
        with studies.make_study_folder() as folder:
            runs = [studies.start(folder, "--workers", "0") for _ in range(2)]
            error_outputs = [run.communicate(timeout=SECONDS)[1] for run in runs]
            codes = [run.returncode for run in runs]
            # Both may run to the end, one after the other.
            is_correct = codes in ([0, 2], [2, 0], [0, 0]) and not any(
                "Traceback" in errors for errors in error_outputs
            )
            passed_count += (
                is_correct and not studies.list_leftovers(folder) and studies.read_values(folder).identical(undisturbed)
            )
    return Row(
        "two runs begun at once", count, passed_count, "one solves, the other is refused or finds all done; bit for bit"
    )


def shift_clock(undisturbed: xr.Dataset, count: int) -> Row:
    """The time of day jumps by up to ten years either way at every reading, in this process."""
    passed_count = 0
    for _ in range(count):
        with studies.make_study_folder() as folder, _jumping_clock():
            is_correct = studies.resume_study(folder) == {"ok": CASES} and not studies.list_leftovers(folder)
            studies.batches(folder)[0].unlink()
            is_correct = is_correct and studies.resume_study(folder) == {"ok": CASES}
            passed_count += is_correct and studies.read_values(folder).identical(undisturbed)
    return Row(
        "clock of the process jumps by up to ten years at every reading",
        count,
        passed_count,
        "run and resumed run, bit for bit",
    )


class _jumping_clock:  # noqa: N801
    """Replaces the clock of the study layer."""

    def __enter__(self) -> None:
        class JumpingClock(datetime):
            @classmethod
            def now(cls, tz=None):
                return datetime.now(tz or UTC) + timedelta(days=rng.uniform(-3650, 3650))

        real_time = time.time
        modules = ("folder", "run", "worker", "files")
        self._patches = [mock.patch(f"contactstudy.study.{name}.datetime", JumpingClock) for name in modules]

        def compute_shifted_time() -> float:
            return real_time() + rng.uniform(-3e8, 3e8)

        self._patches.append(mock.patch("time.time", compute_shifted_time))
        for patch in self._patches:
            patch.start()

    def __exit__(self, *error: object) -> None:
        for patch in self._patches:
            patch.stop()


def edit_study_file(undisturbed: xr.Dataset, count: int) -> Row:
    """The file of the study changes during a run."""
    passed_count = 0
    for _ in range(count):
        with studies.make_study_folder() as folder:
            process = studies.start(folder, "--workers", "0")
            studies.wait(process, partial(_holds_the_lock, process.pid, folder / "out"))
            text = format_toml(STUDY)
            (folder / "study.toml").write_text(text[: rng.randrange(len(text))])
            _, errors = process.communicate(timeout=SECONDS)
            passed_count += (
                process.returncode == 0
                and "Traceback" not in errors
                and studies.read_values(folder).identical(undisturbed)
            )
    return Row(
        "the study's file torn while it runs", count, passed_count, "the run uses the file's first content, bit for bit"
    )


def _holds_the_lock(pid: int, outputs: Path) -> bool:
    """Whether a process holds the lock of an output folder."""
    return outputs.exists() and any(f"process {pid} on " in holder for holder in Folder(outputs).holders)
