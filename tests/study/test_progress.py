import io
import re
import sys

import pytest

from contactstudy.study import progress as module
from contactstudy.study.progress import Progress
from contactstudy.study.work import Job, Record


class Terminal(io.StringIO):
    def isatty(self):
        return True


def watch(monkeypatch):
    """Put a terminal in place of stderr (in the test itself: before it, pytest puts its own there)."""
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.delenv("CI", raising=False)
    return screen


def jobs(*costs):
    return [Job(f"{number:016x}", f"case {number}", {}, "", "summary", cost=cost) for number, cost in enumerate(costs)]


def ok(job):
    return Record(job.id, "ok", 1.0)


def test_the_time_left_counts_effort_and_not_cases(tmp_path, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    cheap, dear, last = jobs(1.0, 9.0, 10.0)
    with Progress(tmp_path / "run.log") as progress:
        progress.begin([cheap, dear, last], total=3)
        for job, until in ((cheap, 101.0), (dear, 110.0), (last, 120.0)):
            now[0] = until
            progress.finished(job, ok(job))
    lines = (tmp_path / "run.log").read_text().splitlines()
    assert [re.search(r"(\d+ s left|all done)", line).group() for line in lines[1:]] == [
        "19 s left",
        "10 s left",
        "all done",
    ]


def test_a_bar_on_a_terminal(tmp_path, monkeypatch):
    terminal = watch(monkeypatch)
    pair = jobs(1.0, 1.0)
    with Progress(tmp_path / "run.log") as progress:
        progress.begin(pair, total=2)
        progress.finished(pair[0], ok(pair[0]))
        progress.finished(pair[1], Record(pair[1].id, "failed", 1.0, error="WindowError", message="too small"))
    assert "2/2 cases" in terminal.getvalue()
    assert "failed: case 1: WindowError: too small" in terminal.getvalue()


@pytest.mark.parametrize("quiet", ["CI", "no terminal", "not wanted"])
def test_no_bar_where_no_one_watches(tmp_path, monkeypatch, quiet):
    terminal = watch(monkeypatch)
    if quiet == "CI":
        monkeypatch.setenv("CI", "true")
    elif quiet == "no terminal":
        monkeypatch.setattr(Terminal, "isatty", lambda self: False)
    (job,) = jobs(1.0)
    with Progress(tmp_path / "run.log", shown=quiet != "not wanted") as progress:
        progress.begin([job], total=1)
        progress.finished(job, ok(job))
    assert terminal.getvalue() == ""


def test_another_process_can_read_the_log_at_once(tmp_path):
    pair = jobs(1.0, 1.0)
    with Progress(tmp_path / "run.log") as progress:
        progress.begin(pair, total=5)
        assert "2 of 5 cases to solve" in (tmp_path / "run.log").read_text()
        progress.finished(pair[0], ok(pair[0]))
        assert (tmp_path / "run.log").read_text().count("\n") == 2
