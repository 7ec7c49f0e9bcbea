"""The shape that is pressed, seen along the axis, and the columns under it: the first ones, and how they are split."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import BoolArray, FloatArray

FIRST_COLUMN = 0.1
"""Width of the first columns at either end, over the half-width. Accuracy: wider ones miss a sharp end in a face."""

WIDEST = 16
"""Least number of columns over the length. Accuracy."""

BENT = 0.1
"""Depth, over ``a**2 / 2R``, by which the shape may leave its chord inside a first column. Accuracy."""

NARROWEST_BENT = 0.1
"""Width over the half-width below which a first column is not split for its shape. Speed."""

STEEPEST = 2.6
"""Largest ratio of neighbouring widths. Accuracy."""

MOST_COLUMNS = 600
"""Columns at which the refinement ends, whatever is settled."""


@dataclass(frozen=True)
class AxialShape:
    """What the refinement knows of the shape that is pressed.

    Attributes
    ----------
    start, stop : float
        Where it can be pressed, metres.
    half_width : float
        Hertz half-width ``a``, metres.
    depth : float
        Depth ``a**2 / 2R`` to which a cylinder sinks, metres.
    height : callable
        Height along the axis over the plane that the shape touches, metres.
    room : tuple of float
        How far the face of the body goes on beyond either end, metres; 0 or less where it does not.
    stiff : bool
        Whether it has no free ends of its own: rigid, or a half-space.
    fades : bool
        Whether the pressure falls towards a common end like a small power of the distance, which no columns settle.
    """

    start: float
    stop: float
    half_width: float
    depth: float
    height: Callable[[FloatArray], FloatArray]
    room: tuple[float, float]
    stiff: bool = True
    fades: bool = False

    def sharp(self, side: int) -> bool:
        """Whether an end is singular with the exponent 0.5 if it is pressed: a stiff one on a face that goes on."""
        return self.stiff and self.room[side] > 0


def first_edges(shape: AxialShape) -> FloatArray:
    """Columns that double from either end, halved where the shape bends."""
    length = shape.stop - shape.start
    width = min(FIRST_COLUMN * shape.half_width, length / (4 * WIDEST))
    widths = [width]
    while sum(widths) < 0.5 * length:
        widths.append(min(2 * widths[-1], length / WIDEST))
    side = np.append(0.0, np.cumsum(widths)) * (0.5 * length / sum(widths))
    edges = shape.start + np.concatenate([side, length - side[-2::-1]])
    edges[-1] = shape.stop
    while True:
        marks = _bent(shape, edges) & (np.diff(edges) > NARROWEST_BENT * shape.half_width)
        if not marks.any() or edges.size > MOST_COLUMNS:
            return edges
        edges = split(edges, marks)


def _bent(shape: AxialShape, edges: FloatArray) -> BoolArray:
    """Columns inside which the shape leaves its chord, where it is low enough to be pressed."""
    part = np.linspace(0.0, 1.0, 9)
    # Just inside: the shape may step at its ends.
    inside = np.clip(part, 1e-9, 1 - 1e-9)
    heights = shape.height((edges[:-1, None] + np.diff(edges)[:, None] * inside).ravel()).reshape(-1, part.size)
    chord = heights[:, :1] + (heights[:, -1:] - heights[:, :1]) * part
    low = heights.min(axis=1) - heights.min()
    return np.asarray((np.abs(heights - chord).max(axis=1) > BENT * shape.depth) & (low < 3 * shape.depth))


def split(edges: FloatArray, marks: BoolArray) -> FloatArray:
    """Halve marked columns, and every column that is then much wider than a neighbour."""
    while marks.any():
        edges = np.sort(np.concatenate([edges, centres_of(edges)[marks]]))
        widths = np.diff(edges)
        marks = np.zeros(widths.size, dtype=bool)
        marks[:-1] |= widths[:-1] > STEEPEST * widths[1:]
        marks[1:] |= widths[1:] > STEEPEST * widths[:-1]
    return edges


def centres_of(edges: FloatArray) -> FloatArray:
    """Centres of the columns between `edges`."""
    return np.asarray(0.5 * (edges[1:] + edges[:-1]))
