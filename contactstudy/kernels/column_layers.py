"""Corners of cells in columns of any width, as points that lie alike relative to the cells along y see them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft

from contactstudy.checks import BoolArray, ComplexArray, FloatArray, IntArray
from contactstudy.kernels.aligned import OFFSET_TOLERANCE, Aligned
from contactstudy.kernels.images import snapped
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.smooth_load import SmoothLoad

FEW_POINTS = 4
"""Points along y up to which the corners are summed one by one instead of by a convolution. Speed."""

FAR, TOGETHER = 3.0, 0.03
"""Distance along x over the load's width from which on columns are taken together, and their width over that distance.
Accuracy: 1e-5 of the pressure."""


@dataclass(frozen=True, eq=False)
class Layer:
    """Points at some depths that lie alike relative to the cells along y, and the cells that they see.

    Attributes
    ----------
    points, at : array of int
        Positions along y, and where among the offsets each has the first of the corners.
    numbers : array of int
        Depths.
    corners : list of EvenCorner
        Corner functions at each.
    edges : array or None
        Edges along y of fine cells; None for the cells themselves.
    reach : float
        Distance along x from which on columns are taken together, metres.
    """

    points: IntArray
    at: IntArray
    numbers: IntArray
    corners: list[EvenCorner]
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
    ) -> Layer:
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
    ) -> Layer:
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
    ) -> Layer:
        """Layer of points that see so many cells."""
        lowest = int(cells.min()) - count
        offsets: FloatArray = offset + step * np.arange(lowest, int(cells.max()) + 1.0)
        corners = [EvenCorner(influence, offsets, float(z[number])) for number in numbers]
        return cls(points, cells - int(cells.min()), numbers, corners, edges, FAR * step * count)

    def loads(self, smooth: SmoothLoad) -> FloatArray:
        """Return the loads of columns on the cells along y that the points see."""
        return smooth.gathered() if self.edges is None else smooth.gathered_on(self.edges)


@dataclass(frozen=True, eq=False)
class Jumps:
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
    def of(cls, edges: FloatArray, loads: FloatArray, layer: Layer, x: float | None = None) -> Jumps:
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

    def field(self, corner: EvenCorner, x: float, at: IntArray) -> FloatArray:
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


class EvenCorner:
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
