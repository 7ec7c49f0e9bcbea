"""What a run of the suite prints and writes: one table, as netCDF and as a Markdown page with figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from contactstudy.errors import InvalidInputError
from contactstudy.study.store import write_dataset, write_text
from contactstudy.verification.check import Check
from contactstudy.verification.convergence import Table
from contactstudy.verification.suite import Verification

HEADING = f"{'':4}  {'difference':>10}  {'allowed':>8}  {'computed':>11}  {'reference':>11}  case: quantity [source]"
"""Columns of the report."""


def line(check: Check) -> str:
    """One line of the table on the screen.

    Examples
    --------
    >>> from contactstudy.verification.check import compare
    >>> line(compare("sphere", "peak pressure", "Hertz", 0.99, 1.0, 0.02))
    'ok      -1.0e-02   2.0e-02         0.99            1  sphere: peak pressure [Hertz]'
    """
    verdict = "ok" if check.passed else "FAIL"
    numbers = f"{check.difference:10.1e}  {check.tolerance:8.1e}  {check.computed:11.6g}  {check.expected:11.6g}"
    return f"{verdict:4}  {numbers}  {check.case}: {check.quantity} [{check.source}]"


def summary(verification: Verification) -> str:
    """Last line on the screen."""
    checks = verification.checks
    failed = sum(not check.passed for check in checks)
    verdict = f"{failed} failed" if failed else "all passed"
    return f"{len(checks)} checks in {verification.seconds:.0f} s: {verdict}"


def convergence_table(table: Table) -> str:
    """Markdown table of a convergence study.

    Examples
    --------
    >>> table = Table(
    ...     title="sphere",
    ...     setting="cells",
    ...     source="Hertz",
    ...     values=(8, 16),
    ...     errors={"approach": (4e-2, 1e-2)},
    ...     tolerance=1.0,
    ...     used=16,
    ...     order=1.0,
    ... )
    >>> print(convergence_table(table))
    **sphere**, against Hertz
    <BLANKLINE>
    | cells | 8 | **16** |
    |---|---|---|
    | approach | 4.0e-02 | 1.0e-02 |
    | ... order | | 2.0 |
    """
    shown = [f"**{value:.4g}**" if value == table.used else f"{value:.4g}" for value in table.values]
    rows = [_row([table.setting, *shown]), "|---" * (len(shown) + 1) + "|"]
    for quantity, errors in table.errors.items():
        rows.append(_row([quantity, *(f"{error:.1e}" for error in errors)]))
        if table.order is not None:
            rows.append(_row(["... order", "", *(f"{order:.1f}" for order in table.orders(quantity))]))
    return f"**{table.title}**, against {table.source}\n\n" + "\n".join(rows)


def page(verification: Verification, figures: dict[str, str]) -> str:
    """Markdown page; `figures` are file names by group."""
    verdict = "every check passed" if verification.passed else "**some checks failed**"
    data = verification.to_dataset()
    parts = [
        "# Verification of contactstudy",
        f"{data.attrs['source']}, level {verification.level}: {summary(verification)}; {verdict}.",
        "Lengths are in half-widths a, pressures and stresses in peak pressures p0; E* = 1.",
    ]
    for name, group in verification.groups.items():
        parts.append(f"## {name[0].upper()}{name[1:]}")
        if name == "convergence":
            parts += [convergence_table(table) for table in verification.tables]
        rows = ["| case | quantity | reference | computed | expected | difference | allowed | |", "|---" * 8 + "|"]
        for check in group:
            numbers = [
                f"{check.computed:.6g}",
                f"{check.expected:.6g}",
                f"{check.difference:.1e}",
                f"{check.tolerance:.1e}",
            ]
            verdict = "ok" if check.passed else "**FAIL**"
            rows.append(_row([check.case, check.quantity, check.source, *numbers, verdict]))
        parts.append("\n".join(rows))
        if name in figures:
            parts.append(f"![{name}: computed and reference]({figures[name]})")
    return "\n\n".join(parts) + "\n"


def _row(cells: list[str]) -> str:
    """Row of a Markdown table."""
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells).replace("|  |", "| |") + " |"


def make_folder(folder: Path) -> None:
    """Make the folder of a report, or raise `InvalidInputError` if it cannot be one."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidInputError("out", str(folder), "a folder that can be written", str(error)) from None


def write(verification: Verification, folder: Path) -> list[Path]:
    """Write ``verification.nc``, ``verification.md`` and its figures, and return their paths.

    Raises
    ------
    InvalidInputError
        If the folder cannot be made.
    """
    from contactstudy.verification.figures import draw

    make_folder(folder)
    data = verification.to_dataset()
    data["passed"] = data["passed"].astype(np.int8)
    write_dataset(folder / "verification.nc", data)
    drawn = draw(verification, folder)
    write_text(folder / "verification.md", page(verification, {name: path.name for name, path in drawn.items()}))
    return [folder / "verification.nc", folder / "verification.md", *drawn.values()]
