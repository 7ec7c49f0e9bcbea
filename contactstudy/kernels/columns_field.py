"""A field of the half-space under columns of cells of any width: a sum over the corners of the loaded cells.

The influence of a cell is the mixed difference of a corner function over its corners. Summed over cells it becomes a
sum over corners, each weighted with the mixed jump of the load there.
"""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.cache import ArrayKey
from contactstudy.checks import FloatArray
from contactstudy.kernels.column_layers import Jumps, Layer
from contactstudy.kernels.columns_seen import AlongY, SeenRequest, columns_seen
from contactstudy.kernels.far_images import far_images
from contactstudy.kernels.fine_cells import mirrored, with_images
from contactstudy.kernels.influence import Influence


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
    first, load = int(loaded[0]), load[:, loaded[0] : loaded[-1] + 1]
    layers = AlongY(grid, y, first, load.shape[1]).layers(z, np.arange(z.size))
    edges, cells = mirrored(grid.x_edges, extent), with_images(load, influence.load.sign_x, extent)
    jumps = [Jumps.of(edges, cells, layer) for layer in layers]
    for i, position in enumerate(x.tolist()):
        _add(field[:, i], influence, layers, jumps, position)
    if np.isfinite(extent).all():
        field += far_images(load, influence, grid, first, x, y, z, extent)
    return field


def smooth_columns_field(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
    added: bool = False,
) -> FloatArray:
    """Likewise of a load that is smooth where it lies near to a point.

    `added` asks for what that adds to a load that is smooth along y only.
    """
    axes = (ArrayKey(x), ArrayKey(y), ArrayKey(z))
    seen = columns_seen(SeenRequest(ArrayKey(load), grid, extent, influence.load.sign_x, axes, added))
    field = np.zeros((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    from_beyond = np.zeros((influence.components, x.size, y.size, seen.depths))
    for i, (position, (near, sides)) in enumerate(zip(x.tolist(), seen.jumps, strict=True)):
        _add(field[:, i], influence, seen.layers, near, position)
        for side in sides:
            _add(from_beyond[:, i], influence, seen.beyond, side, position)
    if not added:
        field += from_beyond if seen.to_z is None else from_beyond @ seen.to_z.T
        if np.isfinite(extent).all():
            field += far_images(seen.load, influence, grid, seen.first, x, y, z, extent)
    return field


def _add(field: FloatArray, influence: Influence, layers: list[Layer], jumps: list[Jumps], x: float) -> None:
    """Add to a field (component, y, depth) at one position what each layer sees."""
    for layer, own in zip(layers, jumps, strict=True):
        seen = own.field(influence, layer.corners, x, layer.at)
        field[:, layer.points[:, None], layer.numbers] += seen.swapaxes(1, 2)
