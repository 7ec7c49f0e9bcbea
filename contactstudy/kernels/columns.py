"""Influence between columns of cells of any width: a dense matrix along x for each wavenumber along y.

The displacement is averaged over the observer's width and known at its centre along y (Galerkin's way along x,
collocation along y). With forces ``f = w p`` per length of y (w: width of a column) the averaged displacement is

    u_i = sum_j K_ij f_j,   K_ij = (1 / (w_i w_j)) int_i dx int_j dx' k(x - x', Y),

for the normal displacement under a pressure the same for (i, j) and (j, i) to the last bit. The integrals are mixed
differences over the columns' edges of a double primitive ``F'' = k`` of the kernel ``k`` of a strip of load,
differenced over the cell along y as well (strips.py). A mirrored column is one at the sum of the
distances from the mirror.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial import chebyshev

from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.kernels.images import FAR_LIMIT, NEAR_IMAGES
from contactstudy.kernels.load import Response
from contactstudy.kernels.strips import Strip, strips_of

FAR_COLUMNS = 24.0
"""Widths of the wider column from which on two columns are expanded about their centres. Accuracy: there the difference
of F loses more digits than the expansion leaves out."""

IMAGE_POINTS = 16
"""Chebyshev points along x, for both columns, from which farther images are interpolated. Accuracy."""

TOGETHER = 16_384
"""Distances along x and y that are evaluated at once. Speed: what they make stays in the processor's cache."""


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
        return self.influence(strips_of(response, poisson), response.load.sign_x)

    def influence(self, strips: tuple[tuple[float, Strip], ...], image: int) -> FloatArray:
        """Influence of strips, each with its factor, and of their images, whose sign is `image`: array likewise."""
        edges, (low, high) = self.edges, self.extent
        lateral = Lateral(self.dy, self.cells_y, strips[0][1].sign_y > 0)
        pairs = _Pairs.of(edges, lateral)
        for factor, strip in strips:
            pairs.add(factor, strip, np.subtract.outer(edges, edges))
            if np.isfinite(low):
                pairs.add(image * factor, strip, np.add.outer(edges - low, edges - low), image=True)
            if np.isfinite(high):
                from_high = np.add.outer(high - edges, high - edges)
                pairs.add(image * strip.sign_x * factor, strip, from_high, image=True)
        kernel = pairs.transformed()
        if np.isfinite(low) and np.isfinite(high):
            for factor, strip in strips:
                far, means = _far_images(strip, image, edges - low, high - low, lateral, self.reference)
                for total, own in zip(kernel, far, strict=True):
                    total += factor * (means.T @ own @ means)
        return kernel


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Influence between columns that is summed up, before it is transformed along y.

    Attributes
    ----------
    widths : array
        Widths of the columns, metres.
    lateral : Lateral
        Cells along y.
    total : array (cell, cell, offset)
        The sum. The offsets along y lie side by side in memory.
    table : array (edge, edge, offset)
        Room for double primitives.
    """

    widths: FloatArray
    lateral: Lateral
    total: FloatArray
    table: FloatArray

    @classmethod
    def of(cls, edges: FloatArray, lateral: Lateral) -> _Pairs:
        """Columns with these edges, without any influence yet."""
        count, offsets = edges.size, lateral.edges.size
        total, table = (np.zeros((size, size, offsets)) for size in (count - 1, count))
        return cls(np.diff(edges), lateral, total, table)

    def add(self, factor: float, strip: Strip, distances: FloatArray, *, image: bool = False) -> None:
        """Add `factor` times the averaged influence of columns with edges at `distances` (edge, edge).

        Those of an image are sums of distances, none negative; else they are signed.
        """
        widths, total, table, y = self.widths, self.total, self.table, self.lateral.edges
        apart = 0.25 * (distances[1:, 1:] + distances[1:, :-1] + distances[:-1, 1:] + distances[:-1, :-1])
        far = np.tril(apart > FAR_COLUMNS * np.maximum.outer(widths, widths))
        # Edges of columns that are not all far from each other.
        near = np.zeros(distances.shape, bool)
        for corner in product((slice(None, -1), slice(1, None)), repeat=2):
            near[corner] |= np.tril(~far)
        backwards = 1 if image else strip.sign_x
        for rows, columns in _together(near | near.T, y.size):
            values = strip.double_primitive(distances[rows, columns, None], y)
            table[columns, rows] = backwards * values
            table[rows, columns] = values
        # That of an image runs backwards.
        factors = np.where(far | far.T, 0.0, -factor if image else factor) / (widths[:, None] * widths)
        step = max(1, TOGETHER // (widths.size * y.size))
        for start in range(0, widths.size, step):
            stop = min(start + step, widths.size)
            here, behind = slice(start, stop), slice(start + 1, stop + 1)
            part = table[behind, :-1] + table[here, 1:]
            part -= table[behind, 1:]
            part -= table[here, :-1]
            part *= factors[here, :, None]
            total[here] += part
        for rows, columns in _together(far, y.size):
            x, squares = apart[rows, columns, None], (widths[rows] ** 2 + widths[columns] ** 2)[:, None]
            # Expanded about their centres, to fourth order.
            values = factor * (strip.kernel(x, y) + squares / 24 * strip.curvature(x, y))
            total[rows, columns] += values
            above = rows > columns  # an image may be far from the column itself
            total[columns[above], rows[above]] += backwards * values[above]

    def transformed(self) -> FloatArray:
        """Return the sum over the wavenumber along y: array (wavenumber, cell, cell)."""
        cells = self.widths.size
        flat = self.total.reshape(cells**2, -1)
        return np.asarray((self.lateral.matrix.T @ flat.T).reshape(-1, cells, cells))


def _together(marked: BoolArray, offsets: int) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield marked pairs below the diagonal and on it, as many at once as are evaluated together."""
    rows, columns = np.nonzero(np.tril(marked))
    step = max(1, TOGETHER // offsets)
    for start in range(0, rows.size, step):
        yield rows[start : start + step], columns[start : start + step]


def _far_images(
    strip: Strip,
    image: int,
    edges: FloatArray,
    length: float,
    lateral: Lateral,
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
    far = np.ascontiguousarray((total @ lateral.matrix).transpose(2, 0, 1))
    from_points = np.linalg.inv(chebyshev.chebvander(chebyshev.chebpts1(IMAGE_POINTS), IMAGE_POINTS - 1))
    scaled = 2 * edges / length - 1
    primitives = np.array([chebyshev.chebval(scaled, chebyshev.chebint(row)) for row in np.eye(IMAGE_POINTS)])
    means = np.diff(primitives, axis=1) / np.diff(scaled)
    return far, np.asarray(from_points.T @ means)
