"""Run random cases and record their outcomes: ``python -m benchmarks.fuzz --cases 10000 --out FILE``.

FILE has one line of JSON for each case, with its seed. Begun again with the same file, the run goes on with the seeds
that are not in it. ``--seed N`` runs one case and shows it.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from random import Random

from benchmarks.fuzz.outcome import outcome_of
from benchmarks.fuzz.random_cases import draw_case
from contactstudy import cache

CACHE_BYTES = 100_000_000
"""Of operators and contacts: random cases have none in common."""


def read_notes(path: Path) -> dict[int, dict[str, object]]:
    """Notes of a file by seed, without an incomplete last line."""
    notes_by_seed: dict[int, dict[str, object]] = {}
    if not path.exists():
        return notes_by_seed
    text = path.read_text()
    if text and not text.endswith("\n"):
        path.write_text(text + "\n")
    for line in text.splitlines():
        try:
            note = json.loads(line)
        except json.JSONDecodeError:
            continue
        notes_by_seed[note["seed"]] = note
    return notes_by_seed


def summary(notes: dict[int, dict[str, object]]) -> str:
    """Counts, and every violation by its seed."""
    kinds = Counter(note["kind"] for note in notes.values())
    refused = Counter(note["message"] for note in notes.values() if note["kind"] == "refused")
    counts = Counter(name for note in notes.values() for name in note["checked"])  # type: ignore[attr-defined]
    lines = [f"{len(notes)} cases: " + ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())]
    lines += [f"  refused: {count} {name}" for name, count in refused.most_common()]
    lines += [f"  held: {count} {name}" for name, count in counts.most_common()]
    violations = ((seed, note) for seed, note in sorted(notes.items()) if note["kind"] == "violation")
    lines += [f"  seed {seed}: {note['message']}" for seed, note in violations]
    return "\n".join(lines)


def main() -> int:
    """Run the selected cases."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
    parser.add_argument("--cases", type=int, default=1000, help="seeds 0 to this number")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--out", type=Path, help="file of notes, one line a case")
    parser.add_argument("--seed", type=int, help="run this case only, and show it")
    options = parser.parse_args()
    if options.seed is not None:
        print(draw_case(Random(options.seed)))
        print(outcome_of(Random(options.seed)))
        return 0
    cache.limit(CACHE_BYTES)
    notes = read_notes(options.out) if options.out else {}
    for seed in range(options.first, options.first + options.cases):
        if seed in notes:
            continue
        notes[seed] = note = {"seed": seed, **asdict(outcome_of(Random(seed)))}
        if options.out:
            with options.out.open("a") as file:
                file.write(json.dumps(note) + "\n")
        if note["kind"] == "violation":
            print(f"seed {seed}: {note['message']}", flush=True)
    print(summary(notes))
    return int(any(note["kind"] == "violation" for note in notes.values()))


if __name__ == "__main__":
    raise SystemExit(main())
