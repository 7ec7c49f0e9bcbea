"""A killed and resumed rolling study."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.faults import rolling


def test_rolling_study_has_requested_size() -> None:
    assert [rolling.rolling_study(cases).size for cases in (500, 6)] == [500, 6]


@pytest.mark.system
def test_killed_rolling_run_equals_undisturbed_run(tmp_path: Path) -> None:
    study = rolling.rolling_study(6)
    undisturbed_study = rolling.run_study(study, tmp_path / "undisturbed", 0)
    assert bool(undisturbed_study["converged"].all())
    assert not rolling.list_differing_variables(undisturbed_study, rolling.run_study(study, tmp_path / "killed", 2, 2))
    changed_study = undisturbed_study.assign(force_y=undisturbed_study["force_y"] + 1e-12)
    assert rolling.list_differing_variables(undisturbed_study, changed_study) == ["force_y"]
