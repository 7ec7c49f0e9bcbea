"""Output of the suite; `test_suite_checks` runs its checks."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, MagnitudeWarning
from contactstudy.cli import main
from contactstudy.verification import Verification, suite, verify
from contactstudy.verification.problems import Check, Curve, Reference


def make_fake_checks() -> Iterator[Check]:
    """A group of two checks; one check fails."""
    x = np.linspace(0, 1, 5)
    yield Reference("good | case", "Hertz").compare(
        "pressure",
        1.0,
        1.0,
        0.1,
        curve=Curve(("x / a", "sigma_xx / p0"), x, x, x),
    )
    yield Reference("bad case", "Hertz").compare("pressure", 2.0, 1.0, 0.1)


@pytest.fixture
def small_suite(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(suite, "GROUPS", {"half-space": lambda full: (make_fake_checks(),)})


@pytest.mark.usefixtures("small_suite")
def test_failed_check_returns_code_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
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
    monkeypatch.setattr(suite, "GROUPS", {"half-space": lambda full: (itertools.islice(make_fake_checks(), 1),)})
    assert main(["verify", "--out", str(tmp_path)]) == 0


def test_suite_with_unit_properties_raises_no_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    """Material properties of 1 are unusual in SI units, but not in the suite's units."""
    monkeypatch.setattr(suite, "GROUPS", {"heat": suite.GROUPS["heat"]})
    with warnings.catch_warnings():
        warnings.simplefilter("error", MagnitudeWarning)
        assert suite.run().passed


def test_empty_verification_fails() -> None:
    assert not Verification("quick").passed


@pytest.mark.parametrize("level", ["thorough", "", None, 2])
def test_unknown_level_raises(level: object) -> None:
    with pytest.raises(InvalidInputError, match="level"):
        verify(level)  # type: ignore[arg-type]


def test_file_as_output_folder_returns_code_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    assert main(["verify", "--out", str(tmp_path / "file")]) == 2
    captured = capsys.readouterr()
    assert "a folder that can be written" in captured.err
    assert captured.out == ""


def test_unknown_level_on_command_line_raises(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["verify", "--level", "thorough"])
    assert "quick" in capsys.readouterr().err
