"""Fields on cells and points of different widths as pictures of equal pixels."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray

Span = tuple[float, float]


def pixels(
    values: FloatArray, axes: tuple[FloatArray, FloatArray], spans: tuple[Span, Span], shape: tuple[int, int]
) -> FloatArray:
    """Values at the centres of pixels, interpolated linearly between points and held beyond the outermost.

    Parameters
    ----------
    values : array (across, up)
        Field.
    axes : tuple of array
        Increasing positions of the points along both.
    spans : tuple
        What the picture shows along both.
    shape : tuple of int
        Pixels along both.

    Returns
    -------
    array (up, across)
        As a picture has it: rows from below.

    Examples
    --------
    >>> values = np.array([[0.0, 1.0], [2.0, 3.0]])
    >>> pixels(values, (np.array([0.0, 1.0]), np.array([0.0, 1.0])), ((0.0, 1.0), (0.0, 1.0)), (2, 1)).tolist()
    [[1.0, 2.0]]
    """
    for axis, (at, span, count) in enumerate(zip(axes, spans, shape, strict=True)):
        if at.size == 1:
            values = np.repeat(values, count, axis=axis)
            continue
        wanted = span[0] + (np.arange(count) + 0.5) * (span[1] - span[0]) / count
        lower = np.clip(np.searchsorted(at, wanted) - 1, 0, at.size - 2)
        part = np.clip((wanted - at[lower]) / (at[lower + 1] - at[lower]), 0.0, 1.0)
        part = part[:, None] if axis == 0 else part
        values = (1 - part) * values.take(lower, axis) + part * values.take(lower + 1, axis)
    return np.ascontiguousarray(values.T)


def between(values: FloatArray, at: FloatArray, wanted: float, axis: int) -> FloatArray:
    """Values in a plane across an axis, interpolated linearly between points and held beyond the outermost.

    Parameters
    ----------
    values : array
        Field.
    at : array
        Increasing positions of the points along the axis.
    wanted : float
        Position of the plane.
    axis : int
        Which axis of the field.

    Examples
    --------
    >>> between(np.array([[0.0, 1.0], [2.0, 3.0]]), np.array([0.0, 1.0]), 0.25, 0).tolist()
    [0.5, 1.5]
    """
    lower = int(np.clip(np.searchsorted(at, wanted) - 1, 0, max(at.size - 2, 0)))
    upper = min(lower + 1, at.size - 1)
    part = float(np.clip((wanted - at[lower]) / (at[upper] - at[lower]), 0.0, 1.0)) if upper > lower else 0.0
    first, last = (np.asarray(values.take(number, axis)) for number in (lower, upper))
    if part in (0.0, 1.0):  # a plane of points does not take NaN from its neighbour
        return last if part else first
    return (1 - part) * first + part * last
