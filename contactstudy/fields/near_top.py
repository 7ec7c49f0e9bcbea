"""The fine cells on which the free ends see a load."""

from __future__ import annotations

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.fine_cells import FineCells, ends_in_steps


def seen_by_ends(cells: FloatArray, grid: Grid, length: float, *, smooth: bool) -> tuple[FloatArray, Grid]:
    """Load that the ends of a body from 0 to `length` are freed from, and the fine cells that carry it.

    It is the one that the half-space carries near the top. What that carries for deeper points makes the same field, so
    one load does for all depths. A load that is not smooth, or ends in steps, is uniform in each cell, for the ends as
    for the half-space.
    """
    if not smooth or ends_in_steps(cells):
        return cells, grid
    return FineCells(cells, grid, (0.0, length)).for_ends()
