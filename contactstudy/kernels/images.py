"""Influence of one cell on a uniform grid, without or with all mirror images in two ends.

Mirroring a load evenly in both ends repeats it with the period ``2 length`` along x. The fields of the images vary
smoothly over one period: the field of the nearest few images is interpolated from Chebyshev points, and a uniformly
spread load replaces the distant images (midpoint rule with its first correction).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from contactstudy.arrays.grid import Grid, Points
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Corner, Load

CornerFunction = Callable[[FloatArray, FloatArray], FloatArray]

NEAR_IMAGES = 5  # images on either side before the uniformly spread load. Accuracy.
FAR_LIMIT = 1e6  # end of the spread load, to which displacements refer, over the length. Accuracy.
ROUNDING = 1e-9  # rounding of an offset over a cell. Rounding.
CHEBYSHEV_X = 16  # points along x of the interpolated influence of images. Accuracy.
IMAGE_CELL = 1e-3  # width of the cells that represent points, over the length. Accuracy.
INTERPOLATION_ERROR = 1.5e-8  # relative error of the interpolated influence of images. Accuracy.


def cell_kernel(corner: CornerFunction, x: FloatArray, y: FloatArray, dx: float, dy: float) -> FloatArray:
    """Influence of a unit load on one cell at uniform offsets `x` and `y` from its centre: array (..., x, y)."""
    x_edges = snap_offsets(np.append(x - 0.5 * dx, x[-1] + 0.5 * dx), dx)
    y_edges = np.append(y - 0.5 * dy, y[-1] + 0.5 * dy)
    return np.diff(np.diff(corner(x_edges[:, None], y_edges[None, :]), axis=-1), axis=-2)


def snap_offsets(offsets: FloatArray, size: float) -> FloatArray:
    """Set offsets within rounding of 0 to 0, where the logarithm of a step of traction is cut off."""
    return np.where(np.abs(offsets) < ROUNDING * size, 0.0, offsets)


def mirrored_kernel(
    corner: CornerFunction, x: FloatArray, y: FloatArray, dx: float, dy: float, length: float, level: FloatArray | float
) -> FloatArray:
    """`cell_kernel` of a load and all its images at distances ``2 length``, if finite; offsets x up to ``length``."""
    # A quantity that grows with distance contains the constant of a spread load up to ``FAR_LIMIT * length``, and the
    # `level` per area, which moves it to its reference.
    kernel = cell_kernel(corner, x, y, dx, dy)
    if np.isinf(length):
        return kernel
    return kernel + image_kernel(corner, x, y, dx, dy, length=length, nearest=2 * length) + dx * dy * level


def image_kernel(
    corner: CornerFunction, x: FloatArray, y: FloatArray, dx: float, dy: float, length: float, *, nearest: float
) -> FloatArray:
    """Influence of unit loads on the images of a cell from the distance `nearest` on, every ``2 length``."""
    period = 2 * length
    spread_start, spread_stop = nearest + (NEAR_IMAGES - 0.5) * period, FAR_LIMIT * length
    shifts: list[float] = []
    weights: list[float] = []

    def add_spread_load(start: float, stop: float, weight: float) -> None:
        """Add a unit load per length between two distances on either side."""
        shifts.extend((start, stop, -stop, -start))
        weights.extend((-weight, weight, -weight, weight))

    for index in range(NEAR_IMAGES):
        add_spread_load(nearest + period * index - 0.5 * dx, nearest + period * index + 0.5 * dx, 1.0)
    # Two Gauss points represent the width of the cell in its spread load.
    for offset in (-dx / np.sqrt(12), dx / np.sqrt(12)):
        add_spread_load(spread_start + offset, spread_stop, 0.5 * dx / period)
    step = 0.1 * length
    for side_shift in (-step, step):
        slope = period / 24 * np.sign(side_shift) / (2 * step)  # eq. (32e)
        add_spread_load(spread_start + side_shift - 0.5 * dx, spread_start + side_shift + 0.5 * dx, slope)

    nodes_x, interpolation_x = _chebyshev_points(x, length + dx, CHEBYSHEV_X)
    nodes_y, interpolation_y = interpolation_points(y, length)
    positions = np.add.outer(shifts, nodes_x)[..., None]
    shifted_rows = corner(positions, nodes_y + 0.5 * dy) - corner(positions, nodes_y - 0.5 * dy)
    images = np.tensordot(weights, shifted_rows, axes=(0, -3))
    images = interpolation_x @ images
    return np.asarray(images if interpolation_y is None else images @ interpolation_y.T)


@dataclass(frozen=True)
class FarImages:
    """Images of a load except the nearest, of period ``2 length``, at few Chebyshev points along x."""

    length: float  # distance between the ends, metres
    image_sign: int  # sign of the load's mirror image
    count: int  # number of points. Accuracy: each point reduces the error by a factor of 6.

    @cached_property
    def _nodes(self) -> FloatArray:
        return np.asarray(chebyshev.chebpts1(self.count))

    @cached_property
    def _coefficients(self) -> FloatArray:
        return np.asarray(np.linalg.inv(chebyshev.chebvander(self._nodes, self.count - 1)))

    def interpolation(self, x: FloatArray) -> FloatArray:
        """Matrix (position, point) that interpolates to distances from the first end."""
        return np.asarray(chebyshev.chebvander(2 * x / self.length - 1, self.count - 1) @ self._coefficients)

    def means(self, edges: FloatArray) -> FloatArray:
        """Matrix (point, cell) of means over the cells between `edges`, distances from the first end."""
        scaled_edges = 2 * edges / self.length - 1
        primitives = np.array([chebyshev.chebval(scaled_edges, chebyshev.chebint(row)) for row in np.eye(self.count)])
        return np.asarray(self._coefficients.T @ (np.diff(primitives, axis=1) / np.diff(scaled_edges)))

    def influence(self, corner: CornerFunction, y: FloatArray, dy: float, level: FloatArray) -> FloatArray:
        """Influence (..., point, point, y) of a unit force per length of y, over `dy`; a row of images adds `level`."""
        points, width = 0.5 * self.length * (self._nodes + 1), IMAGE_CELL * self.length
        image_rows = (
            (np.subtract.outer(points, points), 2 * self.length, 1),
            (np.add.outer(points, points) - self.length, 3 * self.length, self.image_sign),
        )
        total = np.zeros(())
        for distances, nearest, sign in image_rows:
            kernel = image_kernel(corner, distances.ravel(), y, width, dy, length=self.length, nearest=nearest) / width
            kernel = kernel + dy * level[..., None, None]
            total = total + sign * kernel.reshape(*kernel.shape[:-2], *distances.shape, y.size)
        return total


def polynomial_count(half_range: float, distance: float, error: float = INTERPOLATION_ERROR) -> int:
    """Return the number of points of a polynomial on a range ``2 half_range`` for loads at least `distance` away."""
    # Each point divides the error by ``exp(asinh(distance / half_range))``.
    return int(np.ceil(-np.log(error) / np.arcsinh(distance / half_range))) + 1


def interpolation_points(
    positions: FloatArray, distance: float, error: float = INTERPOLATION_ERROR
) -> tuple[FloatArray, FloatArray | None]:
    """Points that interpolate a field of distant loads, and the matrix (value, point); None if points are positions."""
    lowest, highest = float(positions.min()), float(positions.max())
    half_range = 0.5 * (highest - lowest)
    if not half_range:
        return positions[:1], np.ones((positions.size, 1)) if positions.size > 1 else None
    count = polynomial_count(half_range, distance, error)
    if count >= positions.size:
        return positions, None
    points, matrix = _chebyshev_points(positions - 0.5 * (lowest + highest), half_range, count)
    return points + 0.5 * (lowest + highest), matrix


def _chebyshev_points(positions: FloatArray, half_range: float, count: int) -> tuple[FloatArray, FloatArray]:
    """Chebyshev points from ``-half_range`` to ``half_range``, and the interpolation matrix to `positions`."""
    points = chebyshev.chebpts1(count)
    matrix = np.linalg.solve(
        chebyshev.chebvander(points, count - 1).T, chebyshev.chebvander(positions / half_range, count - 1).T
    )
    return half_range * points, np.asarray(matrix.T, dtype=np.float64)


@dataclass(frozen=True, kw_only=True)
class Influence:
    """Components of a field around a unit load on one cell; compared by value, as part of a cached request."""

    corner: Corner
    """Corner functions (component, ...) of broadcastable offsets ``X, Y`` and depths, and Poisson's ratio."""
    poisson: float
    load: Load
    parities: tuple[tuple[int, ...], tuple[int, ...]]
    """Along x and along y per component: 1 or -1 if it is even or odd in the offset under a pressure."""
    image_level: tuple[float, ...]
    """Per component, the constant that the images of a unit load per area add to the kernel (`mirrored_kernel`): the
    reference of a quantity that grows with distance."""

    @property
    def sign_along_x(self) -> tuple[int, ...]:
        """Per component, 1 or -1 if it is even or odd in the offset along x."""
        return tuple(self.load.sign_x * sign for sign in self.parities[0])

    @property
    def sign_along_y(self) -> tuple[int, ...]:
        """Per component, 1 or -1 if it is even or odd in the offset along y."""
        return tuple(self.load.sign_y * sign for sign in self.parities[1])

    @property
    def components(self) -> int:
        """Number of components."""
        return len(self.image_level)

    def corner_at(self, depth: FloatArray | float) -> CornerFunction:
        """Corner functions at one depth or several, as an array (depth, 1, ...)."""
        return lambda x, y: self.corner(x, y, depth, self.poisson)

    def kernel(self, x: FloatArray, y: FloatArray, dx: float, dy: float, length: float, depth: float) -> FloatArray:
        """Influence at uniform offsets `x` and `y`, with all images where `length` is finite: (component, x, y)."""
        level = np.array(self.image_level)[:, None, None]
        return mirrored_kernel(self.corner_at(depth), x, y, dx, dy, length=length, level=level)


LOAD_POINTS = 10
"""Chebyshev points along x of a load in the far images. Accuracy: each point reduces the error by a factor of 6."""


def far_images(
    load: FloatArray, influence: Influence, grid: Grid, first_row: int, points: Points, extent: tuple[float, float]
) -> FloatArray:
    """Field of all images of a load except the nearest; `first_row` is the load's first row in the grid."""
    first_end, length = extent[0], extent[1] - extent[0]
    images = FarImages(length, influence.load.sign_x, LOAD_POINTS)
    point_loads = (images.means(grid.x_edges - first_end) * grid.widths) @ load
    rows_before = max(-first_row, 0)
    rows_behind = max(first_row + load.shape[1] - grid.cells_y, 0)
    centres = grid.y_range[0] + grid.dy * (np.arange(-rows_before, grid.cells_y + rows_behind) + 0.5)
    (nodes_load, load_interpolation), (nodes_y, interpolation_y), (depths, interpolation_z) = (
        interpolation_points(axis, length) for axis in (centres, points.y, points.z)
    )
    loaded_rows = slice(rows_before + first_row, rows_before + first_row + load.shape[1])
    if load_interpolation is not None:
        point_loads = point_loads @ load_interpolation[loaded_rows]
    else:
        point_loads = np.pad(point_loads, ((0, 0), (loaded_rows.start, centres.size - loaded_rows.stop)))
    digits = int(np.ceil(-np.log10(ROUNDING * grid.dy)))
    offsets, offset_indices = np.unique(np.subtract.outer(nodes_y, nodes_load).round(digits), return_inverse=True)
    offset_indices = offset_indices.reshape(nodes_y.size, nodes_load.size)
    field = np.zeros((influence.components, LOAD_POINTS, nodes_y.size, depths.size))
    corner, level = influence.corner_at(depths[:, None, None, None]), np.array(influence.image_level)[:, None]
    kernel = images.influence(corner, offsets, grid.dy, level)
    for row in range(nodes_y.size):
        field[:, :, row] = np.tensordot(kernel[..., offset_indices[row]], point_loads, axes=2).swapaxes(1, 2)
    interpolation_x = images.interpolation(points.x - first_end)
    field = np.tensordot(field, interpolation_x, axes=(1, 1))
    if interpolation_z is not None:
        field = np.tensordot(field, interpolation_z, axes=(2, 1))
        field = field.swapaxes(2, 3)
    if interpolation_y is not None:
        field = np.moveaxis(np.tensordot(field, interpolation_y, axes=(1, 1)), 3, 1)
    return np.asarray(field.transpose(0, 3, 1, 2))
