"""Finer cells of a load: they carry its means for fields near the top; whole cells carry its moments for deep fields.

Below a few cell sizes loads of equal moments cause equal fields. Nearer to the top the distribution inside the cells
matters, and on the top a step of traction makes the stresses infinite. Near the top the load has the shape of a given
pressure (smooth_load.py), averaged over finer cells with a point in the middle of each. The shape, the
cells and the depth of the change to whole cells do not depend on the load: the field is linear in the load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.cache import ArrayKey, cached
from contactstudy.checks import Array, BoolArray, FloatArray, store
from contactstudy.kernels.smooth_load import ShapedLoad, SmoothLoad, moment_loads

MAX_REFINED_DEPTH = 5.0
"""Largest depth of refined cells, over the cell size along y and along x. Accuracy: deeper down whole cells with the
moments of the fine cells are exact to 5e-6 of the pressure."""

PARTS_X = 3  # fine cells per cell along x. Accuracy.
PARTS_Y = 5  # fine cells per cell along y. Accuracy: 3 leave 6e-4 of the pressure on an end at a depth of 0.2 cells.
NEIGHBOURS = 3  # whole cells on either side that carry the moments of a fine cell, up to the order 6. Accuracy.
MIN_RESOLVED_WIDTH = 0.3  # least width of a resolved column, over its distance from the position. Accuracy.
FLATNESS_TOLERANCE = 3e-3  # neglected deviation of a shape from its mean in the cell, over the largest value. Accuracy.
SPARE_CELLS = 1  # cells beyond the loaded cells along y: a shape may extend into the first of them. Accuracy.


@dataclass(frozen=True, kw_only=True, eq=False)
class FineCells:
    """A load on the cells of a grid as a smooth function, and as its means on finer cells."""

    load: FloatArray  # (cell_x, cell_y): load on the cells, and the pressure that determines its distribution inside
    shape: FloatArray
    grid: Grid
    extent: tuple[float, float] = (-np.inf, np.inf)  # positions of the mirrors; infinite for none
    image_sign: int = 1  # sign of the load's mirror image
    first: int = 0
    """First cell along y in the grid, and number of cells: by default the cells of load and shape, and `SPARE_CELLS`
    beyond."""
    count: int = 0

    def __post_init__(self) -> None:
        if not self.count:
            loaded_rows = np.flatnonzero((self.load != 0).any(axis=0) | (self.shape != 0).any(axis=0))
            first = int(loaded_rows[0]) - SPARE_CELLS
            store(self, first=first, count=int(loaded_rows[-1]) + 1 + SPARE_CELLS - first)

    @property
    def added_nbytes(self) -> int:
        """Memory of the load's shape and moments, bytes."""
        return 20 * self.load.nbytes

    @cached_property
    def y_edges(self) -> FloatArray:
        """Edges of the cells along y, metres."""
        return np.asarray(self.grid.y_range[0] + self.grid.dy * np.arange(self.first, self.first + self.count + 1.0))

    def _crop(self, cell_loads: FloatArray) -> FloatArray:
        """Cells between `y_edges`: array (cell_x, y)."""
        stop = self.first + self.count
        inner_cells = cell_loads[:, max(self.first, 0) : stop]
        return np.pad(inner_cells, ((0, 0), (max(-self.first, 0), max(stop - self.grid.cells_y, 0))))

    @cached_property
    def cell_loads(self) -> FloatArray:
        """Load on the cells between `y_edges`: array (cell_x, y)."""
        return self._crop(self.load)

    @cached_property
    def shape_cells(self) -> FineCells:
        """The shape as a load."""
        if np.array_equal(self.load, self.shape):
            return self
        key, rows = ArrayKey(self.shape), {"first": self.first, "count": self.count}
        return share_fine_cells(key, key, self.grid, self.extent, self.image_sign, **rows)

    @cached_property
    def _smooth(self) -> SmoothLoad:
        """Smooth shape along x: rows along y."""
        return SmoothLoad.of(self._crop(self.shape).T, self.grid.x_edges)

    @cached_property
    def _load_along_x(self) -> ShapedLoad:
        return self._smooth.shape_loads(self.cell_loads.T)

    @cached_property
    def _fine_edges(self) -> FloatArray:
        """Edges of the fine cells along x, metres; a constant load needs no fine cells."""
        return _split_edges(self.grid.x_edges, np.full(self.grid.cells_x, not self._load_along_x.is_constant))

    @cached_property
    def x_edges(self) -> FloatArray:
        """Edges of the fine cells along x and of their nearest images, metres."""
        return mirror_edges(self._fine_edges, self.extent)

    @cached_property
    def step_edges(self) -> FloatArray:
        """Edges of load and nearest images with a step of the shape along x, metres."""
        shape, image_sign = self._smooth, self.image_sign
        first, last = shape.sign * shape.first, shape.sign * shape.last
        low, high = (image_sign * np.isfinite(end) for end in self.extent)
        lower, upper = np.column_stack([low * first[:, 0], last]), np.column_stack([first, high * last[:, -1]])
        edges = self.grid.x_edges[np.abs(upper - lower).max(axis=0) > FLATNESS_TOLERANCE * np.abs(self.shape).max()]
        return np.concatenate([edges, *(2 * end - edges for end in self.extent if np.isfinite(end))])

    @cached_property
    def edges(self) -> FloatArray:
        """Edges of the cells along x and of their nearest images, metres."""
        return mirror_edges(self.grid.x_edges, self.extent)

    @cached_property
    def _x_moments(self) -> FloatArray:
        """Moments along x of the cells and their nearest images: array (y, cell)."""
        return add_images(self._load_along_x.moments.T, -self.image_sign, self.extent).T

    def moment_loads(self, is_carried: BoolArray) -> FloatArray:
        """Return loads (column, y) on cells and nearest images with the moments along x of the marked ones."""
        return moment_loads(self.edges, np.where(is_carried, self._x_moments, 0.0)).T

    @cached_property
    def far_load(self) -> FloatArray:
        """Load on the cells with forces and first moments of the smooth load: array (cell_x, y)."""
        # In coupled cells the means of the smooth load differ from the load on the cells.
        moments = self._remove_images(moment_loads(self.edges, self._x_moments).T)
        return np.asarray(self._load_along_x.cell_means.T + moments)

    def is_refined_along_y(self, z: FloatArray) -> BoolArray:
        """Whether cells along y are refined at depths `z`."""
        return np.asarray(z < MAX_REFINED_DEPTH * self.grid.dy)

    def is_refined_along_x(self, z: FloatArray) -> BoolArray:
        """Whether uniform cells along x are refined at depths `z`; constant loads have equal cells at all depths."""
        return np.asarray((z < MAX_REFINED_DEPTH * self.grid.dx) | self._load_along_x.is_constant)

    def column_means(self, edges: list[FloatArray]) -> FloatArray:
        """Means over the columns between the edges of each array: array (column, y); edges may lie among images."""
        low, high = self.extent
        x = np.concatenate(edges)
        is_before, is_behind = x < low, x > high
        inner_x = np.where(is_before, 2 * low - x, np.where(is_behind, 2 * high - x, x))
        integral = self._load_along_x.integral(inner_x)
        if is_before.any():
            integral[:, is_before] *= -self.image_sign
        if is_behind.any():
            total = self._load_along_x.integral(self.grid.x_edges[-1:])
            integral[:, is_behind] = total + self.image_sign * (total - integral[:, is_behind])
        is_column = np.ones(x.size - 1, bool)
        is_column[np.cumsum([array_edges.size for array_edges in edges[:-1]], dtype=int) - 1] = False
        return np.asarray(np.diff(integral, axis=1)[:, is_column].T / np.diff(x)[is_column, None])

    def shape_along_y(self, columns: FloatArray, shape: FloatArray) -> ShapedLoad:
        """Smooth load along y of columns (column, y) with a shape (column, y)."""
        return SmoothLoad.of(shape, self.y_edges, extends_beyond=True).shape_loads(columns)

    def coarse_load(self, *, fine_x: bool) -> tuple[FloatArray, Grid]:
        """Load on uniform cells with the moments of the fine cells: whole cells along y, fine or whole along x."""
        fine_loads, grid = self.fine_load(0.0)
        margin = NEIGHBOURS * self.grid.dy
        y_range = (float(self.y_edges[0]) - margin, float(self.y_edges[-1]) + margin)
        loads = coarsen(fine_loads.T, PARTS_Y).T
        coarse_grid = Grid.between(grid.x_edges, y_range, loads.shape[1])
        return (loads, coarse_grid) if fine_x else self.coarsen_x(loads, coarse_grid)

    def coarsen_x(self, loads: FloatArray, grid: Grid) -> tuple[FloatArray, Grid]:
        """Load on uniform cells, whole cells along x with the moments of the fine cells, and the grid."""
        margin, has_end = NEIGHBOURS * PARTS_X, np.isfinite(self.extent)
        padded = np.pad(loads, ((margin, margin), (0, 0)), mode="symmetric")
        for has_image, loads_beyond in zip(has_end, (padded[:margin], padded[-margin:]), strict=True):
            loads_beyond *= self.image_sign if has_image else 0
        # Whole cells beyond the load, or in its image at an end, also carry moments.
        loads = coarsen(padded, PARTS_X)[NEIGHBOURS:-NEIGHBOURS]
        step, (cells_before, cells_behind) = self.grid.dx, (0 if has_image else NEIGHBOURS for has_image in has_end)
        loads = loads[NEIGHBOURS - cells_before : loads.shape[0] - NEIGHBOURS + cells_behind]
        first_edge, last_edge = self.grid.x_range
        x_edges = np.linspace(first_edge - cells_before * step, last_edge + cells_behind * step, loads.shape[0] + 1)
        return loads, Grid.between(x_edges, grid.y_range, loads.shape[1])

    def end_load(self) -> tuple[FloatArray, Grid]:
        """Load on cells that are split along y, and along x near the ends, over the whole grid."""
        is_split = np.zeros(self.grid.cells_x, bool)
        for end in self.extent:
            if np.isfinite(end):
                is_split[slice(*resolved_columns(self.grid.x_edges, end))] = True
        edges = _split_edges(self.grid.x_edges, is_split)
        is_unsplit = add_images(~is_split, 1, self.extent)

        def column_means(cells: FineCells) -> FloatArray:
            # The neighbours of an unsplit column carry the column's moment.
            moments = self._remove_images(cells.moment_loads(is_unsplit))
            return cells.column_means([edges]) + np.repeat(moments, np.where(is_split, PARTS_X, 1), axis=0)

        fine_loads, _ = self._refine_along_y(edges, column_means(self), column_means(self.shape_cells), 0.0)
        # The cells follow from the grid, not from the loaded cells, so that fields of several loads add up.
        rows_beyond = self.grid.cells_y + SPARE_CELLS - (self.first + self.count)
        padded = np.pad(fine_loads, ((0, 0), (PARTS_Y * (self.first + SPARE_CELLS), PARTS_Y * rows_beyond)))
        low, high = self.grid.y_range
        margin = SPARE_CELLS * self.grid.dy
        return padded, Grid.between(edges, (low - margin, high + margin), padded.shape[1])

    def fine_load(self, offset: float) -> tuple[FloatArray, Grid]:
        """Load on uniform cells split along x and y, and the grid."""
        # Points at the distance `offset` along y from the middles of cells are in the middles of fine cells.
        columns, shape = (cells.column_means([self._fine_edges]) for cells in (self, self.shape_cells))
        return self._refine_along_y(self._fine_edges, columns, shape, offset)

    def _refine_along_y(
        self, edges: FloatArray, columns: FloatArray, shape: FloatArray, offset: float
    ) -> tuple[FloatArray, Grid]:
        """Load of columns on cells that are split along y, and the grid."""
        step = self.grid.dy / PARTS_Y
        shift = offset - step * np.round(offset / step)
        y_edges = self.y_edges[0] + shift + step * np.arange(PARTS_Y * self.count + 1.0)
        if shift:  # one more cell covers the rest of the first or last cell
            y_edges = np.append(y_edges, y_edges[-1] + step) if shift < 0 else np.append(y_edges[0] - step, y_edges)
        cell_loads = self.shape_along_y(columns, shape).equivalent_means(y_edges)
        return cell_loads, Grid.between(edges, (float(y_edges[0]), float(y_edges[-1])), cell_loads.shape[1])

    def _remove_images(self, columns: FloatArray) -> FloatArray:
        """Columns without images."""
        image_count = self.grid.cells_x if np.isfinite(self.extent[0]) else 0
        return columns[image_count : image_count + self.grid.cells_x]


@cached("fine cells")
def share_fine_cells(
    load: ArrayKey,
    shape: ArrayKey,
    grid: Grid,
    extent: tuple[float, float],
    image_sign: int = 1,
    first: int = 0,
    count: int = 0,
) -> FineCells:
    """Fine cells that all points share."""
    arrays = {"load": load.values, "shape": shape.values}
    return FineCells(**arrays, grid=grid, extent=extent, image_sign=image_sign, first=first, count=count)


def coarsen(fine_loads: FloatArray, fine_per_cell: int) -> FloatArray:
    """Return loads (cell, ...) with the moments of `fine_loads` (fine cell, ...), `NEIGHBOURS` cells more per side."""
    offsets = np.arange(-NEIGHBOURS, NEIGHBOURS + 1.0)
    midpoints = (np.arange(fine_per_cell) - 0.5 * (fine_per_cell - 1)) / fine_per_cell
    orders = np.arange(offsets.size)[:, None]

    def moments(centres: FloatArray, width: float) -> FloatArray:
        return np.asarray(
            ((centres + 0.5 * width) ** (orders + 1) - (centres - 0.5 * width) ** (orders + 1)) / (width * (orders + 1))
        )

    weights = np.linalg.solve(moments(offsets, 1.0), moments(midpoints, 1 / fine_per_cell)) / fine_per_cell  # eq. (32c)
    loads_by_cell = fine_loads.reshape(fine_loads.shape[0] // fine_per_cell, fine_per_cell, *fine_loads.shape[1:])
    loads = np.zeros((loads_by_cell.shape[0] + 2 * NEIGHBOURS, *fine_loads.shape[1:]))
    for index, cell_weights in enumerate(weights):
        loads[index : index + loads_by_cell.shape[0]] += np.tensordot(loads_by_cell, cell_weights, axes=(1, 0))
    return loads


def mirror_edges(edges: FloatArray, extent: tuple[float, float]) -> FloatArray:
    """Edges of columns and their nearest images; each end of the body is an edge."""
    first_mirror, last_mirror = extent
    all_edges = [edges]
    if np.isfinite(first_mirror):
        all_edges.insert(0, (2 * first_mirror - edges[::-1])[:-1])
    if np.isfinite(last_mirror):
        all_edges.append((2 * last_mirror - edges[::-1])[1:])
    return np.concatenate(all_edges)


def add_images(columns: Array, image_sign: int, extent: tuple[float, float]) -> Array:
    """Columns (column, y) between their nearest images."""
    has_first_mirror, has_last_mirror = (bool(np.isfinite(end)) for end in extent)
    images = [columns[::-1] if image_sign > 0 else -columns[::-1]]
    return np.concatenate([*images[:has_first_mirror], columns, *images[:has_last_mirror]])


def resolved_columns(edges: FloatArray, x: float, min_width: float = 0.0) -> tuple[int, int]:
    """First column around `x` that is wide over its distance, and the column behind the last; equal without one."""
    # Outer columns up to the width `min_width` do not count as wide.
    widths = np.diff(edges)
    distance = np.abs(0.5 * (edges[1:] + edges[:-1]) - x)
    is_wide = widths > MIN_RESOLVED_WIDTH * distance
    nearest = int(distance.argmin())
    narrow_before, narrow_behind = np.flatnonzero(~is_wide[:nearest]), np.flatnonzero(~is_wide[nearest:])
    lowest = int(narrow_before[-1]) + 1 if narrow_before.size else 0
    highest = nearest + int(narrow_behind[0]) if narrow_behind.size else widths.size
    columns = np.flatnonzero(widths[lowest:highest] > min_width)
    return (lowest + int(columns[0]), lowest + int(columns[-1]) + 1) if columns.size else (nearest, nearest)


def _split_edges(edges: FloatArray, split_columns: BoolArray) -> FloatArray:
    """Edges of columns after the marked columns are split."""
    split_edges = edges[:-1, None] + np.diff(edges)[:, None] * np.arange(PARTS_X) / PARTS_X
    is_edge = np.ones(split_edges.shape, bool)
    is_edge[:, 1:] = split_columns[:, None]
    return np.append(split_edges[is_edge], edges[-1])
