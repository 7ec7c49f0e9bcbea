"""Influence between columns of cells of any width: a dense symmetric matrix along x for each wavenumber along y.

The displacement is averaged over the observer's width and known at its centre along y (Galerkin's way along x,
collocation along y). With forces ``f = w p`` per length of y (w: width of a column) the averaged displacement is

    u_i = sum_j K_ij f_j,   K_ij = (1 / (w_i w_j)) int_i dx int_j dx' k(x - x', Y),

the same for (i, j) and (j, i) to the last bit. The integrals are mixed differences over the columns' edges of a double
primitive ``F'' = k`` of the kernel ``k`` of a strip of load, differenced over the cell along y as well:

    pressure:           k = asinh(Y / |X|),  F = X**2 / 2 asinh(Y / |X|) + X Y asinh(X / |Y|) - Y X**2 / (2 R + 2 |Y|)
    traction along y:   k = ln R,            F = X**2 / 2 ln R + X Y atan(X / Y) - Y**2 / 4 ln(1 + X**2 / Y**2)

with ``R**2 = X**2 + Y**2`` (Love's rectangle integrated once more; terms that cancel in the differences are left out).
Both are even in X, so only distances between edges count. A mirrored column is one at the sum of the distances from the
mirror.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from contactstudy.checks import FloatArray
from contactstudy.kernels.images import FAR_LIMIT, NEAR_IMAGES
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch import TINY

FAR_COLUMNS = 24.0
"""Widths of the wider column from which on two columns are expanded about their centres. Accuracy: there the difference
of F loses more digits than the expansion leaves out."""

IMAGE_POINTS = 16
"""Chebyshev points along x, for both columns, from which farther images are interpolated. Accuracy."""

CHUNK = 2048
"""Distances whose primitives are evaluated at once. Speed."""

Function = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True)
class Strip:
    """Kernel of a strip of load along y, at ``X >= 0`` and ``Y > 0``, and what its integrals need.

    Attributes
    ----------
    kernel : callable
        ``k(X, Y)``, up to terms that do not depend on Y.
    curvature : callable
        ``d2k / dX2``.
    slope : callable
        ``dk / dX``.
    primitive : callable
        Primitive of k in X.
    double_primitive : callable
        Double primitive of k in X, up to terms that cancel in the differences.
    """

    kernel: Function
    curvature: Function
    slope: Function
    primitive: Function
    double_primitive: Function


def _squared(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(x * x + y * y)


def _log(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(0.5 * np.log(np.maximum(_squared(x, y), TINY)))


STRIPS = {
    Load.NORMAL: Strip(
        kernel=lambda x, y: np.arcsinh(y / x),
        curvature=lambda x, y: y * (2 * x * x + y * y) / (x * x * _squared(x, y) * np.hypot(x, y)),
        slope=lambda x, y: -y / (x * np.hypot(x, y)),
        primitive=lambda x, y: x * np.arcsinh(y / x) + y * np.arcsinh(x / y),
        double_primitive=lambda x, y: (
            0.5 * x * x * np.arcsinh(y / np.maximum(x, TINY))
            + x * y * np.arcsinh(x / y)
            - 0.5 * y * x * x / (np.hypot(x, y) + y)
        ),
    ),
    Load.ALONG_Y: Strip(
        kernel=_log,
        curvature=lambda x, y: (y * y - x * x) / _squared(x, y) ** 2,
        slope=lambda x, y: x / _squared(x, y),
        primitive=lambda x, y: x * _log(x, y) + y * np.arctan2(x, y),
        double_primitive=lambda x, y: (
            0.5 * x * x * _log(x, y) + x * y * np.arctan2(x, y) - 0.25 * y * y * np.log1p((x / y) ** 2)
        ),
    ),
}
"""Normal displacement of the top from a strip, without the factors of `columns_kernel`."""


@dataclass(frozen=True)
class Lateral:
    """Cells along y: from values half a cell beside them to the transform on twice as many cells.

    Attributes
    ----------
    dy : float
        Cell size along y, metres.
    cells : int
        Number of cells.
    load : Load
        Direction of the load; kernels odd in y are transformed without their factor i.
    """

    dy: float
    cells: int
    load: Load

    @property
    def edges(self) -> FloatArray:
        """Offsets half a cell beyond 0, 1, 2, ... cells, metres."""
        return np.asarray((np.arange(self.cells + 1) + 0.5) * self.dy)

    @property
    def matrix(self) -> FloatArray:
        """Matrix (edge, wavenumber) that takes the difference over each cell and its transform."""
        numbers = np.arange(self.cells + 1)
        phase = np.pi * np.outer(numbers, numbers) / self.cells
        difference = np.eye(self.cells + 1) - np.eye(self.cells + 1, k=-1)
        if self.load.sign_y > 0:  # F is odd in Y: over the first cell it differs by twice its value
            difference[0, 0] = 2.0
            ends = np.full(self.cells + 1, 2.0)
            ends[[0, -1]] = 1.0
            return np.asarray(difference.T @ (ends[:, None] * np.cos(phase)))
        difference[0, 0] = 0.0
        twice = np.full(self.cells + 1, -2.0)
        twice[[0, -1]] = 0.0
        return np.asarray(difference.T @ (twice[:, None] * np.sin(phase)))


def columns_kernel(
    load: Load, edges: FloatArray, dy: float, cells_y: int, extent: tuple[float, float], reference: float
) -> FloatArray:
    """Averaged displacement of columns per force on columns, with all mirror images in the ends of `extent`.

    Parameters
    ----------
    load : Load
        Direction of the load, normal or along y.
    edges : array (cell + 1)
        Edges of the columns, metres.
    dy, cells_y : float, int
        Cell size along y and number of cells.
    extent : tuple of float
        Where the mirrors stand, metres; infinite for none.
    reference : float
        With two mirrors: distance along y at which the displacement under a pressure is zero, metres.

    Returns
    -------
    array (wavenumber, cell, cell)
        Times ``2 pi G / (1 - nu)`` for pressure and ``4 pi G / (1 - 2 nu)`` for traction, without its factor i.
    """
    lateral = Lateral(dy, cells_y, load)
    strip, matrix = STRIPS[load], lateral.matrix
    low, high = extent
    centres = 0.5 * (edges[1:] + edges[:-1])
    kernel = _between(strip, np.abs(np.subtract.outer(edges, edges)), edges, lateral, matrix, mirrored=False)
    if np.isfinite(low):
        kernel += _between(strip, np.add.outer(edges - low, edges - low), edges, lateral, matrix, mirrored=True)
    if np.isfinite(high):
        kernel += _between(strip, np.add.outer(high - edges, high - edges), edges, lateral, matrix, mirrored=True)
    if np.isfinite(low) and np.isfinite(high):
        far, means = _far_images(strip, load, edges - low, high - low, lateral, matrix, reference)
        kernel += means.T @ far @ means
    assert kernel.shape == (cells_y + 1, centres.size, centres.size)
    return kernel


def _between(
    strip: Strip, distances: FloatArray, edges: FloatArray, lateral: Lateral, matrix: FloatArray, *, mirrored: bool
) -> FloatArray:
    """Averaged influence between columns with edges at `distances` (edge, edge): array (wavenumber, cell, cell)."""
    count, widths = edges.size, np.diff(edges)
    i, j = np.triu_indices(count)
    table = np.empty((lateral.cells + 1, count, count))
    values = np.empty((lateral.cells + 1, i.size))
    for start in range(0, i.size, CHUNK):
        part = slice(start, start + CHUNK)
        values[:, part] = (strip.double_primitive(distances[i[part], j[part], None], lateral.edges) @ matrix).T
    table[:, i, j] = values
    table[:, j, i] = values
    kernel = table[:, 1:, :-1] + table[:, :-1, 1:]
    kernel -= table[:, 1:, 1:] + table[:, :-1, :-1]
    if mirrored:  # the image runs backwards
        np.negative(kernel, out=kernel)
    kernel /= widths[:, None] * widths[None, :]
    _expand_far(kernel, strip, distances, widths, lateral, matrix)
    return kernel


def _expand_far(
    kernel: FloatArray,
    strip: Strip,
    distances: FloatArray,
    widths: FloatArray,
    lateral: Lateral,
    matrix: FloatArray,
) -> None:
    """Replace the influence of columns far from each other by an expansion about their centres, to fourth order."""
    apart = 0.25 * (distances[1:, 1:] + distances[1:, :-1] + distances[:-1, 1:] + distances[:-1, :-1])
    i, j = np.nonzero(np.triu(apart > FAR_COLUMNS * np.maximum.outer(widths, widths)))
    for start in range(0, i.size, CHUNK):
        a, b = i[start : start + CHUNK], j[start : start + CHUNK]
        x, squares = apart[a, b, None], (widths[a] ** 2 + widths[b] ** 2)[:, None]
        values = strip.kernel(x, lateral.edges) + squares / 24 * strip.curvature(x, lateral.edges)
        kernel[:, a, b] = kernel[:, b, a] = (values @ matrix).T


def _far_images(
    strip: Strip,
    load: Load,
    edges: FloatArray,
    length: float,
    lateral: Lateral,
    matrix: FloatArray,
    reference: float,
) -> tuple[FloatArray, FloatArray]:
    """Influence of all images but the three nearest between points, and the columns' shares in these points.

    The images repeat with the period ``2 length``, once as they stand and once mirrored. Some are evaluated; those
    farther away are replaced by their load spread evenly (the midpoint rule with its first correction, read backwards).
    They vary smoothly over the body, so both columns are seen from Chebyshev points.

    Returns
    -------
    array (wavenumber, point, point), array (point, cell)
    """
    points = 0.5 * length * (chebyshev.chebpts1(IMAGE_POINTS) + 1)
    y, period = lateral.edges, 2 * length
    same = np.subtract.outer(points, points)[..., None]
    mirrored = np.add.outer(points, points)[..., None] - length  # about the middle of the two that are near
    total = np.zeros((points.size, points.size, y.size))
    for number in range(1, NEAR_IMAGES + 1):
        total += strip.kernel(period * number + same, y) + strip.kernel(period * number - same, y)
        if number > 1:
            shift = period * number - length
            total += strip.kernel(shift + mirrored, y) + strip.kernel(shift - mirrored, y)
    spread_from, top = (2 * NEAR_IMAGES + 1) * length, np.array(FAR_LIMIT * length)
    for offset, start in ((same, spread_from), (mirrored, spread_from - length)):
        for side in (1.0, -1.0):
            first = start + side * offset
            total += (strip.primitive(top, y) - strip.primitive(first, y)) / period
            total += period / 24 * strip.slope(first, y)
    if load is Load.NORMAL:
        # The images make a line load along x; its logarithm is set to zero at the reference.
        total -= y * (2 / length) * np.log(2 * FAR_LIMIT * length / reference)
    far = np.ascontiguousarray((total @ matrix).transpose(2, 0, 1))
    from_points = np.linalg.inv(chebyshev.chebvander(chebyshev.chebpts1(IMAGE_POINTS), IMAGE_POINTS - 1))
    scaled = 2 * edges / length - 1
    primitives = np.array([chebyshev.chebval(scaled, chebyshev.chebint(row)) for row in np.eye(IMAGE_POINTS)])
    means = np.diff(primitives, axis=1) / np.diff(scaled)
    return far, np.asarray(from_points.T @ means)
