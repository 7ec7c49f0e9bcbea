"""Text for readers: numbers in engineering units with their errors, and tables in HTML."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape

UNITS: dict[str, tuple[tuple[float, float, str], ...]] = {  # by SI unit: least value, size of the unit, name
    "Pa": ((1e8, 1e9, "GPa"), (0.0, 1e6, "MPa")),
    "m": ((1e-4, 1e-3, "mm"), (0.0, 1e-6, "\N{MICRO SIGN}m")),
    "N": ((1e3, 1e3, "kN"), (0.0, 1.0, "N")),
    "N/m": ((0.0, 1e3, "N/mm"),),
    "N m": ((0.0, 1.0, "N m"),),
    "m2": ((0.0, 1e-6, "mm\N{SUPERSCRIPT TWO}"),),
    "rad": ((0.0, 1e-3, "mrad"),),
    "s": ((0.0, 1.0, "s"),),
}

ROUNDING = 1e-6  # Relative rounding of a size that is compared with the least size of a unit. Rounding.
NEGLIGIBLE = 1e-6  # Error over the value below which the text omits it. Rounding.
DIGITS, ERROR_DIGITS = 4, 2  # Digits of a number without an error, and of an error. Accuracy.


def unit_for(size: float, units: str) -> tuple[float, str]:
    """Return the size in SI, and the name, of the unit that suits a size."""
    if units in ("", "1"):
        return 1.0, ""
    candidates = UNITS.get(units, ((0.0, 1.0, units),))
    rounded_up = abs(size) * (1 + ROUNDING)
    return next((entry[1:] for entry in candidates if rounded_up >= entry[0]), candidates[-1][1:])


def format_value(value: float, digits: int = DIGITS) -> str:
    """Return a number with `digits` digits, without an exponent if the text remains short."""
    if not math.isfinite(value):
        return "not known" if math.isnan(value) else f"{'-' if value < 0 else ''}\N{INFINITY}"
    return f"{value:.{digits}g}" if not 1e3 <= abs(value) < 1e6 else f"{value:.{max(digits, 4)}g}"


def format_quantity(value: float, units: str, digits: int = DIGITS) -> str:
    """Write a number of SI units in engineering units."""
    if not math.isfinite(value):
        return format_value(value)
    factor, unit = unit_for(value, units)
    return f"{format_value(value / factor, digits)} {unit}".rstrip()


def format_with_error(value: float, error: float, units: str) -> str:
    """Write a number and its error, NaN if not estimated, in one unit, with the digits that the error leaves."""
    if not math.isfinite(value) or not NEGLIGIBLE * abs(value) < error < math.inf:
        return format_quantity(value, units)
    factor, unit = unit_for(max(abs(value), error), units)
    value, error = value / factor, error / factor
    decimals = ERROR_DIGITS - 1 - math.floor(math.log10(error))
    if abs(value) >= 1e5 or decimals > 8:
        return f"{format_value(value)} ± {error:.1g} {unit}".rstrip()
    places = max(decimals, 0)
    return f"{round(value, decimals):.{places}f} ± {round(error, decimals):.{places}f} {unit}".rstrip()


TEXT_STYLE, NUMBER_STYLE = "text-align:left", "text-align:right;white-space:nowrap"
"""Styles of a column of words, and of a column of numbers with units."""


def html_table(
    subjects: Iterable[tuple[str, Iterable[Sequence[str]]]], styles: Sequence[str] = (TEXT_STYLE,) * 2
) -> str:
    """Table of texts, under one heading per subject."""
    lines = []
    for heading, rows in subjects:
        if heading:
            lines.append(f"<tr><th colspan='{len(styles)}' style='{TEXT_STYLE}'>{escape(heading)}</th></tr>")
        for row in rows:
            cells = (f"<td style='{style}'>{escape(text)}</td>" for style, text in zip(styles, row, strict=True))
            lines.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table>{''.join(lines)}</table>"
