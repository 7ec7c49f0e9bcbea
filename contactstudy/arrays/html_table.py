"""Small tables for notebooks: rows of texts as HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

LEFT, NUMBER = "text-align:left", "text-align:right;white-space:nowrap"
"""Styles of a column of words, and of one of numbers with their units."""


def html_table(subjects: Iterable[tuple[str, Iterable[Sequence[str]]]], styles: Sequence[str] = (LEFT, LEFT)) -> str:
    """Table of texts, under one heading per subject.

    Parameters
    ----------
    subjects : iterable of (str, iterable of sequence of str)
        Heading, which may be empty, and the rows below it, each of as many texts as there are styles.
    styles : sequence of str
        Style of each column.

    Examples
    --------
    >>> html_table([("", [("radius", "5 mm")])], styles=(LEFT,) * 2)[:60]
    "<table><tr><td style='text-align:left'>radius</td><td style="
    """
    lines = []
    for heading, rows in subjects:
        if heading:
            lines.append(f"<tr><th colspan='{len(styles)}' style='{LEFT}'>{escape(heading)}</th></tr>")
        for row in rows:
            cells = (f"<td style='{style}'>{escape(text)}</td>" for style, text in zip(styles, row, strict=True))
            lines.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table>{''.join(lines)}</table>"
