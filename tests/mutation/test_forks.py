"""Mutation run in forked processes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.mutation.__main__ import read_notes
from benchmarks.mutation.equivalent import EQUIVALENT
from benchmarks.mutation.mutants import ROOT, list_mutants


@pytest.mark.system
def test_mutation_run_tests_each_change_by_reaching_tests(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "benchmarks.mutation",
        "--notes",
        str(tmp_path),
        "--only",
        "slab_factors",
        "--tests",
    ]
    for tests in ("tests/overlapping/test_equations_slab.py", "tests/overlapping/test_quadrature.py"):
        subprocess.run([*command, tests], cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)}, check=True)
    reached_notes, tried_notes = (
        read_notes(tmp_path / "reached.jsonl", "test"),
        read_notes(tmp_path / "tried.jsonl", "change"),
    )
    assert {bool(record["lines"]) for test, record in reached_notes.items() if "slab" in test} == {True}
    assert set(tried_notes) == {mutant.key for mutant in list_mutants() if "slab_factors" in mutant.key} - set(
        EQUIVALENT
    )
    assert all("test_equations_slab" in record["by"] for record in tried_notes.values())
