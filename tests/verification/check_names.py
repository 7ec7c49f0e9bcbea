"""The file with the names of all checks of the suite; tests are parametrised by it.

``python -m tests.verification.check_names`` writes the file; necessary after a change of names.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import NamedTuple

from contactstudy.verification import Verification, suite

LIST_PATH = Path(__file__).with_name("checks.csv")


class ListedCheck(NamedTuple):
    """One check: the first level that contains it, its group, and its name."""

    level: str
    group: str
    case: str
    quantity: str

    @property
    def name(self) -> str:
        return f"{self.case}: {self.quantity}"


def list_names(verification: Verification) -> list[tuple[str, str, str]]:
    """Group, case and quantity of every check."""
    return [(group, check.case, check.quantity) for group, checks in verification.groups.items() for check in checks]


def read_list() -> list[ListedCheck]:
    """All listed checks."""
    with LIST_PATH.open(newline="") as file:
        return [ListedCheck(**row) for row in csv.DictReader(file)]


def write_list() -> None:
    """Run the suite and list its checks."""
    quick_names, full_names = (list_names(suite.run(level)) for level in suite.LEVELS)
    with LIST_PATH.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(ListedCheck._fields)
        writer.writerows(("quick" if key in quick_names else "full", *key) for key in full_names)


if __name__ == "__main__":
    write_list()
