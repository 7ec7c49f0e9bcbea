"""Finer cells under a load, on which a field near the top is that of a smooth load instead of steps.

Far below its cells a load on them and a smooth one of the same forces make the same field. Nearer than about a cell
they do not, and on the top itself a step of traction makes the stresses infinite. There the smooth load of
smooth_load.py is taken, as its means on cells a few times finer, placed so that every point lies in the middle of one.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.kernels.smooth_load import SmoothLoad

REACH = 1.5
"""Depth, over the size of a cell, down to which cells along y are refined: below, steps have decayed. Accuracy."""

PARTS_X = 3
"""Fine cells in one along x. Accuracy."""

PARTS_Y, PARTS_Y_UNIFORM = 5, 3
"""Fine cells in one along y, on columns of any width and on uniform cells, of which there are more. Accuracy."""

FLAT = 3e-3
"""Deviation of a smooth load from its cell's mean, over the largest, that is left alone. Accuracy."""

SPARE = 2
"""Cells kept beyond the loaded ones along y: a smooth load may reach into the first. Accuracy."""


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

    @property
    def x_edges(self) -> FloatArray:
        """Edges of the fine cells along x, metres."""
        return _split(self.grid.x_edges, self.split)

    @property
    def parts(self) -> tuple[int, int]:
        """Fine cells in one along x and y, of uniform cells."""
        return (PARTS_X if self.split.any() else 1, PARTS_Y_UNIFORM if self.grid.uniform else PARTS_Y)

    def near(self, z: FloatArray) -> BoolArray:
        """Depths at which cells along y are refined, and uniform cells along x as well."""
        size = self.grid.dy
        if self.grid.uniform and self.split.any():
            size = max(size, self.grid.dx)
        return np.asarray(z < REACH * size)

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
        means = np.diff(integral, axis=1) / np.diff(at)
        between = np.ones(at.size - 1, bool)
        between[np.cumsum([each.size for each in edges[:-1]], dtype=int) - 1] = False
        return np.ascontiguousarray(means[:, between].T)

    def along_y(self, columns: FloatArray) -> SmoothLoad:
        """Columns (column, y) as smooth functions of y."""
        return SmoothLoad.of(columns, self.y_edges, spilling=True)

    def refined(self, *, near: bool, offset: float = 0.0, along_x: bool = True) -> tuple[FloatArray, Grid]:
        """Load on fine cells of the whole grid, and these.

        Parameters
        ----------
        near : bool
            For depths that are near; for others the cells are split along x only, and uniform ones not at all.
        offset : float
            Distance along y of the points from the middles of cells, metres: fine cells are moved so that points
            are in their middles.
        along_x : bool
            Whether to split along x.
        """
        grid = self.grid
        edges = self.x_edges if along_x and (near or not grid.uniform) else grid.x_edges
        columns = self.columns([edges])
        parts = self.parts[1] if near else 1
        moved = 0.0
        y_edges = grid.y_range[0] + grid.dy / parts * np.arange(parts * grid.cells_y + 1.0)
        y_range = grid.y_range
        if near:
            step = grid.dy / parts
            moved = offset - step * np.round(offset / step)
            y_edges = y_edges + moved
            if moved:  # one more, for what is left of the first or behind the last
                y_edges = np.append(y_edges, y_edges[-1] + step) if moved < 0 else np.append(y_edges[0] - step, y_edges)
                y_range = (float(y_edges[0]), float(y_edges[-1]))
        cells = self._on(columns, y_edges) if near else np.zeros((edges.size - 1, grid.cells_y))
        if not near:
            cells[:, self.first : self.first + columns.shape[1]] = self.along_y(columns).gathered()
        if grid.uniform:
            return cells, Grid(grid.x_range, y_range, *cells.shape)
        return cells, Grid.between(edges, y_range, cells.shape[1])

    def _on(self, columns: FloatArray, y_edges: FloatArray) -> FloatArray:
        """Means of columns (column, y) on other cells along y: array (column, cell)."""
        cells = np.zeros((columns.shape[0], y_edges.size - 1))
        seen = np.flatnonzero((y_edges[1:] > self.y_edges[0]) & (y_edges[:-1] < self.y_edges[-1]))
        if seen.size:
            some = slice(int(seen[0]), int(seen[-1]) + 1)
            cells[:, some] = self.along_y(columns).means(y_edges[some.start : some.stop + 1])
        return cells


def _split(edges: FloatArray, columns: BoolArray) -> FloatArray:
    """Edges of columns of which some are split."""
    inner = edges[:-1, None] + np.diff(edges)[:, None] * np.arange(PARTS_X) / PARTS_X
    kept = np.ones(inner.shape, bool)
    kept[:, 1:] = columns[:, None]
    return np.append(inner[kept], edges[-1])
