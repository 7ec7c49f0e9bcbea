"""The largest von Mises stress in a body.

The search evaluates points around the peaks of the pressure and along the contact, and refines them about the largest
values until polynomials of two degrees agree (docs/explanation/numerics.md). On the top it takes cells in contact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import NamedTuple

import numpy as np
import scipy  # imports ndimage, which is slow to import, on first use

from contactstudy.arrays.grid import TOP_ERROR, Grid, Points
from contactstudy.arrays.peaks import interpolate_about, variation_lengths
from contactstudy.bodies.material import Material, dundurs_parameter
from contactstudy.bodies.models import Body, Extent
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.fields.loads import Loads
from contactstudy.kernels.load import Load
from contactstudy.stress import von_mises_of

AXIAL_OFFSETS = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])  # points along x around a peak, over its width. Accuracy.

PEAK_DEPTHS = np.array([0.1, 0.2, 0.32, 0.48, 0.66, 0.9, 1.3])
"""Depths below a peak, over its width. Accuracy: the largest stress under a line contact is at 0.70, a sphere 0.48."""

END_DISTANCES = np.array([0.0, 0.2, 0.45, 0.7, 1.0, 1.4, 2.0, 3.2, 6.0, 12.0, 20.0])
"""Distances of points on the axis from the ends of the contact, over the half-width. Accuracy."""

LATERAL_OFFSETS = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])  # along y, over the half-width of the section. Accuracy.
AXIS_DEPTHS = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 1.0])  # depths below the axis, over the half-width. Accuracy.
MIN_SECOND_PEAK = 0.6  # least searched peak over the largest: near a free end it may cause more stress. Accuracy.
SLIP_TOLERANCE = 1e-6  # tolerance of the traction of a slipping cell, over its bound. Rounding.
BORDER_SHIFT = 0.15  # error of a border of stick and slip, over a cell, in Carter's contact. Accuracy.
RIM_CELLS = 1  # cells at the rim of the contact without accurate stresses on the top. Accuracy.


class Border:
    """Border between stick and slip on the top, where the stress has a cusp between the centres of cells."""

    # The second sticking cell from the border represents the border: the values of the first cell are too smooth.
    # The bound less the traction grows inside the border like a square root.

    def __init__(self, loads: Loads, materials: tuple[Material, Material | None], is_inside_rim: BoolArray) -> None:
        pressure = loads[Load.NORMAL].values
        zero = np.zeros_like(pressure)
        traction = np.stack([loads[load].values if load in loads else zero for load in (Load.ALONG_X, Load.ALONG_Y)])
        rise, border_error = np.zeros_like(pressure), np.zeros_like(pressure)
        ratio = traction / np.where(pressure > 0, pressure, 1.0)
        ratio_size = np.hypot(*ratio)
        bound = ratio_size.max(axis=1, keepdims=True)
        deficit = 1 - ratio_size / np.where(bound > 0, bound, 1.0)
        is_sticking = (pressure > 0) & (deficit > SLIP_TOLERANCE) & (bound > 0)
        is_missed, represents = np.zeros((2, *pressure.shape), bool)
        for step in (1, -1):
            is_slipping = np.roll((pressure > 0) & ~is_sticking, step, axis=1)
            is_border = is_sticking & is_slipping
            has_cell = is_border & np.roll(is_sticking & is_inside_rim, -step, axis=1)
            is_missed |= is_border & ~has_cell
            column, first_row = np.nonzero(has_cell)
            second_row, slipping_row = first_row + step, first_row - step
            # The integrals of this root up to both cells' far faces give the border's distance from the first centre.
            sums = deficit[column, first_row], deficit[column, first_row] + deficit[column, second_row]
            fraction = (sums[0] / sums[1]) ** (2 / 3)
            distance = np.clip(fraction / (1 - fraction) - 0.5, -BORDER_SHIFT, 1.0)
            # Near the rim the squared pressure is linear.
            next_row = np.where(distance > 0, slipping_row, second_row)
            first_pressure, next_pressure = pressure[column, first_row], pressure[column, next_row]
            slope = next_pressure**2 - first_pressure**2
            border_pressure = np.sqrt(first_pressure**2 + abs(distance) * slope)
            traction[:, column, second_row] = border_pressure * ratio[:, column, slipping_row]
            represents[column, second_row] = True
            rise[column, second_row] = border_pressure - pressure[column, second_row]
            border_error[column, second_row] = BORDER_SHIFT * abs(next_pressure - first_pressure)
        # Without a representing cell the cusp is missed. At the distance d from a narrow stick zone at the leading edge
        # of Carter's contact, here half a cell, the stress is lower by ``f p sqrt(2 d / a)``.
        cell_counts = np.maximum(np.count_nonzero(pressure, axis=1), 1)
        missed_error = (is_missed * bound * pressure).max(axis=1) * np.sqrt(2 / cell_counts)
        self.traction = traction  # (2, x, y): tractions of the cells, at the border in the representing cells, Pa
        self.represents = represents  # (x, y): whether the cell represents a border
        self.rise = rise  # (x, y): pressure at the border less the pressure of its representing cell, Pa; otherwise 0
        # In cells that stick the relative strain along y is constant, and the tractions' stress is 2 beta p.
        factor, poisson = 1 - 2 * dundurs_parameter(*materials), materials[0].poisson
        self.pressure_stresses = np.array([poisson * (1 + factor), factor, 1.0])  # -xx, -yy, -zz over the pressure
        # A change of the pressure changes the von Mises stress by at most the von Mises stress of the changes.
        stress_ratio = von_mises_of(*[*self.pressure_stresses, 0 * bound, bound, 0 * bound])
        self.error = stress_ratio * border_error + missed_error[:, None]  # (x, y): error of the stress on the top, Pa


class Search(NamedTuple):
    """Points of the search for the largest stress."""

    grid: Grid
    extent: Extent  # ends of the body, metres
    inside_rim: BoolArray  # (x, y): cells inside the contact with accurate stresses on the top
    border: Border  # border between stick and slip
    samples: list[Points]  # centres of cells and points below, at peaks, then along the contact; may be empty
    peak_width: float  # least width of the peaks of the pressure, metres; infinite without pressure

    @property
    def shallowest(self) -> float:
        """Least depth below the top among the points, metres."""
        return min(float(points.z[1]) for points in self.samples)

    def cells(self, points: Points) -> tuple[IntArray, IntArray]:
        """Return indices of the columns and rows of the cells nearest to points."""
        columns, rows = (
            np.abs(centres - axis[:, None]).argmin(axis=1)
            for axis, centres in ((points.x, self.grid.x), (points.y, self.grid.y))
        )
        return columns, rows

    def inside_rim_at(self, points: Points) -> BoolArray:
        """Whether the cells nearest to points are off the rim: array (x, y)."""
        return np.asarray(self.inside_rim[np.ix_(*self.cells(points))])

    def top_stresses(self, points: Points, stresses: FloatArray) -> FloatArray:
        """Stresses (6, x, y, 1) at centres of cells on the top, at the border in the representing cells."""
        columns, rows = np.ix_(*self.cells(points))
        corrected_stresses, rise = stresses.copy(), self.border.rise[columns, rows, None]
        corrected_stresses[:3] -= self.border.pressure_stresses[:, None, None, None] * rise
        represents, traction = self.border.represents[columns, rows, None], self.border.traction[:, columns, rows, None]
        corrected_stresses[4:] = np.where(represents, -traction, corrected_stresses[4:])
        return corrected_stresses


def place_search(body: Body, loads: Loads, grid: Grid, roller: Material | None = None) -> Search:
    """Points of the search, which do not depend on the friction; without `roller` the roller is rigid."""
    extent, pressure = body.extent, loads[Load.NORMAL].values
    column_maxima = pressure.max(axis=1)
    # The body ends at the outermost columns.
    inside_rim = np.asarray(scipy.ndimage.binary_erosion(pressure > 0, iterations=RIM_CELLS, border_value=1))
    border = Border(loads, (body.material, roller), inside_rim)
    if not column_maxima.any():
        return Search(grid, extent, inside_rim, border, samples=[], peak_width=np.inf)
    samples: list[Points] = []
    widths: list[float] = []
    is_symmetric = bool(  # about the middle of the window, up to errors of the solver
        np.isinf(extent[0]) == np.isinf(extent[1])
        and grid.is_symmetric
        and all(
            np.allclose(
                load.cell_loads, kind.sign_x * load.cell_loads[::-1], rtol=0, atol=1e-4 * np.abs(load.cell_loads).max()
            )
            for kind, load in loads.items()
        )
    )

    def nearest_cells(x: FloatArray, column: int, depths: FloatArray, spacing: float) -> Points:
        """Points at cells nearest to `x`, more than `spacing` apart, across a loaded column."""
        section = pressure[column]
        y = (section * grid.y).sum() / section.sum() + 0.5 * grid.dy * np.count_nonzero(section) * LATERAL_OFFSETS
        columns = np.unique(np.abs(grid.x - x[:, None]).argmin(axis=1))
        # The outermost rows off the rim are included: with friction the stress on the top may grow towards the rim.
        inner_rows = np.flatnonzero(inside_rim[columns].any(axis=0))
        candidates = inner_rows if inner_rows.size else np.arange(grid.cells_y)
        nearest_rows = candidates[np.abs(grid.y[candidates] - y[:, None]).argmin(axis=1)]
        rows = np.union1d(nearest_rows, np.flatnonzero(border.represents[column]))
        centres = grid.x[columns]
        return Points(centres[select_separated(centres, spacing)], grid.y[rows], np.append(0.0, depths))

    for peak in _peaks(column_maxima, symmetric=is_symmetric):
        width = min(variation_lengths(pressure, grid.x, grid.dy, peak, rising=False))
        widths.append(width)
        if not any(abs(grid.x[peak] - points.x).min() < 0.2 * width for points in samples):
            x = np.clip(grid.x[peak] + width * AXIAL_OFFSETS, *extent)
            samples.append(nearest_cells(x, peak, width * PEAK_DEPTHS, spacing=0.1 * width))
    column = int(column_maxima.argmax())
    half_width = 0.5 * grid.dy * np.count_nonzero(pressure[column])
    columns = np.flatnonzero(pressure.any(axis=1))
    first_edge, last_edge = grid.x_edges[columns[0]], grid.x_edges[columns[-1] + 1]
    distances = np.append(half_width * END_DISTANCES, 0.5 * (last_edge - first_edge))
    distances = distances[distances <= 0.5 * (last_edge - first_edge)]
    # By symmetry one point of the second half suffices: the middle is inside the range.
    x = np.concatenate([first_edge + distances, last_edge - (distances[-2:-1] if is_symmetric else distances)])
    samples.append(nearest_cells(x, column, half_width * AXIS_DEPTHS, spacing=0.1 * half_width))
    return Search(grid, extent, inside_rim, border, samples=samples, peak_width=min(widths))


def select_separated(positions: FloatArray, spacing: float) -> IntArray:
    """Return indices of ascending positions more than `spacing` apart: polynomials through closer points oscillate."""
    indices: list[int] = []
    for index in np.argsort(positions, kind="stable").tolist():
        if not indices or positions[index] - positions[indices[-1]] > spacing:
            indices.append(index)
    return np.array(indices)


def _peaks(maxima: FloatArray, *, symmetric: bool) -> list[int]:
    """Columns of the largest pressure in each half, the larger first; in the first half alone if symmetric."""
    middle = (maxima.size + 1) // 2
    peaks = [int(maxima[:middle].argmax())]
    if not symmetric and maxima.size > 1:
        peaks.append(middle + int(maxima[middle:].argmax()))
    high_peaks = [peak for peak in peaks if maxima[peak] >= MIN_SECOND_PEAK * maxima.max()]
    return sorted(high_peaks, key=lambda peak: -maxima[peak])


RISE_ERROR = 0.25  # Least error over a polynomial's rise above the samples: two may agree by chance. Accuracy.
REFINEMENT_TOLERANCE = 3e-3  # relative error of the interpolation that ends the refinement. Accuracy.
LOCAL_OFFSETS = np.array([-0.5, -0.25, 0.0, 0.25, 0.5])  # about a position, over its depth. Accuracy.
TOP_MARGIN = 1.25  # factor on the largest sample on the top for the decision to search around it. Accuracy.
MAX_REFINEMENTS = 6  # largest number of refinements. Speed.


class StressMaximum(NamedTuple):
    """Largest value of the von Mises stress."""

    value: float  # value, Pa, and error: the difference of polynomials of two degrees, or the top cells' error
    error: float
    position: tuple[float, float, float]  # x, y and z, metres


VALUE = attrgetter("value")


class _SampleMaximum(NamedTuple):
    """The largest value among points and between points, and the indices of the largest point."""

    maximum: StressMaximum
    points: Points
    indices: tuple[int, ...]


def find_stress_maximum(
    search: Search, stresses: Sequence[FloatArray], stress_at: Callable[[Points], FloatArray]
) -> StressMaximum:
    """Return the largest von Mises stress; without pressure the value is 0 and the position NaN."""
    if not search.samples:
        return StressMaximum(0.0, 0.0, (np.nan, np.nan, np.nan))
    samples = list(zip(search.samples, stresses, strict=True))
    *peaks, axis_samples = [(points._replace(z=points.z[1:]), field[..., 1:]) for points, field in samples]
    maximum = max((_refine_maximum(_maximum_between_samples(*peak), search, stress_at) for peak in peaks), key=VALUE)
    axis_sample = _maximum_of_samples(*axis_samples)
    if axis_sample.maximum.value > maximum.value:
        maximum = max(maximum, _refine_maximum(axis_sample, search, stress_at), key=VALUE)
    for points, field in samples:
        top = search.top_stresses(points, field[..., :1])
        sample = _maximum_of_samples(points._replace(z=points.z[:1]), top, search.inside_rim_at(points))
        if sample.maximum.value * TOP_MARGIN > maximum.value:
            lower, maximum = sorted((_top_maximum(sample, search, stress_at), maximum), key=VALUE)
            maximum = maximum._replace(error=max(maximum.error, lower.value + lower.error - maximum.value))
    return maximum


def include_points(
    maximum: StressMaximum,
    points: Points,
    stresses: FloatArray,
    search: Search,
    stress_at: Callable[[Points], FloatArray],
) -> StressMaximum:
    """Return the largest von Mises stress, also around any of the `points` whose stress exceeds `maximum`."""
    if not search.samples:
        return maximum
    is_deep = points.z >= search.shallowest
    depth_groups = [is_deep] if is_deep.any() else []
    depth_groups += [points.z == depth for depth in points.z[~is_deep]]
    for is_in_group in depth_groups:
        group = points._replace(z=points.z[is_in_group])
        inside_rim = None if is_in_group is is_deep else search.inside_rim_at(group)
        sample = _maximum_of_samples(group, stresses[..., is_in_group], inside_rim)
        value, position = sample.maximum.value, sample.maximum.position
        if maximum.value < value <= maximum.value + maximum.error:
            maximum = maximum._replace(value=value, position=position)
        elif value > maximum.value and is_in_group is is_deep:
            neighbourhood = _neighbourhood(position, search)
            maximum = _refine_maximum(
                _maximum_between_samples(neighbourhood, stress_at(neighbourhood)), search, stress_at
            )
            if maximum.value < value:
                maximum = StressMaximum(value, maximum.error + value - maximum.value, position)
        elif value > maximum.value:
            maximum = max(maximum, _top_maximum(sample, search, stress_at), key=VALUE)
    return maximum


def _neighbourhood(position: tuple[float, float, float], search: Search) -> Points:
    """Points about a position; their distances along y are whole cells."""
    x, y, z = position
    dy = search.grid.dy
    axial = np.clip(x + z * LOCAL_OFFSETS, *search.extent)
    depths = np.maximum(z * (1 + LOCAL_OFFSETS), search.shallowest)
    rows = np.unique([*np.round(z * LOCAL_OFFSETS / dy), -1, 1])
    return Points(axial[select_separated(axial, 0.1 * z)], y + dy * rows, depths[select_separated(depths, 0.1 * z)])


def _top_maximum(sample: _SampleMaximum, search: Search, stress_at: Callable[[Points], FloatArray]) -> StressMaximum:
    """Largest value at the centres of cells: the search follows larger neighbours from the largest sample on."""
    grid = search.grid
    for _ in range(MAX_REFINEMENTS):
        previous_value = sample.maximum.value
        columns, rows = (
            _neighbour_cells(cells, index, count)
            for cells, index, count in zip(search.cells(sample.points), sample.indices, grid.shape, strict=False)
        )
        centres = Points(grid.x[columns], grid.y[rows], sample.points.z)
        stresses = search.top_stresses(centres, stress_at(centres))
        sample = _maximum_of_samples(centres, stresses, search.inside_rim[np.ix_(columns, rows)])
        if sample.maximum.value <= previous_value * (1 + REFINEMENT_TOLERANCE):
            break
    # The stress may grow towards the rim; along y it falls on either side of a border between stick and slip.
    values, inside_rim = von_mises_of(*stresses)[..., 0], search.inside_rim_at(centres)
    column, row, _ = sample.indices
    cell = columns[column], rows[row]
    error = float(np.hypot(TOP_ERROR * sample.maximum.value, search.border.error[cell]))
    for line_values, is_inside, index in (
        (values[:, row], inside_rim[:, row], column),
        (values[column], inside_rim[column] | search.border.represents[cell], row),
    ):
        neighbours = slice(max(index - 1, 0), index + 2)
        if not is_inside[neighbours].all():
            error = max(error, (RIM_CELLS + 1) * float(np.ptp(line_values[neighbours][is_inside[neighbours]])))
    return sample.maximum._replace(error=error)


def _neighbour_cells(cells: IntArray, index: int, count: int) -> IntArray:
    """Return indices of cells from the previous to the next entry of a sampled cell, with the adjacent cells."""
    cell, distinct_cells = int(cells[index]), np.unique(cells)
    position = int(np.searchsorted(distinct_cells, cell))
    neighbours = distinct_cells[max(position - 1, 0) : position + 2]
    spaced_cells = np.linspace(neighbours[0], neighbours[-1], 5).round().astype(np.int64)
    return np.unique(np.clip([*spaced_cells, cell - 1, cell, cell + 1], 0, count - 1))


def _refine_maximum(sample: _SampleMaximum, search: Search, stress_at: Callable[[Points], FloatArray]) -> StressMaximum:
    """Refine points about the largest value until polynomials of two degrees agree."""
    change = 0.0
    for _ in range(MAX_REFINEMENTS):
        points, is_inside = _closer_points(sample, search)
        if is_inside and sample.maximum.error <= REFINEMENT_TOLERANCE * sample.maximum.value:
            break
        next_sample = _maximum_between_samples(points, stress_at(points))
        change = abs(next_sample.maximum.value - sample.maximum.value)
        if next_sample.maximum.value < sample.maximum.value and not is_inside:
            return _evaluate_at_maximum(sample, change, stress_at)
        sample = next_sample
    else:
        return _evaluate_at_maximum(sample, max(change, sample.maximum.error), stress_at)
    if sample.maximum.position[2] <= search.shallowest * (1 + 1e-9):
        return sample.maximum._replace(error=max(sample.maximum.error, TOP_ERROR * sample.maximum.value))
    return sample.maximum


def _evaluate_at_maximum(
    sample: _SampleMaximum, error: float, stress_at: Callable[[Points], FloatArray]
) -> StressMaximum:
    """Evaluate the stress at a maximum of polynomials that may overshoot, at an edge or without agreement."""
    sample_position = [axis[index] for axis, index in zip(sample.points, sample.indices, strict=True)]
    corners = Points(*(np.unique(ends) for ends in zip(sample.maximum.position, sample_position, strict=True)))
    maximum = _maximum_of_samples(corners, stress_at(corners)).maximum
    return maximum._replace(error=max(error, abs(sample.maximum.value - maximum.value)))


def _maximum_of_samples(points: Points, stresses: FloatArray, selection: BoolArray | None = None) -> _SampleMaximum:
    """Largest value among the points of a `selection` (x, y), without interpolation."""
    values = von_mises_of(*stresses)
    if selection is not None:
        values = np.where(selection[..., None], values, 0.0)
    index = np.unravel_index(int(values.argmax()), values.shape)
    x, y, z = (float(axis[int(axis_index)]) for axis, axis_index in zip(points, index, strict=True))
    return _SampleMaximum(
        StressMaximum(float(values[index]), np.inf, (x, y, z)), points, tuple(int(axis_index) for axis_index in index)
    )


def _maximum_between_samples(points: Points, stresses: FloatArray) -> _SampleMaximum:
    """Largest value between points, from polynomials through the stress components."""
    sample = _maximum_of_samples(points, stresses)
    fine, coarse = (
        _maximum_of_samples(Points(*axes), components).maximum
        for axes, components in (interpolate_about(points, sample.indices, stresses, count) for count in (2, 1))
    )
    error = max(abs(fine.value - coarse.value), RISE_ERROR * (fine.value - sample.maximum.value))
    return sample._replace(maximum=fine._replace(error=error))


def _closer_points(sample: _SampleMaximum, search: Search) -> tuple[Points, bool]:
    """Return closer points around the largest point, shifted if it is outermost, and whether it lies inside."""
    axes, is_inside = [], True
    limits = (search.extent, (-np.inf, np.inf), (search.shallowest, np.inf))
    for axis, index, (low, high) in zip(sample.points, sample.indices, limits, strict=True):
        centre = axis[index]
        previous_position, next_position = axis[max(index - 1, 0)], axis[min(index + 1, axis.size - 1)]
        is_outermost = axis.size > 1 and bool(
            (index == 0 and centre > low) or (index == axis.size - 1 and centre < high)
        )
        is_inside = is_inside and not is_outermost
        shift = 2 * (next_position - previous_position) if is_outermost else 0.0
        start, stop = max(min(previous_position, centre - shift), low), min(max(next_position, centre + shift), high)
        axes.append(np.linspace(start, stop, 5) if axis.size > 1 else axis)
    return Points(*axes), is_inside
