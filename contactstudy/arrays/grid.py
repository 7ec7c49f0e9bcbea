"""Grid of cells of pressure and gap, any edges along x and uniform along y, and the points of a field."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.errors import InvalidInputError

SPACING_TOLERANCE = 1e-4  # Deviation of uniform spacing over a cell, above single precision. Rounding.
MAX_WIDTH_RATIO = 4.0  # Largest ratio of neighbouring widths with valid error estimates. Accuracy.
WIDTH_RATIO = 3.0  # Ratio of neighbouring widths outside the contact. Speed.
EDGE_ROUNDING = 1e-12  # Rounding of the edges, and least width of a cell, over the grid's length. Rounding.
TOP_ERROR = 0.02  # Relative error of stresses on the top due to uniform cell pressures (explanation/limits). Accuracy.
MAX_CELLS = 10**8  # Largest number of cells; more suggest a wrong unit. Limit.


class Points(NamedTuple):
    """Positions of a field: the tensor product of `x`, `y` and `z`, metres."""

    x: FloatArray
    y: FloatArray
    z: FloatArray


@dataclass(frozen=True, kw_only=True)
class Grid:
    """Rectangular cells that tile ``x_min..x_max`` by ``y_min..y_max``; `from_edges` makes cells of different widths.

    Parameters
    ----------
    x_range, y_range : tuple of float
        First and last cell *edge*, metres.
    cells_x, cells_y : int
        Number of cells.

    Raises
    ------
    InvalidInputError
        If a range is empty or a number of cells is below one.

    Examples
    --------
    >>> grid = Grid(x_range=(0.0, 4.0), y_range=(-1.0, 1.0), cells_x=4, cells_y=2)
    >>> grid.x.tolist(), grid.y.tolist(), grid.cell_area
    ([0.5, 1.5, 2.5, 3.5], [-0.5, 0.5], 1.0)
    """

    x_range: tuple[float, float]
    y_range: tuple[float, float]
    cells_x: int
    cells_y: int
    _inner_edges: tuple[float, ...] = field(default=(), repr=False)  # between cells of different widths

    def __post_init__(self) -> None:
        for name in ("x_range", "y_range"):
            try:
                low, high = getattr(self, name)
            except (TypeError, ValueError):
                raise InvalidInputError(name, getattr(self, name), "an increasing pair (metres)") from None
            low, high = checks.finite(name, low, "metres"), checks.finite(name, high, "metres")
            if not high - low > max(1 / checks.MAX_MAGNITUDE, EDGE_ROUNDING * max(abs(low), abs(high))):
                raise InvalidInputError(name, (low, high), "an increasing pair (metres), not closer than rounding is")
            checks.store(self, **{name: (low, high)})
        for name in ("cells_x", "cells_y"):
            checks.store(self, **{name: checks.count(name, getattr(self, name))})
        if self.cells_x * self.cells_y > MAX_CELLS:
            counts = (self.cells_x, self.cells_y)
            raise InvalidInputError("cells_x, cells_y", counts, f"at most {MAX_CELLS:.0e} cells")

    @classmethod
    def from_edges(cls, x_edges: object, y_range: tuple[float, float], cells_y: int) -> Grid:
        """Grid of cells between any increasing edges along x, uniform along y.

        Parameters
        ----------
        x_edges : sequence of float
            Edges of the cells, increasing, metres. Neighbouring widths may differ by a factor of 4 at most.
        y_range, cells_y
            As in `Grid`.

        Raises
        ------
        InvalidInputError
            If the edges do not increase or grow too steeply.

        Examples
        --------
        >>> grid = Grid.from_edges([0.0, 1.0, 2.0, 4.0], (-1.0, 1.0), 2)
        >>> grid.widths.tolist(), grid.uniform
        ([1.0, 1.0, 2.0], False)
        """
        grid = cls.between(x_edges, y_range, cells_y)
        grid.check_growth(np.ones(grid.cells_x, dtype=bool))
        return grid

    @classmethod
    def between(cls, x_edges: object, y_range: tuple[float, float], cells_y: int) -> Grid:
        """Grid of cells between increasing edges; outside the contact the growth of their widths is unlimited."""
        edges = checks.coordinates("x_edges", x_edges)
        if edges.size < 2:
            raise InvalidInputError("x_edges", edges, "at least two edges (metres)")
        widths = np.diff(edges)
        narrow_cells = np.flatnonzero(widths <= EDGE_ROUNDING * (edges[-1] - edges[0]))
        if narrow_cells.size:
            index = int(narrow_cells[0])
            raise InvalidInputError("x_edges", f"{edges[index]:g}, {edges[index + 1]:g} m", "increasing")
        x_range = (float(edges[0]), float(edges[-1]))
        uniform = bool(np.abs(widths - widths.mean()).max() <= 1e-12 * widths.mean())
        inner_edges = () if uniform else tuple(edges[1:-1].tolist())
        return cls(x_range=x_range, y_range=y_range, cells_x=widths.size, cells_y=cells_y, _inner_edges=inner_edges)

    def check_growth(self, cells: BoolArray) -> None:
        """Raise if the widths of neighbours among the given columns differ by more than error estimates allow."""
        edges, widths = self.x_edges, self.widths
        ratio = np.maximum(widths[1:] / widths[:-1], widths[:-1] / widths[1:])
        # The tolerance allows for rounded edges.
        steep_indices = np.flatnonzero((ratio > MAX_WIDTH_RATIO * (1 + SPACING_TOLERANCE)) & cells[1:] & cells[:-1])
        if steep_indices.size:
            index = int(steep_indices[0]) + 1
            raise InvalidInputError(
                "x_edges",
                f"cells of {widths[index - 1]:g} and {widths[index]:g} m next to x = {edges[index]:g} m",
                f"such that neighbouring cells differ by a factor of {MAX_WIDTH_RATIO:g} at most",
            )

    @classmethod
    def from_centres(cls, x: object, y: object) -> Grid:
        """Grid whose cell centres are `x` and `y` (metres; uniform, increasing, at least two of each)."""
        (x_range, cells_x), (y_range, cells_y) = (
            uniform_range(name, centres) for name, centres in (("x", x), ("y", y))
        )
        return cls(x_range=x_range, y_range=y_range, cells_x=cells_x, cells_y=cells_y)

    @property
    def uniform(self) -> bool:
        """Whether all cells have the same width."""
        return not self._inner_edges

    @property
    def is_symmetric(self) -> bool:
        """Whether the cells along x are symmetric about the middle of the window."""
        low, high = self.x_range
        edges = self.x_edges
        return bool(np.abs(edges + edges[::-1] - (low + high)).max() <= EDGE_ROUNDING * (high - low))

    @property
    def observes_means(self) -> bool:
        """Whether gap and displacement are means over the width of each cell, not values at the cell's centre."""
        # Gap, operator and preconditioner must all use means, or all use centres. Means make the operator symmetric on
        # cells of different widths; on uniform cells centres err less (sphere's peak 1.5, rolling 4 times).
        return not self.uniform

    @property
    def dx(self) -> float:
        """Mean cell size along x, metres."""
        return (self.x_range[1] - self.x_range[0]) / self.cells_x

    @property
    def dy(self) -> float:
        """Cell size along y, metres."""
        return (self.y_range[1] - self.y_range[0]) / self.cells_y

    @property
    def cell_area(self) -> float:
        """Mean area of a cell, square metres."""
        return self.dx * self.dy

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of cells ``(cells_x, cells_y)``."""
        return (self.cells_x, self.cells_y)

    @property
    def x_edges(self) -> FloatArray:
        """Edges of the cells along x, metres."""
        if self.uniform:
            return np.linspace(*self.x_range, self.cells_x + 1)
        return np.array([self.x_range[0], *self._inner_edges, self.x_range[1]])

    @property
    def widths(self) -> FloatArray:
        """Widths of the cells along x, metres."""
        return np.full(self.cells_x, self.dx) if self.uniform else np.diff(self.x_edges)

    @property
    def weights(self) -> FloatArray:
        """Widths over the mean width, array (x, 1): weighted sums over cells, times `cell_area`, are integrals."""
        return (self.widths / self.dx)[:, None]

    @property
    def x(self) -> FloatArray:
        """Cell centres along x, metres."""
        if self.uniform:
            return np.asarray(self.x_range[0] + self.dx * (np.arange(self.cells_x) + 0.5))
        return centres_of(self.x_edges)

    @property
    def y(self) -> FloatArray:
        """Cell centres along y, metres; exactly symmetric for a symmetric range."""
        mid_y = 0.5 * (self.y_range[0] + self.y_range[1])
        return np.asarray(mid_y + self.dy * (np.arange(self.cells_y) - 0.5 * (self.cells_y - 1)))

    def coarsened(self) -> Grid:
        """Return a grid with cells of twice the size, slightly larger if the number of cells is odd."""
        if self.uniform:
            return replace(self, cells_x=self.cells_x // 2, cells_y=self.cells_y // 2)
        # Merged cells may exceed the limit of growth: they serve only an initial guess.
        inner_edges = self._inner_edges[1::2]
        return replace(self, cells_x=len(inner_edges) + 1, cells_y=self.cells_y // 2, _inner_edges=inner_edges)


def growing_edges(distance: float, width: float, growth: float = WIDTH_RATIO) -> FloatArray:
    """Edges above 0 of a few cells up to `distance`, that widen from about `width`; one cell if it is infinite."""
    if np.isinf(distance):
        return np.array([width])
    if distance <= 1e-9 * width:
        return np.zeros(0)
    cell_count = max(1, int(np.ceil(np.log1p(distance * (growth - 1) / width) / np.log(growth) - 1e-9)))
    relative_widths = growth ** np.arange(cell_count)
    return np.asarray(np.cumsum(relative_widths) * (distance / relative_widths.sum()))


def uniform_range(name: str, values: object) -> tuple[tuple[float, float], int]:
    """First and last edge, metres, and number of the uniform cells centred at `values`; raise if not uniform."""
    centres = checks.coordinates(name, values)
    if centres.size < 2:
        raise InvalidInputError(name, centres, "at least two cell centres")
    step = (centres[-1] - centres[0]) / (centres.size - 1)
    if step <= 0:
        raise InvalidInputError(name, centres, "increasing cell centres")
    error = np.abs(np.diff(centres) - step) / step
    if error.max() > SPACING_TOLERANCE:
        index = int(error.argmax())
        raise InvalidInputError(name, f"{centres[index]:g}, {centres[index + 1]:g}", "uniformly spaced cell centres")
    return (float(centres[0] - step / 2), float(centres[-1] + step / 2)), centres.size


def centres_of(edges: FloatArray) -> FloatArray:
    """Centres of the cells between `edges`."""
    return np.asarray(0.5 * (edges[1:] + edges[:-1]))


def interpolate_columns(values: FloatArray, centres: FloatArray, x: FloatArray) -> FloatArray:
    """Values (x, ...) at other positions along x, linear between the centres and constant beyond the outermost ones."""
    if centres.size == 1:
        return np.repeat(values, x.size, axis=0)
    upper = np.clip(np.searchsorted(centres, x), 1, centres.size - 1)
    fraction = np.clip((x - centres[upper - 1]) / (centres[upper] - centres[upper - 1]), 0.0, 1.0)
    fraction = fraction.reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray((1 - fraction) * values[upper - 1] + fraction * values[upper])
