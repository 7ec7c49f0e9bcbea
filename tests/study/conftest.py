"""Small studies for all tests of the study layer."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from contactstudy.study import Study
from contactstudy.study.identity import case_id

BASE = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 0.5e-3,
    "max_pressure": 1.5e9,
    "cells_x": 4,
    "cells_y": 8,
    "field_y_over_a": [0.0],
    "field_x_over_a": [0.0, 1.0, 2.0],
    "field_z_over_a": [0.0, 0.5, 1.0],
}
ROOT = Path(__file__).parents[2]


def small_study(name: str = "small", **changes) -> Study:
    """Four cases, or what `changes` make of it."""
    content = {"base": BASE, "sweep": {"e_over_a": [0.0, 1.0], "friction": [0.0, 0.1]}} | changes
    return Study(name=name, **content)


def identity(**changes) -> str:
    """Identity of a case of the small study."""
    return case_id(BASE | changes)


def as_toml(study: Study) -> str:
    """A study as a TOML file; JSON's numbers, texts and lists are TOML as well."""
    lines = [f"name = {json.dumps(study.name)}", f"level = {json.dumps(study.level)}"]
    for part in ("base", "sweep"):
        lines.append(f"[{part}]")
        lines += [f"{key} = {json.dumps(value)}" for key, value in getattr(study, part).items()]
    return "\n".join(lines) + "\n"


def start_run(study: Path, folder: Path, *more: str, seconds: float = 0.2) -> subprocess.Popen[str]:
    """Start the command with the stand-in solver as a process group of its own."""
    import os

    return subprocess.Popen(
        [sys.executable, "-m", "tests.study.fake_run", "run", str(study), "--out", str(folder), "--no-figure", *more],
        cwd=ROOT,
        start_new_session=True,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=os.environ | {"CONTACTSTUDY_TEST_SECONDS": str(seconds)},
    )


@pytest.fixture
def study() -> Study:
    return small_study()


@pytest.fixture
def study_file(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(as_toml(small_study()))
    return path
