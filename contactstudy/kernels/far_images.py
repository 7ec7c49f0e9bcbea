"""The farther images of a load on columns of any width: they vary smoothly, so few points along x tell them."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import chebyshev
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.aligned import aligned_points
from contactstudy.kernels.images import image_kernel
from contactstudy.kernels.influence import Influence

IMAGE_POINTS = 10
"""Chebyshev points along x on which the load is gathered for its farther images. Accuracy: they are a length away, so
each point adds a factor of 6."""

IMAGE_CELL = 1e-3
"""Width of the cells that stand for these points, over the length. Accuracy."""

IMAGE_DEPTHS, DEEPEST = 6, 0.2
"""Chebyshev depths at which the farther images are summed for more depths than these, and the largest depth over the
length for which these suffice: they are a length away. Accuracy: 1e-7 of the pressure."""


def far_images(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    first: int,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    extent: tuple[float, float],
) -> FloatArray:
    """Field of all images of a load but the nearest; its first column along y is the `first` of the grid."""
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
