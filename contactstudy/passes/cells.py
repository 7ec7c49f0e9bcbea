"""Cells of the cross-section (x, z) around the positions of a field."""

from __future__ import annotations

import numpy as np

from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.eigenstrain.body import EigenstrainBody
from contactstudy.errors import InvalidInputError


def edges_around(positions: FloatArray, low: float, high: float) -> FloatArray:
    """Edges of cells around increasing positions, half-way between them; the outer ones on `low` and `high`.

    Where these are infinite the outer cells are as wide to either side.

    Examples
    --------
    >>> edges_around(np.array([0.5, 1.0, 2.0]), 0.0, np.inf).tolist()
    [0.0, 0.75, 1.5, 2.5]
    """
    middle = 0.5 * (positions[1:] + positions[:-1])
    first = low if np.isfinite(low) else 2 * positions[0] - middle[0]
    last = high if np.isfinite(high) else 2 * positions[-1] - middle[-1]
    return np.concatenate([[first], middle, [last]])


def cross_section(body: Body, x: FloatArray, z: FloatArray) -> EigenstrainBody:
    """Cells around positions in a body, from its top and its free ends.

    Raises
    ------
    InvalidInputError
        If positions do not increase, or there are fewer than two along an axis.
    """
    for name, points in (("x", x), ("z", z)):
        if points.size < 2 or (np.diff(points) <= 0).any():
            raise InvalidInputError(name, points, "at least two positions, increasing (metres)")
    low, high = body.extent
    x_edges, z_edges = edges_around(x, low, high), edges_around(z, 0.0, np.inf)
    return EigenstrainBody(body.material, body.extent, x_edges, z_edges)
