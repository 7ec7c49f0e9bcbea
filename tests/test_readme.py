"""The README's own code runs, and its commands are the ones that decide."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()


def test_first_steps_run() -> None:
    code = re.search(r"## First steps\n\n```python\n(.*?)```", README, re.DOTALL)
    assert code is not None
    names: dict[str, object] = {}
    exec(compile(code.group(1), "README.md", "exec"), names)
    result = names["result"]
    assert float(result["end_traction_residual"]) < 1e-4  # type: ignore[index]


def test_named_files_exist() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).exists(), target


def test_ci_calls_the_same_test_command() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert 'pip" install --quiet -e ".[dev]"' in script
    assert '/bin/pytest"' in script
    assert '.venv/bin/pip install -e ".[dev]" && .venv/bin/pytest' in README
