"""Collected tests that are run in forks of one process: everything is imported once, and each fork starts with that.

A fork has nothing that another one has kept, computed or changed, so a test in it is a test run alone.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import pytest

from tests.mutation.mutants import PACKAGES, ROOT, Mutant

TESTS = (
    *(f"contactstudy/{package}" for package in (*PACKAGES, "fields")),
    *(f"tests/{package}" for package in (*PACKAGES, "fields", "verification")),
    "tests/solution",
)
"""Tests that may notice a change: those of the packages and of what is nearest to them."""

MEMORY = 6 * 2**30
"""Bytes that a fork may take; a change that asks for more is noticed by that."""

SPARE, TIMES = 2.0, 5.0
"""Processor time that a test may take: seconds, and so many times what it took without a change."""

CORE = tuple(str(ROOT / "contactstudy" / package) for package in PACKAGES)


@dataclass(frozen=True)
class Reached:
    """What a test does without any change.

    Attributes
    ----------
    test : str
        Its name.
    passed : bool
        Whether it passes.
    seconds : float
        Processor time that it takes alone.
    lines : dict of str to list of str
        Lines of the core that it runs, by source; their texts, which stay what they are when lines are put in before.
    """

    test: str
    passed: bool
    seconds: float
    lines: dict[str, list[str]]


@dataclass
class Session:
    """Collected tests, and all functions of the core.

    Attributes
    ----------
    items : dict of str to list of pytest.Item
        Tests by name; those that share one calculation go together.
    functions : dict
        Functions by source, name and first line.
    """

    items: dict[str, list[pytest.Item]]
    functions: dict[tuple[str, str, int], list[FunctionType]] = field(init=False)

    def __post_init__(self) -> None:
        found = defaultdict(list)
        for each in gc.get_objects():
            if isinstance(each, FunctionType) and each.__code__.co_filename.startswith(CORE):
                found[_place(each.__code__)].append(each)
        self.functions = dict(found)
        gc.freeze()  # else the first collection in each fork copies all that is imported

    def reached(self, test: str) -> Reached:
        """Run a test without any change and note what it runs."""
        lines: dict[str, set[int]] = defaultdict(set)

        def work(say: Callable[[str], None]) -> None:
            sys.settrace(_tracer(lines))
            began = time.process_time()
            failed = self._fails(test)
            sys.settrace(None)
            found = {}
            for name, own in lines.items():
                texts = Path(name).read_text(encoding="utf-8").splitlines()
                found[str(Path(name).relative_to(ROOT))] = sorted({texts[number - 1].strip() for number in own})
            say(json.dumps(asdict(Reached(test, not failed, time.process_time() - began, found))))

        said, _ = forked(work)
        return Reached(**json.loads(said[-1])) if said else Reached(test, False, 0.0, {})

    def first_failure(self, tests: Iterable[tuple[str, float]], mutant: Mutant | None = None) -> str:
        """Name the first of some tests, each with the seconds that it takes, that fails under a change; "" if none."""

        def work(say: Callable[[str], None]) -> None:
            if mutant:
                self._install(mutant)
            for test, seconds in tests:
                say(test)
                signal.setitimer(signal.ITIMER_PROF, SPARE + TIMES * seconds)
                if self._fails(test):
                    return
            say("")

        said, ended = forked(work)
        return said[-1] + (f" (ended by {signal.Signals(ended).name})" if ended else "")

    def _fails(self, test: str) -> bool:
        """Run a test with all its fixtures, and say whether anything of it fails."""
        noted, items = _Failures(), self.items[test]
        plugins = items[0].config.pluginmanager
        plugins.register(noted)
        for item in items:
            plugins.hook.pytest_runtest_protocol(item=item, nextitem=None)
            if noted.failed:
                break
        plugins.unregister(noted)
        return bool(noted.failed)

    def _install(self, mutant: Mutant) -> None:
        """Give the functions of a source the changed code, wherever they have been imported or wrapped."""
        for code in _within(compile(mutant.changed, str(ROOT / mutant.file), "exec")):
            for function in self.functions.get(_place(code), ()):
                function.__code__ = code


class _Failures:
    """Plugin that notes what fails."""

    def __init__(self) -> None:
        self.failed: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.failed.append(report.nodeid)


def named(items: Iterable[pytest.Item]) -> dict[str, list[pytest.Item]]:
    """Tests by name; the checks of a group of `contactstudy verify` are computed together."""
    found: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        entry = item.callspec.params.get("entry") if hasattr(item, "callspec") else None
        found[f"{item.nodeid.split('[')[0]}[{entry.group}]" if hasattr(entry, "group") else item.nodeid].append(item)
    return dict(found)


def _place(code: CodeType) -> tuple[str, str, int]:
    return code.co_filename, code.co_qualname, code.co_firstlineno


def _within(code: CodeType) -> Iterator[CodeType]:
    """Code of all functions within a module's."""
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _within(constant)


def _tracer(lines: dict[str, set[int]]) -> Callable[[FrameType, str, Any], Any]:
    """Trace that notes the lines of the core."""

    def begun(frame: FrameType, event: str, value: Any) -> Any:
        name = frame.f_code.co_filename
        if not name.startswith(CORE):
            return None
        add = lines[name].add
        add(frame.f_lineno)

        def line(frame: FrameType, event: str, value: Any) -> Any:
            add(frame.f_lineno)
            return line

        return line

    return begun


def forked(work: Callable[[Callable[[str], None]], None]) -> tuple[list[str], int]:
    """Run a function in a fork: the lines that it says, and the signal that ended it or 0."""
    read, write = os.pipe()
    process = os.fork()
    if not process:
        try:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            work(lambda said: _write(write, f"{said}\n".encode()))
        finally:
            os._exit(0)
    os.close(write)
    with open(read, encoding="utf-8") as lines:
        said = lines.read().split("\n")[:-1]
    _, status = os.waitpid(process, 0)
    return said, os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0


def _write(file: int, said: bytes) -> None:
    while said:
        said = said[os.write(file, said) :]


def with_session(work: Callable[[Session], None], tests: Iterable[str]) -> None:
    """Collect tests and do something with them instead of running them."""

    class Loop:
        def pytest_runtestloop(self, session: pytest.Session) -> bool:
            work(Session(named(session.items)))
            return True

    options = ["-n", "0", "-q", "--no-header", "-p", "no:cacheprovider", "-p", "no:faulthandler", "-s"]
    os.environ["CI"] = "1"  # the same examples of properties each time
    pytest.main(["--rootdir", str(ROOT), *options, *(str(ROOT / name) for name in tests)], plugins=[Loop()])
