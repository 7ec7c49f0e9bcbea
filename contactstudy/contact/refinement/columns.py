"""Shape of the indenter along the axis, the first columns under the shape, and their splitting."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import centres_of
from contactstudy.checks import BoolArray, FloatArray

FIRST_COLUMN = 0.1  # width of the first columns at the ends, over the half-width. Accuracy: wider ones miss sharp ends.
MIN_COLUMNS = 16  # least number of columns over the length. Accuracy.
CHORD_TOLERANCE = 0.1  # distance of the shape from its chord in a first column, over ``a**2 / 2R``. Accuracy.

SAMPLE_POSITIONS = np.linspace(0.0, 1.0, 257)
"""Sampling points of the shape in a column. Accuracy: in the widest first columns they are 1/4096 of the length apart,
and narrower ridges are missed."""

PENETRATION_TOLERANCE = 0.02
"""Depth, over ``a**2 / 2R``, by which the shape may come below the displaced top in a column that is open. Accuracy: a
crest that is missed then carries 0.14 of the Hertz pressure at most."""

MIN_CHORD_WIDTH = 0.1  # width over the half-width below which a first column is not split for its shape. Speed.
MAX_WIDTH_RATIO = 2.6  # largest ratio of neighbouring widths. Accuracy.
MAX_COLUMNS = 600  # columns at which the refinement ends without convergence


@dataclass(frozen=True, kw_only=True, eq=False)
class AxialShape:
    """Shape of the indenter along the axis."""

    start: float  # range of possible contact, metres
    stop: float
    half_width: float  # Hertz half-width ``a``, metres
    depth: float  # depth ``a**2 / 2R`` to which a cylinder sinks, metres
    height: Callable[[FloatArray], FloatArray]  # height along the axis over the plane that the shape touches, metres
    face_beyond: tuple[float, float]  # length of the body's face beyond either end, metres; 0 or less where it ends
    exponents: tuple[float, float] = (np.nan, np.nan)  # ``m`` of ``K d**-m`` at sharp ends; NaN without a law
    has_fading_end: bool = False  # whether the pressure falls by a small power to a common end: not resolvable
    corners: tuple[float, ...] = ()  # positions of convex corners and of column edges, metres
    nodes: FloatArray = field(default_factory=lambda: np.zeros(0))  # positions between which the shape is smooth, m

    @cached_property
    def node_heights(self) -> FloatArray:
        """Heights at the nodes, metres."""
        return self.height(self.nodes)

    def is_singular(self, side: int) -> bool:
        """Whether the pressure at an end is singular if the end is loaded."""
        return self.exponents[side] > 0


def first_edges(shape: AxialShape) -> FloatArray:
    """Edges of the first columns: widths double from either end, and are halved where the shape bends."""
    length = shape.stop - shape.start
    width = min(FIRST_COLUMN * shape.half_width, length / (4 * MIN_COLUMNS))
    widths = [width]
    while sum(widths) < 0.5 * length:
        widths.append(min(2 * widths[-1], length / MIN_COLUMNS))
    half_edges = np.append(0.0, np.cumsum(widths)) * (0.5 * length / sum(widths))
    edges = shape.start + np.concatenate([half_edges, length - half_edges[-2::-1]])
    edges[-1] = shape.stop
    if shape.corners:
        edges = split_columns(_with_edges(edges, shape.corners), np.zeros(0, dtype=bool))
    while True:
        _, lowest, is_bent = _sample(shape, edges)
        # Columns are split only where the shape is low enough for certain contact.
        is_marked = is_bent & (lowest - lowest.min() < 3 * shape.depth)
        is_marked &= np.diff(edges) > MIN_CHORD_WIDTH * shape.half_width
        if not is_marked.any() or edges.size > MAX_COLUMNS:
            return edges
        edges = split_columns(edges, is_marked)


class SampledColumns(NamedTuple):
    """The shape in each column."""

    heights: FloatArray  # (column, point): heights at points along each column, metres
    lowest: FloatArray  # (column): least height, nodes included, metres
    is_bent: BoolArray  # (column): whether the shape leaves its chord


def _sample(shape: AxialShape, edges: FloatArray) -> SampledColumns:
    """Sample the shape at points along each column and at its nodes."""
    # The outer points lie just inside the column: the shape may step at its ends.
    inside = np.clip(SAMPLE_POSITIONS, 1e-9, 1 - 1e-9)
    positions = edges[:-1, None] + np.diff(edges)[:, None] * inside
    heights = shape.height(positions.ravel()).reshape(positions.shape)
    rise, lowest = heights[:, -1] - heights[:, 0], heights.min(axis=1)
    deviations = np.abs(heights - heights[:, :1] - rise[:, None] * SAMPLE_POSITIONS).max(axis=1)
    if shape.nodes.size:
        columns = np.clip(np.searchsorted(edges, shape.nodes, side="right") - 1, 0, edges.size - 2)
        fraction = (shape.nodes - edges[columns]) / np.diff(edges)[columns]
        np.maximum.at(deviations, columns, np.abs(shape.node_heights - heights[columns, 0] - rise[columns] * fraction))
        np.minimum.at(lowest, columns, shape.node_heights)
    return SampledColumns(heights, lowest, deviations > CHORD_TOLERANCE * shape.depth)


def _with_edges(edges: FloatArray, corners: tuple[float, ...]) -> FloatArray:
    """Add edges at the corners; an edge closer to a corner than a quarter of its column moves onto the corner."""
    for corner in corners:
        nearest = int(np.abs(edges - corner).argmin())
        is_inner = 0 < nearest < edges.size - 1
        if is_inner and abs(edges[nearest] - corner) < 0.25 * np.diff(edges)[nearest - 1 : nearest + 1].min():
            edges[nearest] = corner
        else:
            edges = np.sort(np.append(edges, corner))
    return edges


def find_overlooked(shape: AxialShape, edges: FloatArray, loaded: BoolArray, opening: FloatArray) -> BoolArray:
    """Mark columns in which a solved contact misses details of the shape: a bend under pressure, or an open crest."""
    # An open column is overlooked if the shape lies below the displaced surface, except next to a contact that ends
    # in the column.
    heights, lowest, is_bent = _sample(shape, edges)
    rigid_height = heights.mean(axis=1) - opening
    lowest_point = heights.argmin(axis=1)
    neighbour = np.zeros_like(loaded)
    neighbour[1:] |= loaded[:-1] & (lowest_point[1:] == 0)
    neighbour[:-1] |= loaded[1:] & (lowest_point[:-1] == SAMPLE_POSITIONS.size - 1)
    neighbour &= lowest >= heights.min(axis=1)
    is_missed = ~loaded & ~neighbour & (rigid_height - lowest > PENETRATION_TOLERANCE * shape.depth)
    is_wide = np.diff(edges) > MIN_CHORD_WIDTH * shape.half_width
    return np.asarray(is_wide & (is_missed | (loaded & is_bent)))


def split_columns(edges: FloatArray, is_marked: BoolArray) -> FloatArray:
    """Halve marked columns, and every column that is then much wider than a neighbour."""
    edges = np.sort(np.concatenate([edges, centres_of(edges)[is_marked]])) if is_marked.any() else edges
    while True:
        widths = np.diff(edges)
        is_too_wide = np.zeros(widths.size, dtype=bool)
        is_too_wide[:-1] |= widths[:-1] > MAX_WIDTH_RATIO * widths[1:]
        is_too_wide[1:] |= widths[1:] > MAX_WIDTH_RATIO * widths[:-1]
        if not is_too_wide.any():
            return edges
        edges = np.sort(np.concatenate([edges, centres_of(edges)[is_too_wide]]))
