"""A field of the half-space under columns of cells of any width: a sum over the corners of the loaded cells.

The influence of a cell is the mixed difference of a corner function over its corners. Summed over cells it becomes a
sum over corners, each weighted with the mixed jump of the load there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray, IntArray
from contactstudy.kernels.aligned import OFFSET_TOLERANCE, Aligned, aligned_points
from contactstudy.kernels.images import image_kernel
from contactstudy.kernels.influence import Influence

IMAGE_POINTS = 16
"""Chebyshev points along x on which the load is gathered for its farther images. Accuracy."""

IMAGE_CELL = 1e-3
"""Width of the cells that stand for these points, over the length. Accuracy."""

IMAGE_DEPTHS, DEEPEST = 6, 0.2
"""Chebyshev depths at which the farther images are summed for more depths than these, and the largest depth over the
length for which these suffice: they are a length away. Accuracy: 1e-7 of the pressure."""

FEW_POINTS = 4
"""Points along y up to which the corners are summed one by one instead of by a convolution. Speed."""


@dataclass(frozen=True, eq=False)
class _Columns:
    """Columns of a load, with the image beside it in each end that mirrors it."""

    edges: FloatArray
    cells: FloatArray

    def jumps(self) -> tuple[FloatArray, FloatArray]:
        """Edges at which the load jumps, and its mixed jumps there: array (edge, edge along y)."""
        jumps = np.diff(np.diff(np.pad(self.cells, 1), axis=0), axis=1)
        loaded = jumps.any(axis=1)
        return self.edges[loaded], jumps[loaded]


def columns_field(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
) -> FloatArray:
    """Field in the half-space under a load and all its mirror images, as `half_space_field` on uniform cells."""
    field = np.zeros((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    loaded = np.flatnonzero(load.any(axis=0))
    if not loaded.size:
        return field
    first, last = int(loaded[0]), int(loaded[-1]) + 1
    load = load[:, first:last]
    edges, jumps = _with_images(grid.x_edges, load, influence.load.sign_x, extent).jumps()
    # Corners along y lie half a cell before the first loaded centre, and so on.
    for column in aligned_points(y, float(grid.y[first]) - 0.5 * grid.dy, grid.dy):
        lowest = int(column.cells.min()) - load.shape[1]
        offsets = column.offset + grid.dy * np.arange(lowest, int(column.cells.max()) + 1)
        for number, depth in enumerate(z.tolist()):
            field[:, :, column.points, number] = _layer(influence, x[:, None] - edges, offsets, depth, jumps, column)
    if np.isfinite(extent).all():
        field += _far_images(load, influence, grid, first, x, y, z, extent)
    return field


def _with_images(edges: FloatArray, cells: FloatArray, image: int, extent: tuple[float, float]) -> _Columns:
    """Columns of a load between its nearest images; each end of the body is a border between columns."""
    low, high = extent
    all_edges, all_cells = [edges], [cells]
    if np.isfinite(low):
        all_edges.insert(0, (2 * low - edges[::-1])[:-1])
        all_cells.insert(0, image * cells[::-1])
    if np.isfinite(high):
        all_edges.append((2 * high - edges[::-1])[1:])
        all_cells.append(image * cells[::-1])
    return _Columns(np.concatenate(all_edges), np.concatenate(all_cells))


def _layer(
    influence: Influence, x: FloatArray, offsets: FloatArray, depth: float, jumps: FloatArray, column: Aligned
) -> FloatArray:
    """Field (component, x, point) at one depth; `x` are offsets (x, edge), `offsets` those along y, uniform."""
    corner = _EvenCorner(influence, offsets, depth)
    count = jumps.shape[1]
    at = column.cells - int(column.cells.min())
    layer = np.empty((influence.components, x.shape[0], column.points.size))
    backwards = jumps[:, ::-1]
    few = at.size <= FEW_POINTS
    size = fft.next_fast_len(offsets.size, real=True)
    spectrum = None if few else fft.rfft(backwards, size, axis=1).conj()
    for i, along in enumerate(x):
        values = corner(along)
        if spectrum is None:
            for number, place in enumerate(at.tolist()):
                layer[:, i, number] = np.einsum("cef,ef->c", values[:, :, place : place + count], backwards)
        else:
            summed = np.einsum("cek,ek->ck", fft.rfft(values, size, axis=2), spectrum)
            layer[:, i] = fft.irfft(summed, size, axis=1)[:, at]
    return layer


class _EvenCorner:
    """Corner functions at uniform offsets along y, evaluated on one side of 0 if the other is its image."""

    def __init__(self, influence: Influence, offsets: FloatArray, depth: float) -> None:
        self._corner = influence.corner_at(depth)
        self._at = offsets
        self._index: IntArray | None = None
        self._signs: FloatArray = np.ones(1)
        if offsets.size > 1:
            step = offsets[1] - offsets[0]
            twice = np.round(2 * offsets / step).astype(np.int64)
            if np.abs(2 * offsets / step - twice).max() < OFFSET_TOLERANCE:
                distances, self._index = np.unique(np.abs(twice), return_inverse=True)
                self._at = 0.5 * step * distances
                # A primitive is even where its kernel is odd, and odd where it is even.
                odd = np.array(influence.sign_along_y)[:, None] > 0
                self._signs = np.where(odd & (twice < 0), -1.0, 1.0)[:, None, :]

    def __call__(self, x: FloatArray) -> FloatArray:
        """Values (component, edge, offset) at the distances `x` of the edges."""
        values = self._corner(x[:, None], self._at)
        if self._index is None:
            return values
        return np.asarray(values[:, :, self._index] * self._signs)


def _far_images(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    first: int,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    extent: tuple[float, float],
) -> FloatArray:
    """Field of all images but the nearest: they vary smoothly over the body, so few points along x tell it."""
    low, length = extent[0], extent[1] - extent[0]
    nodes = chebyshev.chebpts1(IMAGE_POINTS)
    coefficients = np.linalg.inv(chebyshev.chebvander(nodes, IMAGE_POINTS - 1))
    to_x = chebyshev.chebvander(2 * (x - low) / length - 1, IMAGE_POINTS - 1) @ coefficients
    edges = 2 * (grid.x_edges - low) / length - 1
    primitives = np.array([chebyshev.chebval(edges, chebyshev.chebint(row)) for row in np.eye(IMAGE_POINTS)])
    width = IMAGE_CELL * length
    gathered = 0.5 * length / width * (coefficients.T @ np.diff(primitives, axis=1)) @ load
    points = 0.5 * length * (nodes + 1)
    patterns = (
        (np.subtract.outer(points, points), 2 * length, 1),
        (np.add.outer(points, points) - length, 3 * length, influence.load.sign_x),
    )
    level = width * grid.dy * np.array(influence.image_level)[:, None, None]
    depths, to_z = _few_depths(z, length)
    field = np.zeros((influence.components, x.size, y.size, depths.size))
    for column in aligned_points(y, float(grid.y[first]), grid.dy):
        lowest = int(column.cells.min()) - load.shape[1] + 1
        offsets = column.offset + grid.dy * np.arange(lowest, int(column.cells.max()) + 1)
        size = fft.next_fast_len(offsets.size, real=True)
        at = column.cells - int(column.cells.min())
        spectrum = fft.rfft(gathered[:, ::-1], size, axis=1).conj()
        for number, depth in enumerate(depths.tolist()):
            total = np.zeros((influence.components, points.size, at.size))
            for distances, nearest, sign in patterns:
                kernel = image_kernel(
                    influence.corner_at(depth), distances.ravel(), offsets, width, grid.dy, length, nearest=nearest
                )
                kernel = (kernel + level).reshape(-1, *distances.shape, offsets.size)
                summed = np.einsum("cpgk,gk->cpk", fft.rfft(kernel, size, axis=3), spectrum)
                total += sign * fft.irfft(summed, size, axis=2)[:, :, at]
            field[:, :, column.points, number] = to_x @ total
    return field if to_z is None else field @ to_z.T


def _few_depths(z: FloatArray, length: float) -> tuple[FloatArray, FloatArray | None]:
    """Depths at which images far away are summed, and the matrix (z, depth) that interpolates; none if it is `z`."""
    deepest = float(z.max())
    if z.size <= IMAGE_DEPTHS or deepest > DEEPEST * length:
        return z, None
    nodes = chebyshev.chebpts1(IMAGE_DEPTHS)
    coefficients = np.linalg.inv(chebyshev.chebvander(nodes, IMAGE_DEPTHS - 1))
    return 0.5 * deepest * (nodes + 1), chebyshev.chebvander(2 * z / deepest - 1, IMAGE_DEPTHS - 1) @ coefficients
