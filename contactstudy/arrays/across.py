"""Largest pressure of each cross-section of a contact, between its cells."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray


def largest_across(pressure: FloatArray) -> FloatArray:
    """Largest pressure of each column (x, y) between its cells along y.

    The squared pressure is a parabola across the contact, so the one through the largest three cells tells its top.

    Examples
    --------
    >>> y = np.array([-0.7, -0.2, 0.3, 0.8])
    >>> float(largest_across(np.sqrt(1 - y**2)[None, :])[0].round(9))
    1.0
    """
    squared = pressure**2
    at = np.clip(squared.argmax(axis=1), 1, squared.shape[1] - 2)
    before, here, after = (squared[np.arange(at.size), at + step] for step in (-1, 0, 1))
    bend = np.minimum(before - 2 * here + after, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        lift = np.where(bend < 0, -((after - before) ** 2) / (8 * bend), 0.0)
    largest = squared.max(axis=1)
    # A contact of a cell or two has no parabola.
    return np.sqrt(np.where(largest > 0, np.maximum(here + np.minimum(lift, 0.25 * here), largest), 0.0))
