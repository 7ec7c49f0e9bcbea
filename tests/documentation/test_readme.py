"""Files named in the README exist, and CI runs the tests of its commands."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()


def test_named_files_exist() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).exists(), target


def test_ci_runs_every_tier() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert '.venv/bin/pip install -e ".[dev]" && .venv/bin/pytest' in README
    assert 'pip install --quiet -e ".[$extras]"' in script
    assert "extras=dev" in script
    assert re.findall(r'"\$bin"/pytest -m ("not browser"|\w+)', script) == ['"not browser"', "browser"]
    for tier in ("system", "slow"):
        assert f".venv/bin/pytest -m {tier}`" in README
