"""Run collected tests in forks of one process with the imported package.

Forks share no results and no changes: a test in a fork runs alone.
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

from benchmarks.mutation.mutants import PACKAGES, ROOT, Mutant

TESTS = (
    *(f"contactstudy/{package}" for package in (*PACKAGES, "fields")),
    *(f"tests/{package}" for package in (*PACKAGES, "fields", "verification")),
    "tests/solution",
)
"""Tests of the changed packages and of their callers."""

MEMORY = 6 * 2**30
"""Bound on the bytes of a fork; a change that exceeds it fails."""

SPARE_SECONDS, TIMES = 2.0, 5.0
"""Bound on the processor time of a test: seconds, and a multiple of the time without a change."""

CORE = tuple(str(ROOT / "contactstudy" / package) for package in PACKAGES)


@dataclass(frozen=True)
class Reached:
    """Run of a test without a change.

    Attributes
    ----------
    test : str
        Name.
    passed : bool
        Whether the test passes.
    seconds : float
        Processor time of the test.
    lines : dict of str to list of str
        Texts of the core's lines that the test runs, by source; texts do not depend on inserted lines.
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
        Tests by name; tests that share one calculation form a group.
    functions : dict
        Functions by source, name and first line.
    """

    items: dict[str, list[pytest.Item]]
    functions: dict[tuple[str, str, int], list[FunctionType]] = field(init=False)

    def __post_init__(self) -> None:
        functions = defaultdict(list)
        for function in gc.get_objects():
            if isinstance(function, FunctionType) and function.__code__.co_filename.startswith(CORE):
                functions[_make_code_key(function.__code__)].append(function)
        self.functions = dict(functions)
        gc.freeze()  # a garbage collection in a fork would copy every imported object

    def find_reached_statements(self, test: str) -> Reached:
        """Run a test without any change and record its lines."""
        lines: dict[str, set[int]] = defaultdict(set)

        def run_test(send: Callable[[str], None]) -> None:
            sys.settrace(_make_tracer(lines))
            start_time = time.process_time()
            test_failed = self._fails(test)
            sys.settrace(None)
            statements = {}
            for name, line_numbers in lines.items():
                texts = Path(name).read_text(encoding="utf-8").splitlines()
                statements[str(Path(name).relative_to(ROOT))] = sorted(
                    {texts[line_number - 1].strip() for line_number in line_numbers}
                )
            send(json.dumps(asdict(Reached(test, not test_failed, time.process_time() - start_time, statements))))

        message, _ = run_forked(run_test)
        return Reached(**json.loads(message[-1])) if message else Reached(test, False, 0.0, {})

    def find_first_failure(self, tests: Iterable[tuple[str, float]], mutant: Mutant | None = None) -> str:
        """Return the name of the first test that fails under a change, empty if all pass; `tests` has names and
        seconds."""

        def run_tests(send: Callable[[str], None]) -> None:
            if mutant:
                self._install(mutant)
            for test, seconds in tests:
                send(test)
                signal.setitimer(signal.ITIMER_PROF, SPARE_SECONDS + TIMES * seconds)
                if self._fails(test):
                    return
            send("")

        message, exit_code = run_forked(run_tests)
        return message[-1] + (f" (ended by {signal.Signals(exit_code).name})" if exit_code else "")

    def _fails(self, test: str) -> bool:
        """Whether a test with its fixtures fails."""
        failures, items = _Failures(), self.items[test]
        plugins = items[0].config.pluginmanager
        plugins.register(failures)
        for item in items:
            plugins.hook.pytest_runtest_protocol(item=item, nextitem=None)
            if failures.failed:
                break
        plugins.unregister(failures)
        return bool(failures.failed)

    def _install(self, mutant: Mutant) -> None:
        """Replace the code of all functions of a source, also of imported and wrapped functions."""
        for code in list_nested_codes(compile(mutant.changed, str(ROOT / mutant.file), "exec")):
            for function in self.functions.get(_make_code_key(code), ()):
                function.__code__ = code


class _Failures:
    """Plugin that records failures."""

    def __init__(self) -> None:
        self.failed: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.failed.append(report.nodeid)


def group_by_name(items: Iterable[pytest.Item]) -> dict[str, list[pytest.Item]]:
    """Tests by name; the checks of a group of `contactstudy verify` are computed together."""
    groups: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        entry = item.callspec.params.get("entry") if hasattr(item, "callspec") else None
        groups[f"{item.nodeid.split('[')[0]}[{entry.group}]" if hasattr(entry, "group") else item.nodeid].append(item)
    return dict(groups)


def _make_code_key(code: CodeType) -> tuple[str, str, int]:
    return code.co_filename, code.co_qualname, code.co_firstlineno


def list_nested_codes(code: CodeType) -> Iterator[CodeType]:
    """Code of all functions nested in a code."""
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from list_nested_codes(constant)


def _make_tracer(lines: dict[str, set[int]]) -> Callable[[FrameType, str, Any], Any]:
    """Trace that records the lines of the core."""

    def trace_call(frame: FrameType, event: str, value: Any) -> Any:
        name = frame.f_code.co_filename
        if not name.startswith(CORE):
            return None
        record_line = lines[name].add
        record_line(frame.f_lineno)

        def trace_line(frame: FrameType, event: str, value: Any) -> Any:
            record_line(frame.f_lineno)
            return trace_line

        return trace_line

    return trace_call


def run_forked(send_messages: Callable[[Callable[[str], None]], None]) -> tuple[list[str], int]:
    """Run a function in a fork; return its messages, and the signal that ended the fork or 0."""
    read_end, write_end = os.pipe()
    process = os.fork()
    if not process:
        try:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            send_messages(lambda message: _write(write_end, f"{message}\n".encode()))
        finally:
            os._exit(0)
    os.close(write_end)
    with open(read_end, encoding="utf-8") as stream:
        message = stream.read().split("\n")[:-1]
    _, status = os.waitpid(process, 0)
    return message, os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0


def _write(file: int, message: bytes) -> None:
    while message:
        message = message[os.write(file, message) :]


def with_session(work: Callable[[Session], None], tests: Iterable[str]) -> None:
    """Collect tests and pass them to `work` instead of running them."""

    class Loop:
        def pytest_runtestloop(self, session: pytest.Session) -> bool:
            work(Session(group_by_name(session.items)))
            return True

    options = ["-n", "0", "-q", "--no-header", "-p", "no:cacheprovider", "-p", "no:faulthandler", "-s"]
    os.environ["CI"] = "1"  # hypothesis draws the same examples each time
    pytest.main(["--rootdir", str(ROOT), *options, *(str(ROOT / name) for name in tests)], plugins=[Loop()])
