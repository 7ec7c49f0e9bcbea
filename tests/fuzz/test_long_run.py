"""Long runs of random cases: continuation, and kinds of outcomes."""

from __future__ import annotations

import json
import sys
from random import Random

import pytest

from benchmarks.fuzz import __main__ as long_run
from benchmarks.fuzz import outcome, properties
from benchmarks.fuzz.outcome import Outcome, classify_outcome
from benchmarks.fuzz.solutions import ViolationError
from contactstudy import InvalidInputError


@pytest.fixture
def run_command(monkeypatch, tmp_path):
    """Function that runs the command with a stand-in outcome; it returns the exit code and the solved seeds."""
    seeds: list[int] = []

    def make_outcome(rng: Random, **options) -> Outcome:
        return Outcome("violation" if rng.random() < 0.2 else "converged", "said", ("balance",))

    create_random = Random
    monkeypatch.setattr(long_run, "classify_outcome", make_outcome)
    monkeypatch.setattr(long_run, "Random", lambda seed: seeds.append(seed) or create_random(seed))

    def run_with(*arguments: str) -> tuple[int, list[int]]:
        seeds.clear()
        monkeypatch.setattr(sys, "argv", ["fuzz", "--out", str(tmp_path / "notes"), *arguments])
        return long_run.main(), list(seeds)

    return run_with


def test_continued_run_solves_missing_seeds(run_command, tmp_path, capsys) -> None:
    assert run_command("--cases", "3")[1] == [0, 1, 2]
    with (tmp_path / "notes").open("a") as file:
        file.write('{"seed": 3, "ki')  # an interrupted write
    code, seeds = run_command("--cases", "8")
    assert seeds == [3, 4, 5, 6, 7]
    output = capsys.readouterr().out
    violations = [seed for seed in range(8) if Random(seed).random() < 0.2]
    assert code == 1
    assert f"{len(violations)} violation" in output
    assert all(f"seed {seed}: said" in output for seed in violations)
    assert run_command("--cases", "8")[1] == []
    lines = (tmp_path / "notes").read_text().splitlines()
    assert json.loads(lines[-1])["seed"] == 7


def test_unexpected_errors_are_violations(monkeypatch) -> None:
    def make_failure(error: Exception):
        def raise_error(*arguments: object, **options: object) -> None:
            raise error

        return raise_error

    for error, kind in ((ZeroDivisionError(), "violation"), (InvalidInputError("a", 1, "b"), "refused")):
        monkeypatch.setattr(outcome, "draw_case", make_failure(error))
        assert classify_outcome(Random(0)).kind == kind
    monkeypatch.undo()
    # An error of the package for a variant of a solved case is a violation.
    for error in (ZeroDivisionError(), InvalidInputError("a", 1, "b"), ViolationError()):
        monkeypatch.setattr(properties, "CONSTANT_CHECKS", (make_failure(error),))
        assert classify_outcome(Random(3)).kind == "violation"


def test_slow_cases_are_violations(monkeypatch) -> None:
    monkeypatch.setattr(outcome, "MAX_SECONDS", 0.0)
    outcome_of_slow_case = classify_outcome(Random(3))
    assert outcome_of_slow_case.kind == "violation"
    assert "s of processor time, converged" in outcome_of_slow_case.message
