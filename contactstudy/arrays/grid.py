"""The uniform grid of cells on which pressure and gap live."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

SPACING_TOLERANCE = 1e-4
"""Deviation of a spacing, over a cell, of cells that count as uniform: coordinates in single precision do. Accuracy."""


@dataclass(frozen=True)
class Grid:
    """Rectangular cells that tile ``x_min..x_max`` by ``y_min..y_max``.

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
    >>> grid = Grid((0.0, 4.0), (-1.0, 1.0), 4, 2)
    >>> grid.x.tolist(), grid.y.tolist(), grid.cell_area
    ([0.5, 1.5, 2.5, 3.5], [-0.5, 0.5], 1.0)
    """

    x_range: tuple[float, float]
    y_range: tuple[float, float]
    cells_x: int
    cells_y: int

    def __post_init__(self) -> None:
        """Check ranges and counts."""
        for name in ("x_range", "y_range"):
            low, high = getattr(self, name)
            low, high = checks.finite(name, low, "metres"), checks.finite(name, high, "metres")
            if not low < high:
                raise InvalidInputError(name, (low, high), "an increasing pair (metres)")
            checks.store(self, **{name: (low, high)})
        for name in ("cells_x", "cells_y"):
            checks.store(self, **{name: checks.count(name, getattr(self, name))})

    @classmethod
    def from_centres(cls, x: object, y: object) -> Grid:
        """Grid whose cell centres are `x` and `y` (metres; uniform, increasing, at least two of each)."""
        ranges = []
        for name, values in (("x", x), ("y", y)):
            centres = checks.coordinates(name, values)
            if centres.size < 2:
                raise InvalidInputError(name, centres, "at least two cell centres")
            step = (centres[-1] - centres[0]) / (centres.size - 1)
            if step <= 0:
                raise InvalidInputError(name, centres, "increasing cell centres")
            error = np.abs(np.diff(centres) - step) / step
            if error.max() > SPACING_TOLERANCE:
                at = int(error.argmax())
                raise InvalidInputError(name, f"{centres[at]:g}, {centres[at + 1]:g}", "uniformly spaced cell centres")
            ranges.append((float(centres[0] - step / 2), float(centres[-1] + step / 2), centres.size))
        (x0, x1, nx), (y0, y1, ny) = ranges
        return cls((x0, x1), (y0, y1), nx, ny)

    @property
    def dx(self) -> float:
        """Cell size along x, metres."""
        return (self.x_range[1] - self.x_range[0]) / self.cells_x

    @property
    def dy(self) -> float:
        """Cell size along y, metres."""
        return (self.y_range[1] - self.y_range[0]) / self.cells_y

    @property
    def cell_area(self) -> float:
        """Area of one cell, square metres."""
        return self.dx * self.dy

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of cells ``(cells_x, cells_y)``."""
        return (self.cells_x, self.cells_y)

    @property
    def x(self) -> FloatArray:
        """Cell centres along x, metres."""
        return np.asarray(self.x_range[0] + self.dx * (np.arange(self.cells_x) + 0.5))

    @property
    def y(self) -> FloatArray:
        """Cell centres along y, metres; exactly symmetric when the range is."""
        middle = 0.5 * (self.y_range[0] + self.y_range[1])
        return np.asarray(middle + self.dy * (np.arange(self.cells_y) - 0.5 * (self.cells_y - 1)))

    def coarsened(self) -> Grid:
        """Return the grid of cells of twice the size; a little more where a number of cells is odd."""
        return Grid(self.x_range, self.y_range, self.cells_x // 2, self.cells_y // 2)
