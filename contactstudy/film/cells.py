"""Cells of the film: columns along x, and cells along y that are merged from uniform cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contactstudy.checks import FloatArray, IntArray

CellWidth = Callable[[float], float]


@dataclass(frozen=True, eq=False)
class MergedCells:
    """Cells along y that are merged from uniform cells; the surface operator acts on the uniform cells."""

    edges: IntArray  # indices of the uniform edges between merged cells

    @classmethod
    def of(cls, cell_count: int, max_count: Callable[[float, float], float]) -> MergedCells:
        """Merge `cell_count` uniform cells in powers of two, at most ``max_count(first, last)`` into one."""
        edges = [0]
        while edges[-1] < cell_count:
            first_cell, width = edges[-1], 1
            previous = edges[-1] - edges[-2] if len(edges) > 1 else 1 << 30
            while (
                first_cell % (2 * width) == 0
                and first_cell + 2 * width <= cell_count
                and 2 * width <= min(2 * previous, max_count(first_cell, first_cell + 2 * width))
            ):
                width *= 2
            edges.append(first_cell + width)
        return cls(np.array(edges))

    @cached_property
    def counts(self) -> IntArray:
        """Numbers of uniform cells in the merged cells."""
        return np.diff(self.edges)

    @cached_property
    def centre_cells(self) -> tuple[IntArray, IntArray]:
        """Uniform cells on either side of each merged cell's centre; the same cell if their number is odd."""
        edge_sums = self.edges[1:] + self.edges[:-1]
        return (edge_sums - 1) // 2, edge_sums // 2

    def to_uniform_cells(self, field: FloatArray) -> FloatArray:
        """Values on the uniform cells from values (x, merged cell)."""
        return np.repeat(field, self.counts, axis=-1)

    def to_centres(self, field: FloatArray) -> FloatArray:
        """Values at the centres of merged cells from values (x, uniform cell)."""
        lower_cells, upper_cells = self.centre_cells
        return np.asarray(0.5 * (field[..., lower_cells] + field[..., upper_cells]))

    def average(self, field: FloatArray) -> FloatArray:
        """Means over the merged cells of values (x, uniform cell)."""
        return np.asarray(np.add.reduceat(field, self.edges[:-1], axis=-1) / self.counts)

    def compute_stiffness(self, response: FloatArray) -> FloatArray:
        """Displacement per pressure on merged cells (x, cell, cell), from a uniform cell's `response` (x, offset)."""
        cell_count = response.shape[-1]
        two_sided_response = np.concatenate([response[:, :0:-1], response], axis=-1)
        sums = np.concatenate([np.zeros((len(response), 1)), np.cumsum(two_sided_response, axis=-1)], axis=-1)
        stiffness = np.zeros((len(response), self.counts.size, self.counts.size))
        for centre_cell in self.centre_cells:
            # The offsets of the uniform cells of a merged cell are consecutive.
            offsets = centre_cell[:, None] - self.edges[None, :] + cell_count
            stiffness += 0.5 * (sums[:, offsets[:, :-1]] - sums[:, offsets[:, 1:]])
        return stiffness


def graded_edges(start: float, stop: float, cell_width: CellWidth) -> FloatArray:
    """Edges from `start` to `stop` of cells about as wide as `cell_width` at their midpoint.

    Examples
    --------
    >>> graded_edges(0.0, 1.0, lambda x: 0.25).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    # The integral of 1 / cell_width is equal over all cells.
    points = [start]
    while points[-1] < stop:
        points.append(points[-1] + 0.1 * cell_width(points[-1]))
    positions = np.minimum(np.array(points), stop)
    midpoints = 0.5 * (positions[1:] + positions[:-1])
    measure = np.concatenate([[0.0], np.cumsum(np.diff(positions) / [cell_width(x) for x in midpoints])])
    cell_count = max(2, int(np.ceil(measure[-1] - 1e-9)))
    edges = np.interp(np.linspace(0.0, measure[-1], cell_count + 1), measure, positions)
    edges[0], edges[-1] = start, stop
    return np.asarray(edges)
