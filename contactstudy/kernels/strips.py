"""Displacements of the top under loads on cells: the kernels of strips of load along y, and their integrals.

``k(X, Y)`` is the displacement at a distance X from a strip, differenced over a cell along y, ``P' = k`` the corner
function of a loaded rectangle, and ``F'' = k`` the double primitive in X (Love's rectangle integrated once more); terms
that cancel in the differences are left out. Distances and their sign determine the kernels.

There are two observers: the centre of a uniform cell (eq. (39a)), and the mean over the width of a column, eq. (35) of
docs/explanation/columns.md, symmetric to the last bit for the normal displacement under a pressure; its integrals are
mixed differences of F over the edges of the columns. `Grid.observes_means` selects one. A mirrored column lies at the
sum of the distances from the mirror.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from contactstudy.cache import recall, retain
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.kernels.convolution import even_spectrum, odd_spectrum, spectrum_matrices
from contactstudy.kernels.images import FAR_LIMIT, CornerFunction, FarImages, mirrored_kernel
from contactstudy.kernels.load import TINY, Load, Response

Function = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, kw_only=True)
class Strip:
    """Kernel of a strip of load along y, at ``X >= 0`` and ``Y > 0``, with its integrals."""

    kernel: Function  # ``k(X, Y)``, up to terms that do not depend on Y
    curvature: Function  # ``d2k / dX2``
    primitive: Function  # primitive of k in X
    double_primitive: Function  # double primitive of k in X, up to terms that cancel in the differences
    sign_x: int  # 1 or -1 if the kernel of a point load is even or odd in X and in Y
    sign_y: int
    row_integral: float | None = None
    """For a kernel with a divergent row of images: the integral over X is ``2 ln(2 X / Y) + row_integral``."""


def _squared(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(x * x + y * y)


def _log(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(0.5 * np.log(np.maximum(_squared(x, y), TINY)))


INVERSE = Strip(  # of 1 / R, with R**2 = X**2 + Y**2
    kernel=lambda x, y: np.arcsinh(y / x),  # eq. (36)
    curvature=lambda x, y: y * (2 * x * x + y * y) / (x * x * _squared(x, y) * np.hypot(x, y)),
    primitive=lambda x, y: x * np.arcsinh(y / x) + y * np.arcsinh(x / y),
    double_primitive=lambda x, y: (  # eq. (38)
        0.5 * x * x * np.arcsinh(y / np.maximum(x, TINY))
        + x * y * np.arcsinh(x / y)
        - 0.5 * y * x * x / (np.hypot(x, y) + y)
    ),
    sign_x=1,
    sign_y=1,
    row_integral=0.0,
)

SQUARE_X = Strip(  # of X**2 / R**3
    kernel=lambda x, y: y / np.hypot(x, y),
    curvature=lambda x, y: y * (2 * x * x - y * y) / np.hypot(x, y) ** 5,
    primitive=lambda x, y: y * np.arcsinh(x / y),
    # without its value at X = 0, which cancels
    double_primitive=lambda x, y: x * y * np.arcsinh(x / y) - y * x * x / (np.hypot(x, y) + y),
    sign_x=1,
    sign_y=1,
    row_integral=-2.0,
)

GRADIENT_Y = Strip(  # of Y / R**2
    kernel=_log,  # eq. (36)
    curvature=lambda x, y: (y * y - x * x) / _squared(x, y) ** 2,
    primitive=lambda x, y: x * _log(x, y) + y * np.arctan2(x, y),
    double_primitive=lambda x, y: (  # eq. (39)
        0.5 * x * x * _log(x, y) + x * y * np.arctan2(x, y) - 0.25 * y * y * np.log1p((x / y) ** 2)
    ),
    sign_x=1,
    sign_y=-1,
)

GRADIENT_X = Strip(  # of X / R**2
    kernel=lambda x, y: np.arctan2(y, x),
    curvature=lambda x, y: 2 * x * y / _squared(x, y) ** 2,
    primitive=lambda x, y: x * np.arctan2(y, x) + y * _log(x, y),
    double_primitive=lambda x, y: 0.5 * x * x * np.arctan2(y, x) + x * y * _log(x, y) + 0.5 * y * y * np.arctan2(x, y),
    sign_x=-1,
    sign_y=1,
)

MIXED = Strip(  # of X Y / R**3
    kernel=lambda x, y: -x / np.hypot(x, y),
    curvature=lambda x, y: 3 * x * y * y / np.hypot(x, y) ** 5,
    primitive=lambda x, y: -x * x / (np.hypot(x, y) + y),
    double_primitive=lambda x, y: -0.5 * x * np.hypot(x, y) - 0.5 * y * y * np.arcsinh(x / y),
    sign_x=-1,
    sign_y=-1,
)

P, X, Y = Load.NORMAL, Load.ALONG_X, Load.ALONG_Y


Strips = tuple[tuple[float, Strip], ...]  # strips and their factors in a sum


def strips_of(response: Response, poisson: float) -> Strips:
    """Return strips, with factors, whose sum is ``4 pi G u`` (Cerruti; Johnson, Contact Mechanics, section 3.6)."""
    # With the potentials V, chi, Theta of load.py: u_z[p] = 2 (1 - nu) V, u_x[p] = -(1 - 2 nu) chi_x = -u_z[q_x],
    # u_x[q_x] = 2 V + 2 nu Theta_xx, u_y[q_x] = u_x[q_y] = 2 nu Theta_xy, and with x and y exchanged.
    compressibility = 1 - 2 * poisson
    return {
        Response(P, P): ((2 * (1 - poisson), INVERSE),),
        Response(X, X): ((2 * (1 - poisson), INVERSE), (2 * poisson, SQUARE_X)),
        Response(Y, Y): ((2.0, INVERSE), (-2 * poisson, SQUARE_X)),
        Response(P, X): ((compressibility, GRADIENT_X),),
        Response(P, Y): ((compressibility, GRADIENT_Y),),
        Response(X, P): ((-compressibility, GRADIENT_X),),
        Response(Y, P): ((-compressibility, GRADIENT_Y),),
        Response(X, Y): ((2 * poisson, MIXED),),
        Response(Y, X): ((2 * poisson, MIXED),),
    }[response]


def corner_function(strips: Strips) -> CornerFunction:
    """Corner function of a loaded rectangle: the sum of the strips' primitives, of signed offsets X and Y."""

    def corner(x: FloatArray, y: FloatArray) -> FloatArray:
        distance_x, distance_y = np.maximum(np.abs(x), TINY), np.maximum(np.abs(y), TINY)
        total = np.zeros(np.broadcast_shapes(x.shape, y.shape))
        for factor, strip in strips:
            primitive = factor * strip.primitive(distance_x, distance_y)
            # P is odd in X where k is even, and k is odd in Y where its density is even.
            primitive = primitive * np.sign(x) if strip.sign_x > 0 else primitive
            total += primitive * np.sign(y) if strip.sign_y > 0 else primitive
        return total

    return corner


def row_level(strips: Strips, image_sign: int, length: float, reference: float) -> float:
    """Return the ``4 pi G u`` per load that makes the displacement next to a row of images zero at the reference."""
    if image_sign < 0 or np.isinf(length):
        return 0.0
    logarithm = np.log(2 * FAR_LIMIT * length / reference)
    return float(
        sum(
            -factor * (logarithm + 0.5 * strip.row_integral) / length
            for factor, strip in strips
            if strip.row_integral is not None
        )
    )


def surface_kernel(
    response: Response,
    poisson: float,
    x: FloatArray,
    y: FloatArray,
    cell: tuple[float, float],
    *,
    length: float = np.inf,
    reference: float = np.inf,
) -> FloatArray:
    """Displacement times ``4 pi G`` of the surface from a unit load on one cell, at uniform offsets: array (x, y)."""
    strips = strips_of(response, poisson)
    level = row_level(strips, response.load.sign_x, length, reference)
    return mirrored_kernel(corner_function(strips), x, y, *cell, length=length, level=level)  # eq. (39a)


FAR_COLUMNS = 24.0
"""Distance of two columns, over the wider one, for an expansion about their centres. Accuracy: beyond it the difference
of F loses more digits than the expansion neglects."""

IMAGE_POINTS = 16  # Chebyshev points along x of the interpolated far images, for both columns. Accuracy.
BLOCK_SIZE = 16_384  # distances along x and y per evaluation. Speed: the values fit into the processor's cache.


@dataclass(frozen=True, kw_only=True)
class ColumnsRequest:
    """Edges, cells and mirrors of columns."""

    edges: FloatArray  # (cell + 1): edges of the columns, metres
    dy: float  # cell size along y and number of cells
    cells_y: int
    extent: tuple[float, float]  # positions of the mirrors, metres; infinite for none
    reference: float = np.inf
    """With two mirrors: distance along y at which a displacement that grows with distance is zero, metres."""

    def kernel(self, response: Response, poisson: float) -> FloatArray:
        """Mean displacement, times ``4 pi G``, of columns per force on columns and images: (wavenumber, cell, cell)."""
        return self.influence(strips_of(response, poisson), response.load.sign_x)

    def influence(self, strips: Strips, image_sign: int) -> FloatArray:
        """Influence of strips with factors, and of their images of sign `image_sign`: (wavenumber, cell, cell)."""
        edges, (first_mirror, last_mirror), even = self.edges, self.extent, strips[0][1].sign_y > 0
        y = self.dy * (np.arange(self.cells_y + 1.0) + 0.5)
        # After a split the influences between the other columns are reused, equal to the last bit.
        key = (strips, image_sign, self.dy, self.cells_y, self.extent)
        pair_sums = _PairSums.of(edges, y, recall("column pairs", key))
        for factor, strip in strips:
            pair_sums.add_strip(factor, strip, np.subtract.outer(edges, edges))
            if np.isfinite(first_mirror):
                pair_sums.add_strip(
                    image_sign * factor, strip, np.add.outer(edges - first_mirror, edges - first_mirror), is_image=True
                )
            if np.isfinite(last_mirror):
                mirror_distances = np.add.outer(last_mirror - edges, last_mirror - edges)
                pair_sums.add_strip(image_sign * strip.sign_x * factor, strip, mirror_distances, is_image=True)
        retain("column pairs", key, pair_sums, replace=True)
        kernel = pair_sums.transform(even=even)
        if np.isfinite(first_mirror) and np.isfinite(last_mirror):
            images = FarImages(last_mirror - first_mirror, image_sign, IMAGE_POINTS)
            reference_level = row_level(strips, image_sign, last_mirror - first_mirror, self.reference)
            offsets = self.dy * np.arange(self.cells_y + 1.0)
            far_kernel = images.influence(corner_function(strips), offsets, self.dy, np.array(reference_level))
            spectrum = even_spectrum(far_kernel) if even else odd_spectrum(far_kernel)
            means = images.means(edges - first_mirror)
            # One wavenumber at a time, as the product of all is as large as the kernel. Speed.
            for total, far_spectrum in zip(kernel, np.ascontiguousarray(spectrum.transpose(2, 0, 1)), strict=True):
                total += means.T @ far_spectrum @ means
        return kernel


@dataclass(frozen=True, eq=False)
class _PairSums:
    """Sum of influences between columns, before the transform along y."""

    edges: FloatArray  # edges of the columns, metres
    y: FloatArray  # offsets half a cell beyond 0, 1, 2, ... cells along y, metres
    total: FloatArray  # (cell, cell, offset): the sum, contiguous along y
    is_missing: BoolArray  # (cell, cell): pairs below the diagonal and on it that are to be added

    @classmethod
    def of(cls, edges: FloatArray, y: FloatArray, stored: _PairSums | None) -> _PairSums:
        """Zero influence between columns with these edges, except the stored influence between columns of `stored`."""
        count = edges.size - 1
        total = np.zeros((count, count, y.size))
        is_missing = np.ones((count, count), bool)
        if stored is not None:
            index = np.minimum(np.searchsorted(stored.edges[:-1], edges[:-1]), stored.edges.size - 2)
            common_columns = np.flatnonzero(
                (stored.edges[index] == edges[:-1]) & (stored.edges[index + 1] == edges[1:])
            )
            total[np.ix_(common_columns, common_columns)] = stored.total[
                np.ix_(index[common_columns], index[common_columns])
            ]
            is_missing[np.ix_(common_columns, common_columns)] = False
        return cls(edges, y, total, np.tril(is_missing))

    def add_strip(self, factor: float, strip: Strip, distances: FloatArray, *, is_image: bool = False) -> None:
        """Add `factor` times the influence of columns with edges at signed `distances`; an image lies at their sums."""
        widths, total, y = np.diff(self.edges), self.total, self.y
        separation = 0.25 * (distances[1:, 1:] + distances[1:, :-1] + distances[:-1, 1:] + distances[:-1, :-1])
        is_far = separation > FAR_COLUMNS * np.maximum.outer(widths, widths)
        # Marks edges of columns near each other.
        is_near = np.zeros(distances.shape, bool)
        for corner in product((slice(None, -1), slice(1, None)), repeat=2):
            is_near[corner] |= self.is_missing & ~is_far
        exchange_sign = 1 if is_image else strip.sign_x
        primitives = np.empty((*distances.shape, y.size))
        for rows, columns in _blocks(is_near | is_near.T, y.size):
            influences = strip.double_primitive(distances[rows, columns, None], y)
            primitives[columns, rows] = exchange_sign * influences
            primitives[rows, columns] = influences
        for rows, columns in _blocks(self.is_missing & ~is_far, y.size):
            influences = primitives[rows + 1, columns] + primitives[rows, columns + 1]
            influences -= primitives[rows + 1, columns + 1]
            influences -= primitives[rows, columns]
            # The edges of an image run backwards; eq. (37).
            influences *= ((-factor if is_image else factor) / (widths[rows] * widths[columns]))[:, None]
            _add_to_pairs(total, rows, columns, influences, exchange_sign)
        for rows, columns in _blocks(self.is_missing & is_far, y.size):
            x, width_squares = separation[rows, columns, None], (widths[rows] ** 2 + widths[columns] ** 2)[:, None]
            # Expansion of eq. (35) about the centres, to fourth order.
            influences = factor * (strip.kernel(x, y) + width_squares / 24 * strip.curvature(x, y))
            _add_to_pairs(total, rows, columns, influences, exchange_sign)

    def transform(self, *, even: bool) -> FloatArray:
        """Differences over the cells along y, transformed on twice as many cells: array (wavenumber, cell, cell)."""
        difference = np.eye(self.y.size) - np.eye(self.y.size, k=-1)
        # Where the kernel is even, F is odd in Y: the difference over the first cell is twice its value.
        difference[0, 0] = 2.0 if even else 0.0
        even_matrix, odd_matrix = spectrum_matrices(self.y.size - 1)
        matrix = difference.T @ (even_matrix if even else odd_matrix)
        cell_count = self.edges.size - 1
        pair_rows = self.total.reshape(cell_count**2, -1)
        return np.asarray((matrix.T @ pair_rows.T).reshape(-1, cell_count, cell_count))


def _add_to_pairs(
    total: FloatArray, rows: IntArray, columns: IntArray, influences: FloatArray, exchange_sign: int
) -> None:
    """Add the influences (pair, offset) of pairs of columns, and for exchanged pairs `exchange_sign` times these."""
    total[rows, columns] += influences
    off_diagonal = rows > columns  # the image of a column may be far from the column
    total[columns[off_diagonal], rows[off_diagonal]] += exchange_sign * influences[off_diagonal]


def _blocks(is_selected: BoolArray, offset_count: int) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield blocks of marked pairs below the diagonal and on it."""
    rows, columns = np.nonzero(np.tril(is_selected))
    step = max(1, BLOCK_SIZE // offset_count)
    for start in range(0, rows.size, step):
        yield rows[start : start + step], columns[start : start + step]
