"""Between the points of a list: polynomials through some of them, evaluated on finer points beside one."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray

FINE = 17
"""Points from one neighbour of a point to the other, where polynomials are evaluated."""


class Refined(NamedTuple):
    """How values at some points are interpolated beside one of them.

    Attributes
    ----------
    window : slice
        The points that the polynomial goes through.
    points : array
        Where it is evaluated: from one neighbour to the other, and the point itself.
    matrix : array (point, node)
        From the values in the window to those at `points`.
    """

    window: slice
    points: FloatArray
    matrix: FloatArray


def refined(place: FloatArray, centre: int, around: int) -> Refined:
    """Polynomial through the `around` points on either side of one; near an edge as many, all on one side.

    Examples
    --------
    >>> near = refined(np.array([0.0, 1.0, 3.0, 4.0]), 1, 1)
    >>> near.window, bool(np.allclose(near.matrix @ [0.0, 1.0, 9.0], near.points**2))
    (slice(0, 3, None), True)
    """
    count = min(2 * around + 1, place.size)
    start = min(max(centre - around, 0), place.size - count)
    nodes = place[start : start + count]
    low, high = place[max(centre - 1, 0)], place[min(centre + 1, place.size - 1)]
    points = np.unique(np.append(np.linspace(low, high, FINE), place[centre])) if count > 1 else nodes
    return Refined(slice(start, start + count), points, _lagrange(nodes, points))


def _lagrange(nodes: FloatArray, points: FloatArray) -> FloatArray:
    """Matrix (point, node) that interpolates by the polynomial through the nodes."""
    matrix = np.ones((points.size, nodes.size))
    for i, j in product(range(nodes.size), repeat=2):
        if i != j:
            matrix[:, i] *= (points - nodes[j]) / (nodes[i] - nodes[j])
    return matrix
