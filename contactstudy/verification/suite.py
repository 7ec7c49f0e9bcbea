"""The verification suite: groups of checks, levels, and reports on the screen, as netCDF and as a Markdown page."""

from __future__ import annotations

import re
import textwrap
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from contactstudy import checks as arguments
from contactstudy.arrays.variables import describe
from contactstudy.errors import InvalidInputError, MagnitudeWarning
from contactstudy.plots.style import line_styles
from contactstudy.study.files import write_dataset, write_text
from contactstudy.verification import exact_solutions, film, free_ends, passes, tribology
from contactstudy.verification.problems import FILM_CASES, PASSES_CASES, Check

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


LEVELS = ("quick", "full")  # Levels of a run
# Iterators that compute checks, by the kind of reference; the argument selects the full level
GROUPS: dict[str, Callable[[bool], tuple[Iterator[Check], ...]]] = {
    "half-space": lambda full: tuple(checks() for checks in exact_solutions.HALF_SPACE),
    "limits": lambda full: tuple(checks() for checks in exact_solutions.LIMITS),
    "quarter space": lambda full: tuple(checks() for checks in free_ends.QUARTER_SPACE),
    "finite elements": lambda full: (free_ends.finite_element_checks(full=full),),
    "published": lambda full: tuple(checks() for checks in free_ends.PUBLISHED),
    "friction": lambda full: (
        tribology.carter_checks(),
        tribology.slope_checks(full=full),
        tribology.shift_checks(),
        tribology.spence_checks(),
        tribology.kalker_checks(full=full),
        tribology.contact_program_checks(),
    ),
    "heat": lambda full: tuple(checks() for checks in tribology.HEAT),
    "wear": lambda full: tuple(checks() for checks in tribology.WEAR),
    "passes": lambda full: (
        passes.shakedown_checks(),
        passes.residual_checks(),
        passes.pass_checks(),
        *(passes.finite_element_checks(name) for name in (PASSES_CASES if full else passes.QUICK_CASES)),
    ),
    "film": lambda full: (
        film.line_checks(full=full),
        film.dry_limit_checks(),
        film.roller_checks(full=full),
        *(film.finite_element_checks(name) for name in FILM_CASES),
        *((film.ellipse_checks(),) if full else ()),
    ),
    "consistency": lambda full: tuple(checks() for checks in exact_solutions.CONSISTENCY),
}


@dataclass(frozen=True, eq=False)
class Verification:
    """Results of the suite."""

    level: str  # "quick" or "full"
    groups: dict[str, list[Check]] = field(default_factory=dict)  # checks by the kind of their reference
    seconds: float = 0.0

    @property
    def checks(self) -> list[Check]:
        """All checks."""
        return [check for group in self.groups.values() for check in group]

    @property
    def passed(self) -> bool:
        """Whether checks exist and all passed."""
        return bool(self.checks) and all(check.passed for check in self.checks)

    def to_dataset(self) -> xr.Dataset:
        """All checks as data along ``check``."""
        groups = [name for name, group in self.groups.items() for _ in group]
        dataset = xr.Dataset({"group": ("check", np.array(groups, dtype=object))})
        kinds = dict.fromkeys(("case", "quantity", "source"), object)
        kinds |= dict.fromkeys(("computed", "expected", "difference", "tolerance"), float) | {"passed": bool}
        for name, kind in kinds.items():
            dataset[name] = "check", np.array([getattr(check, name) for check in self.checks], dtype=kind)
        dataset.attrs = {"level": self.level, "seconds": round(self.seconds, 1)}
        return describe(dataset, "verification of contactstudy")


def run(level: str = "quick", report: Callable[[str, Check], None] | None = None) -> Verification:
    """Run the suite as `verify`; call `report` with the group and the check after every comparison."""
    arguments.known_name("level", level, LEVELS)
    start_time = time.perf_counter()
    groups: dict[str, list[Check]] = {name: [] for name in GROUPS}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MagnitudeWarning)  # the problems have unit moduli and half-widths
        for name, make_checks in GROUPS.items():
            for check in chain.from_iterable(make_checks(level == "full")):
                groups[name].append(check)
                if report is not None:
                    report(name, check)
    return Verification(level, groups, time.perf_counter() - start_time)


def verify(level: str = "quick") -> xr.Dataset:
    """Run the suite and return every check as data.

    Parameters
    ----------
    level : str
        "quick" takes a minute of one core; "full" takes a few minutes, with all load cases.

    Returns
    -------
    Dataset
        Along ``check``: `group`, `case`, `quantity`, `source` of the reference, `computed`, `expected`, `difference`,
        `tolerance`, `passed`.

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


# Columns of the report
HEADING = f"{'':4}  {'difference':>10}  {'allowed':>8}  {'computed':>11}  {'reference':>11}  case: quantity [source]"


def format_line(check: Check) -> str:
    """One line of the table on the screen."""
    status = "ok" if check.passed else "FAIL"
    values = f"{check.difference:10.1e}  {check.tolerance:8.1e}  {check.computed:11.6g}  {check.expected:11.6g}"
    return f"{status:4}  {values}  {check.case}: {check.quantity} [{check.source}]"


def format_summary(verification: Verification) -> str:
    """Last line on the screen."""
    checks = verification.checks
    failed_count = sum(not check.passed for check in checks)
    status = f"{failed_count} failed" if failed_count else "all passed"
    return f"{len(checks)} checks in {verification.seconds:.0f} s: {status}"


def format_page(verification: Verification, figures: dict[str, str]) -> str:
    """Markdown page; `figures` are file names by group."""
    sections = [
        "# Verification of contactstudy",
        f"{verification.to_dataset().attrs['source']}, level {verification.level}: {format_summary(verification)}.",
        "Lengths are in half-widths a, pressures and stresses in peak pressures p0; E* = 1.",
    ]
    for name, group in verification.groups.items():
        sections.append(f"## {name[0].upper()}{name[1:]}")
        rows = ["| case | quantity | reference | computed | expected | difference | allowed | |", "|---" * 8 + "|"]
        for check in group:
            numbers = f"{check.computed:.6g} {check.expected:.6g} {check.difference:.1e} {check.tolerance:.1e}"
            status = "ok" if check.passed else "**FAIL**"
            rows.append(format_row([check.case, check.quantity, check.source, *numbers.split(), status]))
        sections.append("\n".join(rows))
        if name in figures:
            sections.append(f"![{name}: computed and reference]({figures[name]})")
    return "\n\n".join(sections) + "\n"


def format_row(cells: list[str]) -> str:
    """Row of a Markdown table."""
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells).replace("|  |", "| |") + " |"


def create_panels(count: int) -> tuple[Figure, list[Axes]]:
    """Figure of a page's width and its `count` panels in rows of two."""
    from matplotlib.figure import Figure

    rows = -(-count // 2)
    figure = Figure(figsize=(6.0, 2.6 * rows), layout="constrained")
    return figure, [figure.add_subplot(rows, 2, index + 1) for index in range(count)]


def plot_profiles(checks: list[Check]) -> Figure:
    """Draw the profiles of checks: computed as a line, the reference as circles."""
    curves = [(check.case, check.curve) for check in checks if check.curve is not None]
    figure, axes = create_panels(len(curves))
    for ax, (case, curve) in zip(axes, curves, strict=True):
        every_nth = slice(None, None, max(1, curve.positions.size // 40))
        ax.plot(curve.positions, curve.computed, label="computed", **line_styles(1)[0])
        expected = curve.positions[every_nth], curve.expected[every_nth]
        ax.plot(*expected, "o", color="black", markersize=4, markerfacecolor="none", label="reference")
        ax.set_title("\n".join(textwrap.wrap(case, 36)), fontsize="small")
        ax.set_xlabel(curve.labels[0])
        ax.set_ylabel(re.sub(r"(sigma|tau)_(\w\w)", r"$\\\1_{\2}$", curve.labels[1]), fontsize="small")
        ax.grid(alpha=0.3)
    if axes:
        axes[0].legend(fontsize="small")
    return figure


def make_folder(folder: Path) -> None:
    """Make the folder of a report, or raise `InvalidInputError` if the path cannot be a folder."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidInputError("out", str(folder), "a folder that can be written", str(error)) from None


def write(verification: Verification, folder: Path) -> list[Path]:
    """Write ``verification.nc``, ``verification.md`` and a figure of each group with profiles; return the paths."""
    make_folder(folder)
    dataset = verification.to_dataset()
    dataset["passed"] = dataset["passed"].astype(np.int8)
    write_dataset(folder / "verification.nc", dataset)
    figures: dict[str, str] = {}
    for name, checks in verification.groups.items():
        if any(check.curve is not None for check in checks):
            figures[name] = f"{name.replace(' ', '_').replace('-', '_')}.png"
            plot_profiles(checks).savefig(folder / figures[name], dpi=110)
    write_text(folder / "verification.md", format_page(verification, figures))
    return [folder / name for name in ("verification.nc", "verification.md", *figures.values())]
