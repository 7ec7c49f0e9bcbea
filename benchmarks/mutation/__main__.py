"""Try changes of the solver's core: ``python -m benchmarks.mutation --notes FOLDER``.

First, every selected test runs once, and ``FOLDER/reached.jsonl`` stores its lines of the core and its time. Then each
change is made in a fork of the process with all imports. The tests of the changed statement run; tests with many
failures per time run first. ``FOLDER/tried.jsonl`` has a line for each tested change; a second run continues with the
remaining changes.
"""

from __future__ import annotations

import argparse
import json
import os
import traceback
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable
from dataclasses import asdict
from pathlib import Path
from random import Random
from typing import Any

from benchmarks.mutation.equivalent import EQUIVALENT
from benchmarks.mutation.forks import TESTS, Reached, Session, with_session
from benchmarks.mutation.mutants import PACKAGES, Mutant, list_mutants

Notes = dict[str, Any]


def read_notes(file: Path, key: str) -> dict[str, Notes]:
    """Lines of JSON by their entry `key`; the last line of each key counts."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    return {note[key]: note for note in map(json.loads, lines)}


def share_work(work: Callable[[Any], Notes], jobs: list[Any], file: Path, processes: int) -> None:
    """Distribute jobs over processes and append each result to a file.

    Raises
    ------
    RuntimeError
        If a process ends before its last job.
    """
    for process_index in range(processes):
        if os.fork():
            continue
        try:
            for job in jobs[process_index::processes]:
                line = json.dumps(work(job))
                with file.open("a", encoding="utf-8") as notes:
                    notes.write(f"{line}\n")
            os._exit(0)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(1)
    exit_codes = [os.wait()[1] for _ in range(processes)]
    if any(exit_codes):
        raise RuntimeError("a process ended early: run the command again, the results so far are kept")


class Trials:
    """Trials of changes: the tests of the changed lines run until one fails, or for `seconds`."""

    def __init__(self, session: Session, reached: Iterable[Reached], seconds: float) -> None:
        self.session, self.seconds = session, seconds
        self.test_seconds: dict[str, float] = {}
        self.tests_by_line: dict[tuple[str, str], set[str]] = defaultdict(set)
        self.failure_counts: dict[str, Counter[str]] = defaultdict(Counter)
        for reached_test in reached:
            if not reached_test.passed or reached_test.test not in session.items:
                continue
            self.test_seconds[reached_test.test] = reached_test.seconds
            for file, lines in reached_test.lines.items():
                for line in lines:
                    self.tests_by_line[file, line].add(reached_test.test)

    def count_failures(self, notes: dict[str, Notes]) -> None:
        """Count the failures of each test in previous trials."""
        for change, note in notes.items():
            self.failure_counts[change.split(":")[0]][note["by"].split(" (")[0]] += 1

    def tests(self, mutant: Mutant) -> list[tuple[str, float]]:
        """Tests that run a changed statement, with their seconds, ordered by failures per time."""
        reaching_tests = set().union(*(self.tests_by_line[mutant.file, line] for line in mutant.lines))
        failures_by_test = self.failure_counts[mutant.file]
        ordered_tests = sorted(
            reaching_tests, key=lambda test: (self.test_seconds[test] + 0.05) / (1 + 5 * failures_by_test[test])
        )
        chosen_tests, total_seconds = [], 0.0
        for test in ordered_tests:
            if total_seconds + self.test_seconds[test] <= self.seconds:
                chosen_tests.append((test, self.test_seconds[test]))
                total_seconds += self.test_seconds[test]
        return chosen_tests

    def try_mutant(self, mutant: Mutant) -> Notes:
        """Test a change and return the first failing test."""
        tests = self.tests(mutant)
        failing_test = self.session.find_first_failure(tests, mutant)
        self.failure_counts[mutant.file][failing_test.split(" (")[0]] += 1
        print("noticed" if failing_test else "MISSED ", mutant.key, flush=True)
        return {"change": mutant.key, "by": failing_test, "tests": len(tests)}


def format_summary(notes: dict[str, Notes]) -> str:
    """Counts by package, and every change without a failing test."""
    lines = []
    for package in PACKAGES:
        notes_of_package = [note for key, note in notes.items() if f"/{package}/" in key]
        survivors = [note for note in notes_of_package if not note["by"]]
        equivalent = [note for note in survivors if note["change"] in EQUIVALENT]
        lines.append(
            f"{package}: {len(notes_of_package)} tried, {len(notes_of_package) - len(survivors)} failure_counts, "
            f"{len(equivalent)} equivalent, "
            f"{len(survivors) - len(equivalent)} missed"
        )
    return "\n".join(
        lines + [f"  missed: {key}" for key, note in notes.items() if not note["by"] and key not in EQUIVALENT]
    )


def main() -> None:
    """Test the selected changes."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutation", description=__doc__)
    parser.add_argument("--notes", type=Path, required=True, help="folder of notes")
    parser.add_argument("--sample", type=int, help="number of random changes; default: all")
    parser.add_argument("--only", default="", help="only changes whose source or text contains this string")
    parser.add_argument("--tests", nargs="+", default=TESTS, help="files of tests; default: those of the core")
    parser.add_argument("--again", action="store_true", help="repeat the trials of changes without a failing test")
    parser.add_argument("--seconds", type=float, default=60.0, help="processor time of tests for one change")
    parser.add_argument("--processes", type=int, default=1, help="processes that share the work")
    options = parser.parse_args()
    options.notes.mkdir(parents=True, exist_ok=True)
    reached_path, tried_path = options.notes / "reached.jsonl", options.notes / "tried.jsonl"

    def run_trials(session: Session) -> None:
        durations = read_notes(reached_path, "test")
        tests = [test for test in session.items if test not in durations]
        share_work(lambda test: asdict(session.find_reached_statements(test)), tests, reached_path, options.processes)
        trials = Trials(
            session, (Reached(**note) for note in read_notes(reached_path, "test").values()), options.seconds
        )
        notes = read_notes(tried_path, "change")
        trials.count_failures(notes)
        finished_keys = {key for key, note in notes.items() if note["by"] or not options.again}
        mutants = [mutant for mutant in list_mutants() if options.only in mutant.key]
        Random(0).shuffle(mutants)
        remaining = [
            mutant for mutant in mutants[: options.sample] if mutant.key not in finished_keys | set(EQUIVALENT)
        ]
        share_work(trials.try_mutant, remaining, tried_path, options.processes)
        print(format_summary(read_notes(tried_path, "change")))

    with_session(run_trials, options.tests)


if __name__ == "__main__":
    main()
