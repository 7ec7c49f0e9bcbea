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
    return min(changes_within(pressure, x, dy, column, rising=False))


def changes_within(
    pressure: FloatArray, x: FloatArray, dy: float, column: int, *, rising: bool = True
) -> tuple[float, float]:
    """Lengths along the axis and across it on which a pressure changes about one column, metres.

    Along the axis it is the half-width of the peak that would fall as fast; infinite if the pressure is nearly uniform.
    Without pressure there it is the distance to the contact. Where the pressure is `rising` counts as well.
    """
    line = pressure.max(axis=1)
    other = line < FLANK * line[column]
    if rising:
        other |= FLANK * line > line[column]
    loaded = column if line[column] > 0 else int(line.argmax())
    across = 0.5 * dy * np.count_nonzero(pressure[loaded] > 0)
    along = np.abs(x[other] - x[column]).min() if other.any() else np.inf
    if line[column] > 0:
        along /= np.sqrt(1 - FLANK**2)
    return float(along), float(across)
