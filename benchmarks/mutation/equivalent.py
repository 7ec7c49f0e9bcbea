"""Changes without an effect on any number, with reasons, from ``equivalent.txt``."""

from __future__ import annotations

from pathlib import Path


def read_equivalent() -> dict[str, str]:
    """Reason by change; in the file a reason, after ``#``, precedes its changes."""
    reasons, reason = {}, ""
    for line in Path(__file__).with_suffix(".txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            reason = line.removeprefix("#").strip()
        elif line:
            reasons[line] = reason
    return reasons


EQUIVALENT = read_equivalent()
