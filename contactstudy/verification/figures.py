"""Figures of a run of the suite: computed profiles over their references, and errors over settings."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contactstudy.verification.check import Check
from contactstudy.verification.convergence import Table
from contactstudy.verification.suite import Verification

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = 3
"""Panels beside one another."""


def _panels(count: int) -> tuple[Figure, list[Axes]]:
    """Figure with so many panels, in rows."""
    from matplotlib.figure import Figure

    rows = -(-count // COLUMNS)
    figure = Figure(figsize=(4.2 * min(count, COLUMNS), 3.1 * rows), layout="constrained")
    return figure, [figure.add_subplot(rows, min(count, COLUMNS), place + 1) for place in range(count)]


def _with_symbols(text: str) -> str:
    """Names of stress components as symbols."""
    return re.sub(r"(sigma|tau)_(\w\w)", r"$\\\1_{\2}$", text)


def plot_profiles(checks: list[Check]) -> Figure:
    """Draw the profile of every check that has one: line for what is computed, circles for the reference."""
    shown = [check for check in checks if check.curve is not None]
    figure, axes = _panels(len(shown))
    for ax, check in zip(axes, shown, strict=True):
        curve = check.curve
        assert curve is not None
        some = slice(None, None, max(1, curve.positions.size // 40))
        ax.plot(curve.positions, curve.computed, color="C0", label="computed")
        ax.plot(
            curve.positions[some],
            curve.expected[some],
            linestyle="none",
            marker="o",
            markersize=4,
            markerfacecolor="none",
            color="C1",
            label="reference",
        )
        ax.set_title("\n".join(textwrap.wrap(check.case, 48)), fontsize="small")
        ax.set_xlabel(curve.along)
        ax.set_ylabel(_with_symbols(curve.quantity), fontsize="small")
        ax.grid(alpha=0.3)
    if axes:
        axes[0].legend(fontsize="small")
    return figure


def plot_convergence(tables: list[Table]) -> Figure:
    """Draw errors over every setting; a dot marks the value in use."""
    figure, axes = _panels(len(tables))
    for ax, table in zip(axes, tables, strict=True):
        place = table.values.index(table.used)
        for number, (quantity, errors) in enumerate(table.errors.items()):
            visible = np.maximum(errors, 1e-12)
            ax.plot(table.values, visible, color=f"C{number}", marker=".", label=textwrap.shorten(quantity, 36))
            ax.plot(table.used, visible[place], marker="o", color=f"C{number}")
        ax.set_xscale("log", base=2)
        ax.set_yscale("log")
        ax.set_xticks(table.values, [f"{value:.3g}" for value in table.values])
        ax.set_xlabel(table.setting)
        ax.set_ylabel("error")
        ax.set_title("\n".join(textwrap.wrap(table.title, 48)), fontsize="small")
        ax.legend(fontsize="x-small")
        ax.grid(alpha=0.3)
    return figure


def draw(verification: Verification, folder: Path) -> dict[str, Path]:
    """Write one figure per group that has something to show, and return their paths by group."""
    drawn: dict[str, Path] = {}
    for name, checks in verification.groups.items():
        if name == "convergence":
            figure = plot_convergence(verification.tables)
        elif any(check.curve is not None for check in checks):
            figure = plot_profiles(checks)
        else:
            continue
        drawn[name] = folder / f"{name.replace(' ', '_').replace('-', '_')}.png"
        figure.savefig(drawn[name], dpi=110)
    return drawn
