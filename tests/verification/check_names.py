"""The list of the suite's checks, from which the tests take the names of the checks before the run.

After checks were added or renamed, ``python -m tests.verification.check_names`` writes the list anew.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import NamedTuple

from contactstudy.verification import Verification, suite

LIST = Path(__file__).with_name("checks.csv")


class ListedCheck(NamedTuple):
    """One check: the first level that contains it, its group, and its name."""

    level: str
    group: str
    case: str
    quantity: str

    @property
    def name(self) -> str:
        return f"{self.case}: {self.quantity}"


def names(verification: Verification) -> list[tuple[str, str, str]]:
    """Group, case and quantity of every check."""
    return [(group, check.case, check.quantity) for group, checks in verification.groups.items() for check in checks]


def read() -> list[ListedCheck]:
    """All listed checks."""
    with LIST.open(newline="") as file:
        return [ListedCheck(**row) for row in csv.DictReader(file)]


def write() -> None:
    """Run the suite and list its checks."""
    quick_names, full_names = (names(suite.run(level)) for level in suite.LEVELS)
    with LIST.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(ListedCheck._fields)
        writer.writerows(("quick" if key in quick_names else "full", *key) for key in full_names)


if __name__ == "__main__":
    write()
