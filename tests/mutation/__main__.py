"""Try changes of the solver's core: ``python -m tests.mutation --notes FOLDER``.

At first every test that may notice something is run once, and ``FOLDER/reached.jsonl`` notes which lines of the core
it runs and how long it takes. Then each change is made in a fork of the process that has imported everything, and the
tests that run the changed statement are run, those first that have noticed most for their time. ``FOLDER/tried.jsonl``
has a line for each change that was tried; begun again, the run goes on.
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

from tests.mutation.equivalent import EQUIVALENT
from tests.mutation.forked import TESTS, Reached, Session, with_session
from tests.mutation.mutants import PACKAGES, Mutant, all_mutants

Notes = dict[str, Any]


def read(file: Path, key: str) -> dict[str, Notes]:
    """Lines of JSON by one of their entries; the last one of each counts."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    return {note[key]: note for note in map(json.loads, lines)}


def shared(work: Callable[[Any], Notes], jobs: list[Any], file: Path, processes: int) -> None:
    """Do jobs in some processes and append what each returns to a file.

    Raises
    ------
    RuntimeError
        If a process ended before it had done its jobs.
    """
    for number in range(processes):
        if os.fork():
            continue
        try:
            for job in jobs[number::processes]:
                line = json.dumps(work(job))
                with file.open("a", encoding="utf-8") as notes:
                    notes.write(f"{line}\n")
            os._exit(0)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(1)
    ended = [os.wait()[1] for _ in range(processes)]
    if any(ended):
        raise RuntimeError("a process ended early: begin again, what was tried is kept")


class Trials:
    """Changes that are tried by the tests that reach them, until one fails or `seconds` of tests have passed."""

    def __init__(self, session: Session, reached: Iterable[Reached], seconds: float) -> None:
        self.session, self.seconds = session, seconds
        self.taken: dict[str, float] = {}
        self.by_line: dict[tuple[str, str], set[str]] = defaultdict(set)
        self.noticed: dict[str, Counter[str]] = defaultdict(Counter)
        for each in reached:
            if not each.passed or each.test not in session.items:
                continue
            self.taken[each.test] = each.seconds
            for file, lines in each.lines.items():
                for line in lines:
                    self.by_line[file, line].add(each.test)

    def learn(self, notes: dict[str, Notes]) -> None:
        """Count which tests noticed changes that were tried before."""
        for change, note in notes.items():
            self.noticed[change.split(":")[0]][note["by"].split(" (")[0]] += 1

    def tests(self, mutant: Mutant) -> list[tuple[str, float]]:
        """Tests that run a changed statement, with their seconds: the most promising first."""
        reaching = set().union(*(self.by_line[mutant.file, line] for line in mutant.lines))
        noticed = self.noticed[mutant.file]
        promising = sorted(reaching, key=lambda test: (self.taken[test] + 0.05) / (1 + 5 * noticed[test]))
        chosen, total = [], 0.0
        for test in promising:
            if total + self.taken[test] <= self.seconds:
                chosen.append((test, self.taken[test]))
                total += self.taken[test]
        return chosen

    def tried(self, mutant: Mutant) -> Notes:
        """Try a change and say what noticed it."""
        tests = self.tests(mutant)
        by = self.session.first_failure(tests, mutant)
        self.noticed[mutant.file][by.split(" (")[0]] += 1
        print("noticed" if by else "MISSED ", mutant.key, flush=True)
        return {"change": mutant.key, "by": by, "tests": len(tests)}


def summary(notes: dict[str, Notes]) -> str:
    """Counts by package, and every change that no test noticed."""
    lines = []
    for package in PACKAGES:
        own = [note for key, note in notes.items() if f"/{package}/" in key]
        missed = [note for note in own if not note["by"]]
        same = [note for note in missed if note["change"] in EQUIVALENT]
        lines.append(
            f"{package}: {len(own)} tried, {len(own) - len(missed)} noticed, {len(same)} equivalent, "
            f"{len(missed) - len(same)} missed"
        )
    return "\n".join(
        lines + [f"  missed: {key}" for key, note in notes.items() if not note["by"] and key not in EQUIVALENT]
    )


def main() -> None:
    """Try what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    parser.add_argument("--notes", type=Path, required=True, help="folder of notes")
    parser.add_argument("--sample", type=int, help="so many changes, drawn by lot; default: all")
    parser.add_argument("--only", default="", help="only changes whose source or text has this in it")
    parser.add_argument("--tests", nargs="+", default=TESTS, help="files of tests; default: those of the core")
    parser.add_argument("--again", action="store_true", help="try those again that no test noticed")
    parser.add_argument("--seconds", type=float, default=60.0, help="processor time of tests for one change")
    parser.add_argument("--processes", type=int, default=1, help="processes that share the work")
    asked = parser.parse_args()
    asked.notes.mkdir(parents=True, exist_ok=True)
    reached, tried = asked.notes / "reached.jsonl", asked.notes / "tried.jsonl"

    def work(session: Session) -> None:
        known = read(reached, "test")
        tests = [test for test in session.items if test not in known]
        shared(lambda test: asdict(session.reached(test)), tests, reached, asked.processes)
        trials = Trials(session, (Reached(**note) for note in read(reached, "test").values()), asked.seconds)
        notes = read(tried, "change")
        trials.learn(notes)
        done = {key for key, note in notes.items() if note["by"] or not asked.again}
        mutants = [each for each in all_mutants() if asked.only in each.key]
        Random(0).shuffle(mutants)
        rest = [each for each in mutants[: asked.sample] if each.key not in done | set(EQUIVALENT)]
        shared(trials.tried, rest, tried, asked.processes)
        print(summary(read(tried, "change")))

    with_session(work, asked.tests)


if __name__ == "__main__":
    main()
