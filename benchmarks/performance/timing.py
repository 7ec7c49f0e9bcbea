"""Medians of interleaved runs, and the table of the results."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

# Relative change of an input that avoids cached results, below the accuracy of any result.
NUDGE = 1e-13

COLUMNS = ("work", "ours", "peers", "ours / peers", "bar", "met", "notes")


class Nudge:
    """Factors near 1, all different, so that repeated runs do not use cached results."""

    def __init__(self) -> None:
        self._count = 0

    def __call__(self) -> float:
        """Return the next factor."""
        self._count += 1
        return 1.0 + NUDGE * self._count


nudge = Nudge()


@dataclass(frozen=True, kw_only=True)
class Row:
    """One line of the table; `met` is None where the bar does not apply."""

    work: str
    ours: str
    peers: str = ""
    ratio: str = ""
    bar: str = ""
    met: bool | None = None
    notes: str = ""

    def cells(self) -> list[str]:
        """Return the texts of the columns."""
        met = {None: "", True: "yes", False: "**no**"}[self.met]
        return [self.work, self.ours, self.peers, self.ratio, self.bar, met, self.notes]

    def plain(self) -> str:
        """Return the row as one line for a terminal."""
        return " | ".join(text for text in self.cells() if text)


@dataclass
class Report:
    """Rows and remarks of a run."""

    rows: list[Row] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    def add_remark(self, text: str) -> None:
        """Add a remark unless the report contains it."""
        if text not in self.remarks:
            self.remarks.append(text)

    def markdown(self) -> str:
        """Return the table with the remarks below."""
        lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
        lines += ["| " + " | ".join(row.cells()) + " |" for row in self.rows]
        return "\n".join(lines + [""] + [f"* {remark}" for remark in self.remarks])


def compute_medians(
    functions: Mapping[str, Callable[[], object]], repeats: int, *, warm_up: bool = True
) -> dict[str, float]:
    """Median seconds of each function; the functions take turns, so the load of the machine affects all equally.

    Parameters
    ----------
    works : mapping of callables
        Timed functions by name.
    repeats : int
        Rounds.
    warm_up : bool
        Whether each function runs once before, untimed.
    """
    if warm_up:
        for function in functions.values():
            function()
    seconds: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(repeats):
        for name, function in functions.items():
            start = time.perf_counter()
            function()
            seconds[name].append(time.perf_counter() - start)
    return {name: statistics.median(duration) for name, duration in seconds.items()}


def join_times(seconds: Mapping[str, float]) -> str:
    """Return times by name in one cell."""
    return ", ".join(f"{name} {format_time(duration)}" for name, duration in seconds.items())


def format_time(seconds: float) -> str:
    """Return a time with its unit, to two or three digits."""
    return f"{seconds:.3f} s" if seconds < 1 else f"{seconds:.3g} s"
