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

PART = np.linspace(0.0, 1.0, 9)
"""Points along a column at which the shape is looked at. Accuracy."""

MISSED = 0.02
"""Depth, over ``a**2 / 2R``, by which the shape may come below the displaced top in a column that is open. Accuracy: a
crest that is missed then carries 0.14 of the Hertz pressure at most."""

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
    exponents : tuple of float
        Exponent ``m`` of the pressure ``K d**-m`` at either end, if that is a sharp one on a face that goes on; NaN
        where theory knows none.
    fades : bool
        Whether the pressure falls towards a common end like a small power of the distance, which no columns settle.
    """

    start: float
    stop: float
    half_width: float
    depth: float
    height: Callable[[FloatArray], FloatArray]
    room: tuple[float, float]
    exponents: tuple[float, float] = (np.nan, np.nan)
    fades: bool = False

    def sharp(self, side: int) -> bool:
        """Whether an end is singular if it is pressed."""
        return self.exponents[side] > 0


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
    """Columns inside which the shape leaves its chord, where it is low enough to be pressed for certain."""
    heights = _heights(shape, edges)
    low = heights.min(axis=1) - heights.min()
    return np.asarray(_curved(shape, heights) & (low < 3 * shape.depth))


def _heights(shape: AxialShape, edges: FloatArray) -> FloatArray:
    """Heights of the shape at points along each column: array (column, point)."""
    # Just inside: the shape may step at its ends.
    inside = np.clip(PART, 1e-9, 1 - 1e-9)
    return shape.height((edges[:-1, None] + np.diff(edges)[:, None] * inside).ravel()).reshape(-1, PART.size)


def _curved(shape: AxialShape, heights: FloatArray) -> BoolArray:
    """Columns inside which the shape leaves its chord."""
    chord = heights[:, :1] + (heights[:, -1:] - heights[:, :1]) * PART
    return np.asarray(np.abs(heights - chord).max(axis=1) > BENT * shape.depth)


def overlooked(shape: AxialShape, edges: FloatArray, pressed: BoolArray, opening: FloatArray) -> BoolArray:
    """Columns inside which a solved contact misses what the shape does: crests of waves, say, between valleys.

    Pressed ones inside which it leaves its chord; and others inside which it comes below the displaced top, though
    they are open by their mean. Beside a contact it does so in any case, where the contact ends inside a column.

    Parameters
    ----------
    shape : AxialShape
        What is pressed.
    edges : array
        Edges of the columns, metres.
    pressed : array of bool
        Which are pressed.
    opening : array
        Least mean gap of each column under load, metres.
    """
    heights = _heights(shape, edges)
    level = heights.mean(axis=1) - opening
    deepest = heights.argmin(axis=1)
    beside = np.zeros_like(pressed)
    beside[1:] |= pressed[:-1] & (deepest[1:] == 0)
    beside[:-1] |= pressed[1:] & (deepest[:-1] == PART.size - 1)
    missed = ~pressed & ~beside & (level - heights.min(axis=1) > MISSED * shape.depth)
    wide = np.diff(edges) > NARROWEST_BENT * shape.half_width
    return np.asarray(wide & (missed | (pressed & _curved(shape, heights))))


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
