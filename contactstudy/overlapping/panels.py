"""Axial positions graded towards the ends, on which smooth functions of the corner's distance are interpolated.

What the free ends add to a displacement varies on the scale of the distance from the end. Panels that double away
from the end, with a few Gauss points each, hold it to many digits whatever the grid, so the operator of a long roller
costs little more than that of a short one.
"""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.overlapping.quadrature import growing_edges, lagrange, panel_nodes

POSITIONS_PER_PANEL = 8
"""Gauss positions per panel along x. Accuracy."""


def graded_positions(reach: float, finest: float, order: int) -> tuple[FloatArray, FloatArray]:
    """Edges of panels from 0 to `reach` that double from `finest`, and `order` Gauss positions in each.

    Examples
    --------
    >>> edges, positions = graded_positions(4.0, 1.0, 2)
    >>> edges.tolist(), positions.size
    ([0.0, 1.0, 2.0, 4.0], 6)
    """
    panels = max(1, int(np.ceil(np.log2(reach / finest) - 1e-9)))
    edges = growing_edges(reach / 2.0**panels, reach)[: panels + 2]
    return edges, panel_nodes(edges, order)[0]


def cell_moments(edges: FloatArray, positions: FloatArray, cell_edges: FloatArray) -> FloatArray:
    """Integrals over each cell of the Lagrange polynomials on each panel's positions.

    Parameters
    ----------
    edges, positions : array
        Result of `graded_positions`.
    cell_edges : array
        Edges of the cells; parts of cells outside the panels count nothing.

    Returns
    -------
    array (position, cell)

    Examples
    --------
    >>> edges, positions = graded_positions(4.0, 1.0, 3)
    >>> moments = cell_moments(edges, positions, np.array([0.0, 0.5, 2.5, 4.0]))
    >>> (positions**2 @ moments * 3).round(9).tolist()
    [0.125, 15.5, 48.375]
    """
    order = positions.size // (edges.size - 1)
    moments = np.zeros((positions.size, cell_edges.size - 1))
    breaks = np.union1d(edges, np.clip(cell_edges, edges[0], edges[-1]))
    points, weights = panel_nodes(breaks, order)
    middles = np.repeat(0.5 * (breaks[1:] + breaks[:-1]), order)
    panel = np.clip(np.searchsorted(edges, middles) - 1, 0, edges.size - 2)
    cell = np.searchsorted(cell_edges, middles) - 1
    for number in range(edges.size - 1):
        here = (panel == number) & (cell >= 0) & (cell < moments.shape[1])
        own = slice(number * order, (number + 1) * order)
        shares = weights[here, None] * lagrange(positions[own], points[here])
        np.add.at(moments[own].T, cell[here], shares)
    return moments


def graded_interpolation(x: FloatArray, length: float, order: int) -> tuple[FloatArray, FloatArray] | None:
    """Few positions graded towards the ends, and the matrix that interpolates from them to many positions `x`.

    Parameters
    ----------
    x : array
        Positions from 0 to `length`; those on an end are kept as they are.
    length : float
        Distance between the ends; infinite for one end.
    order : int
        Positions per panel.

    Returns
    -------
    positions, matrix : array (p,), array (x, p)
        Or None if there would be no fewer positions than `x` has.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 401)
    >>> positions, matrix = graded_interpolation(x, 1.0, 8)
    >>> bool(positions.size < 200 and np.abs(matrix @ (positions + 0.01) ** -2.0 - (x + 0.01) ** -2.0).max() < 1e-3)
    True
    """
    half = 0.5 * length if np.isfinite(length) else float(x.max())
    near_first = x <= half
    from_end = np.where(near_first, x, length - x)
    inside = from_end > 0
    if not inside.any():
        return None
    finest = float(from_end[inside].min())
    if not half > finest:
        return None
    panels = max(1, int(np.ceil(np.log2(half / finest))))
    edges = finest * (half / finest) ** (np.arange(panels + 1) / panels)
    positions = panel_nodes(edges, order)[0]
    count = positions.size
    sides = 2 if np.isfinite(length) else 1
    kept = np.flatnonzero(~inside)
    if sides * count + kept.size >= x.size:
        return None
    matrix = np.zeros((x.size, sides * count + kept.size))
    panel = np.clip(np.searchsorted(edges, from_end) - 1, 0, panels - 1)
    for number in range(panels):
        own = slice(number * order, (number + 1) * order)
        for side, here in enumerate((near_first, ~near_first)[:sides]):
            points = np.flatnonzero(inside & here & (panel == number))
            matrix[points, side * count + own.start : side * count + own.stop] = lagrange(
                positions[own], from_end[points]
            )
    matrix[kept, sides * count + np.arange(kept.size)] = 1.0
    parts = [positions, length - positions] if sides == 2 else [positions]
    return np.concatenate([*parts, x[kept]]), matrix
