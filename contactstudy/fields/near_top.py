"""The cells on which the free ends see a load: finer ones if a point lies near the top."""

from __future__ import annotations

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.fine_cells import FineCells


def seen_by_ends(cells: FloatArray, grid: Grid, z: FloatArray) -> tuple[FloatArray, Grid]:
    """Load that the ends are freed from for points at depths `z`, and the cells that carry it.

    It is the one that the half-space carries near the top; what that carries for deeper points has the same field.
    """
    fine = FineCells(cells, grid)
    return fine.refined(near=bool(fine.near(z).any()))
