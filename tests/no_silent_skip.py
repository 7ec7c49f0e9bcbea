"""Plugin of pytest: a skip is a failure if the environment variable CI is set."""

from __future__ import annotations

import os
from collections.abc import Generator

import pytest
from sybil.integration.pytest import SybilItem


def fail_skip(report: pytest.TestReport | pytest.CollectReport) -> None:
    """Turn a skip into a failure if CI is set."""
    if not os.environ.get("CI") or not report.skipped or hasattr(report, "wasxfail"):
        return
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    report.outcome = "failed"
    report.longrepr = f"{reason}\nWith the environment variable CI set, a skip is a failure: install the missing parts."


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Fail skipped tests, except blocks of the documentation, whose page contains the reason."""
    report = yield
    if not isinstance(item, SybilItem):
        fail_skip(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Fail skipped files."""
    report = yield
    fail_skip(report)
    return report
