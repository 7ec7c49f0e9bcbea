"""The generatrix of a roller from a map of its surface."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


def ridge(x: FloatArray, y: FloatArray, heights: FloatArray) -> FloatArray:
    """Heights along the highest line of a roller, which need not be parallel to x.

    Parameters
    ----------
    x, y : array
        Positions along and across the roller, metres.
    heights : array (x, y)
        Metres; NaN where there is none.

    Returns
    -------
    array (x)
        Metres; NaN where half the points or more of a section are missing.

    Raises
    ------
    InvalidInputError
        If the surface is not that of a roller whose highest line lies within the map.

    Notes
    -----
    With ``h = p(x) + a y + b x y + c y**2``, where `p` may be anything, `a`, `b` and `c` follow from least squares over
    the whole map. The highest line is ``y = -(a + b x) / (2 c)``, and the height on it the mean over a section of
    ``h - a y - b x y - c y**2`` and ``-(a + b x)**2 / (4 c)``: so the noise of a section is averaged.

    Examples
    --------
    >>> x, y = np.linspace(0.0, 10e-3, 5), np.linspace(-0.2e-3, 0.2e-3, 9)
    >>> heights = -((x[:, None] - 5e-3) ** 2) / 2.5 - (y - 0.05e-3 - 0.01 * x[:, None]) ** 2 / 0.02
    >>> (1e6 * ridge(x, y, heights)).round(6).tolist()[:2]
    [-10.0, -2.5]
    """
    there = np.isfinite(heights)
    counts = there.sum(axis=1)
    known = 2 * counts > y.size
    scale, length = max(float(np.abs(y).max()), 1e-300), max(float(np.abs(x).max()), 1e-300)
    across, along = np.broadcast_to(y / scale, heights.shape), (x / length)[:, None]

    def centred(values: FloatArray) -> FloatArray:
        """Without the mean of each section."""
        means = np.sum(values, axis=1, where=there) / np.maximum(counts, 1)
        return np.asarray((values - means[:, None])[there])

    terms = np.stack([centred(term) for term in (across, along * across, across**2)], axis=1)
    filled = np.where(there, heights, 0.0)
    a, b, c = np.linalg.lstsq(terms, centred(filled), rcond=None)[0]
    slope = a + b * x / length
    highest = -0.5 * scale * slope / c if c < 0 else np.full(x.size, np.nan)
    inside = (highest >= y[0]) & (highest <= y[-1])
    if not inside[known].all() or not known.any():
        raise InvalidInputError(
            "height",
            "a map without the highest line of a roller in it",
            "such that the surface rises to one line across the map and falls again",
            "turn=90 takes the other axis for the roller's; for a part that is straight across give one line as CSV",
        )
    form = slope[:, None] * across + c * across**2
    means = np.sum(filled - form, axis=1, where=there) / np.maximum(counts, 1)
    return np.where(known, means - slope**2 / (4 * c), np.nan)
