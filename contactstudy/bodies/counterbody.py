"""The second elastic body of a contact, and how its cells lie on the first one's."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contactstudy.arrays.grid import Grid, growing_edges
from contactstudy.bodies.models import Body, FiniteLengthSpace, HalfSpace
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

ALIGNED = 1e-6  # Part of a cell within which an end of the counterbody lies on a border between cells


@dataclass(frozen=True)
class Counterbody:
    """The second body, in coordinates from its end I: it presses on the first.

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

    def own_grid(self, grid: Grid) -> Grid:
        """Cells in the counterbody's own coordinate that span it if it has ends.

        On uniform cells they are about as large as the cells of `grid`; else they equal the cells of `grid`, with
        borders at the ends of both bodies, and few more where the counterbody overhangs.
        """
        if not isinstance(self.body, FiniteLengthSpace):
            return _moved(grid, -self.start)
        if grid.uniform:
            cells = max(4, round(self.body.length / grid.dx))
            return Grid(x_range=(0.0, self.body.length), y_range=grid.y_range, cells_x=cells, cells_y=grid.cells_y)
        edges, stop = grid.x_edges - self.start, self.body.length
        tolerance = ALIGNED * grid.widths.min()
        for end in (0.0, stop):
            if edges[0] < end < edges[-1] and np.abs(edges - end).min() > tolerance:
                raise InvalidInputError(
                    "grid",
                    f"cells without a border at x = {self.start + end:g} m",
                    "cells that meet the ends of both bodies where their widths differ",
                )
        inside = edges[(edges > tolerance) & (edges < stop - tolerance)]
        widths = grid.widths
        before = -growing_edges(edges[0], widths[0])[::-1] + edges[0] if edges[0] > tolerance else np.zeros(1)
        after = growing_edges(stop - edges[-1], widths[-1]) + edges[-1] if stop - edges[-1] > tolerance else [stop]
        own = np.concatenate([before, inside, after])
        own[0], own[-1] = 0.0, stop
        return Grid.between(own, grid.y_range, grid.cells_y)

    def overlap(self, grid: Grid) -> FloatArray:
        """Return the length that each own cell shares with each cell of `grid`, metres: array (own cell, cell).

        A uniform cell that the counterbody's end cuts belongs to it whole if its centre does: the part beyond is
        counted to the last own cell, so that no load is lost.
        """
        own_edges, edges = self.start + self.own_grid(grid).x_edges, grid.x_edges
        tolerance = ALIGNED * grid.widths.min()
        inside = (grid.x > own_edges[0] - tolerance) & (grid.x < own_edges[-1] + tolerance)
        own_edges[0], own_edges[-1] = min(own_edges[0], edges[0]), max(own_edges[-1], edges[-1])
        low = np.maximum(own_edges[:-1, None], edges[None, :-1])
        high = np.minimum(own_edges[1:, None], edges[None, 1:])
        shared = np.maximum(high - low, 0.0)
        shared[shared < tolerance] = 0.0
        return np.asarray(shared * inside)

    def load_on(self, grid: Grid, load: FloatArray) -> FloatArray:
        """Load on the own cells from one on the cells of `grid`; its resultant stays the same."""
        return np.asarray(self.overlap(grid) @ load / self.own_grid(grid).widths[:, None])


def _moved(grid: Grid, shift: float) -> Grid:
    """Return the same cells elsewhere along x."""
    if grid.uniform:
        return replace(grid, x_range=(grid.x_range[0] + shift, grid.x_range[1] + shift))
    return Grid.between(grid.x_edges + shift, grid.y_range, grid.cells_y)
