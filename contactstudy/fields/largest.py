"""The largest von Mises stress in a body, wherever its stresses are asked for.

It lies below a peak of the pressure, at a depth that goes with the peak's width: for an edge radius some hundredths of
a half-width, between any usual depths. Or it lies near a free end, where less pressure does more. So points are laid
around the peaks and along the contact, and laid again more closely around the largest values until polynomials
through them agree. With much friction it lies on the top. There stresses are known at the centres of cells inside the
contact; on the rim they show the cells.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.between import refined
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.invariants import von_mises_of
from contactstudy.arrays.peak_width import peak_width
from contactstudy.bodies.models import Extent
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.fields.loads import Loads
from contactstudy.kernels.load import Load
from contactstudy.overlapping.field import Place

BESIDE = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
"""Points along x and y around a peak, over its width and its half-width across."""

BELOW = np.array([0.1, 0.2, 0.32, 0.48, 0.66, 0.9, 1.3])
"""Depths, over the width: the largest stress under a line contact is at 0.70, under a round one at 0.48."""

ALONG = np.array([0.2, 0.45, 0.7, 1.0, 1.4, 2.0, 3.2, 6.0, 12.0, 20.0])
"""Distances from the ends of the contact at which it is looked at along the axis, over the half-width."""

ACROSS = np.array([-0.4, 0.0, 0.4])
"""Points across it, likewise."""

DEEP = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 1.0])
"""Depths, likewise."""

HIGH = 0.6
"""Share of the largest pressure from which on the other half's peak is looked at: at a free end it may do more."""

RIM = 2
"""Cells at the rim of the contact whose stresses on the top are not looked at. Accuracy."""

ON_TOP = 0.02
"""Relative error of stresses on the top under a solved pressure, see the page on limits. Accuracy."""

BETWEEN = 0.25
"""Share of what polynomials add to the largest point that counts as their error: two degrees may agree by chance."""

SETTLED = 3e-3
"""Relative error of the interpolation at which points are close enough."""

CLOSEST = 1e-3
"""Distance of points that a user asks for, over their range, from which on polynomials go through them."""

MOST = 6
"""Times that points are laid anew."""


class Largest(NamedTuple):
    """Largest value of the von Mises stress.

    Attributes
    ----------
    value, error : float
        The value, Pa, and by how much polynomials of two degrees differ; on the top what cells may make of it.
    place : tuple of float
        Where it is: x, y and z, metres.
    """

    value: float
    error: float
    place: tuple[float, float, float]


class _Top(NamedTuple):
    """The largest value among some points and between them; `at`: number of the largest point along each axis."""

    found: Largest
    points: Place
    at: tuple[int, ...]


def points_looked_at(loads: Loads, grid: Grid, extent: Extent) -> list[Place]:
    """Points among which the largest stress is looked for; none without pressure. They do not depend on the friction.

    They lie below the top, but for centres of cells inside the contact, which are places of their own.
    """
    pressure = loads[Load.NORMAL].values
    line = pressure.max(axis=1)
    found: list[Place] = []
    if not line.any():
        return found
    alike = _mirrored(loads, grid, extent)
    for peak in _peaks(line, alike=alike):
        middle, half_width = _across(pressure[peak], grid)
        width = peak_width(pressure, grid.x, grid.dy, peak)
        if any(abs(grid.x[peak] - other.x).min() < 0.2 * width for other in found):
            continue
        x, y = grid.x[peak] + width * BESIDE, middle + half_width * BESIDE
        inside = np.clip(x, *extent)
        below = Place(inside[_apart(inside, 0.1 * width)], y, width * BELOW)
        found += [below, *_on_top(pressure, grid, peak, x, y)]
    return [*found, _along(pressure, grid, alike=alike)]


def _across(pressure: FloatArray, grid: Grid) -> tuple[float, float]:
    """Middle and half-width of a contact across one column, metres."""
    return float((pressure * grid.y).sum() / pressure.sum()), 0.5 * grid.dy * np.count_nonzero(pressure)


def _along(pressure: FloatArray, grid: Grid, *, alike: bool) -> Place:
    """Points from the ends of a contact to its middle, on one half of it and beside it only if both are alike."""
    columns = np.flatnonzero(pressure.any(axis=1))
    first, last = grid.x_edges[columns[0]], grid.x_edges[columns[-1] + 1]
    middle, half_width = _across(pressure[int(pressure.max(axis=1).argmax())], grid)
    inside = np.append(half_width * ALONG, 0.5 * (last - first))
    inside = inside[inside <= 0.5 * (last - first)]
    # Of two halves that are alike one point of the other, so that the middle is not at the edge.
    x = np.concatenate([first + inside, last - (inside[-2:-1] if alike else inside)])
    return Place(x[_apart(x, 0.1 * half_width)], middle + half_width * ACROSS, half_width * DEEP)


def _apart(positions: FloatArray, least: float) -> IntArray:
    """Numbers of positions in order, without those too close to the one before: polynomials through these are wild."""
    kept: list[int] = []
    for number in np.argsort(positions, kind="stable").tolist():
        if not kept or positions[number] - positions[kept[-1]] > least:
            kept.append(number)
    return np.array(kept)


def _on_top(pressure: FloatArray, grid: Grid, peak: int, x: FloatArray, y: FloatArray) -> list[Place]:
    """Centres of the cells nearest to some positions, off the rim; none if the contact is all rim."""
    loaded: BoolArray = np.asarray(pressure > 0)
    columns = _nearest(grid.x, x, _off_rim(np.asarray(loaded.any(axis=1)), peak))
    rows = _nearest(grid.y, y, _off_rim(np.asarray(loaded[columns].all(axis=0)), int(pressure[peak].argmax())))
    return [Place(grid.x[columns], grid.y[rows], np.zeros(1))] if columns.size and rows.size else []


def _off_rim(loaded: BoolArray, at: int) -> IntArray:
    """Numbers of the cells of a contact around `at`, off its rim; at the end of all cells the body ends, too."""
    free = np.flatnonzero(~loaded)
    before, after = free[free <= at], free[free >= at]
    start = before[-1] + 1 + RIM if before.size else 0
    stop = after[0] - RIM if after.size else loaded.size
    return np.arange(start, stop)


def _nearest(centres: FloatArray, wanted: FloatArray, among: IntArray) -> IntArray:
    """Those of some cells that are nearest to some positions, and neighbours of the outermost; none of none."""
    if not among.size:
        return among
    at = np.unique(np.abs(centres[among] - wanted[:, None]).argmin(axis=1))
    return np.asarray(among[np.unique(np.clip([*at, at[0] + 1, at[-1] - 1], 0, among.size - 1))])


def _mirrored(loads: Loads, grid: Grid, extent: Extent) -> bool:
    """Whether body and loads have a mirror plane at mid-length."""
    return bool(
        np.isinf(extent[0]) == np.isinf(extent[1])
        and np.allclose(grid.widths, grid.widths[::-1])
        and all(
            np.allclose(load.cells, load.cells[::-1], rtol=0, atol=1e-4 * np.abs(load.cells).max())
            for load in loads.values()
        )
    )


def _peaks(line: FloatArray, *, alike: bool) -> Iterator[int]:
    """Columns of the highest pressures of either half; of the first only if both are alike."""
    half = (line.size + 1) // 2
    first, last = int(line[:half].argmax()), half + int(line[half:].argmax()) if line.size > 1 else 0
    for peak in (first,) if alike else (first, last) if line[first] >= line[last] else (last, first):
        if line[peak] >= HIGH * line.max():
            yield peak


def largest_stress(
    looked_at: Sequence[tuple[Place, FloatArray]],
    asked: tuple[Place, FloatArray],
    extent: Extent,
    stress: Callable[[Place], FloatArray],
) -> Largest:
    """Largest von Mises stress; 0 nowhere without pressure.

    Parameters
    ----------
    looked_at : sequence of (Place, array (6, x, y, z))
        What `points_looked_at` returns, and the stresses there.
    asked : (Place, array (6, x, y, z))
        Other points that are known, which are looked at as far as they are not too near to the top.
    extent : tuple of float
        Ends of the body, metres.
    stress : callable
        Stresses at other places.
    """
    if not looked_at:
        return Largest(0.0, 0.0, (np.nan, np.nan, np.nan))
    below = [(place, field) for place, field in looked_at if place.z[0] > 0]
    shallowest = min(float(place.z[0]) for place, _ in below)
    *at_peaks, along = below
    found = [_settled(_top(*peak), extent, shallowest, stress) for peak in at_peaks]
    found += [_of_cells(place, field) for place, field in looked_at if place.z[0] == 0]
    elsewhere = [along]
    if (asked[0].z >= shallowest).any():
        elsewhere.append(_well_spaced(*asked, shallowest))
    for place, field in elsewhere:
        top = _sampled(place, field)
        if top.found.value > max(each.value for each in found):
            found.append(_settled(top, extent, shallowest, stress))
    return max(found, key=lambda each: each.value)


def _well_spaced(place: Place, field: FloatArray, shallowest: float) -> tuple[Place, FloatArray]:
    """Points that a user asks for, in order, as far as they are not too near to the top or to each other."""
    deep = np.flatnonzero(place.z >= shallowest)
    axes = (place.x, place.y, place.z[deep])
    in_x, in_y, in_z = (_apart(axis, CLOSEST * float(np.ptp(axis))) for axis in axes)
    kept = (in_x, in_y, deep[in_z])
    for number, chosen in enumerate(kept, start=1):
        field = field.take(chosen, axis=number)
    return Place(*(axis[chosen] for axis, chosen in zip(place, kept, strict=True))), field


def _settled(top: _Top, extent: Extent, shallowest: float, stress: Callable[[Place], FloatArray]) -> Largest:
    """Lay points again around the largest value of some, until polynomials through them agree."""
    for _ in range(MOST):
        closer, inside = _closer(top, extent, shallowest)
        if inside and top.found.error <= SETTLED * top.found.value:
            break
        next_top = _top(closer, stress(closer))
        change = abs(next_top.found.value - top.found.value)
        if next_top.found.value < top.found.value and not inside:
            # Beyond the edge it falls.
            known = top.found.error if np.isfinite(top.found.error) else 0.0
            return top.found._replace(error=max(known, change))
        top = next_top
    return top.found


def _of_cells(place: Place, stresses: FloatArray) -> Largest:
    """Largest value at the centres of cells on the top; in the outermost ones it may go on growing."""
    values = von_mises_of(*stresses)[..., 0]
    best = np.unravel_index(int(values.argmax()), values.shape)
    value, error = float(values[best]), ON_TOP * float(values[best])
    for line, index in ((values[:, best[1]], int(best[0])), (values[best[0]], int(best[1]))):
        if line.size > 1 and index in (0, line.size - 1):
            error = max(error, (RIM + 1) * float(abs(value - line[1 if index == 0 else -2])))
    x, y = (float(axis[int(index)]) for axis, index in zip(place[:2], best, strict=True))
    return Largest(value, error, (x, y, 0.0))


def _sampled(points: Place, stresses: FloatArray) -> _Top:
    """Largest value among points that may be too far apart for polynomials."""
    values = von_mises_of(*stresses)
    at = np.unravel_index(int(values.argmax()), values.shape)
    x, y, z = (float(axis[int(number)]) for axis, number in zip(points, at, strict=True))
    return _Top(Largest(float(values[at]), np.inf, (x, y, z)), points, tuple(int(number) for number in at))


def _top(points: Place, stresses: FloatArray) -> _Top:
    """Largest value between points where the stresses are known: polynomials go through the components."""
    at = np.unravel_index(int(von_mises_of(*stresses).argmax()), stresses.shape[1:])
    index = tuple(int(number) for number in at)
    (value, place), (rough, _) = (_between(points, stresses, index, around) for around in (2, 1))
    sampled = float(von_mises_of(*stresses)[index])
    return _Top(Largest(value, max(abs(value - rough), BETWEEN * (value - sampled)), place), points, index)


def _between(
    points: Place, stresses: FloatArray, index: tuple[int, ...], around: int
) -> tuple[float, tuple[float, float, float]]:
    """Largest value of polynomials through the points `around` one on either side, and its place."""
    near = [refined(axis, number, around) for axis, number in zip(points, index, strict=True)]
    values = stresses[(slice(None), *(each.window for each in near))]
    for number, each in enumerate(near, start=1):
        values = np.moveaxis(np.tensordot(each.matrix, values, axes=(1, number)), 0, number)
    between = von_mises_of(*values)
    best = np.unravel_index(int(between.argmax()), between.shape)
    x, y, z = (float(each.points[number]) for each, number in zip(near, best, strict=True))
    return float(between[best]), (x, y, z)


def _closer(top: _Top, extent: Extent, shallowest: float) -> tuple[Place, bool]:
    """Points around the largest one, closer together; as far apart, and further out, where that is at an edge."""
    axes, inside = [], True
    limits = (extent, (-np.inf, np.inf), (shallowest, np.inf))
    for axis, index, (low, high) in zip(top.points, top.at, limits, strict=True):
        at = axis[index]
        before, after = axis[max(index - 1, 0)], axis[min(index + 1, axis.size - 1)]
        outermost = axis.size > 1 and bool((index == 0 and at > low) or (index == axis.size - 1 and at < high))
        inside = inside and not outermost
        reach = 2 * (after - before) if outermost else 0.0
        start, stop = max(min(before, at - reach), low), min(max(after, at + reach), high)
        axes.append(np.linspace(start, stop, 5) if axis.size > 1 else axis)
    return Place(*axes), inside
