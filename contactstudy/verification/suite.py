"""The verification suite: which checks belong to which level, run one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from contactstudy import checks as arguments
from contactstudy.arrays.variables import describe
from contactstudy.verification import (
    consistency,
    convergence,
    finite_elements,
    friction,
    half_space,
    heat,
    limits,
    passes,
    published,
    quarter_space,
    wear,
)
from contactstudy.verification.check import Check
from contactstudy.verification.convergence import Table

LEVELS = ("quick", "full")
"""How thorough a run is."""

GROUPS: dict[str, Callable[[bool], Iterator[Check]]] = {
    "half-space": lambda full: half_space.checks(),
    "limits": lambda full: limits.checks(),
    "quarter space": lambda full: quarter_space.checks(),
    "finite elements": lambda full: finite_elements.checks(full=full),
    "published": lambda full: published.checks(),
    "friction": lambda full: friction.checks(full=full),
    "heat": lambda full: heat.checks(),
    "wear": lambda full: wear.checks(),
    "passes": lambda full: passes.checks(full=full),
    "consistency": lambda full: consistency.checks(),
}
"""Checks by what they compare with; those of convergence are added at the full level."""


@dataclass(frozen=True, eq=False)
class Verification:
    """What a run of the suite found.

    Attributes
    ----------
    level : str
        "quick" or "full".
    groups : dict of str to list of Check
        Checks by what they compare with.
    tables : list of Table
        Convergence tables (full level).
    seconds : float
        Time taken.
    """

    level: str
    groups: dict[str, list[Check]] = field(default_factory=dict)
    tables: list[Table] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def checks(self) -> list[Check]:
        """All checks."""
        return [check for group in self.groups.values() for check in group]

    @property
    def passed(self) -> bool:
        """Whether every check passed; nothing checked is not a pass."""
        return bool(self.checks) and all(check.passed for check in self.checks)

    def to_dataset(self) -> xr.Dataset:
        """All checks as data, one per entry along ``check``; convergence errors along ``entry``."""
        groups = [name for name, group in self.groups.items() for _ in group]
        columns: dict[str, object] = {"group": np.array(groups, dtype=object)}
        for name in ("case", "quantity", "source"):
            columns[name] = np.array([getattr(check, name) for check in self.checks], dtype=object)
        for name in ("computed", "expected", "difference", "tolerance"):
            columns[name] = np.array([getattr(check, name) for check in self.checks])
        columns["passed"] = np.array([check.passed for check in self.checks], dtype=bool)
        data = xr.Dataset({name: ("check", values) for name, values in columns.items()})
        if self.tables:
            rows = [
                (table.title, table.setting, table.source, quantity, value, error)
                for table in self.tables
                for quantity, errors in table.errors.items()
                for value, error in zip(table.values, errors, strict=True)
            ]
            names = ("title", "setting", "against", "of", "value", "error")
            for name, values in zip(names, zip(*rows, strict=True), strict=True):
                kind = object if isinstance(values[0], str) else float
                data[f"convergence_{name}"] = ("entry", np.array(values, dtype=kind))
        data.attrs = {"level": self.level, "seconds": round(self.seconds, 1)}
        return describe(data, "verification of contactstudy")


def run(level: str = "quick", report: Callable[[str, Check], None] | None = None) -> Verification:
    """Run the suite.

    Parameters
    ----------
    level : str
        "quick" for a minute of one core, "full" for a few, with all load cases and the convergence tables.
    report : callable, optional
        Called with the group and each check as soon as it is done.

    Raises
    ------
    InvalidInputError
        If the level is unknown.
    """
    arguments.instance("level", level, str, "a name")
    arguments.known_name("level", level, LEVELS)
    began = time.perf_counter()
    full = level == "full"
    groups: dict[str, list[Check]] = {}
    tables: list[Table] = []

    def convergence_checks() -> Iterator[Check]:
        yield from convergence.quadrature_checks()
        for table in convergence.tables():
            tables.append(table)
            yield from table.checks()

    sources = {name: make(full) for name, make in GROUPS.items()}
    if full:
        sources["convergence"] = convergence_checks()
    for name, source in sources.items():
        groups[name] = []
        for check in source:
            groups[name].append(check)
            if report is not None:
                report(name, check)
    return Verification(level, groups, tables, time.perf_counter() - began)


def verify(level: str = "quick") -> xr.Dataset:
    """Run the suite and return every check as data.

    Parameters
    ----------
    level : str
        "quick" for a minute of one core, "full" for a few, with all load cases and the convergence tables.

    Returns
    -------
    Dataset
        Along ``check``: `group`, `case`, `quantity`, `source` of the reference, `computed`, `expected`, `difference`,
        `tolerance`, `passed`. The full level adds the convergence tables along ``entry``.

    Raises
    ------
    InvalidInputError
        If the level is unknown.

    Examples
    --------
    >>> verify("thorough")
    Traceback (most recent call last):
    contactstudy.errors.InvalidInputError: level = 'thorough': must be one of full, quick
    """
    return run(level).to_dataset()
