"""Values that a contact on columns is refined for: peaks, and pressures and loads at its ends."""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.across import largest_across
from contactstudy.checks import FloatArray
from contactstudy.contact.axial_shape import centres_of
from contactstudy.contact.end_law import EndLaw

Pair = tuple[float, float]
Laws = tuple[EndLaw | None, EndLaw | None]


def read_ends(edges: FloatArray, pressure: FloatArray, laws: Laws) -> tuple[Pair, Pair, float]:
    """Peak of either half, pressure at either end, and by how much the parabola across lifts the largest pressure."""
    top = largest_across(pressure)
    along_y = float(top.max() / pressure.max()) - 1
    half = 0.5 * (edges[-1] - edges[0])
    peaks, ends = [], []
    for side in (0, 1):
        distances, row = from_end(side, edges, top)
        end = _extrapolated(distances, row)
        own = row[centres_of(distances) < half]
        # Where the pressure rises through the middle, the largest of a half lies there.
        largest = max(float(own.max()), float(np.interp(half, centres_of(distances), row)))
        # Only where the pressure rises to the end is the largest one beyond the outermost column's mean.
        peaks.append(np.inf if laws[side] else max(largest, end) if own.argmax() == 0 else largest)
        ends.append(np.inf if laws[side] else end)
    return (peaks[0], peaks[1]), (ends[0], ends[1]), along_y


def end_loads(edges: FloatArray, pressure: FloatArray, half_width: float) -> Pair:
    """Load on the last half-width at either end, over the width of a cell along y."""
    sums = pressure.sum(axis=1)
    loads = []
    for side in (0, 1):
        distances, row = from_end(side, edges, sums)
        loads.append(float(row @ np.diff(np.minimum(distances, half_width))))
    return loads[0], loads[1]


def from_end(side: int, edges: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distances of the edges from an end of the shape, and the values counted from there."""
    return (edges - edges[0], values) if side == 0 else (edges[-1] - edges[::-1], values[::-1])


def _extrapolated(edges: FloatArray, row: FloatArray) -> float:
    """Pressure at the end, from the means of the three outermost columns."""
    if row[0] <= 0:
        return 0.0
    sums = np.cumsum(row[:3] * np.diff(edges[:4]))
    at = edges[1:4]
    return max(float(np.linalg.solve(np.stack([at, at**2, at**3], axis=1), sums)[0]), 0.0)
