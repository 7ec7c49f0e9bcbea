"""Gap before deformation on cells: at the centres of uniform ones, the mean along x over others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray

GAP_NODES = 6
"""Gauss points over the width of a cell from which the mean gap is taken. Accuracy."""

ROUNDING = 1e-9
"""Part of a cell that is rounding. Accuracy."""

Clearance = Callable[[FloatArray, FloatArray], FloatArray]
"""Height of a roller (x, y) at distances from its mid-length and from its centre line; infinite beyond its ends."""


def onto_ends(from_middle: FloatArray, half: float, width: float) -> FloatArray:
    """Distances of cells' centres from mid-length, those right at the roller's ends exactly there.

    Rounding does not decide whether such a cell is under the roller: it is, at both ends.

    Examples
    --------
    >>> bool(onto_ends(np.array([0.1 + 0.2]), 0.3, 0.1) == 0.3)
    True
    """
    at_end = np.abs(np.abs(from_middle) - half) <= ROUNDING * width
    return np.where(at_end, np.copysign(half, from_middle), from_middle)


def gap_on_cells(clearance: Clearance, grid: Grid, middle: float, half: float) -> FloatArray:
    """Return the gap on the cells of a grid, metres.

    Parameters
    ----------
    clearance : callable
        Height of the roller.
    grid : Grid
        Cells.
    middle, half : float
        Position of the roller's mid-length, and half of its length, metres.

    Examples
    --------
    >>> grid = Grid((0.0, 4.0), (-1.0, 1.0), 4, 1)
    >>> gap_on_cells(lambda x, y: x[:, None] ** 2 + 0 * y, grid, 2.0, 2.0)[:, 0].tolist()
    [2.25, 0.25, 0.25, 2.25]
    """
    from_middle = grid.x - middle
    if grid.uniform:
        return clearance(onto_ends(from_middle, half, grid.dx), grid.y)
    nodes, weights = np.polynomial.legendre.leggauss(GAP_NODES)
    within = from_middle[:, None] + 0.5 * grid.widths[:, None] * nodes
    along = clearance(within.ravel(), np.zeros(1)).reshape(within.shape)
    under = np.isfinite(along)
    shares = np.maximum(under @ weights, weights.min())
    mean = np.where(under, along, 0.0) @ weights / shares
    at_centre = clearance(from_middle, np.zeros(1))[:, 0]
    moved = np.where(np.isfinite(at_centre), mean - np.where(np.isfinite(at_centre), at_centre, 0.0), 0.0)
    return np.asarray(clearance(from_middle, grid.y) + moved[:, None])
