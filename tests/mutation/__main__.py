"""Try mutants of the solver's core: ``python -m tests.mutation --sample 100 --out FILE``.

FILE has one line of JSON for each mutant that was tried; begun again with the same file, the run goes on. Without
``--sample`` all are tried, which takes days. ``--survivors`` tries those of the file again that no test noticed.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from random import Random

from tests.mutation.mutants import Mutant, all_mutants
from tests.mutation.trial import ROOT, Trial, copy_repository, try_mutant

PACKAGES = ("kernels", "overlapping", "contact")


def key(mutant: Mutant) -> str:
    """What tells a mutant from others, also after lines have moved."""
    return f"{mutant.file}: {mutant.shown}"


def chosen(mutants: list[Mutant], sample: int | None) -> list[Mutant]:
    """So many of the mutants, always the same ones, from every source in turn."""
    if sample is None:
        return mutants
    by_file: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        by_file.setdefault(mutant.file, []).append(mutant)
    for file, own in by_file.items():
        Random(file).shuffle(own)
    depth = max(len(own) for own in by_file.values())
    in_turn = [own[i] for i in range(depth) for own in by_file.values() if i < len(own)]
    return in_turn[:sample]


def summary(notes: dict[str, dict[str, object]]) -> str:
    """Counts by package, and every mutant that no test noticed."""
    lines = []
    for package in PACKAGES:
        kinds = Counter(note["killed"] for name, note in notes.items() if f"/{package}/" in name)
        lines.append(f"{package}: {kinds.total()} tried, {kinds[True]} noticed, {kinds[False]} not")
    lines += [f"  not noticed: {name}" for name, note in notes.items() if not note["killed"]]
    return "\n".join(lines)


def main() -> int:
    """Try what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    parser.add_argument("--sample", type=int, help="number of mutants; default: all")
    parser.add_argument("--package", choices=PACKAGES, action="append", help="only these; default: all three")
    parser.add_argument("--out", type=Path, required=True, help="file of notes, one line a mutant")
    parser.add_argument("--survivors", action="store_true", help="try those again that were not noticed")
    asked = parser.parse_args()
    lines = asked.out.read_text().splitlines() if asked.out.exists() else []
    notes = {note["mutant"]: note for note in map(json.loads, lines)}
    again = {name for name, note in notes.items() if asked.survivors and not note["killed"]}
    mutants = chosen(all_mutants(ROOT, tuple(asked.package or PACKAGES)), None if asked.survivors else asked.sample)
    with tempfile.TemporaryDirectory(prefix="mutation-") as place:
        copy_repository(Path(place))
        for mutant in mutants:
            name = key(mutant)
            if name not in again if asked.survivors else name in notes:
                continue
            found: Trial = try_mutant(mutant, Path(place))
            notes[name] = {"mutant": name, **asdict(found)}
            print("noticed " if found.killed else "MISSED  ", f"{found.seconds:5.0f} s", name, flush=True)
            with asked.out.open("a") as file:
                file.write(json.dumps(notes[name]) + "\n")
    print(summary(notes))
    return int(any(not note["killed"] for note in notes.values()))


if __name__ == "__main__":
    raise SystemExit(main())
