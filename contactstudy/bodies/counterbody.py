"""The second elastic body of a contact, and its cells on the cells of the first body."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contactstudy.arrays.grid import Grid, growing_edges
from contactstudy.bodies.models import Body, FiniteLengthSpace, HalfSpace
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

ALIGNMENT_TOLERANCE = 1e-6  # Maximum distance, over a cell, between an end of the counterbody and an edge of cells


@dataclass(frozen=True)
class Counterbody:
    """The second body of a contact, in coordinates from its end I.

    Parameters
    ----------
    body : Body
        A half-space, or a finite-length space.
    start : float
        Position of its end I on the first body's x axis, metres.
    """

    body: Body
    start: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.body, HalfSpace | FiniteLengthSpace):
            raise InvalidInputError("counterbody", self.body, "a HalfSpace or a FiniteLengthSpace")

    def grid_on_body(self, grid: Grid) -> Grid:
        """Return cells in the counterbody's coordinate, over its whole length if it has ends.

        On uniform cells they are about as large as the cells of `grid`; else they equal the cells of `grid`, with
        edges at the ends of both bodies, and a few further cells on overhanging ends.
        """
        if not isinstance(self.body, FiniteLengthSpace):
            if not grid.uniform:
                return Grid.between(grid.x_edges - self.start, grid.y_range, grid.cells_y)
            return replace(grid, x_range=(grid.x_range[0] - self.start, grid.x_range[1] - self.start))
        if grid.uniform:
            cell_count = max(4, round(self.body.length / grid.dx))
            return Grid(x_range=(0.0, self.body.length), y_range=grid.y_range, cells_x=cell_count, cells_y=grid.cells_y)
        edges, stop = grid.x_edges - self.start, self.body.length
        tolerance = ALIGNMENT_TOLERANCE * grid.widths.min()
        for end in (0.0, stop):
            if edges[0] < end < edges[-1] and np.abs(edges - end).min() > tolerance:
                allowed = "cells that meet the ends of both bodies where their widths differ"
                raise InvalidInputError("grid", f"cells without a border at x = {self.start + end:g} m", allowed)
        inner, widths = edges[(edges > tolerance) & (edges < stop - tolerance)], grid.widths
        before = -growing_edges(edges[0], widths[0])[::-1] + edges[0] if edges[0] > tolerance else np.zeros(1)
        after = growing_edges(stop - edges[-1], widths[-1]) + edges[-1] if stop - edges[-1] > tolerance else [stop]
        body_edges = np.concatenate([before, inner, after])
        body_edges[0], body_edges[-1] = 0.0, stop
        return Grid.between(body_edges, grid.y_range, grid.cells_y)

    def overlap(self, grid: Grid) -> FloatArray:
        """Return the overlap of the counterbody's cells and the cells of `grid`, metres: array (its cell, cell).

        A uniform cell with its centre on the counterbody overlaps entirely; its last cell includes the length
        beyond the counterbody's end, which preserves the load.
        """
        body_edges, edges = self.start + self.grid_on_body(grid).x_edges, grid.x_edges
        tolerance = ALIGNMENT_TOLERANCE * grid.widths.min()
        is_inside = (grid.x > body_edges[0] - tolerance) & (grid.x < body_edges[-1] + tolerance)
        body_edges[0], body_edges[-1] = min(body_edges[0], edges[0]), max(body_edges[-1], edges[-1])
        low = np.maximum(body_edges[:-1, None], edges[None, :-1])
        high = np.minimum(body_edges[1:, None], edges[None, 1:])
        lengths = np.maximum(high - low, 0.0)
        lengths[lengths < tolerance] = 0.0
        return np.asarray(lengths * is_inside)

    def transfer_load(self, grid: Grid, load: FloatArray) -> FloatArray:
        """Transfer a load on the cells of `grid` to the counterbody's cells, with the same resultant."""
        return np.asarray(self.overlap(grid) @ load / self.grid_on_body(grid).widths[:, None])
