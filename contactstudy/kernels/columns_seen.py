"""Which columns of cells a point of a field sees, and how finely.

Around a point columns are split, so that their load is smooth there. Columns far away are taken together, and what
they do is smooth over the depth: few depths tell it. None of this depends on the field or on the load's direction, so
all stresses under a pressure and its friction share it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.cache import ArrayKey, kept
from contactstudy.checks import FloatArray, IntArray
from contactstudy.kernels.aligned import OFFSET_TOLERANCE, Aligned, aligned_points
from contactstudy.kernels.column_layers import Jumps, Layer, gathered_far
from contactstudy.kernels.fine_cells import PARTS_Y, FineCells, seen_apart
from contactstudy.kernels.images import few_points
from contactstudy.kernels.smooth_load import Sent

NARROW = 0.15
"""Width of a column, over the least depth, below which it is never split. Accuracy."""

MOST_PARTS = 6
"""Parts of the shortest distance between positions along y that are tried as a step of all, and parts of a cell that
such a step is at least. Speed."""

BATCH = 16
"""Positions along x whose surroundings are made smooth at once. Speed."""

FAR, LEFT_OF_FAR = 3.0, 1e-6
"""Distance along x over the load's width from which on columns are taken together and seen from few depths, and the
part of what they do that this may leave. Accuracy."""

CENTRED = 0.25
"""Width of the fine column in whose middle a point lies, over that of the fine column around it. Accuracy."""

LEAST = 1e-3
"""That width at a step of the load, over the column's. Accuracy: on the top it has infinite stresses."""

SAME_END = 1e-9
"""Part of a column by which a point on an end may miss it. Accuracy."""


@dataclass(frozen=True, eq=False)
class AlongY:
    """Positions along y, and the cells along y that they see: `count` from the `first` of the grid on."""

    grid: Grid
    y: FloatArray
    first: int
    count: int

    @property
    def begin(self) -> float:
        """First edge along y, metres."""
        return float(self.grid.y[self.first]) - 0.5 * self.grid.dy

    @cached_property
    def alike(self) -> list[Aligned]:
        """Positions that lie alike relative to the corners, which are half a cell before the centres."""
        return aligned_points(self.y, self.begin, self.grid.dy)

    def layers(self, z: FloatArray, numbers: IntArray, parts: int | None = None) -> list[Layer]:
        """Layers at some of the depths; each cell in so many parts of a smooth load, or uniform if None."""
        if not numbers.size:
            return []
        dy, begin, count, depths = self.grid.dy, self.begin, self.count, z[numbers]
        step = common_step(self.y, dy) if parts is not None and len(self.alike) > 1 else None
        if step is None:
            return [Layer.of(each, depths, numbers, begin, dy, count, parts or 0) for each in self.alike]
        # One set of cells that has every point in the middle of one.
        number = int(np.ceil(step * max(parts or 0, 1) / dy - OFFSET_TOLERANCE))
        low, every = float(self.y.min()), np.arange(self.y.size)
        places = np.round((self.y - low) / step).astype(np.int64) * number
        return [Layer.centred(every, places, depths, numbers, low - begin, begin, count * dy, step / number)]


class SeenRequest(NamedTuple):
    """What decides which columns points see.

    Attributes
    ----------
    cells : ArrayKey
        Load on the cells of `grid`.
    grid : Grid
        Cells.
    extent : tuple of float
        Where the mirrors stand, metres; infinite for none.
    image : int
        Sign of the load's mirror image.
    axes : tuple of ArrayKey
        Positions along x, y and z.
    added : bool
        Whether to see what splitting columns adds to them instead.
    """

    cells: ArrayKey
    grid: Grid
    extent: tuple[float, float]
    image: int
    axes: tuple[ArrayKey, ArrayKey, ArrayKey]
    added: bool


class ColumnsSeen(NamedTuple):
    """What the points see.

    Attributes
    ----------
    layers, beyond : list of Layer
        Points at their own depths, and at the few from which what columns far away do is interpolated.
    to_z : array (z, depth), or None
        This interpolation; None if the depths are the points' own.
    jumps : list of tuple
        For each position along x the jumps of the columns around it as `layers` see them, and for either side those of
        the columns far away as the layers `beyond` see them.
    first, load : int, array (cell_x, cell_y)
        First column along y of the load that is seen, and this load.
    """

    layers: list[Layer]
    beyond: list[Layer]
    to_z: FloatArray | None
    jumps: list[tuple[list[Jumps], list[list[Jumps]]]]
    first: int
    load: FloatArray

    @property
    def depths(self) -> int:
        """Number of the few depths."""
        return self.beyond[0].numbers.size if self.beyond else 0

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        each = (jumps for near, sides in self.jumps for part in (near, *sides) for jumps in part)
        return self.load.nbytes + sum(jumps.nbytes for jumps in each)


@kept("columns seen", lambda seen: seen.nbytes)
def columns_seen(request: SeenRequest) -> ColumnsSeen:
    """Which columns some points see."""
    cells, grid, extent, image, axes, added = request
    x, y, z = (axis.values for axis in axes)
    fine = FineCells(cells.values, grid, extent, image)
    lateral = AlongY(grid, y, fine.first, fine.cells.shape[1])
    near = fine.near(z)
    layers = lateral.layers(z, np.flatnonzero(~near), 0) + lateral.layers(z, np.flatnonzero(near), PARTS_Y)
    reach = FAR * fine.cells.shape[1] * grid.dy
    depths, to_z = few_points(z, reach, LEFT_OF_FAR)
    beyond = [] if added else lateral.layers(depths, np.arange(depths.size), 0)
    jumps = list(_jumps(x, layers, beyond, fine, NARROW * float(z.min()), reach, extent))
    return ColumnsSeen(layers, beyond, to_z, jumps, fine.first, fine.cells)


def _jumps(
    x: FloatArray,
    layers: list[Layer],
    beyond: list[Layer],
    fine: FineCells,
    narrow: float,
    reach: float,
    extent: tuple[float, float],
) -> Iterator[tuple[list[Jumps], list[list[Jumps]]]]:
    """For each position the jumps of the columns around it, split unless they are narrow, and of those on either side.

    The latter are farther away than the `reach`, for the layers `beyond`. Without any, the jumps are of what splitting
    the columns adds to them.
    """
    edges = fine.edges
    smooth = fine.along_y(fine.gathered)
    base, far = ([layer.loads(smooth) for layer in each] for each in (layers, beyond))
    for start in range(0, x.size, BATCH):
        positions = x[start : start + BATCH].tolist()
        around = [_surroundings(position, fine, narrow, extent) for position in positions]
        columns = fine.columns([each.inserted for each in around])
        columns += np.concatenate([each.received(fine) for each in around])
        smooth = fine.along_y(columns)
        inserted = [layer.loads(smooth) for layer in layers]
        stop = 0
        for position, each in zip(positions, around, strict=True):
            first, stop = stop, stop + each.inserted.size - 1
            own = [loads[first:stop] for loads in inserted]
            if not beyond:
                yield [each.added(edges, *given) for given in zip(base, layers, own, strict=True)], []
                continue
            low, high = each.within(edges, position, reach)
            sides = [(edges[: low + 1], slice(0, low)), (edges[high:], slice(high, None))]
            yield (
                [each.exchanged(edges, low, high, *given) for given in zip(base, layers, own, strict=True)],
                [
                    [
                        Jumps.of(*gathered_far(away, loads[there], position), layer)
                        for loads, layer in zip(far, beyond, strict=True)
                    ]
                    for away, there in sides
                    if away.size > 1
                ],
            )


class _Surroundings(NamedTuple):
    """Columns around a point that are split, and one more on either side that their moments are not sent to.

    Attributes
    ----------
    inserted : array
        Edges of the columns that replace others; one if none are replaced.
    lowest, highest : int
        Which of the columns these are.
    """

    inserted: FloatArray
    lowest: int
    highest: int

    def within(self, edges: FloatArray, x: float, reach: float) -> tuple[int, int]:
        """First of the columns within `reach` of `x`, or the nearest one, or replaced, and the one behind the last."""
        distances = np.maximum(edges[:-1] - x, x - edges[1:])
        near = np.flatnonzero(distances <= max(reach, float(distances.min())))
        return min(int(near[0]), self.lowest), max(int(near[-1]) + 1, self.highest)

    def received(self, fine: FineCells) -> FloatArray:
        """Return what the inserted columns receive from those that stay, for their moments: array (column, y)."""
        if self.lowest == self.highest:
            return np.zeros((0, fine.cells.shape[1]))
        sent, last = fine.sent, self.highest - 1
        stay = np.ones(fine.edges.size - 1, bool)
        stay[self.lowest + 1 : last] = fine.stays[self.lowest + 1 : last]
        total = Sent(*(np.where(stay, each, 0.0) for each in sent)).total.T
        middles = 0.5 * (self.inserted[1:] + self.inserted[:-1])
        return total[np.searchsorted(fine.edges, middles) - 1]

    def exchanged(
        self, edges: FloatArray, low: int, high: int, loads: FloatArray, layer: Layer, inserted: FloatArray
    ) -> Jumps:
        """Jumps of the columns from `low` on before `high`, the inserted ones in their place."""
        return Jumps.of(
            np.concatenate([edges[low : self.lowest], self.inserted, edges[self.highest + 1 : high + 1]]),
            np.concatenate([loads[low : self.lowest], inserted, loads[self.highest : high]]),
            layer,
        )

    def added(self, edges: FloatArray, loads: FloatArray, layer: Layer, inserted: FloatArray) -> Jumps:
        """Jumps of what the inserted columns add to those that they replace."""
        if self.lowest == self.highest:
            return Jumps.of(edges, np.zeros(loads.shape), layer)
        new, old = self.inserted, edges[self.lowest : self.highest + 1]
        both = np.unique(np.concatenate([new, old]))
        middles = 0.5 * (both[1:] + both[:-1])
        difference = inserted[np.searchsorted(new, middles) - 1]
        difference -= loads[self.lowest : self.highest][np.searchsorted(old, middles) - 1]
        return Jumps.of(both, difference, layer)


def _surroundings(x: float, fine: FineCells, narrow: float, extent: tuple[float, float]) -> _Surroundings:
    """Columns around a point that are split, the point in the middle of one; none if all are narrow."""
    edges, count = fine.edges, fine.edges.size - 1
    column = int(np.clip(np.searchsorted(edges, x, side="right") - 1, 0, count - 1))
    on_end = min(abs(x - end) for end in extent) < SAME_END * (edges[column + 1] - edges[column])
    lowest, highest = seen_apart(edges, x, narrow)
    if lowest == highest:
        return _Surroundings(edges[lowest : lowest + 1], lowest, lowest)
    low, high = edges[lowest], edges[highest]
    inserted = fine.x_edges[(fine.x_edges >= low) & (fine.x_edges <= high)]
    if not on_end and low < x < high:
        # On an edge the narrower of both columns decides, so that the mirrored load is treated alike.
        beside = np.searchsorted(inserted, [x - SAME_END * (high - low), x + SAME_END * (high - low)]) - 1
        # A point a rounding before the outermost edge has its columns on this side.
        width = float(np.diff(inserted)[np.clip(beside, 0, inserted.size - 2)].min())
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
