"""Runs that a signal kills."""

import contextlib
import os
import signal
import time

import pytest

from contactstudy.study import run_study
from contactstudy.study.folder import Folder
from tests.small_study import format_toml, small_study
from tests.stand_in_solver import give_tickets, solve_fake
from tests.study.conftest import count_finished, has_intact_batches, locate_tickets, start_run

SECONDS = 300.0
"""Longest wait for another process, so large that slow machines pass."""
LARGE_SWEEP = {"e_over_a": [0.0, 0.5, 1.0, 1.5, 2.0], "friction": [0.0, 0.05, 0.1, 0.2]}


def wait_for(process, condition):
    deadline = time.monotonic() + SECONDS
    while not condition():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline, "waited too long"
        time.sleep(0.1)


def kill_group(process):
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


@pytest.fixture
def large_study_file(tmp_path):
    path = tmp_path / "large.toml"
    path.write_text(format_toml(small_study("large", sweep=LARGE_SWEEP)))
    return path


@pytest.mark.system
@pytest.mark.parametrize(("signal_number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_interrupted_run_releases_lock_and_resumes(large_study_file, tmp_path, signal_number, code):
    folder = tmp_path / "out"
    process = start_run(large_study_file, folder, "--workers", "2", tickets=3)
    wait_for(process, lambda: count_finished(folder) == 3)
    if signal_number == signal.SIGINT:
        os.killpg(process.pid, signal_number)  # the signal reaches the workers as well, as from a terminal
    else:
        process.send_signal(signal_number)
    output, errors = process.communicate(timeout=SECONDS)
    assert process.returncode == code, output + errors
    assert f"interrupted: 3 of 20 cases are kept in {folder}; run again to go on" in errors
    assert "Traceback" not in errors
    assert not Folder(folder).holders
    assert not list(folder.glob("**/*.part-*"))
    assert count_finished(folder) == 3
    report = run_study(small_study("large", sweep=LARGE_SWEEP), folder, workers=0, solver=solve_fake)
    assert (report.solved, report.counts) == (17, {"ok": 20})


@pytest.mark.system
@pytest.mark.parametrize("has_results", [True, False])
def test_repeated_interrupts_end_run_quietly(large_study_file, tmp_path, has_results):
    """Eight interrupts of the whole process group, while workers solve or while workers start."""
    folder = tmp_path / "out"
    process = start_run(large_study_file, folder, "--workers", "2", tickets=3 if has_results else 0)
    wait_for(process, lambda: count_finished(folder) >= 1 if has_results else (folder / "run.log").exists())
    for _ in range(8):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGINT)
        time.sleep(0.1)
    _, errors = process.communicate(timeout=SECONDS)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    # The first interrupt may precede the first worker.
    assert ("interrupted: ending the workers ..." if has_results else "contactstudy: interrupted") in errors
    assert not Folder(folder).holders


@pytest.mark.system
def test_concurrent_run_is_refused(large_study_file, tmp_path):
    folder = tmp_path / "out"
    first_process = start_run(large_study_file, folder, "--workers", "0", tickets=1)
    wait_for(first_process, lambda: count_finished(folder) == 1)
    second_process = start_run(large_study_file, folder, "--workers", "0", tickets=0)
    _, errors = second_process.communicate(timeout=SECONDS)
    assert second_process.returncode == 2
    assert f"process {first_process.pid} on " in errors
    give_tickets(locate_tickets(folder), 19)
    output, errors = first_process.communicate(timeout=SECONDS)
    assert first_process.returncode == 0, errors
    assert "20 ok" in output


@pytest.mark.system
def test_killed_run_is_taken_over(large_study_file, tmp_path):
    folder = tmp_path / "out"
    process = start_run(large_study_file, folder, "--workers", "2", tickets=3)
    wait_for(process, lambda: count_finished(folder) == 3)
    os.kill(process.pid, signal.SIGKILL)  # only the parent, whose end must end the workers
    process.wait()
    process.communicate(timeout=SECONDS)  # ends when the last worker has closed the pipe
    assert count_finished(folder) == 3
    assert has_intact_batches(folder)
    report = run_study(small_study("large", sweep=LARGE_SWEEP), folder, workers=0, solver=solve_fake)
    assert (report.solved, report.counts) == (17, {"ok": 20})
