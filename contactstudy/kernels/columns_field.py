"""A field of the half-space under columns of cells of any width: a sum over the corners of the loaded cells.

The influence of a cell is the mixed difference of a corner function over its corners. Summed over cells it becomes a
sum over corners, each weighted with the mixed jump of the load there.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.kernels.aligned import OFFSET_TOLERANCE, aligned_points
from contactstudy.kernels.column_layers import Jumps, Layer
from contactstudy.kernels.far_images import far_images
from contactstudy.kernels.fine_cells import PARTS_Y, FineCells, mirrored, seen_apart, with_images
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.smooth_load import Sent

NARROW = 0.15
"""Width of a column, over the least depth, below which it is never split. Accuracy."""

MOST_PARTS = 6
"""Parts of the shortest distance between positions along y that are tried as a step of all, and parts of a cell that
such a step is at least. Speed."""

BATCH = 64
"""Positions along x whose surroundings are made smooth at once. Speed."""

CENTRED = 0.25
"""Width of the fine column in whose middle a point lies, over that of the fine column around it. Accuracy."""

LEAST = 1e-3
"""That width at a step of the load, over the column's. Accuracy: on the top it has infinite stresses."""

SAME_END = 1e-9
"""Part of a column by which a point on an end may miss it. Accuracy."""


def columns_field(
    load: FloatArray,
    influence: Influence,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
    fine: FineCells | None = None,
    added: bool = False,
) -> FloatArray:
    """Field in the half-space under a load and all its mirror images, as `half_space_field` on uniform cells.

    With `fine` the load is smooth where it lies near to a point; `added` asks for what that adds to a load that is
    smooth along y only.
    """
    field = np.zeros((influence.components, x.size, z.size, y.size)).swapaxes(2, 3)
    loaded = np.flatnonzero(load.any(axis=0))
    if not loaded.size:
        return field
    first, load = int(loaded[0]), load[:, loaded[0] : loaded[-1] + 1]
    if fine is not None:
        first, load = fine.first, fine.cells
    # Corners along y lie half a cell before the first loaded centre, and so on.
    begin = float(grid.y[first]) - 0.5 * grid.dy
    near = np.zeros(z.size, bool) if fine is None else fine.near(z)
    for wanted in (False, True):
        numbers = np.flatnonzero(near == wanted)
        if not numbers.size:
            continue
        parts, columns = PARTS_Y if wanted else 0, aligned_points(y, begin, grid.dy)
        step = common_step(y, grid.dy) if len(columns) > 1 and fine is not None else None
        if step is None:
            layers = [
                Layer.of(influence, column, z, numbers, begin, grid.dy, load.shape[1], parts) for column in columns
            ]
        else:
            # One set of cells that has every point in the middle of one.
            number = int(np.ceil(step * max(parts, 1) / grid.dy - OFFSET_TOLERANCE))
            places = np.round((y - y.min()) / step).astype(np.int64) * number
            span = load.shape[1] * grid.dy
            layers = [
                Layer.centred(
                    influence, np.arange(y.size), places, z, numbers, y.min() - begin, begin, span, step / number
                )
            ]
        seen = (
            _seen(x, layers, mirrored(grid.x_edges, extent), with_images(load, influence.load.sign_x, extent))
            if fine is None
            else _smooth(x, layers, fine, NARROW * float(z[numbers].min()), extent, added=added)
        )
        for i, (position, jumps) in enumerate(zip(x.tolist(), seen, strict=True)):
            for layer, own in zip(layers, jumps, strict=True):
                for number, corner in zip(layer.numbers.tolist(), layer.corners, strict=True):
                    field[:, i, layer.points, number] = own.field(corner, position, layer.at)
    if np.isfinite(extent).all() and not added:
        field += far_images(load, influence, grid, first, x, y, z, extent)
    return field


def common_step(y: FloatArray, dy: float) -> float | None:
    """Largest step that all distances between positions are multiples of; none if it is much shorter than a cell.

    Examples
    --------
    >>> round(common_step(np.array([-0.9, 0.0, 0.6]), 0.25), 9), common_step(np.array([0.0, 1.0, np.pi]), 0.25)
    (0.3, None)
    """
    ordered = np.unique(y)
    if ordered.size < 2:
        return None
    distances = np.diff(ordered)
    for parts in range(1, MOST_PARTS + 1):
        step = float(distances.min()) / parts
        if step < dy / MOST_PARTS:
            return None
        if np.abs(distances / step - np.round(distances / step)).max() < OFFSET_TOLERANCE:
            return step
    return None


def _seen(x: FloatArray, layers: list[Layer], edges: FloatArray, cells: FloatArray) -> Iterator[list[Jumps]]:
    """For each position the jumps that each layer sees: the same for all."""
    jumps = [Jumps.of(edges, cells, layer) for layer in layers]
    yield from (jumps for _ in x)


def _smooth(
    x: FloatArray,
    layers: list[Layer],
    fine: FineCells,
    narrow: float,
    extent: tuple[float, float],
    *,
    added: bool,
) -> Iterator[list[Jumps]]:
    """For each position the jumps that each layer sees, the columns around it split unless they are narrow."""
    edges = fine.edges
    smooth = fine.along_y(fine.gathered)
    base = [layer.loads(smooth) for layer in layers]
    alone = [Jumps.of(edges, loads, layer) for loads, layer in zip(base, layers, strict=True)]
    nothing = [Jumps.of(edges, np.zeros(loads.shape), layer) for loads, layer in zip(base, layers, strict=True)]
    for start in range(0, x.size, BATCH):
        around = [_surroundings(position, fine, narrow, extent) for position in x[start : start + BATCH].tolist()]
        exchanged = [each for each in around if each is not None]
        inserted = []
        if exchanged:
            columns = fine.columns([each.inserted for each in exchanged])
            columns += np.concatenate([each.received(fine) for each in exchanged])
            smooth = fine.along_y(columns)
            inserted = [layer.loads(smooth) for layer in layers]
        stop = 0
        for position, each in zip(x[start : start + BATCH].tolist(), around, strict=True):
            if each is None:
                yield nothing if added else alone
                continue
            first, stop = stop, stop + each.inserted.size - 1
            own = [loads[first:stop] for loads in inserted]
            take = each.added if added else each.exchanged
            yield [take(edges, position, *given) for given in zip(base, layers, own, strict=True)]


class _Surroundings(NamedTuple):
    """Columns around a point that are split, and one more on either side that their moments are not sent to.

    Attributes
    ----------
    inserted : array
        Edges of the columns that replace others.
    lowest, highest : int
        Which of the columns these are.
    """

    inserted: FloatArray
    lowest: int
    highest: int

    def received(self, fine: FineCells) -> FloatArray:
        """Return what the inserted columns receive from those that stay, for their moments: array (column, y)."""
        sent, last = fine.sent, self.highest - 1
        stay = np.ones(fine.edges.size - 1, bool)
        stay[self.lowest + 1 : last] = fine.stays[self.lowest + 1 : last]
        total = Sent(*(np.where(stay, each, 0.0) for each in sent)).total.T
        middles = 0.5 * (self.inserted[1:] + self.inserted[:-1])
        return total[np.searchsorted(fine.edges, middles) - 1]

    def exchanged(self, edges: FloatArray, x: float, loads: FloatArray, layer: Layer, inserted: FloatArray) -> Jumps:
        """Jumps of all columns, the inserted ones in their place, as a point at `x` sees them."""
        return Jumps.of(
            np.concatenate([edges[: self.lowest], self.inserted, edges[self.highest + 1 :]]),
            np.concatenate([loads[: self.lowest], inserted, loads[self.highest :]]),
            layer,
            x,
        )

    def added(self, edges: FloatArray, x: float, loads: FloatArray, layer: Layer, inserted: FloatArray) -> Jumps:
        """Jumps of what the inserted columns add to those that they replace."""
        new, old = self.inserted, edges[self.lowest : self.highest + 1]
        both = np.unique(np.concatenate([new, old]))
        middles = 0.5 * (both[1:] + both[:-1])
        difference = inserted[np.searchsorted(new, middles) - 1]
        difference -= loads[self.lowest : self.highest][np.searchsorted(old, middles) - 1]
        return Jumps.of(both, difference, layer, x)


def _surroundings(x: float, fine: FineCells, narrow: float, extent: tuple[float, float]) -> _Surroundings | None:
    """Columns around a point that are split, the point in the middle of one; none if all are narrow."""
    edges, count = fine.edges, fine.edges.size - 1
    column = int(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, count - 1))
    on_end = min(abs(x - end) for end in extent) < SAME_END * (edges[column + 1] - edges[column])
    lowest, highest = seen_apart(edges, x, narrow)
    if lowest == highest:
        return None
    low, high = edges[lowest], edges[highest]
    inserted = fine.x_edges[(fine.x_edges >= low) & (fine.x_edges <= high)]
    if not on_end and low < x < high:
        # On an edge the narrower of both columns decides, so that the mirrored load is treated alike.
        beside = np.searchsorted(inserted, [x - SAME_END * (high - low), x + SAME_END * (high - low)]) - 1
        width = float(np.diff(inserted)[beside].min())
        # No column reaches over a step of the load, which would move its force.
        free = float(np.abs(fine.steps - x).min(initial=np.inf)) / 2
        step = min(CENTRED * width, max(free, LEAST * width))
        own = x + step * np.array([-1.5, -0.5, 0.5, 1.5])
        if low < own[0] and own[-1] < high:
            kept = np.abs(inserted - x) > 1.9 * step
            kept[[0, -1]] = True
            inserted = np.sort(np.concatenate([inserted[kept], own]))
    first, last = max(lowest - 1, 0), min(highest + 1, count)
    whole = np.concatenate([edges[first:lowest], inserted, edges[highest + 1 : last + 1]])
    return _Surroundings(whole, first, last)
