"""Run random cases, one after another, and note what became of each: ``python -m tests.fuzz --cases 10000 --out FILE``.

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

from contactstudy import cache
from tests.fuzz.drawn import random_drawn
from tests.fuzz.outcome import outcome_of

KEPT_BYTES = 100_000_000
"""Of operators and contacts: random cases have none in common."""


def done(path: Path) -> dict[int, dict[str, object]]:
    """What a file notes, by seed; a line that was being written when the run ended does not count."""
    found: dict[int, dict[str, object]] = {}
    if not path.exists():
        return found
    text = path.read_text()
    if text and not text.endswith("\n"):
        path.write_text(text + "\n")
    for line in text.splitlines():
        try:
            note = json.loads(line)
        except json.JSONDecodeError:
            continue
        found[note["seed"]] = note
    return found


def summary(notes: dict[int, dict[str, object]]) -> str:
    """Counts, and every violation by its seed."""
    kinds = Counter(note["kind"] for note in notes.values())
    refused = Counter(note["said"] for note in notes.values() if note["kind"] == "refused")
    held = Counter(name for note in notes.values() for name in note["checked"])  # type: ignore[attr-defined]
    lines = [f"{len(notes)} cases: " + ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())]
    lines += [f"  refused: {count} {name}" for name, count in refused.most_common()]
    lines += [f"  held: {count} {name}" for name, count in held.most_common()]
    lines += [f"  seed {seed}: {note['said']}" for seed, note in sorted(notes.items()) if note["kind"] == "violation"]
    return "\n".join(lines)


def main() -> int:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--cases", type=int, default=1000, help="seeds 0 to this number")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--out", type=Path, help="file of notes, one line a case")
    parser.add_argument("--seed", type=int, help="run this case only, and show it")
    asked = parser.parse_args()
    if asked.seed is not None:
        print(random_drawn(Random(asked.seed)))
        print(outcome_of(Random(asked.seed)))
        return 0
    cache.limit(KEPT_BYTES)
    notes = done(asked.out) if asked.out else {}
    for seed in range(asked.first, asked.first + asked.cases):
        if seed in notes:
            continue
        notes[seed] = note = {"seed": seed, **asdict(outcome_of(Random(seed)))}
        if asked.out:
            with asked.out.open("a") as file:
                file.write(json.dumps(note) + "\n")
        if note["kind"] == "violation":
            print(f"seed {seed}: {note['said']}", flush=True)
    print(summary(notes))
    return int(any(note["kind"] == "violation" for note in notes.values()))


if __name__ == "__main__":
    raise SystemExit(main())
