"""How tests are run: hypothesis' profiles, and no silent skip in CI."""

from __future__ import annotations

import os
from collections.abc import Generator

import pytest
from hypothesis import settings
from sybil.integration.pytest import SybilItem

pytest_plugins = ("tests.documentation.blocks", "tests.documentation.notebooks")

IN_CI = bool(os.environ.get("CI"))

# Figures are drawn to files, with and without a screen.
os.environ.setdefault("MPLBACKEND", "Agg")
# dask silences numpy's warnings about empty slices with `warnings.catch_warnings`, which threads undo for one another.
os.environ.setdefault("DASK_SCHEDULER", "synchronous")

# Times depend on the machine, so no example has a deadline. What lands must not hang on chance: the examples of the
# short profile are always the same in CI, the search of `thorough` (`--hypothesis-profile=thorough`) is never.
settings.register_profile("short", max_examples=20, deadline=None, derandomize=IN_CI)
settings.register_profile("thorough", max_examples=200, deadline=None)
settings.load_profile("short")


def _refuse_skip(report: pytest.TestReport | pytest.CollectReport) -> None:
    """Turn a skip into a failure."""
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    report.outcome = "failed"
    report.longrepr = (
        f"{reason}\nNothing may be skipped where the environment variable CI is set: install what is missing."
    )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Let no test be skipped in CI; blocks of the documentation say in the page itself why they are."""
    report = yield
    if IN_CI and report.skipped and not hasattr(report, "wasxfail") and not isinstance(item, SybilItem):
        _refuse_skip(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Let no file be skipped in CI."""
    report = yield
    if IN_CI and report.skipped:
        _refuse_skip(report)
    return report
