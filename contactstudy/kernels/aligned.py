"""Points of an axis that lie alike relative to uniform cells: they share one kernel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray, IntArray

OFFSET_TOLERANCE = 1e-6
"""Part of a cell by which offsets from the cell centre may differ and count as one. Accuracy."""


@dataclass(frozen=True, eq=False)
class Aligned:
    """Points of one axis that share their offset from the nearest cell centre.

    Attributes
    ----------
    offset : float
        Distance from the cell centre, metres.
    points : array of int
        Which points of the axis they are.
    cells : array of int
        Cell of each (also outside the grid).
    """

    offset: float
    points: IntArray
    cells: IntArray


def aligned_points(values: FloatArray, first_centre: float, step: float) -> list[Aligned]:
    """Group the points of one axis by their offset from the cell centres."""
    position = (values - first_centre) / step
    cells = np.floor(position + 0.5 - OFFSET_TOLERANCE).astype(np.int64)
    offset = np.round((position - cells) / OFFSET_TOLERANCE).astype(np.int64)
    return [
        Aligned(float(value) * OFFSET_TOLERANCE * step, members, cells[members])
        for value in np.unique(offset)
        for members in [np.flatnonzero(offset == value)]
    ]
