"""What the suite prints and writes says what it found; `test_checks` makes its checks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError
from contactstudy.cli import main
from contactstudy.verification import Verification, report, suite, verify
from contactstudy.verification.check import Check, Curve, compare
from contactstudy.verification.convergence import Table


def fake(full: bool) -> Iterator[Check]:
    """Two checks, of which one fails."""
    x = np.linspace(0, 1, 5)
    yield compare("good | case", "pressure", "Hertz", 1.0, 1.0, 0.1, curve=Curve("x / a", "sigma_xx / p0", x, x, x))
    yield compare("bad case", "pressure", "Hertz", 2.0, 1.0, 0.1)


@pytest.fixture
def small_suite(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(suite, "GROUPS", {"half-space": fake})


@pytest.mark.usefixtures("small_suite")
def test_command_writes_the_table_and_fails_with_a_failed_check(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", "--out", str(tmp_path / "out")]) == 1
    output = capsys.readouterr().out
    assert re.search(r"^ok .* good \| case: pressure \[Hertz\]$", output, re.MULTILINE)
    assert re.search(r"^FAIL .* bad case: pressure \[Hertz\]$", output, re.MULTILINE)
    assert "2 checks in" in output
    assert "1 failed" in output
    data = xr.load_dataset(tmp_path / "out" / "verification.nc")
    assert data["passed"].values.tolist() == [1, 0]
    assert data["difference"].values.tolist() == [0.0, 1.0]
    page = (tmp_path / "out" / "verification.md").read_text()
    assert "**FAIL**" in page
    assert r"good \| case" in page
    for figure in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page):
        assert (tmp_path / "out" / figure).stat().st_size > 1000
    assert "half_space.png" in page


@pytest.mark.usefixtures("small_suite")
def test_command_succeeds_when_all_checks_pass(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(suite, "GROUPS", {"half-space": lambda full: iter(list(fake(full))[:1])})
    assert main(["verify", "--out", str(tmp_path)]) == 0


def test_nothing_checked_is_not_a_pass() -> None:
    assert not Verification("quick").passed


def test_convergence_tables_are_written_and_drawn(tmp_path: Path) -> None:
    table = Table(
        title="sphere",
        setting="cells",
        source="Hertz",
        values=(8, 16),
        errors={"error": (0.04, 0.01)},
        used=16,
        order=1.0,
    )
    verification = Verification("full", {"convergence": list(table.checks())}, [table], 1.0)
    paths = report.write(verification, tmp_path)
    assert tmp_path / "convergence.png" in paths
    assert "| ... order | | 2.0 |" in (tmp_path / "verification.md").read_text()
    data = xr.load_dataset(tmp_path / "verification.nc")
    assert data["convergence_error"].values.tolist() == [0.04, 0.01]
    assert data["convergence_setting"].values.tolist() == ["cells", "cells"]


@pytest.mark.parametrize("level", ["thorough", "", None, 2])
def test_unknown_levels_are_errors(level: object) -> None:
    with pytest.raises(InvalidInputError, match="level"):
        verify(level)  # type: ignore[arg-type]


def test_a_folder_that_cannot_be_made_is_refused_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert main(["verify", "--out", str(tmp_path / "file")]) == 2
    captured = capsys.readouterr()
    assert "a folder that can be written" in captured.err
    assert captured.out == ""


def test_command_knows_its_levels(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["verify", "--level", "thorough"])
    assert "quick" in capsys.readouterr().err
