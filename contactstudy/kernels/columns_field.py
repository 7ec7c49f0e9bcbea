"""A field of the half-space under columns of cells of any width: a sum over the corners of the loaded cells.

The influence of a cell is the mixed difference of a corner function over its corners. Summed over cells it becomes a
sum over corners, each weighted with the mixed jump of the load there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.kernels.aligned import OFFSET_TOLERANCE, Aligned, aligned_points
from contactstudy.kernels.far_images import far_images
from contactstudy.kernels.fine_cells import PARTS_Y, FineCells, mirrored, seen_apart, with_images
from contactstudy.kernels.images import snapped
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.smooth_load import Sent, SmoothLoad

FEW_POINTS = 4
"""Points along y up to which the corners are summed one by one instead of by a convolution. Speed."""

NARROW = 0.15
"""Width of a column, over the least depth, below which it is never split. Accuracy."""

BATCH = 64
"""Positions along x whose surroundings are made smooth at once. Speed."""

CENTRED = 0.25
"""Width of the fine column in whose middle a point lies, over that of the fine column around it. Accuracy."""

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
        layers = [
            _Layer.of(influence, column, z, numbers, begin, grid.dy, load.shape[1], PARTS_Y if wanted else 0)
            for column in aligned_points(y, begin, grid.dy)
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


def _seen(x: FloatArray, layers: list[_Layer], edges: FloatArray, cells: FloatArray) -> Iterator[list[_Jumps]]:
    """For each position the jumps that each layer sees: the same for all."""
    jumps = [_Jumps.of(edges, cells, layer) for layer in layers]
    yield from (jumps for _ in x)


def _smooth(
    x: FloatArray,
    layers: list[_Layer],
    fine: FineCells,
    narrow: float,
    extent: tuple[float, float],
    *,
    added: bool,
) -> Iterator[list[_Jumps]]:
    """For each position the jumps that each layer sees, the columns around it split unless they are narrow."""
    edges = fine.edges
    smooth = fine.along_y(fine.gathered)
    base = [layer.loads(smooth) for layer in layers]
    alone = [_Jumps.of(edges, loads, layer) for loads, layer in zip(base, layers, strict=True)]
    nothing = [_Jumps.of(edges, np.zeros(loads.shape), layer) for loads, layer in zip(base, layers, strict=True)]
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
        for each in around:
            if each is None:
                yield nothing if added else alone
                continue
            first, stop = stop, stop + each.inserted.size - 1
            own = [loads[first:stop] for loads in inserted]
            take = each.added if added else each.exchanged
            yield [take(edges, *given) for given in zip(base, layers, own, strict=True)]


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

    def exchanged(self, edges: FloatArray, loads: FloatArray, layer: _Layer, inserted: FloatArray) -> _Jumps:
        """Jumps of all columns, the inserted ones in their place."""
        return _Jumps.of(
            np.concatenate([edges[: self.lowest], self.inserted, edges[self.highest + 1 :]]),
            np.concatenate([loads[: self.lowest], inserted, loads[self.highest :]]),
            layer,
        )

    def added(self, edges: FloatArray, loads: FloatArray, layer: _Layer, inserted: FloatArray) -> _Jumps:
        """Jumps of what the inserted columns add to those that they replace."""
        new, old = self.inserted, edges[self.lowest : self.highest + 1]
        both = np.unique(np.concatenate([new, old]))
        middles = 0.5 * (both[1:] + both[:-1])
        difference = inserted[np.searchsorted(new, middles) - 1]
        difference -= loads[self.lowest : self.highest][np.searchsorted(old, middles) - 1]
        return _Jumps.of(both, difference, layer)


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
        step = CENTRED * float(np.diff(inserted)[beside].min())
        own = x + step * np.array([-1.5, -0.5, 0.5, 1.5])
        if low < own[0] and own[-1] < high:
            kept = np.abs(inserted - x) > 1.9 * step
            kept[[0, -1]] = True
            inserted = np.sort(np.concatenate([inserted[kept], own]))
    first, last = max(lowest - 1, 0), min(highest + 1, count)
    whole = np.concatenate([edges[first:lowest], inserted, edges[highest + 1 : last + 1]])
    return _Surroundings(whole, first, last)


@dataclass(frozen=True, eq=False)
class _Layer:
    """Points at some depths that lie alike relative to the cells along y, and the cells that they see.

    Attributes
    ----------
    points, at : array of int
        Positions along y, and where among the offsets each has the first of the corners.
    numbers : array of int
        Depths.
    corners : list of _EvenCorner
        Corner functions at each.
    edges : array or None
        Edges along y of fine cells; None for the cells themselves.
    """

    points: IntArray
    at: IntArray
    numbers: IntArray
    corners: list[_EvenCorner]
    edges: FloatArray | None

    @classmethod
    def of(
        cls,
        influence: Influence,
        column: Aligned,
        z: FloatArray,
        numbers: IntArray,
        start: float,
        dy: float,
        count: int,
        parts: int,
    ) -> _Layer:
        """Layer over `count` cells from the edge `start` on, each of so many `parts` or not split."""
        offset, cells, step, edges = column.offset, column.cells, dy, None
        if parts:
            # Fine cells have the points in their middles.
            step = dy / parts
            before = int(np.floor(-offset / step - 0.5))
            begin = offset + step * (before + 0.5)
            total = int(np.ceil((count * dy - begin) / step - 1e-9))
            edges = np.asarray(start + begin + step * np.arange(total + 1.0))
            offset, cells, count = 0.5 * step, parts * cells - before - 1, total
        lowest = int(cells.min()) - count
        offsets: FloatArray = offset + step * np.arange(lowest, int(cells.max()) + 1.0)
        corners = [_EvenCorner(influence, offsets, float(z[number])) for number in numbers]
        return cls(column.points, cells - int(cells.min()), numbers, corners, edges)

    def loads(self, smooth: SmoothLoad) -> FloatArray:
        """Return the loads of columns on the cells along y that the points see."""
        return smooth.gathered() if self.edges is None else smooth.gathered_on(self.edges)


@dataclass(frozen=True, eq=False)
class _Jumps:
    """Mixed jumps of a load at the edges along x where there are any: array (edge, corner), backwards along y."""

    edges: FloatArray
    values: FloatArray
    spectrum: ComplexArray | None
    size: int
    least: float

    @classmethod
    def of(cls, edges: FloatArray, loads: FloatArray, layer: _Layer) -> _Jumps:
        """Jumps of `loads` (column, cell), with their spectrum if a layer has many points."""
        jumps = np.diff(np.diff(np.pad(loads, 1), axis=0), axis=1)
        loaded = jumps.any(axis=1)
        backwards = jumps[loaded, ::-1]
        few = layer.at.size <= FEW_POINTS
        size = fft.next_fast_len(jumps.shape[1] + int(layer.at.max()), real=True)
        spectrum = None if few else fft.rfft(backwards, size, axis=1).conj()
        return cls(edges[loaded], backwards, spectrum, size, float(np.diff(edges).min()))

    def field(self, corner: _EvenCorner, x: float, at: IntArray) -> FloatArray:
        """Field (component, point) of corners that see a point at `x`."""
        values, count = corner(snapped(x - self.edges, self.least)), self.values.shape[1]
        if self.spectrum is None:
            places = (values[:, :, place : place + count] for place in at.tolist())
            return np.stack([np.einsum("cef,ef->c", seen, self.values) for seen in places], axis=1)
        summed = np.einsum("cek,ek->ck", fft.rfft(values, self.size, axis=2), self.spectrum)
        return np.asarray(fft.irfft(summed, self.size, axis=1)[:, at])


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
