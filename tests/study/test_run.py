import contextlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path

import pytest

from contactstudy.errors import InvalidInputError, Terminated
from contactstudy.study import StoreError, StudyFileError, open_study, rerun_study, run_study, worker
from contactstudy.study.batches import batch_paths
from contactstudy.study.folder import Folder
from contactstudy.study.settings import RunSettings
from tests.small_study import small_study
from tests.stand_in_solver import DIES, FAILS, IS_LARGE, WRONG_FRICTION, solve_fake
from tests.study.conftest import ROOT, count_finished, has_intact_batches

NOBODY = 65534


def run(study, folder, **options):
    return run_study(study, folder, **({"workers": 0, "solver": solve_fake} | options))


def test_second_run_solves_no_case(study, tmp_path):
    assert run(study, tmp_path).solved == 4
    assert run(study, tmp_path).solved == 0


def test_extended_study_solves_only_new_cases(study, tmp_path):
    run(study, tmp_path)
    report = run(small_study(sweep={"e_over_a": [0, 1], "friction": [0, 0.1, 0.2]}), tmp_path)
    assert (report.solved, report.counts) == (2, {"ok": 6})
    assert repr(report) == f"RunReport(6 cases: 6 ok; 2 solved now; folder={str(report.folder)!r})"


def test_failed_case_does_not_stop_run(tmp_path):
    study = small_study(sweep={"e_over_a": [0, 1], "friction": [FAILS, 0.1]})
    report = run(study, tmp_path)
    assert report.counts == {"failed": 2, "ok": 2}
    assert report.failures[0][1] == "WindowError: this friction fails in tests"
    assert run(study, tmp_path).solved == 0
    assert "this friction fails" in (tmp_path / "run.log").read_text()
    assert rerun_study(tmp_path, workers=0, solver=solve_fake).solved == 2


def test_memory_error_fails_single_case(tmp_path):
    report = run(small_study(sweep={"e_over_a": [0], "friction": [IS_LARGE, 0.1]}), tmp_path)
    assert report.counts == {"failed": 1, "ok": 1}
    assert report.failures[0][1] == "MemoryError: Unable to allocate 7 EiB"


def solve_failed_case(case, grid, **settings):
    assert case.friction == FAILS
    object.__setattr__(case, "friction", 0.0)
    return solve_fake(case, grid, **settings)


def test_rerun_solves_failed_cases(tmp_path):
    study = small_study(sweep={"e_over_a": [0, 1], "friction": [FAILS, 0.1]})
    run(study, tmp_path)
    assert rerun_study(tmp_path, workers=0, solver=solve_failed_case).counts == {"ok": 4}
    assert "failed" not in open_study(tmp_path)["status"]


@pytest.mark.parametrize(("signal_number", "kind"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)])
def test_interrupt_message_contains_finished_cases(study, tmp_path, signal_number, kind):
    solved_cases = []

    def solve_then_interrupt(case, grid, **settings):
        solved_cases.append(case)
        if len(solved_cases) == 3:
            signal.raise_signal(signal_number)
        return solve_fake(case, grid, **settings)

    with pytest.raises(KeyboardInterrupt) as caught:
        run(study, tmp_path, solver=solve_then_interrupt)
    message = f"interrupted: 2 of 4 cases are kept in {tmp_path}; run again to go on"
    assert (type(caught.value), str(caught.value)) == (kind, message)
    traceback_text = "".join(traceback.format_exception(caught.value))
    assert "interrupted(case" not in traceback_text
    assert traceback_text.count("File ") == 3  # frames: the test, its helper `run`, the public function
    assert message in (tmp_path / "run.log").read_text()
    assert run(study, tmp_path).solved == 2


@pytest.mark.parametrize("workers", [0, pytest.param(1, marks=pytest.mark.system)])
def test_program_error_stops_run(tmp_path, workers):
    study = small_study(sweep={"e_over_a": [0, 1], "friction": [0.1, WRONG_FRICTION]})
    with pytest.raises(ZeroDivisionError) as caught:
        run(study, tmp_path, workers=workers)
    assert "friction=0.88" in caught.value.__notes__[0]
    assert not Folder(tmp_path).holders
    assert count_finished(tmp_path) >= 1
    assert "ZeroDivisionError" in (tmp_path / "run.log").read_text()


def make_partial_study(**changes):
    """The cases of the small study at one end distance."""
    return small_study(sweep={"e_over_a": [changes["e_over_a"]], "friction": [0.0, 0.1]})


@pytest.fixture
def two_batches(study, tmp_path, monkeypatch):
    """Folder with a study in two batches of two cases."""
    monkeypatch.setattr(Folder, "compact", lambda self, at_end=False: None)
    monkeypatch.setattr(worker, "RUN", RunSettings(save_seconds=60.0))
    for e_over_a in (0.0, 1.0):
        run(make_partial_study(e_over_a=e_over_a), tmp_path)
    Folder(tmp_path).write_study(study)
    assert [len(batch) for batch in Folder(tmp_path).results().batches] == [2, 2]
    return tmp_path


@pytest.mark.parametrize("content", [b"", b"no netCDF"])
def test_damaged_batch_loses_only_contained_cases(study, two_batches, content):
    path = batch_paths(two_batches / "batches")[0]
    path.write_bytes(content)
    dataset = open_study(two_batches)
    lost_cases = dataset["status"] == "missing"
    assert int(lost_cases.sum()) == 2
    assert path.name in str(dataset["message"].values[lost_cases.values][0])
    assert float(dataset["peak_pressure"].where(~lost_cases).min()) > 0
    report = run(study, two_batches)
    assert (report.solved, report.counts) == (2, {"ok": 4})
    assert (two_batches / "set-aside" / path.name).read_bytes() == content
    assert "its cases are missing" in report.remarks[0]
    assert float(open_study(two_batches)["peak_pressure"].min()) > 0


def test_changed_byte_is_detected(study, tmp_path):
    run(study, tmp_path)
    (path,) = batch_paths(tmp_path / "batches")
    data = bytearray(path.read_bytes())
    data[-100] ^= 1
    path.write_bytes(bytes(data))
    assert run(study, tmp_path).solved == 4
    assert (tmp_path / "set-aside" / path.name).exists()


def test_foreign_files_are_set_aside(study, two_batches):
    batches = two_batches / "batches"
    first_path, second_path = batch_paths(batches)
    shutil.copy(first_path, second_path)  # another batch has this name
    (batches / "notes.nc").write_text("mine")
    (batches / "pipe.nc").symlink_to(two_batches / "nowhere")
    os.mkfifo(batches / "fifo.nc")
    (batches / "report.html").write_text("a report of the study")
    assert run(study, two_batches).solved == 2
    assert (batches / "report.html").exists()
    aside_folder = {path.name for path in (two_batches / "set-aside").iterdir()}
    assert aside_folder == {second_path.name, "notes.nc", "pipe.nc", "fifo.nc"}


def test_higher_level_solves_cases_again(tmp_path):
    run(small_study(level="summary"), tmp_path)
    assert run(small_study(level="fields"), tmp_path).solved == 4
    assert run(small_study(level="summary"), tmp_path).solved == 0


def test_rerun_solves_stale_cases(study, tmp_path, monkeypatch):
    monkeypatch.setattr("contactstudy.study.worker.run_context", lambda: {"contactstudy": "0.0.1"})
    assert run(study, tmp_path).counts == {"stale": 4}
    monkeypatch.undo()
    assert run(study, tmp_path).solved == 0
    assert rerun_study(tmp_path, workers=0, solver=solve_fake).counts == {"ok": 4}


def test_folder_of_other_study_raises(study, tmp_path):
    run(study, tmp_path)
    with pytest.raises(StoreError, match="'small', not 'other'"):
        run(small_study("other"), tmp_path)


def test_study_without_possible_case_raises(tmp_path):
    with pytest.raises(StudyFileError, match="body length"):
        run(small_study(sweep={"e_over_a": [-9]}), tmp_path)


def test_uncreatable_folder_raises(study, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot make"):
        run(study, tmp_path / "file")


@contextlib.contextmanager
def become_ordinary_user():
    """User without root's right to write anywhere."""
    if os.geteuid() != 0:
        yield
        return
    try:
        os.seteuid(NOBODY)
    except OSError:
        pytest.skip("root without the right to become another user")
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def open_folder():
    """A folder in which every user may write, unlike pytest's temporary folder."""
    path = Path(tempfile.mkdtemp())
    path.chmod(0o777)
    yield path
    for folder in (path, *path.glob("**/")):
        folder.chmod(0o777)
    shutil.rmtree(path)


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="permissions of POSIX")
@pytest.mark.parametrize("closed_folder", ["", "batches"])
def test_folder_without_permission_raises(study, open_folder, closed_folder):
    folder = open_folder / "out"
    run(study, folder)
    larger_study = small_study(sweep={"e_over_a": [0, 1], "friction": [0, 0.1, 0.2]})
    for path in (folder, *folder.glob("**/*")):
        path.chmod(0o777)
    (folder / closed_folder).chmod(0o555)
    with become_ordinary_user(), pytest.raises(StoreError, match=r"cannot write .*[Pp]ermission"):
        run(larger_study, folder)
    (folder / closed_folder).chmod(0o777)
    assert not Folder(folder).holders
    assert has_intact_batches(folder)
    report = run(larger_study, folder)
    assert (report.counts, report.solved) == ({"ok": 6}, 2)


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="permissions of POSIX")
def test_forbidden_folder_raises(study, open_folder):
    open_folder.chmod(0o555)
    with become_ordinary_user(), pytest.raises(StoreError, match=r"cannot make .*[Pp]ermission"):
        run(study, open_folder / "new")


@pytest.fixture
def small_disk(tmp_path):
    """A file system too small for a study."""
    path = tmp_path / "disk"
    path.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1200k", "tmpfs", str(path)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("needs the right to mount a file system")
    yield path
    subprocess.run(["umount", "-l", str(path)], check=True)


@pytest.mark.system
@pytest.mark.parametrize("workers", [0, 1])
def test_full_disk_raises(small_disk, study, workers):
    filler_path = small_disk / "other.bin"
    filler_path.write_bytes(bytes(1_060_000))
    with pytest.raises(StoreError, match=r"disk is full|No space"):
        run(study, small_disk / "out", workers=workers)
    assert not list(small_disk.glob("**/*.part-*"))
    assert not Folder(small_disk / "out").holders
    assert has_intact_batches(small_disk / "out")
    finished_count = count_finished(small_disk / "out")
    filler_path.unlink()
    report = run(study, small_disk / "out")
    assert (report.counts, report.solved) == ({"ok": 4}, 4 - finished_count)


@pytest.mark.system
def test_dead_local_worker_fails_one_case(tmp_path):
    sweep = {"e_over_a": [0, 1, 2], "friction": [0, DIES]}
    study = small_study(sweep=sweep, exclude=[{"e_over_a": [0, 2], "friction": DIES}])
    report = run(study, tmp_path, workers=2)
    assert report.counts == {"ok": 3, "failed": 1}
    assert report.failures[0][0].name == "e_over_a=1 friction=0.77"
    assert report.failures[0][1].startswith("WorkerDied")


MEMORY_OF_A_RUN = """
import sys
from dataclasses import replace
import psutil
from contactstudy.study import run, run_study
from contactstudy.study.run import Progress
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake

memory_sizes, original_record = [], Progress.record

def record_with_memory(self, outcome):
    original_record(self, outcome)
    memory_sizes.append(psutil.Process().memory_info().rss)

Progress.record = record_with_memory
run.RUN = replace(run.RUN, compact_seconds=1e9)  # joining batches takes memory up to batch_bytes
sweep = {"e_over_a": [0, 1, 2, 3, 4], "max_pressure": [1e9 + 1e6 * number for number in range(100)]}
assert run_study(small_study(sweep=sweep), sys.argv[1], workers=2, solver=solve_fake).counts == {"ok": 500}
print(max(memory_sizes[250:]) - memory_sizes[250])
"""


@pytest.mark.slow
def test_parent_memory_does_not_grow(tmp_path):
    """The memory is measured over the second half of 500 cases with fields."""
    command = [sys.executable, "-c", MEMORY_OF_A_RUN, str(tmp_path)]
    growth = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    assert float(growth.split()[-1]) < 8e6


def test_sample_solves_evenly_spaced_cases(study, tmp_path):
    report = run(study, tmp_path, sample=2)
    assert (report.solved, report.counts) == (2, {"ok": 2, "missing": 2})
    assert report.states.status[0] == report.states.status[-1] == "ok"


def test_shares_equal_whole_study(study, tmp_path):
    for share_number in (2, 1, 3):
        run(study, tmp_path / "shares", share=(share_number, 3))
    run(study, tmp_path / "whole")
    shared_study, whole_study = (
        open_study(tmp_path / name).drop_vars("seconds").load() for name in ("shares", "whole")
    )
    assert shared_study.identical(whole_study)
    assert (tmp_path / "shares" / "run-2-of-3.log").exists()
    assert run(study, tmp_path / "shares").solved == 0


@pytest.mark.parametrize("share", [(0, 3), (4, 3), (1, 2, 3), "1/3", (1.0, 2)])
def test_invalid_share_raises(study, tmp_path, share):
    with pytest.raises(InvalidInputError, match="share"):
        run(study, tmp_path, share=share)


def test_deleted_working_directory_raises(study, tmp_path, monkeypatch):
    removed_folder = tmp_path / "gone"
    removed_folder.mkdir()
    monkeypatch.chdir(removed_folder)
    removed_folder.rmdir()
    with pytest.raises(StoreError, match="working directory"):
        run(study, None)


def test_worker_skips_impossible_case(tmp_path, monkeypatch):
    monkeypatch.setattr("contactstudy.study.plan.RUN", RunSettings(checked_groups=1))
    report = run(small_study(sweep={"e_over_a": [0, -9, -8], "friction": [0.0]}), tmp_path)
    assert report.counts == {"ok": 1, "skipped": 2}
    assert "body length" in report.states.reasons[1]
