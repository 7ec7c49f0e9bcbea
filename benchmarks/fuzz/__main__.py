"""Run random cases and record their outcomes: ``python -m benchmarks.fuzz --cases 10000 --out FILE``.

FILE has one line of JSON for each case, with its seed. A run with an existing file solves the seeds that the file
lacks. ``--seed N`` runs one case and prints it.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from random import Random

from benchmarks.fuzz.outcome import classify_outcome
from benchmarks.fuzz.random_cases import draw_case
from contactstudy import cache

CACHE_BYTES = 100_000_000
"""Bound on the cache: random cases share no operators."""


def read_outcomes(path: Path) -> dict[int, dict[str, object]]:
    """Outcomes of a file by seed, without an incomplete last line."""
    outcomes: dict[int, dict[str, object]] = {}
    if not path.exists():
        return outcomes
    text = path.read_text()
    if text and not text.endswith("\n"):
        path.write_text(text + "\n")
    for line in text.splitlines():
        try:
            outcome = json.loads(line)
        except json.JSONDecodeError:
            continue
        outcomes[outcome["seed"]] = outcome
    return outcomes


def format_summary(outcomes: dict[int, dict[str, object]]) -> str:
    """Counts, and every violation by its seed."""
    kind_counts = Counter(outcome["kind"] for outcome in outcomes.values())
    refusal_counts = Counter(outcome["message"] for outcome in outcomes.values() if outcome["kind"] == "refused")
    property_counts = Counter(name for outcome in outcomes.values() for name in outcome["checked"])  # type: ignore[attr-defined]
    lines = [f"{len(outcomes)} cases: " + ", ".join(f"{count} {kind}" for kind, count in kind_counts.most_common())]
    lines += [f"  refused: {count} {name}" for name, count in refusal_counts.most_common()]
    lines += [f"  held: {count} {name}" for name, count in property_counts.most_common()]
    violations = ((seed, outcome) for seed, outcome in sorted(outcomes.items()) if outcome["kind"] == "violation")
    lines += [f"  seed {seed}: {outcome['message']}" for seed, outcome in violations]
    return "\n".join(lines)


def main() -> int:
    """Run the selected cases."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
    parser.add_argument("--cases", type=int, default=1000, help="seeds 0 to this number")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--out", type=Path, help="file of outcomes, one line for each case")
    parser.add_argument("--seed", type=int, help="run this case only, and print it")
    options = parser.parse_args()
    if options.seed is not None:
        print(draw_case(Random(options.seed)))
        print(classify_outcome(Random(options.seed)))
        return 0
    cache.limit(CACHE_BYTES)
    outcomes = read_outcomes(options.out) if options.out else {}
    for seed in range(options.first, options.first + options.cases):
        if seed in outcomes:
            continue
        outcomes[seed] = outcome = {"seed": seed, **asdict(classify_outcome(Random(seed)))}
        if options.out:
            with options.out.open("a") as file:
                file.write(json.dumps(outcome) + "\n")
        if outcome["kind"] == "violation":
            print(f"seed {seed}: {outcome['message']}", flush=True)
    print(format_summary(outcomes))
    return int(any(outcome["kind"] == "violation" for outcome in outcomes.values()))


if __name__ == "__main__":
    raise SystemExit(main())
