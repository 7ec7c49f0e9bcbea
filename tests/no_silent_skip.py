"""Plugin of pytest: with the environment variable CI a skip is a failure."""

from __future__ import annotations

import os
from collections.abc import Generator

import pytest
from sybil.integration.pytest import SybilItem


def _refuse(report: pytest.TestReport | pytest.CollectReport) -> None:
    """Turn a skip into a failure if skips are forbidden."""
    if not os.environ.get("CI") or not report.skipped or hasattr(report, "wasxfail"):
        return
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    report.outcome = "failed"
    report.longrepr = f"{reason}\nWith the environment variable CI set, a skip is a failure: install the missing parts."


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Forbid skipped tests; blocks of the documentation state the reason in their page."""
    report = yield
    if not isinstance(item, SybilItem):
        _refuse(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Forbid skipped files."""
    report = yield
    _refuse(report)
    return report
