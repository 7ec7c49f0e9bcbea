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

FEW_POINTS = 8
"""Points along y up to which the corners are summed one by one instead of by a convolution. Speed."""

TOGETHER_AT = 16_384
"""Corners and depths that are evaluated at once. Speed: what they make stays in the processor's cache."""

TOGETHER = 0.03
"""Width, over their distance, of columns far away that are taken together. Accuracy: 1e-5 of the pressure."""


@dataclass(frozen=True, eq=False)
class Layer:
    """Points at some depths that lie alike relative to the cells along y, and the cells that they see.

    Attributes
    ----------
    points, at : array of int
        Positions along y, and where among the offsets each has the first of the corners.
    numbers : array of int
        Depths.
    corners : EvenOffsets
        Offsets and depths at which corner functions are wanted.
    edges : array or None
        Edges along y of fine cells; None for the cells themselves.
    """

    points: IntArray
    at: IntArray
    numbers: IntArray
    corners: EvenOffsets
    edges: FloatArray | None

    @classmethod
    def of(
        cls,
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
            return cls.centred(column.points, places, z, numbers, column.offset, start, span, dy / parts)
        return cls._seen(column.points, column.cells, z, numbers, column.offset, dy, count, None)

    @classmethod
    def centred(
        cls,
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
        return cls._seen(points, places - before - 1, z, numbers, 0.5 * step, step, total, edges)

    @classmethod
    def _seen(
        cls,
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
        return cls(points, cells - int(cells.min()), numbers, EvenOffsets(offsets, z), edges)

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
    folded: FloatArray | None
    size: int
    least: float

    @classmethod
    def of(cls, edges: FloatArray, loads: FloatArray, layer: Layer) -> Jumps:
        """Jumps of `loads` (column, cell) as a layer sees them."""
        least = float(np.diff(edges).min())
        jumps = np.diff(np.diff(np.pad(loads, 1), axis=0), axis=1)
        loaded = jumps.any(axis=1)
        backwards, corners = jumps[loaded, ::-1], layer.corners
        size = fft.next_fast_len(jumps.shape[1] + int(layer.at.max()), real=True)
        folded = None
        if layer.at.size <= FEW_POINTS and corners.index is not None:
            folded = np.stack([corners.folded(backwards, place) for place in layer.at.tolist()], axis=1)
            folded = folded.reshape(-1, 2 * layer.at.size)
        return cls(edges[loaded], backwards, folded, size, least)

    def field(self, influence: Influence, corners: EvenOffsets, x: float, at: IntArray) -> FloatArray:
        """Field (component, depth, point) of corners that see points at `x`."""
        distances = snapped(x - self.edges, self.least)
        step = max(1, TOGETHER_AT // max(1, distances.size * corners.along_y.size))
        spectrum = None if at.size <= FEW_POINTS else fft.rfft(self.values, self.size, axis=1).conj()
        parts = [
            self._at_depths(influence, corners, corners.z[start : start + step], distances, at, spectrum)
            for start in range(0, corners.z.size, step)
        ]
        return np.concatenate(parts, axis=1)

    def _at_depths(
        self,
        influence: Influence,
        corners: EvenOffsets,
        z: FloatArray,
        distances: FloatArray,
        at: IntArray,
        spectrum: ComplexArray | None,
    ) -> FloatArray:
        """Return the field at some of the depths; for many points along y from the jumps' `spectrum`."""
        values = influence.corner(distances[:, None], corners.along_y, z[:, None, None], influence.poisson)
        # A primitive is even where its kernel is odd, and odd where it is even.
        odd = np.array(influence.sign_along_y) > 0
        if self.folded is not None:
            both = values.reshape(*values.shape[:2], -1) @ self.folded
            return np.where(odd[:, None, None], both[..., 1::2], both[..., ::2])
        values, count = corners.on_both_sides(values, odd), self.values.shape[1]
        if spectrum is None:
            places = (values[..., place : place + count] for place in at.tolist())
            return np.stack([np.einsum("czef,ef->cz", seen, self.values) for seen in places], axis=2)
        summed = np.einsum("czek,ek->czk", fft.rfft(values, self.size, axis=3), spectrum)
        return np.asarray(fft.irfft(summed, self.size, axis=2)[..., at])

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        arrays = (self.edges, self.values, self.folded)
        return sum(array.nbytes for array in arrays if array is not None)


class EvenOffsets:
    """Uniform offsets along y at which corner functions are wanted, and depths.

    Functions even or odd along y are evaluated on one side of 0 only, if that gives the other.

    Parameters
    ----------
    offsets : array
        Uniform offsets along y.
    z : array
        Depths.

    Attributes
    ----------
    along_y : array
        Where to evaluate functions along y.
    index : array of int or None
        Which of these stands for each offset; None where they are the offsets themselves.
    """

    def __init__(self, offsets: FloatArray, z: FloatArray) -> None:
        self.z = z
        self.along_y = offsets
        self._sides: FloatArray = np.ones(1)
        self.index: IntArray | None = None
        if offsets.size > 1:
            step = offsets[1] - offsets[0]
            twice = np.round(2 * offsets / step).astype(np.int64)
            if np.abs(2 * offsets / step - twice).max() < OFFSET_TOLERANCE:
                distances, self.index = np.unique(np.abs(twice), return_inverse=True)
                self.along_y = 0.5 * step * distances
                self._sides = np.where(twice < 0, -1.0, 1.0)
        self._onto: dict[tuple[int, int], FloatArray] = {}

    def on_both_sides(self, values: FloatArray, odd: BoolArray) -> FloatArray:
        """Values (component, depth, edge, offset) from those where functions are evaluated."""
        if self.index is None:
            return values
        signs = np.where(odd[:, None], self._sides, 1.0)[:, None, None, :]
        return np.asarray(values[..., self.index] * signs)

    def folded(self, jumps: FloatArray, place: int) -> FloatArray:
        """Sum jumps (edge, corner) over both sides of 0, as even and as odd functions see them.

        Returns an array (edge and distance, 2), for the corners from the offset number `place` on.
        """
        onto = self._onto.get((place, jumps.shape[1]))
        if onto is None:
            onto = self._onto[place, jumps.shape[1]] = self._folding(place, jumps.shape[1])
        return (jumps @ onto).reshape(-1, 2)

    def _folding(self, place: int, count: int) -> FloatArray:
        """Matrix that sums over both sides of 0: array (corner, distance and parity)."""
        assert self.index is not None
        seen, corners = slice(place, place + count), np.arange(count)
        onto = np.zeros((count, self.along_y.size, 2))
        onto[corners, self.index[seen], 0] = 1.0
        onto[corners, self.index[seen], 1] = self._sides[seen]
        return onto.reshape(count, -1)


def gathered_far(edges: FloatArray, loads: FloatArray, x: float) -> tuple[FloatArray, FloatArray]:
    """Take neighbouring columns (column, cell) together that are narrow against their distance from `x`.

    Their forces are kept.

    Examples
    --------
    >>> edges, loads = np.array([0.0, 1.0, 99.0, 100.0, 101.0]), np.array([[1.0], [2.0], [3.0], [5.0]])
    >>> found, together = gathered_far(edges, loads, -9.0)
    >>> found.tolist(), together.ravel().tolist()
    ([0.0, 1.0, 99.0, 101.0], [1.0, 2.0, 4.0])
    """
    distances = np.abs(0.5 * (edges[1:] + edges[:-1]) - x)
    rings = np.log(distances / distances.min()) // np.log1p(TOGETHER)
    starts = np.flatnonzero(np.append(True, np.diff(rings) != 0))
    if starts.size == loads.shape[0]:
        return edges, loads
    kept = np.append(edges[starts], edges[-1])
    forces = np.add.reduceat(loads * np.diff(edges)[:, None], starts, axis=0)
    return kept, forces / np.diff(kept)[:, None]
