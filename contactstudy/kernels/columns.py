"""Influence between columns of cells of any width: a dense matrix along x for each wavenumber along y.

The displacement is averaged over the observer's width and known at its centre along y (Galerkin's way along x,
collocation along y). With forces ``f = w p`` per length of y (w: width of a column) the averaged displacement is

    u_i = sum_j K_ij f_j,   K_ij = (1 / (w_i w_j)) int_i dx int_j dx' k(x - x', Y),

for the normal displacement under a pressure the same for (i, j) and (j, i) to the last bit. The integrals are mixed
differences over the columns' edges of a double primitive ``F'' = k`` of the kernel ``k`` of a strip of load,
differenced over the cell along y as well. With ``R**2 = X**2 + Y**2`` all nine displacements are made of five kernels:

    of 1 / R:        k = asinh(Y / |X|),  F = X**2 / 2 asinh(Y / |X|) + X Y asinh(X / |Y|) - Y X**2 / (2 R + 2 |Y|)
    of X**2 / R**3:  k = Y / R,           F = X Y asinh(X / |Y|) - Y R
    of Y / R**2:     k = ln R,            F = X**2 / 2 ln R + X Y atan(X / Y) - Y**2 / 4 ln(1 + X**2 / Y**2)
    of X / R**2:     k = atan(Y / X),     F = X**2 / 2 atan(Y / X) + X Y ln R + Y**2 / 2 atan(X / Y)
    of X Y / R**3:   k = -X / R,          F = -X R / 2 - Y**2 / 2 asinh(X / |Y|)

(Love's rectangle integrated once more; terms that cancel in the differences are left out). The first three are even in
X, the last two odd, so distances between edges and their sign are enough. A mirrored column is one at the sum of the
distances from the mirror.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial import chebyshev

from contactstudy.checks import FloatArray
from contactstudy.kernels.images import FAR_LIMIT, NEAR_IMAGES
from contactstudy.kernels.load import Load, Response
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
    sign_x, sign_y : int
        1 or -1 if what the strip is made of is even or odd in X and in Y.
    row : float or None
        For one whose row of images grows without end: its integral over X is ``2 ln(2 X / Y) + row``.
    """

    kernel: Function
    curvature: Function
    slope: Function
    primitive: Function
    double_primitive: Function
    sign_x: int
    sign_y: int
    row: float | None = None


def _squared(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(x * x + y * y)


def _log(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(0.5 * np.log(np.maximum(_squared(x, y), TINY)))


INVERSE = Strip(
    kernel=lambda x, y: np.arcsinh(y / x),
    curvature=lambda x, y: y * (2 * x * x + y * y) / (x * x * _squared(x, y) * np.hypot(x, y)),
    slope=lambda x, y: -y / (x * np.hypot(x, y)),
    primitive=lambda x, y: x * np.arcsinh(y / x) + y * np.arcsinh(x / y),
    double_primitive=lambda x, y: (
        0.5 * x * x * np.arcsinh(y / np.maximum(x, TINY))
        + x * y * np.arcsinh(x / y)
        - 0.5 * y * x * x / (np.hypot(x, y) + y)
    ),
    sign_x=1,
    sign_y=1,
    row=0.0,
)
"""Of 1 / R."""

ACROSS = Strip(
    kernel=lambda x, y: y / np.hypot(x, y),
    curvature=lambda x, y: y * (2 * x * x - y * y) / np.hypot(x, y) ** 5,
    slope=lambda x, y: -x * y / np.hypot(x, y) ** 3,
    primitive=lambda x, y: y * np.arcsinh(x / y),
    # less its value at X = 0, which cancels
    double_primitive=lambda x, y: x * y * np.arcsinh(x / y) - y * x * x / (np.hypot(x, y) + y),
    sign_x=1,
    sign_y=1,
    row=-2.0,
)
"""Of X**2 / R**3."""

AHEAD = Strip(
    kernel=_log,
    curvature=lambda x, y: (y * y - x * x) / _squared(x, y) ** 2,
    slope=lambda x, y: x / _squared(x, y),
    primitive=lambda x, y: x * _log(x, y) + y * np.arctan2(x, y),
    double_primitive=lambda x, y: (
        0.5 * x * x * _log(x, y) + x * y * np.arctan2(x, y) - 0.25 * y * y * np.log1p((x / y) ** 2)
    ),
    sign_x=1,
    sign_y=-1,
)
"""Of Y / R**2."""

BESIDE = Strip(
    kernel=lambda x, y: np.arctan2(y, x),
    curvature=lambda x, y: 2 * x * y / _squared(x, y) ** 2,
    slope=lambda x, y: -y / _squared(x, y),
    primitive=lambda x, y: x * np.arctan2(y, x) + y * _log(x, y),
    double_primitive=lambda x, y: 0.5 * x * x * np.arctan2(y, x) + x * y * _log(x, y) + 0.5 * y * y * np.arctan2(x, y),
    sign_x=-1,
    sign_y=1,
)
"""Of X / R**2."""

DIAGONAL = Strip(
    kernel=lambda x, y: -x / np.hypot(x, y),
    curvature=lambda x, y: 3 * x * y * y / np.hypot(x, y) ** 5,
    slope=lambda x, y: -y * y / np.hypot(x, y) ** 3,
    primitive=lambda x, y: -x * x / (np.hypot(x, y) + y),
    double_primitive=lambda x, y: -0.5 * x * np.hypot(x, y) - 0.5 * y * y * np.arcsinh(x / y),
    sign_x=-1,
    sign_y=-1,
)
"""Of X Y / R**3."""

P, X, Y = Load.NORMAL, Load.ALONG_X, Load.ALONG_Y


def strips_of(response: Response, poisson: float) -> tuple[tuple[float, Strip], ...]:
    """Return strips, with factors, whose sum is ``4 pi G u`` (surface.py)."""
    free = 1 - 2 * poisson
    return {
        Response(P, P): ((2 * (1 - poisson), INVERSE),),
        Response(X, X): ((2 * (1 - poisson), INVERSE), (2 * poisson, ACROSS)),
        Response(Y, Y): ((2.0, INVERSE), (-2 * poisson, ACROSS)),
        Response(P, X): ((free, BESIDE),),
        Response(P, Y): ((free, AHEAD),),
        Response(X, P): ((-free, BESIDE),),
        Response(Y, P): ((-free, AHEAD),),
        Response(X, Y): ((2 * poisson, DIAGONAL),),
        Response(Y, X): ((2 * poisson, DIAGONAL),),
    }[response]


@dataclass(frozen=True)
class Lateral:
    """Cells along y: from values half a cell beside them to the transform on twice as many cells.

    Attributes
    ----------
    dy : float
        Cell size along y, metres.
    cells : int
        Number of cells.
    even : bool
        Whether the kernel is even in y; one that is odd is transformed without its factor i.
    """

    dy: float
    cells: int
    even: bool

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
        if self.even:  # F is odd in Y: over the first cell it differs by twice its value
            difference[0, 0] = 2.0
            ends = np.full(self.cells + 1, 2.0)
            ends[[0, -1]] = 1.0
            return np.asarray(difference.T @ (ends[:, None] * np.cos(phase)))
        difference[0, 0] = 0.0
        twice = np.full(self.cells + 1, -2.0)
        twice[[0, -1]] = 0.0
        return np.asarray(difference.T @ (twice[:, None] * np.sin(phase)))


@dataclass(frozen=True)
class ColumnsRequest:
    """What decides the influence between columns.

    Attributes
    ----------
    edges : array (cell + 1)
        Edges of the columns, metres.
    dy, cells_y : float, int
        Cell size along y and number of cells.
    extent : tuple of float
        Where the mirrors stand, metres; infinite for none.
    reference : float
        With two mirrors: distance along y at which a displacement that grows with distance is zero, metres.
    """

    edges: FloatArray
    dy: float
    cells_y: int
    extent: tuple[float, float]
    reference: float = np.inf

    def kernel(self, response: Response, poisson: float) -> FloatArray:
        """Averaged displacement, times ``4 pi G``, of columns per force on columns: array (wavenumber, cell, cell).

        All mirror images in the ends of `extent` are included; a kernel odd along y lacks its factor i.
        """
        image = response.load.sign_x
        parts = (factor * self.influence(strip, image) for factor, strip in strips_of(response, poisson))
        total = next(parts)
        for part in parts:
            total += part
        return total

    def influence(self, strip: Strip, image: int) -> FloatArray:
        """Influence of one strip with its images, whose sign is `image`: array (wavenumber, cell, cell)."""
        edges, (low, high) = self.edges, self.extent
        lateral = Lateral(self.dy, self.cells_y, strip.sign_y > 0)
        matrix = lateral.matrix
        kernel = _between(strip, np.subtract.outer(edges, edges), edges, lateral, matrix)
        if np.isfinite(low):
            kernel += image * _between(
                strip, np.add.outer(edges - low, edges - low), edges, lateral, matrix, image=True
            )
        if np.isfinite(high):
            from_high = np.add.outer(high - edges, high - edges)
            kernel += image * strip.sign_x * _between(strip, from_high, edges, lateral, matrix, image=True)
        if np.isfinite(low) and np.isfinite(high):
            far, means = _far_images(strip, image, edges - low, high - low, lateral, matrix, self.reference)
            kernel += means.T @ far @ means
        return kernel


def _between(
    strip: Strip,
    distances: FloatArray,
    edges: FloatArray,
    lateral: Lateral,
    matrix: FloatArray,
    *,
    image: bool = False,
) -> FloatArray:
    """Averaged influence between columns with edges at `distances` (edge, edge): array (wavenumber, cell, cell).

    Those of an image are sums of distances, none negative; else they are signed.
    """
    count, widths = edges.size, np.diff(edges)
    apart = 0.25 * (distances[1:, 1:] + distances[1:, :-1] + distances[:-1, 1:] + distances[:-1, :-1])
    far = np.tril(apart > FAR_COLUMNS * np.maximum.outer(widths, widths))
    # Edges of columns that are not all far from each other.
    near = np.zeros((count, count), bool)
    for corner in product((slice(None, -1), slice(1, None)), repeat=2):
        near[corner] |= np.tril(~far)
    i, j = np.nonzero(np.tril(near | near.T))
    backwards = 1 if image else strip.sign_x
    # Wavenumbers last until the end: they lie side by side in memory.
    table = np.zeros((count, count, lateral.cells + 1))
    for start in range(0, i.size, CHUNK):
        rows, columns = i[start : start + CHUNK], j[start : start + CHUNK]
        values = strip.double_primitive(distances[rows, columns, None], lateral.edges) @ matrix
        table[columns, rows] = backwards * values
        table[rows, columns] = values
    kernel = table[1:, :-1] + table[:-1, 1:]
    kernel -= table[1:, 1:]
    kernel -= table[:-1, :-1]
    # That of an image runs backwards.
    kernel *= ((-1 if image else 1) / (widths[:, None] * widths[None, :]))[..., None]
    i, j = np.nonzero(far)
    for start in range(0, i.size, CHUNK):
        rows, columns = i[start : start + CHUNK], j[start : start + CHUNK]
        x, squares = apart[rows, columns, None], (widths[rows] ** 2 + widths[columns] ** 2)[:, None]
        # Expanded about their centres, to fourth order.
        expanded = strip.kernel(x, lateral.edges) + squares / 24 * strip.curvature(x, lateral.edges)
        values = expanded @ matrix
        kernel[rows, columns] = values
        kernel[columns, rows] = backwards * values
    return np.ascontiguousarray(kernel.transpose(2, 0, 1))


def _far_images(
    strip: Strip,
    image: int,
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
    y, period, behind = lateral.edges, 2 * length, strip.sign_x
    same = np.subtract.outer(points, points)[..., None]
    mirrored = np.add.outer(points, points)[..., None] - length  # about the middle of the two that are near
    total = np.zeros((points.size, points.size, y.size))
    for number in range(1, NEAR_IMAGES + 1):
        total += strip.kernel(period * number + same, y) + behind * strip.kernel(period * number - same, y)
        if number > 1:
            shift = period * number - length
            total += image * (strip.kernel(shift + mirrored, y) + behind * strip.kernel(shift - mirrored, y))
    spread_from, top = (2 * NEAR_IMAGES + 1) * length, np.array(FAR_LIMIT * length)
    for offset, start, sign in ((same, spread_from, 1), (mirrored, spread_from - length, image)):
        for side in (1, -1):
            first = start + side * offset
            spread = (strip.primitive(top, y) - strip.primitive(first, y)) / period
            spread += period / 24 * strip.slope(first, y)
            total += sign * (spread if side > 0 else behind * spread)
    if strip.row is not None and image > 0:
        # The images make a line load along x; its logarithm is set to zero at the reference.
        total -= y * (2 / length) * (np.log(2 * FAR_LIMIT * length / reference) + 0.5 * strip.row)
    far = np.ascontiguousarray((total @ matrix).transpose(2, 0, 1))
    from_points = np.linalg.inv(chebyshev.chebvander(chebyshev.chebpts1(IMAGE_POINTS), IMAGE_POINTS - 1))
    scaled = 2 * edges / length - 1
    primitives = np.array([chebyshev.chebval(scaled, chebyshev.chebint(row)) for row in np.eye(IMAGE_POINTS)])
    means = np.diff(primitives, axis=1) / np.diff(scaled)
    return far, np.asarray(from_points.T @ means)
