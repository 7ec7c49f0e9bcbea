"""Table of faults in the page, and counts of failed trials."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

from benchmarks.faults import hosts, scenarios, studies
from benchmarks.faults.table import BEGIN, END, Row, write_table
from tests.study.conftest import ROOT

PAGE = ROOT / "docs" / "explanation" / "reliability.md"


@pytest.fixture(scope="module")
def undisturbed() -> xr.Dataset:
    return studies.compute_undisturbed_values()


def test_table_replaces_previous_table(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"before\n\n{BEGIN}\nold\n{END}\n\nafter\n")
    for passed_trials in (1, 2):
        write_table(page, [Row("kill", 2, passed_trials, "all")])
    text = page.read_text()
    assert text.startswith("before\n\n")
    assert text.endswith("\n\nafter\n")
    assert "| kill | 2 | 2 | all |" in text
    assert "old" not in text
    assert text.count("| kill") == 1


def test_page_contains_table_markers() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert text.count(BEGIN) == text.count(END) == 1


@pytest.mark.system
def test_study_survives_every_fault(undisturbed: xr.Dataset) -> None:
    for row in (
        scenarios.damage_batches(undisturbed, len(scenarios.DAMAGES)),
        scenarios.kill_runs(undisturbed, 1),
        scenarios.kill_runs(undisturbed, 1, workers=2),
        scenarios.shift_clock(undisturbed, 1),
        hosts.run_on_two_hosts(undisturbed, 1),
    ):
        assert row.passed == row.trials, row


@pytest.mark.system
def test_trial_with_deleted_batch_fails(undisturbed: xr.Dataset, monkeypatch) -> None:
    monkeypatch.setattr(scenarios, "DAMAGES", (lambda path, other_batch_path: path.unlink(),))
    monkeypatch.setattr(studies, "count_damaged_batches", lambda folder: 1)
    assert scenarios.damage_batches(undisturbed, 1).passed == 0
