"""Border of the contact across y, resolved finer than the cells."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

FEWEST_CELLS = 8
"""Cells across the contact below which its border is taken from whole cells."""


def _edge(pressure: Array, place: Array, outermost: Array, inwards: int) -> Array:
    """Where the square of the pressure vanishes beyond the outermost loaded cell.

    At the border of a smooth contact the pressure goes to zero like a square root, so its square is smooth there (and
    a parabola in Hertz' contact): it is continued from three cells inside, without the outermost one, that the border
    cuts.
    """

    def at(values: Array, step: int) -> Array:
        column = np.clip(outermost + inwards * step, 0, values.shape[-1] - 1)
        return np.asarray(np.take_along_axis(values, column[..., None], axis=-1)[..., 0])

    y1, y2, y3 = (at(place, step) for step in (1, 2, 3))
    f1, f2, f3 = (at(pressure, step) ** 2 for step in (1, 2, 3))
    slope = (f2 - f1) / (y2 - y1)
    curvature = ((f3 - f2) / (y3 - y2) - slope) / (y3 - y1)
    root = y1 - f1 / slope
    for _ in range(4):
        value = f1 + (root - y1) * (slope + curvature * (root - y2))
        root = root - value / (slope + curvature * (2 * root - y1 - y2))
    # The border lies in the outermost loaded cell or, where the next one carries too little to count, the next.
    border, step = at(place, 0), np.abs(y2 - y1)
    inside, outside = border + 0.5 * inwards * step, border - inwards * step
    root = np.where(np.isfinite(root), root, border - 0.5 * inwards * step)
    return np.asarray(np.clip(root, np.minimum(inside, outside), np.maximum(inside, outside)))


def contact_borders(pressure: Array, place: Array) -> tuple[Array, Array]:
    """First and last y in contact, for each row of cells.

    Parameters
    ----------
    pressure : array (..., y)
        Pressure on cells; NaN beyond a padded row.
    place : array (..., y)
        Cell centres, increasing.

    Returns
    -------
    tuple of array (...)
        In the unit of `place`; NaN where nothing is loaded.

    Examples
    --------
    >>> y = (np.arange(40) - 19.5) / 16
    >>> first, last = contact_borders(np.sqrt(np.clip(1 - y**2, 0, None)), y)
    >>> bool(abs(last - 1) < 1e-12), bool(abs(first + 1) < 1e-12)
    (True, True)
    """
    place = np.broadcast_to(place, pressure.shape)
    loaded = pressure > 0
    count = loaded.sum(axis=-1)
    first = loaded.argmax(axis=-1)
    last = pressure.shape[-1] - 1 - loaded[..., ::-1].argmax(axis=-1)
    filled = np.where(loaded, pressure, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = _edge(filled, place, first, 1), _edge(filled, place, last, -1)
    cells = max(place.shape[-1] - 1, 1)
    half = 0.5 * (np.nanmax(place, axis=-1) - np.nanmin(place, axis=-1)) / cells if place.size else 0.0
    whole = [np.take_along_axis(place, at[..., None], axis=-1)[..., 0] for at in (first, last)]
    fine = count >= FEWEST_CELLS
    borders = np.where(fine, low, whole[0] - half), np.where(fine, high, whole[1] + half)
    empty = count == 0
    return np.where(empty, np.nan, borders[0]), np.where(empty, np.nan, borders[1])
