"""Files that the README names exist, and its test commands are the ones that decide."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()


def test_named_files_exist() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).exists(), target


def test_ci_calls_the_same_test_commands() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert '.venv/bin/pip install -e ".[dev]" && .venv/bin/pytest' in README
    assert 'pip install --quiet -e ".[$extras]"' in script
    assert "extras=dev" in script
    for command in ("pytest", "pytest -m system", "pytest -m slow"):
        assert f'"$bin"/{command}\n' in script
        assert f".venv/bin/{command}`" in README or f".venv/bin/{command}\n" in README
