"""A skipped test fails in CI."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SKIPPED_TEST = "import pytest\n\ndef test_a():\n    pytest.skip('no program')\n"
SKIPPED_MODULE = "import pytest\n\npytest.importorskip('no_such_module')\n\ndef test_a():\n    pass\n"


@pytest.mark.system
@pytest.mark.parametrize("content", [SKIPPED_TEST, SKIPPED_MODULE])
@pytest.mark.parametrize(("ci", "fails"), [("1", True), ("", False)])
def test_skipped_test_fails_in_ci(tmp_path: Path, content: str, ci: str, fails: bool) -> None:
    (tmp_path / "test_it.py").write_text(content)
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    command = [sys.executable, "-m", "pytest", "-p", "tests.no_silent_skip", "--rootdir", tmp_path, tmp_path]
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST_")}
    environment |= {"CI": ci, "PYTHONPATH": path}
    finished_process = subprocess.run(
        command,
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ("a skip is a failure" in finished_process.stdout) == fails, (
        finished_process.stdout + finished_process.stderr
    )
    assert (finished_process.returncode in (1, 2)) == fails, finished_process.stdout
