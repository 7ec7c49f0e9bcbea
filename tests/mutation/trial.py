"""A mutant in a copy of the repository, and the tests that should notice it."""

from __future__ import annotations

import functools
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.mutation.mutants import Mutant

ROOT = Path(__file__).parents[2]

COPIED = ("contactstudy", "tests", "data", "docs", "studies", "README.md", "pyproject.toml")
"""What tests of the solver need, those that compare it with the documentation among them."""

NO_END = "no end"

SECONDS = 600.0
"""Longest time for one mutant; a change that never ends is noticed by that."""

TESTS = {
    "kernels": (
        ("tests/kernels",),
        ("tests/fields", "tests/contact/test_solve.py", "tests/verification/test_checks.py"),
    ),
    "overlapping": (("tests/overlapping",), ("tests/fields", "tests/kernels", "tests/verification/test_checks.py")),
    "contact": (
        ("tests/contact/test_solve.py", "tests/contact/test_conjugate_gradients.py"),
        ("tests/contact/test_counterbody.py", "tests/contact/test_prescribed.py", "tests/contact/test_settled.py"),
    ),
}
"""Tests of a package: those that are quick or near, and those that are tried if nothing is noticed."""

NEAREST = {
    "certificate": ("tests/contact/test_certificate.py",),
    "slice_model": ("tests/contact/test_slice_model.py",),
    "end_law": ("tests/contact/test_end_law.py",),
    "refinement": ("tests/contact/test_refinement.py",),
    "axial_shape": ("tests/contact/test_refinement.py", "tests/contact/test_settled.py"),
    "settled": ("tests/contact/test_settled.py",),
    "pair": ("tests/contact/test_counterbody.py",),
    "prescribed": ("tests/contact/test_prescribed.py",),
}
"""Tests of a module of the contact, before all others."""


@dataclass(frozen=True)
class Trial:
    """What became of a mutant.

    Attributes
    ----------
    killed : bool
        Whether a test failed, or did not end.
    by : str
        The test that failed.
    seconds : float
        Time it took.
    """

    killed: bool
    by: str
    seconds: float


def copy_repository(place: Path) -> None:
    """Copy what the tests need; mutants never touch the repository itself."""
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, place / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, place / name)


def try_mutant(mutant: Mutant, place: Path) -> Trial:
    """Apply a mutant in a copy, run its tests and take it back.

    Raises
    ------
    RuntimeError
        If the test that fails does so without the mutant as well, and so tells nothing.
    """
    path = place / mutant.file
    source = path.read_text(encoding="utf-8")
    began, failed = time.monotonic(), ""
    path.write_text(mutant.applied(source), encoding="utf-8")
    try:
        for tests in _rounds(mutant):
            failed = _first_failure(place, tests, SECONDS - (time.monotonic() - began))
            if failed:
                return Trial(True, failed, time.monotonic() - began)
        return Trial(False, "", time.monotonic() - began)
    finally:
        path.write_text(source, encoding="utf-8")
        if failed and failed != NO_END and not _passes(place, failed):
            raise RuntimeError(f"without any change, too: {failed}")


def _rounds(mutant: Mutant) -> list[tuple[str, ...]]:
    """Tests to run, one round after another: the source's own example with the nearest tests first."""
    package, module = Path(mutant.file).parts[1], Path(mutant.file).stem
    near, wide = TESTS[package]
    own = ROOT / "tests" / package / f"test_{module}.py"
    first = NEAREST.get(module, (own.relative_to(ROOT).as_posix(),) if own.exists() else near)
    return [(mutant.file, *(name for name in first if (ROOT / name).exists())), near, wide]


def _first_failure(place: Path, tests: tuple[str, ...], seconds: float) -> str:
    """Name the first test that fails; empty if all pass."""
    command = [sys.executable, "-m", "pytest", "-x", "-n", "0", "-q", "--no-header", "--tb=no", *tests]
    settings = {"PYTHONPATH": str(place), "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1", "CI": "1"}
    process = subprocess.Popen(
        command,
        cwd=place,
        env=os.environ | settings,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=max(seconds, 1.0))
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return NO_END
    if process.returncode in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
        return ""
    if process.returncode < 0:
        raise RuntimeError(f"the tests were ended by signal {-process.returncode}")
    failed = [line for line in output.splitlines() if line.startswith(("FAILED", "ERROR"))]
    if not failed:
        raise RuntimeError(f"pytest ended with {process.returncode}: {output[-500:]}")
    return failed[0].split(" - ")[0].split(" ", 1)[1]


@functools.cache
def _passes(place: Path, test: str) -> bool:
    """Whether a test passes in the copy as it is."""
    return not _first_failure(place, (test,), SECONDS)
