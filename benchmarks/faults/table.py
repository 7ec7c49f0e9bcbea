"""Table of the kinds of fault, and its place in a page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

BEGIN, END = "<!-- faults -->", "<!-- end of faults -->"
"""Lines of the page between which the table stands."""

HEAD = "| fault | trials | passed | checked properties |\n|---|---|---|---|"


@dataclass(frozen=True)
class Row:
    """A kind of fault.

    Attributes
    ----------
    fault : str
        Fault of the study.
    trials, passed : int
        Number of trials, and of trials with all checked properties.
    result : str
        Checked properties, with figures.
    """

    fault: str
    trials: int
    passed: int
    result: str

    def __str__(self) -> str:
        return f"| {self.fault} | {self.trials} | {self.passed} | {self.result} |"


def write_table(page: Path, rows: list[Row]) -> None:
    """Replace the table between its marks on a page."""
    before, _, remaining_text = page.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = remaining_text.partition(END)
    table = "\n".join([BEGIN, "", HEAD, *map(str, rows), "", END])
    page.write_text(before + table + after, encoding="utf-8")
