"""The largest von Mises stress in a body.

The largest stress lies below a peak of the pressure, at a depth proportional to the width of the peak (some hundredths
of a half-width for an edge radius), near a free end, or on the top, with much friction and where the contact reaches an
end. The search evaluates points around the peaks and along the contact, and refines them about the largest values until
polynomials of two degrees agree. On the top it evaluates the centres of cells inside the contact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from contactstudy.arrays.grid import TOP_ERROR, Grid
from contactstudy.arrays.peaks import interpolate_about, peak_width
from contactstudy.arrays.points import Points
from contactstudy.bodies.models import Body, Extent
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.fields.loads import Loads
from contactstudy.kernels.load import Load
from contactstudy.stress import von_mises_of

AXIAL_OFFSETS = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])  # points along x around a peak, over its width

DEPTHS = np.array([0.1, 0.2, 0.32, 0.48, 0.66, 0.9, 1.3])
"""Depths below a peak, over its width: the largest stress under a line contact is at 0.70, under a sphere at 0.48."""

END_DISTANCES = np.array([0.0, 0.2, 0.45, 0.7, 1.0, 1.4, 2.0, 3.2, 6.0, 12.0, 20.0])
"""Distances of points on the axis from the ends of the contact, over the half-width."""

LATERAL_OFFSETS = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])  # points along y, over the half-width of the section
AXIS_DEPTHS = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 1.0])  # depths below the axis, over the half-width

MIN_SECOND_PEAK = 0.6
"""Least peak of a half of the contact that is searched, over the largest: at a free end a lower peak may cause more."""

SLIP_TOLERANCE = 1e-6  # tolerance of the traction of a slipping cell, over its bound
RIM_CELLS = 2  # cells at the rim of the contact without accurate stresses on the top. Accuracy.


class Border(NamedTuple):
    """Border between stick and slip on the top, where the stress has a cusp between the centres of cells."""

    # The second sticking cell from the border represents it: the values of the first one are too smooth.

    traction: FloatArray  # (2, x, y): tractions of the cells, at the border in the representing cells, Pa
    rise: FloatArray  # (x, y): pressure at the border less that of the cell that represents it, Pa; otherwise 0
    poisson: float  # Poisson's ratio of the body

    @classmethod
    def of_loads(cls, loads: Loads, poisson: float) -> Border:
        """Border of the sticking cells under loads: inside it the traction is below its bound like a square root."""
        pressure = loads[Load.NORMAL].values
        zero = np.zeros_like(pressure)
        traction = np.stack([loads[load].values if load in loads else zero for load in (Load.ALONG_X, Load.ALONG_Y)])
        rise = np.zeros_like(pressure)
        ratio = traction / np.where(pressure > 0, pressure, 1.0)
        size = np.hypot(*ratio)
        bound = size.max(axis=1, keepdims=True)
        deficit = 1 - size / np.where(bound > 0, bound, 1.0)
        is_sticking = (pressure > 0) & (deficit > SLIP_TOLERANCE) & (bound > 0)
        for step in (1, -1):
            is_slipping = np.roll((pressure > 0) & ~is_sticking, step, axis=1)
            column, first = np.nonzero(is_sticking & is_slipping & np.roll(is_sticking, -step, axis=1))
            second, slipping = first + step, first - step
            squares = deficit[column, first] ** 2, deficit[column, second] ** 2
            distance = np.clip(squares[0] / np.maximum(squares[1] - squares[0], 1e-300), 0.0, 1.0)
            at_border = (1 - distance) * pressure[column, first] + distance * pressure[column, slipping]
            traction[:, column, second] = at_border * ratio[:, column, slipping]
            rise[column, second] = at_border - pressure[column, second]
        return cls(traction, rise, poisson)


class Search(NamedTuple):
    """Points of the search for the largest stress."""

    grid: Grid
    extent: Extent  # ends of the body, metres
    inside_rim: BoolArray  # (x, y): cells inside the contact with accurate stresses on the top
    border: Border  # border between stick and slip
    samples: list[Points]
    """Centres of cells on the top and points below: about the peaks, then along the contact. Empty without pressure."""

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
        corrected, rise = stresses.copy(), self.border.rise[columns, rows, None]
        corrected[:3] -= np.array([2 * self.border.poisson, 1.0, 1.0])[:, None, None, None] * rise
        corrected[4:] = np.where(rise != 0, -self.border.traction[:, columns, rows, None], corrected[4:])
        return corrected


def place_search(body: Body, loads: Loads, grid: Grid) -> Search:
    """Points of the search; they do not depend on the friction."""
    extent, border = body.extent, Border.of_loads(loads, body.material.poisson)
    pressure = loads[Load.NORMAL].values
    maxima = pressure.max(axis=1)
    # The body ends at the outermost columns.
    inside_rim = np.asarray(ndimage.binary_erosion(pressure > 0, iterations=RIM_CELLS, border_value=1))
    if not maxima.any():
        return Search(grid, extent, inside_rim, border, [])
    samples: list[Points] = []
    symmetric = bool(  # about the middle of the window, up to errors of the solver
        np.isinf(extent[0]) == np.isinf(extent[1])
        and np.allclose(grid.widths, grid.widths[::-1])
        and all(
            np.allclose(load.cells, kind.sign_x * load.cells[::-1], rtol=0, atol=1e-4 * np.abs(load.cells).max())
            for kind, load in loads.items()
        )
    )
    for peak in _peaks(maxima, symmetric=symmetric):
        width = peak_width(pressure, grid.x, grid.dy, peak)
        if not any(abs(grid.x[peak] - points.x).min() < 0.2 * width for points in samples):
            x = np.clip(grid.x[peak] + width * AXIAL_OFFSETS, *extent)
            samples.append(_nearest_cells(grid, inside_rim, x, pressure[peak], width * DEPTHS, spacing=0.1 * width))
    section = pressure[int(maxima.argmax())]
    half_width = 0.5 * grid.dy * np.count_nonzero(section)
    columns = np.flatnonzero(pressure.any(axis=1))
    first, last = grid.x_edges[columns[0]], grid.x_edges[columns[-1] + 1]
    distances = np.append(half_width * END_DISTANCES, 0.5 * (last - first))
    distances = distances[distances <= 0.5 * (last - first)]
    # One point of the second half: the middle is inside the range.
    x = np.concatenate([first + distances, last - (distances[-2:-1] if symmetric else distances)])
    depths = half_width * AXIS_DEPTHS
    samples.append(_nearest_cells(grid, inside_rim, x, section, depths, spacing=0.1 * half_width))
    return Search(grid, extent, inside_rim, border, samples)


def _nearest_cells(
    grid: Grid, inside_rim: BoolArray, x: FloatArray, section: FloatArray, depths: FloatArray, spacing: float
) -> Points:
    """Centres of the cells nearest to positions, more than `spacing` apart, across a pressed section, and below."""
    y = (section * grid.y).sum() / section.sum() + 0.5 * grid.dy * np.count_nonzero(section) * LATERAL_OFFSETS
    columns = np.unique(np.abs(grid.x - x[:, None]).argmin(axis=1))
    # The outermost rows off the rim are included: with friction the stress on the top may grow towards the rim.
    inner_rows = np.flatnonzero(inside_rim[columns].any(axis=0))
    candidates = inner_rows if inner_rows.size else np.arange(grid.cells_y)
    rows = candidates[np.unique(np.abs(grid.y[candidates] - y[:, None]).argmin(axis=1))]
    centres = grid.x[columns]
    return Points(centres[select_separated(centres, spacing)], grid.y[rows], np.append(0.0, depths))


def select_separated(positions: FloatArray, spacing: float) -> IntArray:
    """Return indices of ascending positions more than `spacing` apart: polynomials through closer points oscillate."""
    indices: list[int] = []
    for index in np.argsort(positions, kind="stable").tolist():
        if not indices or positions[index] - positions[indices[-1]] > spacing:
            indices.append(index)
    return np.array(indices)


def _peaks(maxima: FloatArray, *, symmetric: bool) -> Iterator[int]:
    """Columns of the largest pressure of either half; of the first half of a symmetric contact."""
    half = (maxima.size + 1) // 2
    first, last = int(maxima[:half].argmax()), half + int(maxima[half:].argmax()) if maxima.size > 1 else 0
    for peak in (first,) if symmetric else (first, last) if maxima[first] >= maxima[last] else (last, first):
        if maxima[peak] >= MIN_SECOND_PEAK * maxima.max():
            yield peak


RISE_ERROR = 0.25
"""Error over the rise of the polynomials above the largest sample: two degrees may agree by chance. Accuracy."""

TOLERANCE = 3e-3  # relative error of the interpolation that ends the refinement. Accuracy.

LOCAL_OFFSETS = np.array([-0.5, -0.25, 0.0, 0.25, 0.5])
"""Points about a position below the top, over its depth, the distance from the load. Accuracy."""

TOP_MARGIN = 1.25  # factor on the largest sampled cell on the top that starts a search beside it. Accuracy.
MAX_REFINEMENTS = 6  # largest number of refinements. Speed.


class StressMaximum(NamedTuple):
    """Largest value of the von Mises stress."""

    value: float  # the value, Pa, and the difference of polynomials of two degrees; on the top the error of the cells
    error: float
    position: tuple[float, float, float]  # x, y and z, metres


class _SampleMaximum(NamedTuple):
    """The largest value among points and between them, and the indices of the largest point."""

    largest: StressMaximum
    points: Points
    indices: tuple[int, ...]


def find_stress_maximum(
    search: Search,
    stresses: Sequence[FloatArray],
    stress: Callable[[Points], FloatArray],
) -> StressMaximum:
    """Largest von Mises stress; 0 at NaN without pressure."""
    if not search.samples:
        return StressMaximum(0.0, 0.0, (np.nan, np.nan, np.nan))
    samples = list(zip(search.samples, stresses, strict=True))
    *peaks, axis = [(points._replace(z=points.z[1:]), field[..., 1:]) for points, field in samples]
    largest = _select_largest(_refine_maximum(_maximum_between_samples(*peak), search, stress) for peak in peaks)
    axis_sample = _maximum_of_samples(*axis)
    if axis_sample.largest.value > largest.value:
        largest = _select_largest([largest, _refine_maximum(axis_sample, search, stress)])
    for points, field in samples:
        top = search.top_stresses(points, field[..., :1])
        sample = _maximum_of_samples(points._replace(z=points.z[:1]), top, search.inside_rim_at(points))
        if sample.largest.value * TOP_MARGIN > largest.value:
            largest = _select_largest([largest, _top_maximum(sample, search, stress)])
    return largest


def include_points(
    largest: StressMaximum, points: Points, stresses: FloatArray, search: Search, stress: Callable[[Points], FloatArray]
) -> StressMaximum:
    """Largest von Mises stress, and of the neighbourhood of points with a larger stress."""
    if not search.samples:
        return largest
    is_deep = points.z >= search.shallowest
    depth_groups = [is_deep] if is_deep.any() else []
    depth_groups += [points.z == depth for depth in points.z[~is_deep]]
    for depths in depth_groups:
        group = points._replace(z=points.z[depths])
        inside_rim = None if depths is is_deep else search.inside_rim_at(group)
        sample = _maximum_of_samples(group, stresses[..., depths], inside_rim)
        value, position = sample.largest.value, sample.largest.position
        if largest.value < value <= largest.value + largest.error:
            largest = largest._replace(value=value, position=position)
        elif value > largest.value and depths is is_deep:
            neighbourhood = _neighbourhood(position, search)
            largest = _refine_maximum(_maximum_between_samples(neighbourhood, stress(neighbourhood)), search, stress)
            if largest.value < value:
                largest = StressMaximum(value, largest.error + value - largest.value, position)
        elif value > largest.value:
            largest = _select_largest([largest, _top_maximum(sample, search, stress)])
    return largest


def _neighbourhood(position: tuple[float, float, float], search: Search) -> Points:
    """Points about a position; their distances along y are whole cells."""
    x, y, z = position
    dy = search.grid.dy
    axial = np.clip(x + z * LOCAL_OFFSETS, *search.extent)
    depths = np.maximum(z * (1 + LOCAL_OFFSETS), search.shallowest)
    rows = np.unique([*np.round(z * LOCAL_OFFSETS / dy), -1, 1])
    return Points(axial[select_separated(axial, 0.1 * z)], y + dy * rows, depths[select_separated(depths, 0.1 * z)])


def _select_largest(candidates: Iterable[StressMaximum]) -> StressMaximum:
    """Return the candidate with the largest value."""
    return max(candidates, key=lambda candidate: candidate.value)


def _top_maximum(sample: _SampleMaximum, search: Search, stress: Callable[[Points], FloatArray]) -> StressMaximum:
    """Largest value at the centres of cells: the search follows larger neighbours from the largest sample on."""
    grid = search.grid
    for _ in range(MAX_REFINEMENTS):
        previous_value = sample.largest.value
        columns, rows = (
            _neighbour_cells(cells, index, count)
            for cells, index, count in zip(search.cells(sample.points), sample.indices, grid.shape, strict=False)
        )
        centres = Points(grid.x[columns], grid.y[rows], sample.points.z)
        stresses = search.top_stresses(centres, stress(centres))
        sample = _maximum_of_samples(centres, stresses, search.inside_rim[np.ix_(columns, rows)])
        if sample.largest.value <= previous_value * (1 + TOLERANCE):
            break
    # The stress may grow towards the rim.
    values, mask, (column, row, _) = (
        von_mises_of(*stresses)[..., 0],
        search.inside_rim_at(centres),
        sample.indices,
    )
    error = TOP_ERROR * sample.largest.value
    for line, inner, index in (
        (values[:, row], mask[:, row], column),
        (values[column], mask[column], row),
    ):
        near = slice(max(index - 1, 0), index + 2)
        if not inner[near].all():
            error = max(error, (RIM_CELLS + 1) * float(np.ptp(line[near][inner[near]])))
    return sample.largest._replace(error=error)


def _neighbour_cells(cells: IntArray, index: int, count: int) -> IntArray:
    """Return indices of cells between the neighbours of a cell in a list, with the adjacent cells."""
    cell, listed = int(cells[index]), np.unique(cells)
    number = int(np.searchsorted(listed, cell))
    before, after = listed[max(number - 1, 0)], listed[min(number + 1, listed.size - 1)]
    between = np.linspace(before, after, 5).round().astype(np.int64)
    return np.unique(np.clip([*between, cell - 1, cell, cell + 1], 0, count - 1))


def _refine_maximum(top: _SampleMaximum, search: Search, stress: Callable[[Points], FloatArray]) -> StressMaximum:
    """Refine points about the largest value until polynomials of two degrees agree."""
    change = 0.0
    for _ in range(MAX_REFINEMENTS):
        points, inside = _closer_points(top, search)
        if inside and top.largest.error <= TOLERANCE * top.largest.value:
            break
        next_top = _maximum_between_samples(points, stress(points))
        change = abs(next_top.largest.value - top.largest.value)
        if next_top.largest.value < top.largest.value and not inside:
            return _evaluate_at_maximum(top, change, stress)
        top = next_top
    else:
        return _evaluate_at_maximum(top, max(change, top.largest.error), stress)
    if top.largest.position[2] <= search.shallowest * (1 + 1e-9):
        return top.largest._replace(error=max(top.largest.error, TOP_ERROR * top.largest.value))
    return top.largest


def _evaluate_at_maximum(top: _SampleMaximum, error: float, stress: Callable[[Points], FloatArray]) -> StressMaximum:
    """Largest stress itself about a value of polynomials that may overshoot: they end at an edge, or do not agree."""
    sampled = [axis[number] for axis, number in zip(top.points, top.indices, strict=True)]
    corners = Points(*(np.unique(pair) for pair in zip(top.largest.position, sampled, strict=True)))
    largest = _maximum_of_samples(corners, stress(corners)).largest
    return largest._replace(error=max(error, abs(top.largest.value - largest.value)))


def _maximum_of_samples(points: Points, stresses: FloatArray, selection: BoolArray | None = None) -> _SampleMaximum:
    """Largest value among the points of a `selection` (x, y), without interpolation."""
    values = von_mises_of(*stresses)
    if selection is not None:
        values = np.where(selection[..., None], values, 0.0)
    index = np.unravel_index(int(values.argmax()), values.shape)
    x, y, z = (float(axis[int(number)]) for axis, number in zip(points, index, strict=True))
    return _SampleMaximum(
        StressMaximum(float(values[index]), np.inf, (x, y, z)), points, tuple(int(number) for number in index)
    )


def _maximum_between_samples(points: Points, stresses: FloatArray) -> _SampleMaximum:
    """Largest value between points, of polynomials through the components."""
    sample = _maximum_of_samples(points, stresses)
    (value, position), (rough, _) = (
        _interpolate(points, stresses, sample.indices, neighbours) for neighbours in (2, 1)
    )
    error = max(abs(value - rough), RISE_ERROR * (value - sample.largest.value))
    return sample._replace(largest=StressMaximum(value, error, position))


def _interpolate(
    points: Points, stresses: FloatArray, index: tuple[int, ...], neighbours: int
) -> tuple[float, tuple[float, float, float]]:
    """Largest value, and its position, of polynomials through `neighbours` points on either side of a point."""
    axes, values = interpolate_about(points, index, stresses, neighbours)
    von_mises = von_mises_of(*values)
    best = np.unravel_index(int(von_mises.argmax()), von_mises.shape)
    x, y, z = (float(axis[number]) for axis, number in zip(axes, best, strict=True))
    return float(von_mises[best]), (x, y, z)


def _closer_points(top: _SampleMaximum, search: Search) -> tuple[Points, bool]:
    """Closer points around the largest one; beyond an edge of the range, shifted points at equal spacing."""
    axes, inside = [], True
    limits = (search.extent, (-np.inf, np.inf), (search.shallowest, np.inf))
    for axis, index, (low, high) in zip(top.points, top.indices, limits, strict=True):
        centre = axis[index]
        before, after = axis[max(index - 1, 0)], axis[min(index + 1, axis.size - 1)]
        outermost = axis.size > 1 and bool((index == 0 and centre > low) or (index == axis.size - 1 and centre < high))
        inside = inside and not outermost
        reach = 2 * (after - before) if outermost else 0.0
        start, stop = max(min(before, centre - reach), low), min(max(after, centre + reach), high)
        axes.append(np.linspace(start, stop, 5) if axis.size > 1 else axis)
    return Points(*axes), inside
