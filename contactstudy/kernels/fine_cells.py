"""Finer cells under a load, on which a field near the top is that of a smooth load instead of steps.

Far below its cells a load on them and a smooth one of the same forces make the same field. Nearer than about a cell
they do not, and on the top itself a step of traction makes the stresses infinite. There the smooth load of
smooth_load.py is taken, as its means on cells a few times finer, placed so that every point lies in the middle of one.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import Array, BoolArray, FloatArray
from contactstudy.kernels.smooth_load import Sent, SmoothLoad, sent

REACH = 3.0
"""Depth, over the size of a cell along y and along x, down to which cells are refined: steps have decayed below, and
what is left is the moments of cells. Accuracy."""

PARTS_X = 3
"""Fine cells in one along x. Accuracy."""

PARTS_Y = 5
"""Fine cells in one along y. Accuracy: with 3 on uniform cells, an end keeps 6e-4 of the pressure at 0.2 of a cell."""

WIDE = 0.3
"""Width of a column, over its distance, from which the distribution of its load is seen. Accuracy."""

FLAT = 3e-3
"""Deviation of a smooth load from its cell's mean, over the largest, that is left alone. Accuracy."""

STEP, LEAST_STEP = 0.8, 0.3
"""Last cell of a load along y over the one before from which on it ends in a step, and such a step over the largest
load from which on the load counts as uniform in each cell. Accuracy: a contact's pressure falls to 0.7 at most."""

SPARE = 1
"""Cells kept beyond the loaded ones along y: a smooth load may reach into the first. Accuracy."""


def ends_in_steps(cells: FloatArray) -> bool:
    """Whether a load (cell_x, cell_y) ends in steps along y: uniform patches do, the pressure of a contact does not.

    Examples
    --------
    >>> ends_in_steps(np.array([[0.0, 1.0, 1.0, 0.0]])), ends_in_steps(np.sqrt([[1.0, 3.0, 3.0, 1.0]]))
    (True, False)
    """
    loads = np.abs(np.pad(cells, ((0, 0), (2, 2))))
    for row in (loads, loads[:, ::-1]):
        before, own, behind = row[:, :-2], row[:, 1:-1], row[:, 2:]
        stepped = np.where((behind == 0) & (own > STEP * before), own, 0.0)
        if stepped.max() > LEAST_STEP * loads.max():
            return True
    return False


class FineCells:
    """A load on the cells of a grid as a smooth function, and as its means on finer cells.

    Parameters
    ----------
    cells : array (cell_x, cell_y)
        Load on the cells of `grid`.
    grid : Grid
        Cells.
    extent : tuple of float
        Where the mirrors stand; infinite for none.
    image : int
        Sign of the load's mirror image.
    """

    def __init__(
        self, cells: FloatArray, grid: Grid, extent: tuple[float, float] = (-np.inf, np.inf), image: int = 1
    ) -> None:
        self.grid, self._extent, self._image = grid, extent, image
        loaded = np.flatnonzero(cells.any(axis=0))
        self.first = max(int(loaded[0]) - SPARE, 0)
        stop = min(int(loaded[-1]) + 1 + SPARE, grid.cells_y)
        self.cells = cells[:, self.first : stop]
        self.y_edges: FloatArray = grid.y_range[0] + grid.dy * np.arange(self.first, stop + 1.0)
        self._along_x = SmoothLoad.of(self.cells.T, grid.x_edges)

    @cached_property
    def split(self) -> BoolArray:
        """Columns that are split along x."""
        edges = _split(self.grid.x_edges, np.ones(self.grid.cells_x, bool))
        fine = self._along_x.means(edges).reshape(-1, self.grid.cells_x, PARTS_X)
        deviation = np.abs(fine - self.cells.T[..., None]).max(axis=(0, 2))
        uneven = deviation > FLAT * np.abs(self.cells).max()
        return np.full(uneven.shape, uneven.any()) if self.grid.uniform else uneven

    @cached_property
    def x_edges(self) -> FloatArray:
        """Edges of the fine cells along x, metres, with those of the nearest images."""
        return mirrored(_split(self.grid.x_edges, self.split), self._extent)

    @cached_property
    def steps(self) -> FloatArray:
        """Edges at which the load ends in a step along x, metres, with those of the nearest images."""
        load, image = self._along_x, self._image
        first, last = load.sign * load.first, load.sign * load.last
        low, high = (image * np.isfinite(end) for end in self._extent)
        before, behind = np.column_stack([low * first[:, 0], last]), np.column_stack([first, high * last[:, -1]])
        own = self.grid.x_edges[np.abs(behind - before).max(axis=0) > FLAT * np.abs(self.cells).max()]
        return np.concatenate([own, *(2 * end - own for end in self._extent if np.isfinite(end))])

    @cached_property
    def edges(self) -> FloatArray:
        """Edges of the cells along x, metres, with those of the nearest images."""
        return mirrored(self.grid.x_edges, self._extent)

    @cached_property
    def stays(self) -> BoolArray:
        """Columns, with their nearest images, that are never split."""
        return ~with_images(self.split, 1, self._extent)

    @cached_property
    def sent(self) -> Sent:
        """Loads that stand for the moments along x of the cells and their nearest images: arrays (y, cell)."""
        moments = with_images(self._along_x.moments.T, -self._image, self._extent).T
        return sent(self.edges, moments)

    @cached_property
    def gathered(self) -> FloatArray:
        """Load on the cells and their nearest images that far away along x makes the field of the smooth one."""
        # The smooth load shares the force of the last two cells anew where less than half of the last is pressed.
        return with_images(self._along_x.cell_means.T, self._image, self._extent) + self.sent.total.T

    @property
    def parts(self) -> tuple[int, int]:
        """Fine cells in one along x and y, of uniform cells."""
        return (PARTS_X if self.split.any() else 1, PARTS_Y)

    def near(self, z: FloatArray) -> BoolArray:
        """Depths at which cells along y are refined, and uniform cells along x as well."""
        reach = REACH * self.grid.dy
        if self.grid.uniform and self.split.any():
            reach = max(reach, REACH * self.grid.dx)
        return np.asarray(z < reach)

    def columns(self, edges: list[FloatArray]) -> FloatArray:
        """Means over columns between edges, metres, which may lie among the nearest images: array (column, y).

        Those between the edges of each array, one after the other.
        """
        low, high = self._extent
        at = np.concatenate(edges)
        before, behind = at < low, at > high
        inside = np.where(before, 2 * low - at, np.where(behind, 2 * high - at, at))
        integral = self._along_x.integral(inside)
        if before.any():
            integral[:, before] *= -self._image
        if behind.any():
            total = self._along_x.integral(self.grid.x_edges[-1:])
            integral[:, behind] = total + self._image * (total - integral[:, behind])
        between = np.ones(at.size - 1, bool)
        between[np.cumsum([each.size for each in edges[:-1]], dtype=int) - 1] = False
        return np.asarray(np.diff(integral, axis=1)[:, between].T / np.diff(at)[between, None])

    def along_y(self, columns: FloatArray) -> SmoothLoad:
        """Columns (column, y) as smooth functions of y."""
        return SmoothLoad.of(columns, self.y_edges, spilling=True)

    def far(self) -> FloatArray:
        """Load on the cells of the grid that makes the field of the smooth one at depths that are not near."""
        cells = np.zeros(self.grid.shape)
        columns = self.along_y(self._own(self.gathered)).gathered()
        cells[:, self.first : self.first + columns.shape[1]] = columns
        return cells

    def for_ends(self) -> tuple[FloatArray, Grid]:
        """Load on cells that are split along y, and along x where an end sees how their load is distributed."""
        return self._refined(*self._columns_for_ends(), 0.0)

    def near_top(self, offset: float, *, split: bool) -> tuple[FloatArray, Grid]:
        """Load on uniform cells that are split along y, and along x if wanted, and these.

        Points at the distance `offset` along y from the middles of cells are in the middles of the fine ones.
        """
        edges = self.grid.x_edges
        if not (split and self.split.any()):
            return self._refined(edges, self._own(self.gathered), offset)
        edges = _split(edges, self.split)
        return self._refined(edges, self.columns([edges]), offset)

    def _refined(self, edges: FloatArray, columns: FloatArray, offset: float) -> tuple[FloatArray, Grid]:
        """Columns on cells that are split along y, and these."""
        grid = self.grid
        step = grid.dy / self.parts[1]
        moved = offset - step * np.round(offset / step)
        y_edges = grid.y_range[0] + moved + step * np.arange(self.parts[1] * grid.cells_y + 1.0)
        if moved:  # one more, for what is left of the first or behind the last
            y_edges = np.append(y_edges, y_edges[-1] + step) if moved < 0 else np.append(y_edges[0] - step, y_edges)
        y_range = (float(y_edges[0]), float(y_edges[-1])) if moved else grid.y_range
        cells = self._on(columns, y_edges)
        return cells, Grid.between(edges, y_range, cells.shape[1])

    def _own(self, columns: FloatArray) -> FloatArray:
        """Columns without their images."""
        images = self.grid.cells_x if np.isfinite(self._extent[0]) else 0
        return columns[images : images + self.grid.cells_x]

    def _columns_for_ends(self) -> tuple[FloatArray, FloatArray]:
        """Edges and loads of columns, split where an end sees how their load is distributed."""
        split = np.zeros(self.split.size, bool)
        for end in self._extent:
            if np.isfinite(end):
                split[slice(*seen_apart(self.grid.x_edges, end))] = True
        split &= self.split
        edges = _split(self.grid.x_edges, split)
        columns = self.columns([edges])
        # Columns that stay send the moments of their load to their neighbours.
        kept = with_images(~split, 1, self._extent)
        received = self._own(Sent(*(np.where(kept, each, 0.0) for each in self.sent)).total.T)
        return edges, columns + np.repeat(received, np.where(split, PARTS_X, 1), axis=0)

    def _on(self, columns: FloatArray, y_edges: FloatArray) -> FloatArray:
        """Means of columns (column, y) on other cells along y: array (column, cell)."""
        cells = np.zeros((columns.shape[0], y_edges.size - 1))
        seen = np.flatnonzero((y_edges[1:] > self.y_edges[0]) & (y_edges[:-1] < self.y_edges[-1]))
        if seen.size:
            some = slice(int(seen[0]), int(seen[-1]) + 1)
            cells[:, some] = self.along_y(columns).gathered_on(y_edges[some.start : some.stop + 1])
        return cells


def mirrored(edges: FloatArray, extent: tuple[float, float]) -> FloatArray:
    """Edges with those of the nearest images; each end of the body is an edge between columns."""
    low, high = extent
    all_edges = [edges]
    if np.isfinite(low):
        all_edges.insert(0, (2 * low - edges[::-1])[:-1])
    if np.isfinite(high):
        all_edges.append((2 * high - edges[::-1])[1:])
    return np.concatenate(all_edges)


def with_images(columns: Array, image: int, extent: tuple[float, float]) -> Array:
    """Columns (column, y) between their nearest images."""
    low, high = (bool(np.isfinite(end)) for end in extent)
    images = [columns[::-1] if image > 0 else -columns[::-1]]
    return np.concatenate([*images[:low], columns, *images[:high]])


def seen_apart(edges: FloatArray, x: float, narrow: float = 0.0) -> tuple[int, int]:
    """First column around `x` whose load is seen to be distributed, and the one behind the last; alike if none is.

    Columns wider than a part of their distance, of which `narrow` ones at either end are left out.
    """
    widths = np.diff(edges)
    distance = np.abs(0.5 * (edges[1:] + edges[:-1]) - x)
    wide = widths > WIDE * distance
    nearest = int(distance.argmin())
    before, behind = np.flatnonzero(~wide[:nearest]), np.flatnonzero(~wide[nearest:])
    lowest = int(before[-1]) + 1 if before.size else 0
    highest = nearest + int(behind[0]) if behind.size else widths.size
    seen = np.flatnonzero(widths[lowest:highest] > narrow)
    return (lowest + int(seen[0]), lowest + int(seen[-1]) + 1) if seen.size else (nearest, nearest)


def _split(edges: FloatArray, columns: BoolArray) -> FloatArray:
    """Edges of columns of which some are split."""
    inner = edges[:-1, None] + np.diff(edges)[:, None] * np.arange(PARTS_X) / PARTS_X
    kept = np.ones(inner.shape, bool)
    kept[:, 1:] = columns[:, None]
    return np.append(inner[kept], edges[-1])
