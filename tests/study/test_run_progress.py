import io
import re
import sys

import pytest

from contactstudy.study import StoreError
from contactstudy.study import run as module
from contactstudy.study.run import Progress
from contactstudy.study.worker import Outcome
from tests.study.conftest import make_planned_case


class Terminal(io.StringIO):
    def isatty(self):
        return True


def replace_stderr(monkeypatch):
    """Replace stderr by a terminal; a test calls this function because pytest replaces stderr before each test."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.delenv("CI", raising=False)
    return terminal


def make_outcome(index):
    return Outcome(make_planned_case(index), "ok")


def test_remaining_time_follows_from_finished_cases(tmp_path, monkeypatch):
    times = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: times[0])
    with Progress(tmp_path / "run.log") as progress:
        progress.begin(4, total=4)
        for count, time in ((1, 110.0), (3, 120.0)):
            times[0] = time
            for index in range(count):
                progress.record(make_outcome(index))
            progress.show()
    lines = (tmp_path / "run.log").read_text().splitlines()
    assert [re.search(r"(\d+ s left|all done)", line).group() for line in lines[1:]] == ["30 s left", "all done"]


def test_terminal_has_progress_bar(tmp_path, monkeypatch):
    terminal = replace_stderr(monkeypatch)
    with Progress(tmp_path / "run.log") as progress:
        progress.begin(2, total=2)
        progress.record(make_outcome(0))
        progress.record(Outcome(make_planned_case(1), "failed", "WindowError: too small"))
        progress.show()
    assert "2/2 cases" in terminal.getvalue()
    assert "failed: case 1: WindowError: too small" in terminal.getvalue()
    assert "WindowError: too small" in (tmp_path / "run.log").read_text()


@pytest.mark.parametrize("reason", ["CI", "no terminal", "not wanted"])
def test_pipe_has_no_progress_bar(tmp_path, monkeypatch, reason):
    terminal = replace_stderr(monkeypatch)
    if reason == "CI":
        monkeypatch.setenv("CI", "true")
    elif reason == "no terminal":
        monkeypatch.setattr(Terminal, "isatty", lambda self: False)
    with Progress(tmp_path / "run.log", visible=reason != "not wanted") as progress:
        progress.begin(1, total=1)
        progress.record(make_outcome(0))
        progress.show()
    assert terminal.getvalue() == ""


def test_log_is_flushed_after_each_line(tmp_path):
    with Progress(tmp_path / "run.log") as progress:
        progress.begin(2, total=5)
        assert "2 of 5 cases to solve" in (tmp_path / "run.log").read_text()


def test_log_refuses_links(tmp_path):
    (tmp_path / "run.log").symlink_to(tmp_path / "target")
    with pytest.raises(StoreError, match=r"run\.log"), Progress(tmp_path / "run.log"):
        pass
    assert not (tmp_path / "target").exists()
