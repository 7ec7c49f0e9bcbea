"""Labels that are longer than their axis, in several lines."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LETTER = 0.073
"""Width of a letter of a label, inches; of a legend's it is a little less."""

FEWEST = 14
"""Letters that a line has at least."""

WIDEST_NAME = 40
"""Letters after which a name in a legend within the axes goes on in the next line."""

WORDS = re.compile(r"(?:\\.|\$(?:[^$\\]|\\.)*\$|\S)+")
"""Words with formulas in one piece."""

MARKUP = re.compile(r"\\[A-Za-z]+|[\\{}$_^]")
"""What of a formula is not seen."""


def folded(text: str, width: int) -> str:
    r"""Text in lines of at most so many letters where words allow it; formulas stay whole, longer words are cut.

    Examples
    --------
    >>> folded("largest von Mises stress (GPa)", 20)
    'largest von Mises\nstress (GPa)'
    >>> folded(r"depth, $z\ \mathrm{(mm)}$", 12)
    'depth,\n$z\\ \\mathrm{(mm)}$'
    """
    lines: list[str] = []
    for word in WORDS.findall(text):
        if lines and _length(lines[-1]) + 1 + _length(word) <= width:
            lines[-1] += f" {word}"
        elif "$" in word:
            lines.append(word)
        else:
            lines += [word[start : start + width] for start in range(0, len(word), width)]
    return "\n".join(lines)


def _length(text: str) -> int:
    """Letters of a text that are seen."""
    return len(MARKUP.sub("", text))


def fold_labels(*axes: Axes) -> None:
    """Fold the labels and titles of axes, so that they are no longer than their side of the axes."""
    for ax in axes:
        dots = ax.get_window_extent()
        across, up = (max(FEWEST, int(size / ax.figure.dpi / LETTER)) for size in (dots.width, dots.height))
        for text, width in ((ax.xaxis.label, across), (ax.yaxis.label, up), (ax.title, across)):
            if text.get_text():
                text.set_text(folded(text.get_text(), width))
