"""The second elastic body of a contact, and how its cells lie on the first one's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import Body, FiniteLengthSpace, HalfSpace
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

ALIGNED = 1e-6
"""Part of a cell within which an end of the counterbody lies on a border between cells. Accuracy."""


@dataclass(frozen=True)
class Counterbody:
    """The second body, seen from its own end I: what presses on the first.

    Parameters
    ----------
    body : Body
        A half-space, or a finite-length space with ends of its own.
    start : float
        Position of its end I on the first body's x axis, metres.
    """

    body: Body
    start: float = 0.0

    def __post_init__(self) -> None:
        """Refuse bodies that cannot be placed."""
        if not isinstance(self.body, HalfSpace | FiniteLengthSpace):
            raise InvalidInputError("counterbody", self.body, "a HalfSpace or a FiniteLengthSpace")

    def own_grid(self, grid: Grid) -> Grid:
        """Cells about as large as those of `grid`, in the counterbody's own coordinate, that span it if it has ends."""
        if not isinstance(self.body, FiniteLengthSpace):
            return Grid((grid.x_range[0] - self.start, grid.x_range[1] - self.start), grid.y_range, *grid.shape)
        cells = max(4, round(self.body.length / grid.dx))
        return Grid((0.0, self.body.length), grid.y_range, cells, grid.cells_y)

    def overlap(self, grid: Grid) -> FloatArray:
        """Return the length that each own cell shares with each cell of `grid`, metres: array (own cell, cell).

        A cell that the counterbody's end cuts belongs to it whole if its centre does: the part beyond is counted to
        the last own cell, so that no load is lost.
        """
        own = self.own_grid(grid)
        own_edges = self.start + np.linspace(*own.x_range, own.cells_x + 1)
        edges = np.linspace(*grid.x_range, grid.cells_x + 1)
        tolerance = ALIGNED * grid.dx
        inside = (grid.x > own_edges[0] - tolerance) & (grid.x < own_edges[-1] + tolerance)
        own_edges[0], own_edges[-1] = min(own_edges[0], edges[0]), max(own_edges[-1], edges[-1])
        low = np.maximum(own_edges[:-1, None], edges[None, :-1])
        high = np.minimum(own_edges[1:, None], edges[None, 1:])
        return np.asarray(np.maximum(high - low, 0.0) * inside)

    def load_on(self, grid: Grid, load: FloatArray) -> FloatArray:
        """Load on the own cells from one on the cells of `grid`; its resultant stays the same."""
        return np.asarray(self.overlap(grid) @ load / self.own_grid(grid).dx)
