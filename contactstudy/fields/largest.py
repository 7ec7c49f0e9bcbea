"""The largest von Mises stress in a body, wherever its stresses are asked for.

Points around the peaks of the pressure and along the contact are laid again more closely around the largest values,
until polynomials through them agree. With much friction, and where the contact reaches a free end, it lies on the top.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.between import refined
from contactstudy.arrays.grid import ON_TOP
from contactstudy.arrays.invariants import von_mises_of
from contactstudy.bodies.models import Extent
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.fields.search import RIM, Search, apart
from contactstudy.overlapping.field import Place

BETWEEN = 0.25
"""Share of what polynomials add to the largest point that counts as their error: two degrees may agree by chance."""

SETTLED = 3e-3
"""Relative error of the interpolation at which points are close enough."""

AROUND = np.array([-0.5, -0.25, 0.0, 0.25, 0.5])
"""Points about one that a user asks for, over its depth: no load is nearer, so stresses change within that."""

NEARLY = 1.25
"""Factor by which the largest cell of some on the top may miss the largest of all: beside it the search goes on."""

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


def largest_stress(
    search: Search,
    stresses: Sequence[FloatArray],
    asked: tuple[Place, FloatArray],
    stress: Callable[[Place], FloatArray],
) -> Largest:
    """Largest von Mises stress; 0 nowhere without pressure.

    Parameters
    ----------
    search : Search
        Where it is looked for.
    stresses : sequence of array (6, x, y, z)
        Stresses at the places of `search`.
    asked : (Place, array (6, x, y, z))
        Other points that are known: if one has more, it is looked for about that.
    stress : callable
        Stresses at other places.
    """
    if not search.places:
        return Largest(0.0, 0.0, (np.nan, np.nan, np.nan))
    known = list(zip(search.places, stresses, strict=True))
    *at_peaks, along = [(place._replace(z=place.z[1:]), field[..., 1:]) for place, field in known]
    shallowest = min(float(place.z[0]) for place, _ in (*at_peaks, along))
    largest = _highest(_settled(_top(*peak), search, shallowest, stress) for peak in at_peaks)
    elsewhere = _sampled(*along)
    if elsewhere.found.value > largest.value:
        largest = _highest([largest, _settled(elsewhere, search, shallowest, stress)])
    for place, field in known:
        sample = _sampled(place._replace(z=place.z[:1]), field[..., :1], search.off_rim_at(place))
        if sample.found.value * NEARLY > largest.value:
            largest = _highest([largest, _of_cells(sample, search, stress)])
    return _with_asked(largest, asked, search, shallowest, stress)


def _with_asked(
    known: Largest,
    asked: tuple[Place, FloatArray],
    search: Search,
    shallowest: float,
    stress: Callable[[Place], FloatArray],
) -> Largest:
    """Return what is known, or the largest value about points that a user asks for, if that is more."""
    points, stresses = asked
    deep = points.z >= shallowest
    of_depths = [deep] if deep.any() else []
    of_depths += [points.z == depth for depth in points.z[~deep]]
    for depths in of_depths:
        place = points._replace(z=points.z[depths])
        off_rim = None if depths is deep else search.off_rim_at(place)
        sample = _sampled(place, stresses[..., depths], off_rim)
        value = sample.found.value
        if known.value < value <= known.value + known.error:
            known = known._replace(value=value, place=sample.found.place)
        elif value > known.value and depths is deep:
            about = _about(sample.found.place, search, shallowest)
            known = _settled(_top(about, stress(about)), search, shallowest, stress)
            if known.value < value:
                known = Largest(value, known.error + value - known.value, sample.found.place)
        elif value > known.value:
            known = _highest([known, _of_cells(sample, search, stress)])
    return known


def _about(place: tuple[float, float, float], search: Search, shallowest: float) -> Place:
    """Points about one, along y whole cells apart."""
    x, y, z = place
    dy = search.grid.dy
    beside = np.clip(x + z * AROUND, *search.extent)
    below = np.maximum(z * (1 + AROUND), shallowest)
    rows = np.unique([*np.round(z * AROUND / dy), -1, 1])
    return Place(beside[apart(beside, 0.1 * z)], y + dy * rows, below[apart(below, 0.1 * z)])


def _highest(found: Iterable[Largest]) -> Largest:
    """Return the largest of some."""
    return max(found, key=lambda each: each.value)


def _of_cells(sample: _Top, search: Search, stress: Callable[[Place], FloatArray]) -> Largest:
    """Largest value at the centres of cells, looked for from the largest sample on until no cell beside it has more."""
    grid = search.grid
    for _ in range(MOST):
        before = sample.found.value
        columns, rows = (
            _between_neighbours(cells, at, count)
            for cells, at, count in zip(search.cells(sample.points), sample.at, grid.shape, strict=False)
        )
        centres = Place(grid.x[columns], grid.y[rows], sample.points.z)
        stresses = stress(centres)
        sample = _sampled(centres, stresses, search.off_rim[np.ix_(columns, rows)])
        if sample.found.value <= before * (1 + SETTLED):
            break
    return _beside_the_rim(sample, von_mises_of(*stresses)[..., 0], search.off_rim_at(centres))


def _beside_the_rim(sample: _Top, values: FloatArray, off_rim: BoolArray) -> Largest:
    """Return the largest value of cells with its error: beside the rim it may go on growing."""
    column, row, _ = sample.at
    error = ON_TOP * sample.found.value
    for line, known, index in (
        (values[:, row], off_rim[:, row], column),
        (values[column], off_rim[column], row),
    ):
        beside = slice(max(index - 1, 0), index + 2)
        if not known[beside].all():
            error = max(error, (RIM + 1) * float(np.ptp(line[beside][known[beside]])))
    return sample.found._replace(error=error)


def _between_neighbours(cells: IntArray, at: int, count: int) -> IntArray:
    """Numbers of cells from one neighbour of a cell in a list to the other, the cells beside it among them."""
    cell, listed = int(cells[at]), np.unique(cells)
    number = int(np.searchsorted(listed, cell))
    before, after = listed[max(number - 1, 0)], listed[min(number + 1, listed.size - 1)]
    between = np.linspace(before, after, 5).round().astype(np.int64)
    return np.unique(np.clip([*between, cell - 1, cell, cell + 1], 0, count - 1))


def _settled(top: _Top, search: Search, shallowest: float, stress: Callable[[Place], FloatArray]) -> Largest:
    """Lay points again around the largest value of some, until polynomials through them agree."""
    for _ in range(MOST):
        closer, inside = _closer(top, search.extent, shallowest)
        if inside and top.found.error <= SETTLED * top.found.value:
            break
        next_top = _top(closer, stress(closer))
        change = abs(next_top.found.value - top.found.value)
        if next_top.found.value < top.found.value and not inside:
            # Beyond the edge it falls.
            return _confirmed(top, change, stress)
        top = next_top
    if top.found.place[2] <= shallowest * (1 + 1e-9):
        return top.found._replace(error=max(top.found.error, ON_TOP * top.found.value))
    return top.found


def _confirmed(top: _Top, change: float, stress: Callable[[Place], FloatArray]) -> Largest:
    """Return what the stress itself is where polynomials are largest: beside the last points they may overshoot."""
    sampled = [axis[number] for axis, number in zip(top.points, top.at, strict=True)]
    points = Place(*(np.unique(pair) for pair in zip(top.found.place, sampled, strict=True)))
    found = _sampled(points, stress(points)).found
    return found._replace(error=max(change, abs(top.found.value - found.value)))


def _sampled(points: Place, stresses: FloatArray, known: BoolArray | None = None) -> _Top:
    """Largest value among points, as far as stresses are `known` (x, y), that may be too far apart for polynomials."""
    values = von_mises_of(*stresses)
    if known is not None:
        values = np.where(known[..., None], values, 0.0)
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
