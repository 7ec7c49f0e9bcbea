"""The farther images of a load on columns of any width: they vary smoothly, so few points along x tell them."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import chebyshev

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.images import ROUNDING, few_points, image_kernel
from contactstudy.kernels.influence import Influence

IMAGE_POINTS = 10
"""Chebyshev points along x on which the load is gathered for its farther images. Accuracy: they are a length away, so
each point adds a factor of 6."""

IMAGE_CELL = 1e-3
"""Width of the cells that stand for these points, over the length. Accuracy."""


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
    # The images vary slowly along y and z as well.
    centres = grid.y[first : first + load.shape[1]]
    (at_load, from_load), (at_y, to_y), (depths, to_z) = (few_points(each, length) for each in (centres, y, z))
    if from_load is not None:
        gathered = gathered @ from_load
    offsets, number = np.unique(np.subtract.outer(at_y, at_load).round(_digits(grid.dy)), return_inverse=True)
    number = number.reshape(at_y.size, at_load.size)
    field = np.zeros((influence.components, points.size, at_y.size, depths.size))
    for depth in range(depths.size):
        for distances, nearest, sign in patterns:
            kernel = image_kernel(
                influence.corner_at(float(depths[depth])),
                distances.ravel(),
                offsets,
                width,
                grid.dy,
                length,
                nearest=nearest,
            )
            kernel = (kernel + level).reshape(-1, *distances.shape, offsets.size)
            for row in range(at_y.size):
                field[:, :, row, depth] += sign * np.tensordot(kernel[..., number[row]], gathered, axes=2)
    field = np.tensordot(field, to_x, axes=(1, 1))
    if to_z is not None:
        field = np.tensordot(field, to_z, axes=(2, 1))
        field = field.swapaxes(2, 3)
    if to_y is not None:
        field = np.moveaxis(np.tensordot(field, to_y, axes=(1, 1)), 3, 1)
    return np.asarray(field.transpose(0, 3, 1, 2))


def _digits(size: float) -> int:
    """Decimals to which positions are the same if they agree to a small part of `size`."""
    return int(np.ceil(-np.log10(ROUNDING * size)))
