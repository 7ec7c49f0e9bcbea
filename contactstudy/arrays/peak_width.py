"""How wide a peak of a contact pressure is: the depths at which stresses below it are largest go with that."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray

FLANK = 0.8
"""Share of a peak at which its width is read; a half-ellipse is 1 / 0.6 times as wide as there."""


def peak_width(pressure: FloatArray, x: FloatArray, dy: float, column: int) -> float:
    """Half-width of a peak of the pressure along its steeper side, or across the contact if that is narrower, metres.

    Parameters
    ----------
    pressure : array (x, y)
        Pressure of the cells.
    x : array
        Their centres along the axis, metres.
    dy : float
        Their width across, metres.
    column : int
        Number of the peak along x.

    Examples
    --------
    >>> x = np.linspace(-1.0, 1.0, 201)
    >>> ridge = np.sqrt(np.maximum(1 - (x / 0.5) ** 2, 0))[:, None] * np.ones(20)
    >>> round(peak_width(ridge, x, 0.1, 100), 1)
    0.5
    """
    line = pressure.max(axis=1)
    low = np.flatnonzero(line < FLANK * line[column])
    across = 0.5 * dy * np.count_nonzero(pressure[column] > 0)
    if not low.size:
        return across
    return float(min(np.abs(x[low] - x[column]).min() / np.sqrt(1 - FLANK**2), across))
