"""Border of the contact across y, resolved to a few hundredths of a cell.

Across the smooth edge of a contact the pressure goes to zero like the square root of the distance, and the gap opens
like its power 3/2 (K. L. Johnson, Contact Mechanics, 1985, section 5.1). So the squared pressure inside and the gap to
the power 2/3 outside are straight lines through the edge: quadratics are fitted to them, and their zeros averaged.
"""

from __future__ import annotations

import numpy as np

from contactstudy.checks import Array, FloatArray, IntArray

SKIPPED = 2
"""Cells on either side of an edge that are left out: they carry the error of the cell that the edge cuts. Accuracy."""

FITTED = 5
"""Cells behind these that a quadratic is fitted to. Accuracy."""

EDGE_UNCERTAINTY = 0.04
"""Largest error of an edge in cells, as seen at Hertz' contacts whose edge lies anywhere in a cell. Accuracy."""


def contact_borders(pressure: Array, place: Array, gap: Array | None = None) -> tuple[Array, Array]:
    """First and last y in contact, for each row of cells.

    Parameters
    ----------
    pressure : array (..., y)
        Pressure on cells; NaN beyond a padded row.
    place : array (..., y)
        Cell centres, increasing and uniform; NaN beyond a padded row.
    gap : array (..., y), optional
        Gap after deformation, infinite where there is nothing to touch: a second opinion on the border, and the only
        one where the contact is narrow.

    Returns
    -------
    tuple of array (...)
        In the unit of `place`; NaN where nothing is loaded. Where fewer than 7 cells are fit for it, the border is
        the face of the last loaded cell.

    Examples
    --------
    >>> y = (np.arange(40) - 19.5) / 16
    >>> first, last = contact_borders(np.sqrt(np.clip(1 - y**2, 0, None)), y)
    >>> bool(abs(last - 1) < 1e-12), bool(abs(first + 1) < 1e-12)
    (True, True)
    """
    shape, cells = pressure.shape[:-1], pressure.shape[-1]
    rows = np.nan_to_num(np.asarray(pressure, np.float64)).reshape(-1, cells)
    opening = np.full_like(rows, np.nan) if gap is None else np.asarray(gap).reshape(-1, cells)
    centres = np.broadcast_to(place, pressure.shape).reshape(-1, cells)
    begin, count = np.nanmin(centres, axis=1, initial=np.inf), np.isfinite(centres).sum(axis=1)
    step = (np.nanmax(centres, axis=1, initial=-np.inf) - begin) / np.maximum(count - 1, 1)
    first = cells - 1 - _last_edges(rows[:, ::-1], opening[:, ::-1])
    last = _last_edges(rows, opening)
    return (begin + step * first).reshape(shape), (begin + step * last).reshape(shape)


def _last_edges(pressure: FloatArray, gap: FloatArray) -> FloatArray:
    """Last edge along each row, in cells from the centre of the first; NaN where open."""
    edges = np.full(pressure.shape[0], np.nan)
    rows = np.flatnonzero(pressure.any(axis=1))
    last = pressure.shape[1] - 1 - (pressure[rows, ::-1] > 0).argmax(axis=1)
    begin_inside, begin_outside = last - SKIPPED, last + 1 + SKIPPED
    squared = _samples(pressure[rows], begin_inside, -1) ** 2
    opening = _samples(gap[rows], begin_outside, 1) ** (2 / 3)
    face = last + 0.5
    estimates = np.stack([begin_inside + _distance_to_zero(squared), begin_outside - _distance_to_zero(opening)])
    valid = np.abs(estimates - face) <= 1
    total = np.where(valid, estimates, 0.0).sum(axis=0)
    edges[rows] = np.where(valid.any(axis=0), total / np.maximum(valid.sum(axis=0), 1), face)
    return edges


def _samples(values: FloatArray, begin: IntArray, direction: int) -> FloatArray:
    """Values of each row from the cell `begin` on: array (row, `FITTED`); NaN unless all are positive numbers."""
    cells = begin[:, None] + direction * np.arange(FITTED)
    inside = (cells >= 0) & (cells < values.shape[1])
    found = np.take_along_axis(values, np.where(inside, cells, 0), axis=1)
    good = (inside & (found > 0) & np.isfinite(found)).all(axis=1)
    return np.where(good[:, None], found, np.nan)


def _distance_to_zero(values: FloatArray) -> FloatArray:
    """How many steps before the first of growing values (of each row) the quadratic fitted to them is zero, or NaN."""
    to_quadratic = np.linalg.pinv(np.vander(np.arange(float(FITTED)), 3))
    bend, slope, level = to_quadratic @ values.T
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(2 * level / (slope + np.sqrt(slope**2 - 4 * bend * level)))
