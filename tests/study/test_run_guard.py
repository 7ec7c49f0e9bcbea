"""A script that runs a study without a guard raises an error with the remedy."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
from contactstudy.study import run_study
from tests.small_study import small_study

run_study(small_study(), {folder!r}, workers=1, progress=False)
"""


@pytest.mark.system
def test_unguarded_script_error_contains_remedy(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(folder=str(tmp_path / "results")))
    root = Path(__file__).parents[2]
    process = subprocess.run(
        [sys.executable, script], cwd=root, env=os.environ | {"PYTHONPATH": str(root)}, capture_output=True, text=True
    )
    assert process.returncode == 1
    message = process.stderr.strip().splitlines()[-1]
    assert "if __name__ == '__main__':" in message
    assert "workers=0" in message
    assert process.stderr.count("Traceback") == 1
