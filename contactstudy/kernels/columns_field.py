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
from contactstudy.checks import BoolArray, ComplexArray, FloatArray, IntArray
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

FAR, TOGETHER = 3.0, 0.03
"""Distance along x over the load's width from which on columns are taken together, and their width over that distance.
Accuracy: 1e-5 of the pressure."""

MOST_PARTS = 6
"""Parts of the shortest distance between positions along y that are tried as a step of all, and parts of a cell that
such a step is at least. Speed."""

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
        parts, columns = PARTS_Y if wanted else 0, aligned_points(y, begin, grid.dy)
        step = common_step(y, grid.dy) if len(columns) > 1 and fine is not None else None
        if step is None:
            layers = [
                _Layer.of(influence, column, z, numbers, begin, grid.dy, load.shape[1], parts) for column in columns
            ]
        else:
            # One set of cells that has every point in the middle of one.
            number = int(np.ceil(step * max(parts, 1) / grid.dy - OFFSET_TOLERANCE))
            places = np.round((y - y.min()) / step).astype(np.int64) * number
            span = load.shape[1] * grid.dy
            layers = [
                _Layer.centred(
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


def gathered_far(edges: FloatArray, loads: FloatArray, x: float, reach: float) -> tuple[FloatArray, FloatArray]:
    """Take neighbouring columns (column, cell) together that are far from `x` and narrow against their distance.

    Their forces are kept.

    Examples
    --------
    >>> edges, loads = np.array([0.0, 1.0, 99.0, 100.0, 101.0]), np.array([[1.0], [2.0], [3.0], [5.0]])
    >>> found, together = gathered_far(edges, loads, 0.0, 9.0)
    >>> found.tolist(), together.ravel().tolist()
    ([0.0, 1.0, 99.0, 101.0], [1.0, 2.0, 4.0])
    """
    distances = 0.5 * (edges[1:] + edges[:-1]) - x
    rings = np.log(np.maximum(np.abs(distances), reach) / reach) // np.log1p(TOGETHER)
    alike = (np.diff(rings) == 0) & (rings[1:] > 0) & (distances[1:] * distances[:-1] > 0)
    starts = np.flatnonzero(np.append(True, ~alike))
    if starts.size == loads.shape[0]:
        return edges, loads
    kept = np.append(edges[starts], edges[-1])
    forces = np.add.reduceat(loads * np.diff(edges)[:, None], starts, axis=0)
    return kept, forces / np.diff(kept)[:, None]


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

    def exchanged(self, edges: FloatArray, x: float, loads: FloatArray, layer: _Layer, inserted: FloatArray) -> _Jumps:
        """Jumps of all columns, the inserted ones in their place, as a point at `x` sees them."""
        return _Jumps.of(
            np.concatenate([edges[: self.lowest], self.inserted, edges[self.highest + 1 :]]),
            np.concatenate([loads[: self.lowest], inserted, loads[self.highest :]]),
            layer,
            x,
        )

    def added(self, edges: FloatArray, x: float, loads: FloatArray, layer: _Layer, inserted: FloatArray) -> _Jumps:
        """Jumps of what the inserted columns add to those that they replace."""
        new, old = self.inserted, edges[self.lowest : self.highest + 1]
        both = np.unique(np.concatenate([new, old]))
        middles = 0.5 * (both[1:] + both[:-1])
        difference = inserted[np.searchsorted(new, middles) - 1]
        difference -= loads[self.lowest : self.highest][np.searchsorted(old, middles) - 1]
        return _Jumps.of(both, difference, layer, x)


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
    reach : float
        Distance along x from which on columns are taken together, metres.
    """

    points: IntArray
    at: IntArray
    numbers: IntArray
    corners: list[_EvenCorner]
    edges: FloatArray | None
    reach: float

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
        if parts:
            places, span = parts * column.cells, count * dy
            return cls.centred(influence, column.points, places, z, numbers, column.offset, start, span, dy / parts)
        return cls._seen(influence, column.points, column.cells, z, numbers, column.offset, dy, count, None)

    @classmethod
    def centred(
        cls,
        influence: Influence,
        points: IntArray,
        places: IntArray,
        z: FloatArray,
        numbers: IntArray,
        offset: float,
        start: float,
        span: float,
        step: float,
    ) -> _Layer:
        """Layer of points at ``start + offset + step * places``, which lie in the middle of cells from `start` on."""
        before = int(np.floor(-offset / step - 0.5))
        begin = offset + step * (before + 0.5)
        total = int(np.ceil((span - begin) / step - 1e-9))
        edges = np.asarray(start + begin + step * np.arange(total + 1.0))
        return cls._seen(influence, points, places - before - 1, z, numbers, 0.5 * step, step, total, edges)

    @classmethod
    def _seen(
        cls,
        influence: Influence,
        points: IntArray,
        cells: IntArray,
        z: FloatArray,
        numbers: IntArray,
        offset: float,
        step: float,
        count: int,
        edges: FloatArray | None,
    ) -> _Layer:
        """Layer of points that see so many cells."""
        lowest = int(cells.min()) - count
        offsets: FloatArray = offset + step * np.arange(lowest, int(cells.max()) + 1.0)
        corners = [_EvenCorner(influence, offsets, float(z[number])) for number in numbers]
        return cls(points, cells - int(cells.min()), numbers, corners, edges, FAR * step * count)

    def loads(self, smooth: SmoothLoad) -> FloatArray:
        """Return the loads of columns on the cells along y that the points see."""
        return smooth.gathered() if self.edges is None else smooth.gathered_on(self.edges)


@dataclass(frozen=True, eq=False)
class _Jumps:
    """Mixed jumps of a load at the edges along x where there are any: array (edge, corner), backwards along y.

    For few points along y the jumps are `folded` onto the corner functions' different distances instead: array
    (edge and distance, point and parity).
    """

    edges: FloatArray
    values: FloatArray
    spectrum: ComplexArray | None
    folded: FloatArray | None
    size: int
    least: float

    @classmethod
    def of(cls, edges: FloatArray, loads: FloatArray, layer: _Layer, x: float | None = None) -> _Jumps:
        """Jumps of `loads` (column, cell) as a layer sees them, from `x` if it is given."""
        least = float(np.diff(edges).min())
        if x is not None:
            edges, loads = gathered_far(edges, loads, x, layer.reach)
        jumps = np.diff(np.diff(np.pad(loads, 1), axis=0), axis=1)
        loaded = jumps.any(axis=1)
        backwards, corner = jumps[loaded, ::-1], layer.corners[0]
        size = fft.next_fast_len(jumps.shape[1] + int(layer.at.max()), real=True)
        spectrum = folded = None
        if layer.at.size > FEW_POINTS:
            spectrum = fft.rfft(backwards, size, axis=1).conj()
        elif corner.index is not None:
            folded = np.stack([corner.folded(backwards, place) for place in layer.at.tolist()], axis=1)
            folded = folded.reshape(-1, 2 * layer.at.size)
        return cls(edges[loaded], backwards, spectrum, folded, size, least)

    def field(self, corner: _EvenCorner, x: float, at: IntArray) -> FloatArray:
        """Field (component, point) of corners that see a point at `x`."""
        distances = snapped(x - self.edges, self.least)
        if self.folded is not None:
            both = corner.different(distances).reshape(len(corner.odd), -1) @ self.folded
            return np.where(corner.odd[:, None], both[:, 1::2], both[:, ::2])
        values, count = corner(distances), self.values.shape[1]
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
        self._sides: FloatArray = np.ones(1)
        self.index: IntArray | None = None
        # A primitive is even where its kernel is odd, and odd where it is even.
        self.odd: BoolArray = np.array(influence.sign_along_y) > 0
        if offsets.size > 1:
            step = offsets[1] - offsets[0]
            twice = np.round(2 * offsets / step).astype(np.int64)
            if np.abs(2 * offsets / step - twice).max() < OFFSET_TOLERANCE:
                distances, self.index = np.unique(np.abs(twice), return_inverse=True)
                self._at = 0.5 * step * distances
                self._sides = np.where(twice < 0, -1.0, 1.0)

    def different(self, x: FloatArray) -> FloatArray:
        """Values (component, edge, distance) at the distances `x` of the edges, on one side of 0 along y."""
        return self._corner(x[:, None], self._at)

    def __call__(self, x: FloatArray) -> FloatArray:
        """Values (component, edge, offset) at the distances `x` of the edges."""
        values = self.different(x)
        if self.index is None:
            return values
        signs = np.where(self.odd[:, None], self._sides, 1.0)[:, None, :]
        return np.asarray(values[:, :, self.index] * signs)

    def folded(self, jumps: FloatArray, place: int) -> FloatArray:
        """Sum jumps (edge, corner) over both sides of 0, as even and as odd functions see them.

        Returns an array (edge and distance, 2), for the corners from the offset number `place` on.
        """
        assert self.index is not None
        seen = slice(place, place + jumps.shape[1])
        onto = np.zeros((jumps.shape[1], self._at.size, 2))
        corners = np.arange(jumps.shape[1])
        onto[corners, self.index[seen], 0] = 1.0
        onto[corners, self.index[seen], 1] = self._sides[seen]
        return np.tensordot(jumps, onto, axes=1).reshape(-1, 2)
