"""Common cells of a study: positions over the half-width on which the surfaces and stresses of all cases lie.

The common edges along x are those edges of the cases that lie at least half of the narrowest adjacent cell apart, with
further edges where stress points are denser, and a thin cell on each end of a case. Pressure and traction are averaged
over a common cell, which preserves loads; flags have the value of the case's cell at the centre; others are linear.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from contactstudy.arrays.grid import SPACING_TOLERANCE, centres_of, interpolate_columns
from contactstudy.checks import FloatArray
from contactstudy.profiles.measured_profile import minmod

MIN_WIDTH = 0.5  # Least width of a common cell over the narrowest adjacent cell of all cases. Accuracy
END_WIDTH = 1e-10  # Width of the cell on the end of a case over the longest case, above rounding. Accuracy
AVERAGED_VARIABLES = frozenset({"pressure", "traction_x", "traction_y"})  # averaged over a common cell
FLAG_VARIABLES = frozenset({"stick"})  # Variables that are true or false


def resampling_comment(name: str) -> str:
    """Comment on the computation of a variable's values on common cells."""
    if name in AVERAGED_VARIABLES:
        return "averaged over cells common to all cases: loads remain, peaks may be a little lower"
    if name in FLAG_VARIABLES:
        return "value of the case's cell at the centre of the common cell; false beyond the case's cells"
    return "interpolated linearly from the case's cells"


def common_columns(edges: Sequence[FloatArray]) -> FloatArray:
    """Edges along x, over the half-width, that resolve the cells of all cases."""
    union = np.unique(np.concatenate(edges))
    midpoints = centres_of(union)
    min_widths = np.full(midpoints.size, np.inf)
    for case_edges in edges:
        cells = np.searchsorted(case_edges, midpoints) - 1
        in_case = (cells >= 0) & (cells < case_edges.size - 1)
        min_widths[in_case] = np.minimum(min_widths[in_case], np.diff(case_edges)[cells[in_case]])
    # Edges of narrower cells precede edges of wider cells near them.
    adjacent_widths = np.minimum(min_widths[:-1], min_widths[1:])
    kept = sorted({0, union.size - 1})
    for index in (1 + np.argsort(adjacent_widths, kind="stable")).tolist():
        place = bisect(kept, index)
        distance = min(union[index] - union[kept[place - 1]], union[kept[place]] - union[index])
        if distance >= MIN_WIDTH * adjacent_widths[index - 1]:
            kept.insert(place, index)
    return np.asarray(union[kept])


def end_cells(edges: Sequence[FloatArray], points: Sequence[FloatArray]) -> FloatArray:
    """Thin cells (end, inner edge) on the ends of the cases that are the first or last stress point of a case."""
    ends = np.unique([case_edges[[0, -1]] for case_edges in edges], axis=0)
    width = END_WIDTH * np.ptp(ends, axis=1).max()
    cells = np.stack([ends, ends + np.array([width, -width])], axis=-1).reshape(-1, 2)
    first_and_last = np.unique([(case_points.min(), case_points.max()) for case_points in points])
    return np.asarray(cells[np.abs(first_and_last[:, None] - cells[:, 0]).min(axis=0, initial=np.inf) < width])


def common_rows(edges: Sequence[FloatArray]) -> FloatArray:
    """Uniform edges along y over the widest window, with the narrowest cells of all cases."""
    half_window = max(float(np.abs(case_edges).max()) for case_edges in edges)
    width = min(float(np.diff(case_edges).min()) for case_edges in edges)
    return np.linspace(-half_window, half_window, 1 + int(np.ceil(2 * half_window / width * (1 - SPACING_TOLERANCE))))


def split_cells(edges: FloatArray, points: FloatArray) -> FloatArray:
    """Edges with an additional edge between any two points that lie in one cell."""
    cells = np.minimum(np.searchsorted(edges, points, side="right"), edges.size - 1)
    return np.union1d(edges, centres_of(points)[cells[1:] == cells[:-1]])


def centre_cells(edges: FloatArray, points: FloatArray) -> FloatArray:
    """Edges moved and added so that every point is the centre of a cell."""
    ends = edges[[0, -1]]
    for index, point in enumerate(points):
        cell = int(np.clip(np.searchsorted(edges, point) - 1, 0, edges.size - 2))
        low, high = edges[cell], edges[cell + 1]
        width = high - low
        is_centre = np.abs(centres_of(edges) - point).min() < END_WIDTH * (edges[-1] - edges[0])
        spacing = np.abs(np.delete(points[max(index - 1, 0) : index + 2], min(index, 1)) - point).min(initial=np.inf)
        # Two points in one cell, or at its edge, move the cell's edges.
        is_alone = spacing > 0.5 * width * (1 + SPACING_TOLERANCE)
        if (is_centre and is_alone) or not edges[0] < point < edges[-1]:
            continue
        half_cell = min(0.25 * width, 0.5 * spacing, point - edges[0], edges[-1] - point)
        distance = min(point - low, high - point)
        if distance > SPACING_TOLERANCE * width:
            half_cell = min(half_cell, distance)
        is_beyond_cell = np.abs(edges - point) > half_cell * (1 + SPACING_TOLERANCE)
        edges = np.union1d(edges[is_beyond_cell], [point - half_cell, point + half_cell])
        edges[[0, -1]] = ends  # without rounding
    return edges


@dataclass(frozen=True, eq=False, kw_only=True)
class Resampling:
    """Map from the cells or points of a case to the common axis."""

    source: FloatArray  # edges of the case's cells, or its points, over the half-width
    axis: FloatArray
    borders: FloatArray  # borders around each position of the axis
    fill: float = np.nan  # average beyond the case's cells: 0 outside the contact, NaN beyond the body
    has_points: bool = False

    @property
    def is_outside(self) -> npt.NDArray[np.bool_]:
        """Positions of the axis beyond the case's cells or points."""
        low, high = self.source.min(), self.source.max()
        tolerance = SPACING_TOLERANCE * (high - low) if self.has_points else 0.0
        return np.asarray((self.axis < low - tolerance) | (self.axis > high + tolerance))

    def average(self, values: FloatArray) -> FloatArray:
        """Average values (cell, ...) within the common borders, by limited slopes, which preserve integrals."""
        from scipy import sparse  # slow to import, and not needed to open a study

        low = np.maximum(self.borders[:-1, None], self.source[None, :-1])
        high = np.minimum(self.borders[1:, None], self.source[None, 1:])
        overlap_fraction = np.maximum(high - low, 0.0) / np.diff(self.borders)[:, None]
        midpoints = centres_of(self.source)
        lever_arms = np.where(overlap_fraction > 0, 0.5 * (low + high) - midpoints, 0.0)
        slopes = _limited_slopes(midpoints, values)
        result = sparse.csr_array(overlap_fraction) @ values + sparse.csr_array(overlap_fraction * lever_arms) @ slopes
        result[~overlap_fraction.any(axis=1)] = self.fill
        return np.asarray(result)

    def select_cells(self, values: FloatArray) -> FloatArray:
        """Values along the first axis of the case's cells that contain the positions; 0 beyond the cells."""
        cells = np.clip(np.searchsorted(self.source, self.axis) - 1, 0, self.source.size - 2)
        result = values[cells]
        result[self.is_outside] = 0.0
        return np.asarray(result)

    def interpolate(self, values: FloatArray) -> FloatArray:
        """Interpolate values along the first axis linearly; NaN beyond the case's cells or points."""
        positions = centres_of(self.source)
        if self.has_points:
            order = np.argsort(self.source)
            positions, values = self.source[order], values[order]
        with np.errstate(invalid="ignore"):
            result = interpolate_columns(values, positions, self.axis)
        # Next to an infinite gap linear interpolation has no value.
        cell_indices = np.searchsorted(self.source, self.axis) - 1
        nearest_indices = np.searchsorted(positions, self.axis) if self.has_points else cell_indices
        result = np.where(np.isfinite(result), result, values[np.clip(nearest_indices, 0, positions.size - 1)])
        result[self.is_outside] = np.nan
        return result


def resample(name: str, values: npt.NDArray[Any], resamplings: Iterable[Resampling | None]) -> npt.NDArray[Any]:
    """Values of a variable on the common cells; an axis whose resampling is None is unchanged."""
    result = np.asarray(values, dtype=np.float64)
    # x comes last: values beyond the body are NaN, although the pressure outside the window is 0.
    for axis, resampling in reversed(list(enumerate(resamplings))):
        if resampling is None:
            continue
        moved_values = np.moveaxis(result, axis, 0)
        if name in AVERAGED_VARIABLES:
            averages = resampling.average(moved_values.reshape(moved_values.shape[0], -1))
            moved_values = averages.reshape(-1, *moved_values.shape[1:])
        elif name in FLAG_VARIABLES:
            moved_values = resampling.select_cells(moved_values)
        else:
            moved_values = resampling.interpolate(moved_values)
        result = np.moveaxis(moved_values, 0, axis)
    return result


def _limited_slopes(centres: FloatArray, values: FloatArray) -> FloatArray:
    """Slope of each cell: the smaller slope to either neighbour, 0 at a local extreme and at the outermost cells."""
    slopes = np.zeros_like(values)
    if centres.size > 2:
        steps = np.diff(values, axis=0) / np.diff(centres)[:, None]
        slopes[1:-1] = minmod(steps[:-1], steps[1:])
    return slopes
