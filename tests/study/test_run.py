import contextlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import traceback
from pathlib import Path

import numpy as np
import pytest

from contactstudy.errors import Terminated
from contactstudy.study import StoreError, StudyFileError, open_study, rerun_study, run_study
from contactstudy.study.folder import Folder
from contactstudy.study.progress import Progress
from contactstudy.study.store import load_case, read_header
from tests.small_study import identity, small_study
from tests.stand_in_solver import DIES, FAILS, IS_LARGE, IS_WRONG, solve_fake

NOBODY = 65534


def run(study, folder, **options):
    return run_study(study, folder, **({"workers": 0, "solver": solve_fake} | options))


def test_a_second_run_solves_nothing(study, tmp_path):
    assert run(study, tmp_path).solved == 4
    assert run(study, tmp_path).solved == 0


def test_growing_a_study_solves_only_the_new_cases(study, tmp_path):
    run(study, tmp_path)
    report = run(small_study(sweep={"e_over_a": [0, 1], "friction": [0, 0.1, 0.2]}), tmp_path)
    assert (report.solved, report.counts) == (2, {"ok": 6})
    assert repr(report) == f"RunReport(6 cases: 6 ok; 2 solved now; folder={str(report.folder)!r})"


def test_without_the_manifest_nothing_is_lost(study, tmp_path):
    run(study, tmp_path)
    for content in (None, "{", json.dumps({"schema": 99, "files": []})):
        (tmp_path / "manifest.jsonl").unlink()
        if content is not None:
            (tmp_path / "manifest.jsonl").write_text(content)
        assert run(study, tmp_path).solved == 0


def test_a_failed_case_is_recorded_and_the_rest_goes_on(tmp_path):
    study = small_study(sweep={"e_over_a": [0, 1], "friction": [FAILS, 0.1]})
    report = run(study, tmp_path)
    assert report.counts == {"failed": 2, "ok": 2}
    assert report.failures[0][1].reason == "WindowError: this friction fails in tests"
    assert run(study, tmp_path).solved == 0
    assert "this friction fails" in (tmp_path / "run.log").read_text()
    assert rerun_study(tmp_path, workers=0, solver=solve_fake).solved == 2


def test_a_case_larger_than_the_memory_fails_alone(tmp_path):
    report = run(small_study(sweep={"e_over_a": [0], "friction": [IS_LARGE, 0.1]}), tmp_path)
    assert report.counts == {"failed": 1, "ok": 1}
    assert report.failures[0][1].reason == "MemoryError: Unable to allocate 7 EiB"


def repaired(case, grid, **settings):
    settings_of_failed_case = case.friction
    assert settings_of_failed_case == FAILS
    object.__setattr__(case, "friction", 0.0)
    return solve_fake(case, grid, **settings)


def test_rerun_repairs(tmp_path):
    study = small_study(sweep={"e_over_a": [0, 1], "friction": [FAILS, 0.1]})
    run(study, tmp_path)
    assert rerun_study(tmp_path, workers=0, solver=repaired).counts == {"ok": 4}
    assert not list((tmp_path / "cases").glob("*.failed"))


@pytest.mark.parametrize(("number", "kind"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)])
def test_an_interruption_says_what_is_kept_and_leaves_out_where_the_solver_was(study, tmp_path, number, kind):
    solved = []

    def interrupted(case, grid, **settings):
        solved.append(case)
        if len(solved) == 3:
            signal.raise_signal(number)
        return solve_fake(case, grid, **settings)

    with pytest.raises(KeyboardInterrupt) as caught:
        run(study, tmp_path, solver=interrupted)
    said = f"interrupted: 2 of 4 cases are kept in {tmp_path}; run again to go on"
    assert (type(caught.value), str(caught.value)) == (kind, said)
    shown = "".join(traceback.format_exception(caught.value))
    assert "interrupted(case" not in shown
    assert shown.count("File ") == 3  # this test, its helper and the door of the package
    assert said in (tmp_path / "run.log").read_text()
    assert run(study, tmp_path).solved == 2


@pytest.mark.parametrize("workers", [0, pytest.param(1, marks=pytest.mark.system)])
def test_an_error_of_the_program_stops_the_run(tmp_path, workers):
    study = small_study(sweep={"e_over_a": [0, 1], "friction": [0.1, IS_WRONG]})
    with pytest.raises(ZeroDivisionError) as caught:
        run(study, tmp_path, workers=workers)
    assert "friction=0.88" in caught.value.__notes__[0]
    assert not (tmp_path / "run.lock").exists()
    assert len(list((tmp_path / "cases").glob("*.nc"))) >= 1
    assert "ZeroDivisionError" in (tmp_path / "run.log").read_text()


@pytest.mark.parametrize("content", [b"", b"no netCDF"])
def test_a_damaged_file_is_set_aside_and_solved_again(study, tmp_path, content):
    run(study, tmp_path)
    path = Folder(tmp_path).case_path(identity(e_over_a=1, friction=0.1))
    path.write_bytes(content)
    assert run(study, tmp_path).solved == 1
    assert (tmp_path / "set-aside" / path.name).read_bytes() == content
    assert path.name in (tmp_path / "run.log").read_text()
    assert load_case(path)["pressure"].max() > 0


def test_foreign_and_misplaced_files_are_set_aside(study, tmp_path):
    run(study, tmp_path)
    cases = tmp_path / "cases"
    good = Folder(tmp_path).case_path(identity(e_over_a=1, friction=0.1))
    shutil.copy(good, cases / "copy.nc")
    (cases / "notes.nc").write_text("mine")
    report = good.with_suffix(".html")
    report.write_text("a report of the case")
    assert run(study, tmp_path).solved == 0
    assert report.exists()
    assert {path.name for path in (tmp_path / "set-aside").iterdir()} == {"copy.nc", "notes.nc"}


def test_another_case_under_a_cases_name(study, tmp_path):
    run(study, tmp_path)
    one, other = (Folder(tmp_path).case_path(identity(e_over_a=1, friction=f)) for f in (0, 0.1))
    shutil.copy(one, other)
    assert run(study, tmp_path).solved == 1


def test_a_higher_level_solves_again(tmp_path):
    run(small_study(level="summary"), tmp_path)
    assert run(small_study(level="fields"), tmp_path).solved == 4
    assert run(small_study(level="summary"), tmp_path).solved == 0


def test_cases_of_another_version_are_stale_and_solved_by_rerun(study, tmp_path, monkeypatch):
    monkeypatch.setattr("contactstudy.study.work.circumstances", lambda: {"contactstudy": "0.0.1"})
    assert run(study, tmp_path).counts == {"stale": 4}
    monkeypatch.undo()
    assert run(study, tmp_path).solved == 0
    assert rerun_study(tmp_path, workers=0, solver=solve_fake).counts == {"ok": 4}


def test_the_folder_of_another_study(study, tmp_path):
    run(study, tmp_path)
    with pytest.raises(StoreError, match="'small', not 'other'"):
        run(small_study("other"), tmp_path)


def test_a_study_without_a_possible_case(tmp_path):
    with pytest.raises(StudyFileError, match="body length"):
        run(small_study(sweep={"e_over_a": [-9]}), tmp_path)


def test_a_folder_that_cannot_be_made(study, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot make"):
        run(study, tmp_path / "file")


@contextlib.contextmanager
def ordinary_user():
    """Whoever runs the tests, without root's right to write anywhere."""
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
def open_place():
    """A folder that every user may enter, as pytest's own is not."""
    place = Path(tempfile.mkdtemp())
    place.chmod(0o777)
    yield place
    for folder in (place, *place.glob("**/")):
        folder.chmod(0o777)
    shutil.rmtree(place)


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="permissions of POSIX")
@pytest.mark.parametrize("closed", ["", "cases"])
def test_a_folder_without_permission(study, open_place, closed):
    folder = open_place / "out"
    run(study, folder)
    with_more = small_study(sweep={"e_over_a": [0, 1], "friction": [0, 0.1, 0.2]})
    for path in (folder, *folder.glob("**/*")):
        path.chmod(0o777)
    (folder / closed).chmod(0o555)
    with ordinary_user(), pytest.raises(StoreError, match=r"cannot write .*[Pp]ermission"):
        run(with_more, folder)
    (folder / closed).chmod(0o777)
    assert not (folder / "run.lock").exists()
    for path in folder.glob("cases/*.nc"):
        read_header(path, verify=True)
    report = run(with_more, folder)
    assert (report.counts, report.solved) == ({"ok": 6}, 2)


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="permissions of POSIX")
def test_a_folder_that_may_not_be_made(study, open_place):
    open_place.chmod(0o555)
    with ordinary_user(), pytest.raises(StoreError, match=r"cannot make .*[Pp]ermission"):
        run(study, open_place / "new")


@pytest.fixture
def small_disk(tmp_path):
    """A file system of its own, too small for a study."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1200k", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("needs the right to mount a file system")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


@pytest.mark.system
@pytest.mark.parametrize("workers", [0, 1])
def test_a_full_disk(small_disk, study, workers):
    rest = small_disk / "other.bin"
    rest.write_bytes(bytes(1_060_000))
    with pytest.raises(StoreError, match=r"disk is full|No space"):
        run(study, small_disk / "out", workers=workers)
    assert not list(small_disk.glob("**/*.part-*"))
    assert not (small_disk / "out" / "run.lock").exists()
    done = list((small_disk / "out" / "cases").glob("*.nc"))
    for path in done:
        read_header(path, verify=True)
    rest.unlink()
    report = run(study, small_disk / "out")
    assert (report.counts, report.solved) == ({"ok": 4}, 4 - len(done))


@pytest.mark.system
def test_results_do_not_depend_on_workers(study, tmp_path):
    for workers in (0, 1, 2):
        assert run(study, tmp_path / str(workers), workers=workers).counts == {"ok": 4}
    first = open_study(tmp_path / "0").drop_vars("seconds")
    for workers in (1, 2):
        other = open_study(tmp_path / str(workers)).drop_vars("seconds")
        assert other.load().identical(first.load())


@pytest.mark.system
def test_a_worker_that_dies_costs_its_case_only(tmp_path):
    sweep = {"e_over_a": [0, 1, 2], "friction": [0, DIES]}
    study = small_study(sweep=sweep, exclude=[{"e_over_a": [0, 2], "friction": DIES}])
    report = run(study, tmp_path, workers=2)
    assert report.counts == {"ok": 3, "failed": 1}
    assert report.failures[0][0].name == "e_over_a=1 friction=0.77"
    assert report.failures[0][1].reason.startswith("WorkerDied")


def test_records_hold_no_fields(study, tmp_path):
    report = run(study, tmp_path)
    assert all(np.isscalar(value) for entry in report.entries for value in entry.scalars.values())


@pytest.mark.slow
def test_memory_of_the_parent_is_flat(tmp_path, monkeypatch):
    """Over 500 cases of two workers that keep fields; what grows is the manifest, a few kilobytes for each."""
    import psutil

    sizes = []
    finished = Progress.finished

    def note(self, job, record):
        finished(self, job, record)
        sizes.append(psutil.Process().memory_info().rss)

    monkeypatch.setattr(Progress, "finished", note)
    sweep = {"e_over_a": [0, 1, 2, 3, 4], "max_pressure": [1e9 + 1e6 * number for number in range(100)]}
    assert run(small_study(sweep=sweep), tmp_path, workers=2).counts == {"ok": 500}
    assert max(sizes) - sizes[49] < 8e6
