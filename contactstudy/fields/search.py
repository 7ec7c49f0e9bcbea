"""Where the largest von Mises stress in a body is looked for under a pressure.

It lies below a peak of the pressure, at a depth that goes with the peak's width: for an edge radius some hundredths of
a half-width, between any usual depths. Or it lies near a free end, where less pressure does more, below the top or on
it. So points are laid around the peaks and along the contact. On the top stresses are known at the centres of cells
inside the contact; on the rim they show the cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.peak_width import peak_width
from contactstudy.bodies.models import Extent
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.fields.loads import Loads
from contactstudy.kernels.load import Load
from contactstudy.overlapping.field import Place

BESIDE = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
"""Points along x around a peak, over its width."""

BELOW = np.array([0.1, 0.2, 0.32, 0.48, 0.66, 0.9, 1.3])
"""Depths, over the width: the largest stress under a line contact is at 0.70, under a round one at 0.48."""

ALONG = np.array([0.0, 0.2, 0.45, 0.7, 1.0, 1.4, 2.0, 3.2, 6.0, 12.0, 20.0])
"""Distances from the ends of the contact at which it is looked at along the axis, over the half-width."""

ACROSS = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
"""Points across it, over its half-width there."""

DEEP = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 1.0])
"""Depths, likewise."""

HIGH = 0.6
"""Share of the largest pressure from which on the other half's peak is looked at: at a free end it may do more."""

RIM = 2
"""Cells at the rim of the contact whose stresses on the top are not looked at. Accuracy."""


class Search(NamedTuple):
    """Where the largest stress under some loads is looked for.

    Attributes
    ----------
    grid : Grid
        Cells.
    extent : tuple of float
        Ends of the body, metres.
    off_rim : array of bool (x, y)
        Cells inside the contact at which stresses on the top are known.
    places : list of Place
        Centres of cells on the top, and points below these; about the peaks, then along the contact. None without
        pressure.
    """

    grid: Grid
    extent: Extent
    off_rim: BoolArray
    places: list[Place]

    def cells(self, place: Place) -> tuple[IntArray, IntArray]:
        """Numbers of the columns and rows of cells whose centres are nearest to some points."""
        columns, rows = (
            np.abs(centres - axis[:, None]).argmin(axis=1)
            for axis, centres in ((place.x, self.grid.x), (place.y, self.grid.y))
        )
        return columns, rows

    def off_rim_at(self, place: Place) -> BoolArray:
        """Whether the cells next to some points are off the rim: array (x, y)."""
        return np.asarray(self.off_rim[np.ix_(*self.cells(place))])


def search_under(loads: Loads, grid: Grid, extent: Extent) -> Search:
    """Points among which the largest stress is looked for. They do not depend on the friction."""
    pressure = loads[Load.NORMAL].values
    line = pressure.max(axis=1)
    # Where the cells end along x, the body ends.
    off_rim = np.asarray(ndimage.binary_erosion(pressure > 0, iterations=RIM, border_value=1))
    if not line.any():
        return Search(grid, extent, off_rim, [])
    places: list[Place] = []
    alike = _mirrored(loads, grid, extent)
    for peak in _peaks(line, alike=alike):
        middle, half_width = _across(pressure[peak], grid)
        width = peak_width(pressure, grid.x, grid.dy, peak)
        if not any(abs(grid.x[peak] - place.x).min() < 0.2 * width for place in places):
            x = np.clip(grid.x[peak] + width * BESIDE, *extent)
            places.append(_place(grid, off_rim, x, 0.1 * width, middle + half_width * ACROSS, width * BELOW))
    middle, half_width = _across(pressure[int(line.argmax())], grid)
    x = _along(pressure, grid, half_width, alike=alike)
    places.append(_place(grid, off_rim, x, 0.1 * half_width, middle + half_width * ACROSS, half_width * DEEP))
    return Search(grid, extent, off_rim, places)


def _place(grid: Grid, off_rim: BoolArray, x: FloatArray, least: float, y: FloatArray, below: FloatArray) -> Place:
    """Centres of the cells nearest to some positions, along x some `least` distance apart, on the top and below."""
    columns = np.unique(np.abs(grid.x - x[:, None]).argmin(axis=1))
    # The outermost rows off the rim are among them: with friction the stress on the top may grow towards it.
    known = np.flatnonzero(off_rim[columns].any(axis=0))
    among = known if known.size else np.arange(grid.cells_y)
    rows = among[np.unique(np.abs(grid.y[among] - y[:, None]).argmin(axis=1))]
    along = grid.x[columns]
    return Place(along[apart(along, least)], grid.y[rows], np.append(0.0, below))


def _across(pressure: FloatArray, grid: Grid) -> tuple[float, float]:
    """Middle and half-width of a contact across one column, metres."""
    return float((pressure * grid.y).sum() / pressure.sum()), 0.5 * grid.dy * np.count_nonzero(pressure)


def _along(pressure: FloatArray, grid: Grid, half_width: float, *, alike: bool) -> FloatArray:
    """Positions from the ends of a contact to its middle, on one half of it and beside it only if both are alike."""
    columns = np.flatnonzero(pressure.any(axis=1))
    first, last = grid.x_edges[columns[0]], grid.x_edges[columns[-1] + 1]
    inside = np.append(half_width * ALONG, 0.5 * (last - first))
    inside = inside[inside <= 0.5 * (last - first)]
    # Of two halves that are alike one point of the other, so that the middle is not at the edge.
    return np.concatenate([first + inside, last - (inside[-2:-1] if alike else inside)])


def apart(positions: FloatArray, least: float) -> IntArray:
    """Numbers of positions in order, without those too close to the one before: polynomials through these are wild."""
    kept: list[int] = []
    for number in np.argsort(positions, kind="stable").tolist():
        if not kept or positions[number] - positions[kept[-1]] > least:
            kept.append(number)
    return np.array(kept)


def _mirrored(loads: Loads, grid: Grid, extent: Extent) -> bool:
    """Whether body and loads have a mirror plane at mid-length."""
    return bool(
        np.isinf(extent[0]) == np.isinf(extent[1])
        and np.allclose(grid.widths, grid.widths[::-1])
        and all(
            np.allclose(load.cells, kind.sign_x * load.cells[::-1], rtol=0, atol=1e-4 * np.abs(load.cells).max())
            for kind, load in loads.items()
        )
    )


def _peaks(line: FloatArray, *, alike: bool) -> Iterator[int]:
    """Columns of the highest pressures of either half; of the first only if both are alike."""
    half = (line.size + 1) // 2
    first, last = int(line[:half].argmax()), half + int(line[half:].argmax()) if line.size > 1 else 0
    for peak in (first,) if alike else (first, last) if line[first] >= line[last] else (last, first):
        if line[peak] >= HIGH * line.max():
            yield peak
