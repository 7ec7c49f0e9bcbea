"""Paths and test commands of the README."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()


def test_link_targets_exist() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).exists(), target


def test_test_commands_equal_those_of_ci() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert '.venv/bin/pip install -e ".[dev]" && .venv/bin/pytest' in README
    assert 'pip install --quiet -e ".[$extras]"' in script
    assert "extras=dev" in script
    assert '"$bin"/pytest\n' in script
    (tiers,) = re.findall(r'"\$bin"/pytest -m "(system .*?)"', script)
    for tier in ("system", "slow"):
        assert tier in tiers.split(" or ")
        assert f".venv/bin/pytest -m {tier}`" in README
