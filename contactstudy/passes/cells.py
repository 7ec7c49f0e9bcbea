"""Cells of the cross-section (x, z) around the positions of a field."""

from __future__ import annotations

import numpy as np

from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.eigenstrain.body import EigenstrainBody
from contactstudy.errors import InvalidInputError

NEAR = 1.0
"""Distance of the outer position from an end, over the distance of positions, up to which its cell ends there."""


ROUNDING = 1e-9
"""Part of the positions' range that is rounding. Accuracy."""


def edges_around(positions: FloatArray, low: float, high: float) -> FloatArray:
    """Edges of cells around increasing positions, half-way between them.

    The outer cells end at `low` and `high` if these are as near as the next position, and else are as wide to
    either side.

    Examples
    --------
    >>> edges_around(np.array([0.5, 1.0, 2.0]), 0.0, 9.0).tolist()
    [0.0, 0.75, 1.5, 2.5]
    """
    middle = 0.5 * (positions[1:] + positions[:-1])
    near = [NEAR * (positions[1] - positions[0]), NEAR * (positions[-1] - positions[-2])]
    first = low if positions[0] - low <= near[0] else 2 * positions[0] - middle[0]
    last = high if high - positions[-1] <= near[1] else 2 * positions[-1] - middle[-1]
    return np.concatenate([[first], middle, [last]])


def cross_section(body: Body, x: FloatArray, z: FloatArray) -> EigenstrainBody:
    """Cells around positions in a body, from its top and its free ends.

    Raises
    ------
    InvalidInputError
        If positions do not increase, there are fewer than two along an axis, or they do not reach to the top and the
        free ends, or beyond these.
    """
    for name, points in (("x", x), ("z", z)):
        if points.size < 2 or (np.diff(points) <= 0).any():
            raise InvalidInputError(name, points, "at least two positions, increasing (metres)")
    low, high = body.extent
    slack = ROUNDING * (x[-1] - x[0])
    if x[0] < low - slack or x[-1] > high + slack:
        raise InvalidInputError("x", f"{x[0]:g} to {x[-1]:g} m", f"positions in the body, from {low:g} to {high:g} m")
    x_edges, z_edges = edges_around(x, low, high), edges_around(z, 0.0, np.inf)
    for name, face, edge in (("x", low, x_edges[0]), ("x", high, x_edges[-1]), ("z", 0.0, z_edges[0])):
        if np.isfinite(face) and edge != face:
            where = "the top" if name == "z" else f"the free end at {face:g} m"
            raise InvalidInputError(name, f"{edge:g} m, where the outer cell ends", f"positions that reach to {where}")
    return EigenstrainBody(body.material, body.extent, x_edges, z_edges)
