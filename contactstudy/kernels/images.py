"""Influence of one cell on a uniform grid: alone, or with all its mirror images in two ends.

Mirroring a load evenly in both ends repeats it with the period ``2 length`` along x. The nearest image is taken as it
stands. The others vary smoothly over one period: the next few are evaluated, and those further away replaced by their
load spread evenly (the midpoint rule with its first correction, read backwards), at Chebyshev points only, and
interpolated.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from contactstudy.checks import FloatArray

CornerFunction = Callable[[FloatArray, FloatArray], FloatArray]

NEAR_IMAGES = 5
"""Images on either side that are evaluated one by one; those beyond are spread evenly. Accuracy."""

FAR_LIMIT = 1e6
"""Where the spread load ends, over the length. Accuracy; references of displacements count from it."""

ROUNDING = 1e-9
"""Part of a cell that is nothing. Accuracy."""

CHEBYSHEV_X = 16
"""Points along x from which the images' influence is interpolated. Accuracy."""

LEFT = 1.5e-8
"""Part of the images' influence that interpolation between few points may leave. Accuracy."""


def cell_kernel(corner: CornerFunction, x: FloatArray, y: FloatArray, dx: float, dy: float) -> FloatArray:
    """Influence of a unit load on one cell at uniform offsets `x` and `y` from its centre.

    Parameters
    ----------
    corner : callable
        Corner function of broadcastable offsets ``(X, Y)``; it may return leading axes.
    x, y : array
        Offsets from cell to observer, with spacing `dx` and `dy`.
    dx, dy : float
        Cell size.

    Returns
    -------
    array (..., x, y)
    """
    x_edges = snapped(np.append(x - 0.5 * dx, x[-1] + 0.5 * dx), dx)
    y_edges = np.append(y - 0.5 * dy, y[-1] + 0.5 * dy)
    return np.diff(np.diff(corner(x_edges[:, None], y_edges[None, :]), axis=-1), axis=-2)


def snapped(offsets: FloatArray, size: float) -> FloatArray:
    """Offsets from edges, 0 where rounding left a little: a step of traction has a logarithm there, cut off at 0."""
    return np.where(np.abs(offsets) < ROUNDING * size, 0.0, offsets)


def mirrored_kernel(
    corner: CornerFunction, x: FloatArray, y: FloatArray, dx: float, dy: float, length: float
) -> FloatArray:
    """Influence of a unit load on one cell and on all its images at distances ``2 length`` along x.

    As `cell_kernel`; offsets along x stay within ``length`` (and half a cell). A quantity that grows with distance
    contains the constant of a load that ends at ``FAR_LIMIT * length``.
    """
    images = image_kernel(corner, x, y, dx, dy, length, nearest=2 * length)
    return cell_kernel(corner, x, y, dx, dy) + images


def image_kernel(
    corner: CornerFunction, x: FloatArray, y: FloatArray, dx: float, dy: float, length: float, *, nearest: float
) -> FloatArray:
    """Influence of a unit load on each of a cell's images from the distance `nearest` on, every ``2 length``.

    As `mirrored_kernel`, of which it is all but the cell itself.
    """
    period = 2 * length
    spread_from, spread_to = nearest + (NEAR_IMAGES - 0.5) * period, FAR_LIMIT * length
    shifts: list[float] = []
    weights: list[float] = []

    def add(start: float, stop: float, weight: float) -> None:
        """Add a unit load per length between two distances, and its like on the other side."""
        shifts.extend((start, stop, -stop, -start))
        weights.extend((-weight, weight, -weight, weight))

    for number in range(NEAR_IMAGES):
        add(nearest + period * number - 0.5 * dx, nearest + period * number + 0.5 * dx, 1.0)
    add(spread_from, spread_to, dx / period)
    step = 0.1 * length
    for side in (-step, step):
        slope = period / 24 * np.sign(side) / (2 * step)
        add(spread_from + side - 0.5 * dx, spread_from + side + 0.5 * dx, slope)

    at_x, from_points_x = _chebyshev_points(x, length + dx, CHEBYSHEV_X)
    at_y, from_points_y = few_points(y, length)
    positions = np.add.outer(shifts, at_x)[..., None]
    values = corner(positions, at_y + 0.5 * dy) - corner(positions, at_y - 0.5 * dy)
    images = np.tensordot(weights, values, axes=(0, -3))
    images = from_points_x @ images
    return np.asarray(images if from_points_y is None else images @ from_points_y.T)


def few_points(values: FloatArray, distance: float, left: float = LEFT) -> tuple[FloatArray, FloatArray | None]:
    """Few points from which what loads far away do is interpolated to many, and the matrix (value, point) that does so.

    The loads are at a `distance` from all points, so on a span ``2 s`` each point divides what is left by
    ``exp(asinh(distance / s))``. Where no fewer points would do: `values` and None.
    """
    low, high = float(values.min()), float(values.max())
    half = 0.5 * (high - low)
    if not half:
        return values[:1], np.ones((values.size, 1)) if values.size > 1 else None
    count = int(np.ceil(-np.log(left) / np.arcsinh(distance / half))) + 1
    if count >= values.size:
        return values, None
    points, matrix = _chebyshev_points(values - 0.5 * (low + high), half, count)
    return points + 0.5 * (low + high), matrix


def _chebyshev_points(values: FloatArray, span: float, count: int) -> tuple[FloatArray, FloatArray]:
    """Chebyshev points of ``-span..span``, and the matrix that interpolates from them to `values`."""
    points = chebyshev.chebpts1(count)
    matrix = np.linalg.solve(
        chebyshev.chebvander(points, count - 1).T, chebyshev.chebvander(values / span, count - 1).T
    )
    return span * points, np.asarray(matrix.T, dtype=np.float64)
