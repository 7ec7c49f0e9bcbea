"""Cells of the film: joined from uniform ones along y, columns along x, and the surface operator on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.fft import next_fast_len

from contactstudy.checks import FloatArray, IntArray

Size = Callable[[float], float]


@dataclass(frozen=True, eq=False)
class JoinedCells:
    """Cells along y that are joined from uniform ones, on which the surface operator acts.

    Attributes
    ----------
    edges : array of int
        Numbers of the uniform edges between joined cells.
    """

    edges: IntArray

    @classmethod
    def of(cls, count: int, size: Callable[[float, float], float]) -> JoinedCells:
        """Join `count` uniform cells in powers of two, to at most ``size(first, last)`` cells between two edges."""
        edges = [0]
        while edges[-1] < count:
            first, width = edges[-1], 1
            previous = edges[-1] - edges[-2] if len(edges) > 1 else 1 << 30
            while (
                first % (2 * width) == 0
                and first + 2 * width <= count
                and 2 * width <= min(2 * previous, size(first, first + 2 * width))
            ):
                width *= 2
            edges.append(first + width)
        return cls(np.array(edges))

    @cached_property
    def counts(self) -> IntArray:
        """Numbers of uniform cells in each."""
        return np.diff(self.edges)

    @cached_property
    def middles(self) -> tuple[IntArray, IntArray]:
        """Uniform cells on either side of each centre; the same one twice in a cell of an odd number."""
        total = self.edges[1:] + self.edges[:-1]
        return (total - 1) // 2, total // 2

    def spread(self, values: FloatArray) -> FloatArray:
        """Values (x, joined cell) on the uniform cells."""
        return np.repeat(values, self.counts, axis=-1)

    def centred(self, values: FloatArray) -> FloatArray:
        """Values at the centres from those on uniform cells (x, uniform cell)."""
        before, after = self.middles
        return np.asarray(0.5 * (values[..., before] + values[..., after]))

    def mean(self, values: FloatArray) -> FloatArray:
        """Means over the cells of values on uniform cells (x, uniform cell)."""
        return np.asarray(np.add.reduceat(values, self.edges[:-1], axis=-1) / self.counts)

    def stiffness(self, response: FloatArray) -> FloatArray:
        """Matrices (x, cell, cell) from the response (x, offset) to a load on one uniform cell."""
        count = response.shape[-1]
        both = np.concatenate([response[:, :0:-1], response], axis=-1)
        sums = np.concatenate([np.zeros((len(response), 1)), np.cumsum(both, axis=-1)], axis=-1)
        total = np.zeros((len(response), self.counts.size, self.counts.size))
        for middle in self.middles:
            # The offsets of a joined cell's uniform ones are consecutive.
            from_first = middle[:, None] - self.edges[None, :] + count
            total += 0.5 * (sums[:, from_first[:, :-1]] - sums[:, from_first[:, 1:]])
        return total


def graded_edges(start: float, stop: float, size: Size) -> FloatArray:
    """Edges from `start` to `stop` of cells about as wide as `size` at their middle.

    Examples
    --------
    >>> graded_edges(0.0, 1.0, lambda x: 0.25).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    # Cells of equal measure in the density 1 / size.
    points = [start]
    while points[-1] < stop:
        points.append(points[-1] + 0.1 * size(points[-1]))
    position = np.minimum(np.array(points), stop)
    middle = 0.5 * (position[1:] + position[:-1])
    measure = np.concatenate([[0.0], np.cumsum(np.diff(position) / [size(each) for each in middle])])
    count = max(2, int(np.ceil(measure[-1] - 1e-9)))
    edges = np.interp(np.linspace(0.0, measure[-1], count + 1), measure, position)
    edges[0], edges[-1] = start, stop
    return np.asarray(edges)


def uniform_count(length: float, width: float) -> int:
    """Return a number of uniform cells, a multiple of 16 that the transform likes, at most `width` wide."""
    return 16 * int(next_fast_len(int(np.ceil(length / width / 16)), real=True))
