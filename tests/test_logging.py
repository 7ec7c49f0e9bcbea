"""The package logs its stages to configured loggers, and is silent by default."""

from __future__ import annotations

import logging
import subprocess
import sys
from pathlib import Path

import pytest

from contactstudy import Case, HalfSpace, Material, Roller, solve
from contactstudy.analysis.provenance import RUN_ATTRIBUTE, attribute
from contactstudy.cli import main
from contactstudy.study import run_study
from tests.small_study import format_toml, small_study
from tests.stand_in_solver import solve_fake

BODY = HalfSpace(material=Material(210e9, 0.3))
CASE = Case(body=BODY, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9)


def test_solution_stages_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "contactstudy"):
        result = solve(CASE, y=[0.0], z=[1e-5])
    messages = [record.getMessage() for record in caplog.records]
    assert all(record.name.startswith("contactstudy.") for record in caplog.records)
    for prefix in ("refined to ", "contact: ", "stresses: "):
        assert any(message.startswith(prefix) for message in messages), prefix
    run = attribute(result, RUN_ATTRIBUTE)
    assert set(run["stages"]) == {"contact", "stresses"}
    assert run["seconds"] == pytest.approx(sum(run["stages"].values()), abs=1e-3)
    assert min(run["stages"].values()) > 0


def test_study_progress_is_logged(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.2e-3, "max_pressure": 1.5e9}
    parameters = {"body": "half-space", "cells_x": 4, "cells_y": 8, "stresses": False, "e_over_a": 0}
    study = small_study(base=base | parameters, sweep={"friction": [0.0]})
    with caplog.at_level(logging.INFO, "contactstudy"):
        run_study(study, tmp_path, workers=0, progress=False)
    assert any("1/1 cases" in record.getMessage() for record in caplog.records)


def test_verbose_option_logs_to_stderr(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "small.toml").write_text(format_toml(small_study()))
    arguments = ["run", str(tmp_path / "small.toml"), "--out", str(tmp_path / "out"), "--workers", "0", "--no-figure"]
    logger = logging.getLogger("contactstudy")
    previous_level = logger.level
    try:
        assert main(["--verbose", *arguments], solver=solve_fake) == 0
        assert logger.level == logging.INFO
    finally:
        logger.setLevel(previous_level)
    assert any("4/4 cases" in record.getMessage() for record in caplog.records)


def test_versions_option_prints_packages(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--versions"]) == 0
    assert "numpy" in capsys.readouterr().out


@pytest.mark.system
def test_default_logging_is_silent() -> None:
    code = "import logging, contactstudy as cs; logging.getLogger('contactstudy.x').error('lost')"
    finished_process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert finished_process.stdout == finished_process.stderr == ""
