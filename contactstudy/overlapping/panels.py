"""Axial positions graded towards the ends, on which smooth functions of the corner's distance are interpolated.

What the free ends add to a displacement varies on the scale of the distance from the end. Panels that double away
from the end, with a few Gauss points each, hold it to many digits whatever the grid, so the operator of a long roller
costs little more than that of a short one.
"""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.overlapping.quadrature import growing_edges, panel_nodes


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
        nodes = positions[number * order : (number + 1) * order]
        for i in range(order):
            others = np.delete(nodes, i)
            lagrange = np.prod((points[here, None] - others) / (nodes[i] - others), axis=1)
            np.add.at(moments[number * order + i], cell[here], weights[here] * lagrange)
    return moments
