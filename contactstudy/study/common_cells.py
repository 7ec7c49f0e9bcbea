"""Common cells of a study: positions over the half-width on which the surfaces and stresses of all cases lie.

The common edges along x are edges of the cases, thinned to half the width of the narrowest cell of any case there, with
further edges where stress points are denser. Pressure and traction are averaged over a common cell, so loads remain;
flags have the value of the case's cell at the centre; other quantities are interpolated linearly.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from contactstudy.arrays.grid import SPACING_TOLERANCE
from contactstudy.checks import FloatArray

LEAST_WIDTH = 0.5  # Least width of a common cell over the narrowest cell of any case there. Accuracy
AVERAGED = frozenset({"pressure", "traction_x", "traction_y"})  # Variables that are averaged over a common cell
FLAGS = frozenset({"stick"})  # Variables that are true or false


def resampling_comment(name: str) -> str:
    """Comment on the values of a variable on common cells."""
    if name in AVERAGED:
        return "averaged over cells common to all cases: loads remain, peaks may be a little lower"
    if name in FLAGS:
        return "value of the case's cell at the centre of the common cell; false beyond the case's cells"
    return "interpolated linearly from the case's cells"


def common_columns(edges: Sequence[FloatArray]) -> FloatArray:
    """Edges along x, over the half-width, that resolve the cells of all cases."""
    union = np.unique(np.concatenate(edges))
    middles = 0.5 * (union[1:] + union[:-1])
    narrowest = np.full(middles.size, np.inf)
    for case_edges in edges:
        cells = np.searchsorted(case_edges, middles) - 1
        inside = (cells >= 0) & (cells < case_edges.size - 1)
        narrowest[inside] = np.minimum(narrowest[inside], np.diff(case_edges)[cells[inside]])
    thinned = [union[0]]
    for edge, width in zip(union[1:], narrowest, strict=True):
        if edge - thinned[-1] >= LEAST_WIDTH * width:
            thinned.append(edge)
    # The last edge replaces a nearby one before it.
    if thinned[-1] != union[-1]:
        thinned[-1 if len(thinned) > 1 else 1 :] = [union[-1]]
    return np.array(thinned)


def common_rows(edges: Sequence[FloatArray]) -> FloatArray:
    """Uniform edges along y over the widest window, with the narrowest cells of all cases."""
    reach = max(float(np.abs(case_edges).max()) for case_edges in edges)
    width = min(float(np.diff(case_edges).min()) for case_edges in edges)
    return np.linspace(-reach, reach, 1 + int(np.ceil(2 * reach / width * (1 - SPACING_TOLERANCE))))


def split_cells(edges: FloatArray, points: FloatArray) -> FloatArray:
    """Edges with a further one between each two points within one cell."""
    middles = 0.5 * (points[1:] + points[:-1])
    cells = np.searchsorted(edges, points, side="right")
    cells[points >= edges[-1]] = edges.size - 1
    return _with_faces(np.union1d(edges, middles[cells[1:] == cells[:-1]]), points)


def _with_faces(edges: FloatArray, points: FloatArray) -> FloatArray:
    """Edges with a thin cell, 4e-6 of the first or last one, at each face that contains a point."""
    faces = []
    for end, inward in ((0, 1), (-1, -2)):
        width = edges[inward] - edges[end]
        if (np.abs(points - edges[end]) < SPACING_TOLERANCE * abs(width)).any():
            faces.append(edges[end] + 4e-6 * width)
    return np.union1d(edges, faces)


def centred_cells(edges: FloatArray, points: FloatArray) -> FloatArray:
    """Edges such that every point is the centre of a cell."""
    edges = _with_faces(edges, points)
    for index, point in enumerate(points):
        cell = int(np.clip(np.searchsorted(edges, point) - 1, 0, edges.size - 2))
        low, high = edges[cell], edges[cell + 1]
        width = high - low
        if not edges[0] < point < edges[-1] or abs(point - 0.5 * (low + high)) < 1e-9 * width:
            continue
        spacings = np.abs(np.delete(points[max(index - 1, 0) : index + 2], min(index, 1)) - point)
        half = min(0.25 * width, 0.5 * spacings.min(initial=np.inf), point - edges[0], edges[-1] - point)
        distance = min(point - low, high - point)
        if distance > SPACING_TOLERANCE * width:
            half = min(half, distance)
        outside = np.abs(edges - point) > half * (1 + SPACING_TOLERANCE)
        edges = np.union1d(edges[outside], [point - half, point + half])
    return edges


@dataclass(frozen=True, eq=False, kw_only=True)
class Resampling:
    """Map from the cells or points of a case to the common axis."""

    source: FloatArray  # edges of the case's cells, or its points, over the half-width
    axis: FloatArray
    borders: FloatArray  # borders around each position of the axis
    outside: float = np.nan  # average beyond the case's cells: 0 outside the contact, NaN where the body ends
    of_points: bool = False

    @property
    def beyond(self) -> npt.NDArray[np.bool_]:
        """Positions of the axis beyond the case's cells or points."""
        low, high = self.source.min(), self.source.max()
        slack = SPACING_TOLERANCE * (high - low) if self.of_points else 0.0
        return np.asarray((self.axis < low - slack) | (self.axis > high + slack))

    def averages(self, values: FloatArray) -> FloatArray:
        """Average values (cell, ...) within the common borders, by limited slopes: integrals remain."""
        from scipy import sparse  # slow to import, and not needed to open a study

        low = np.maximum(self.borders[:-1, None], self.source[None, :-1])
        high = np.minimum(self.borders[1:, None], self.source[None, 1:])
        shared = np.maximum(high - low, 0.0) / np.diff(self.borders)[:, None]
        middles = centres(self.source)
        arms = np.where(shared > 0, 0.5 * (low + high) - middles, 0.0)
        slopes = _limited_slopes(middles, values)
        result = sparse.csr_array(shared) @ values + sparse.csr_array(shared * arms) @ slopes
        result[~shared.any(axis=1)] = self.outside
        return np.asarray(result)

    def containing(self, values: FloatArray) -> FloatArray:
        """Values along the first axis of the case's cells that contain the positions; 0 beyond the cells."""
        cells = np.clip(np.searchsorted(self.source, self.axis) - 1, 0, self.source.size - 2)
        result = values[cells]
        result[self.beyond] = 0.0
        return np.asarray(result)

    def interpolated(self, values: FloatArray) -> FloatArray:
        """Interpolate values along the first axis linearly; NaN beyond the case's cells or points."""
        positions = centres(self.source)
        if self.of_points:
            order = np.argsort(self.source)
            positions, values = self.source[order], values[order]
        if positions.size == 1:
            result = np.repeat(values, self.axis.size, axis=0)
        else:
            cells = np.clip(np.searchsorted(positions, self.axis) - 1, 0, positions.size - 2)
            part = np.clip((self.axis - positions[cells]) / (positions[cells + 1] - positions[cells]), 0.0, 1.0)
            part = part.reshape(-1, *(1,) * (values.ndim - 1))
            with np.errstate(invalid="ignore"):
                result = (1 - part) * values[cells] + part * values[cells + 1]
            # Interpolation beside an infinite gap is impossible.
            nearest = np.clip(np.searchsorted(positions, self.axis), 0, positions.size - 1)
            if not self.of_points:
                nearest = np.clip(np.searchsorted(self.source, self.axis) - 1, 0, positions.size - 1)
            result = np.where(np.isfinite(result), result, values[nearest])
        result[self.beyond] = np.nan
        return result


def resampled(name: str, values: npt.NDArray[Any], maps: Iterable[Resampling | None]) -> npt.NDArray[Any]:
    """Values of a variable on the common cells; an axis without a map remains."""
    result = np.asarray(values, dtype=np.float64)
    # Along x last: beyond the body values are NaN, beside the window the pressure is 0.
    for axis, resampling in reversed(list(enumerate(maps))):
        if resampling is None:
            continue
        moved = np.moveaxis(result, axis, 0)
        if name in AVERAGED:
            flat = resampling.averages(moved.reshape(moved.shape[0], -1))
            moved = flat.reshape(-1, *moved.shape[1:])
        elif name in FLAGS:
            moved = resampling.containing(moved)
        else:
            moved = resampling.interpolated(moved)
        result = np.moveaxis(moved, 0, axis)
    return result


def _limited_slopes(centres: FloatArray, values: FloatArray) -> FloatArray:
    """Slope of each cell: the smaller one to either neighbour, 0 at a local extreme and at the outermost cells."""
    slopes = np.zeros_like(values)
    if centres.size > 2:
        steps = np.diff(values, axis=0) / np.diff(centres)[:, None]
        before, after = steps[:-1], steps[1:]
        smaller = np.minimum(np.abs(before), np.abs(after))
        slopes[1:-1] = np.where(before * after > 0, np.sign(before) * smaller, 0.0)
    return slopes


def centres(edges: FloatArray) -> FloatArray:
    """Centres of the cells between `edges`."""
    return np.asarray(0.5 * (edges[1:] + edges[:-1]))
