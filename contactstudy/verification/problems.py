"""Unit problems that the checks share: ``E*`` is 1, lengths are in half-widths ``a``, pressures in ``p0``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray

Range = tuple[float, float]


def unit_material(poisson: float = 0.3) -> Material:
    """Material of contact modulus 1.

    Examples
    --------
    >>> round(unit_material(0.25).plane_strain_modulus, 12)
    1.0
    """
    return Material(young=1 - poisson**2, poisson=poisson)


def on_cells(
    function: Callable[[FloatArray, FloatArray], FloatArray], x_range: Range, y_range: Range, cells: tuple[int, int]
) -> xr.DataArray:
    """Values of a function of (x, y) at cell centres; it is called with a column of x and a row of y.

    Examples
    --------
    >>> on_cells(lambda x, y: x + y, (0, 2), (0, 2), (2, 2)).values.tolist()
    [[1.0, 2.0], [2.0, 3.0]]
    """
    return on_grid(lambda grid: function(grid.x[:, None], grid.y[None, :]), Grid(x_range, y_range, *cells))


def on_grid(function: Callable[[Grid], FloatArray], grid: Grid) -> xr.DataArray:
    """Values of a function of a grid, labelled."""
    values = np.broadcast_to(function(grid), grid.shape)
    return xr.DataArray(values, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))


def cell_means(
    integral_y: Callable[[FloatArray], FloatArray], x_range: Range, y_range: Range, cells: tuple[int, int]
) -> xr.DataArray:
    """Means over the cells of a load that is uniform along x, from its integral over y from the left.

    Pressure is uniform in each cell: with its mean there the resultant is exact.
    """

    def means(grid: Grid) -> FloatArray:
        edges = np.linspace(*y_range, grid.cells_y + 1)
        return np.asarray(np.diff(integral_y(edges)) / grid.dy)[None, :]

    return on_grid(means, Grid(x_range, y_range, *cells))


def components(fields: Mapping[Any, ArrayLike]) -> FloatArray:
    """Six stresses as one array, components first."""
    return np.array([fields[name] for name in STRESSES])


def strip(x: FloatArray, y: FloatArray) -> FloatArray:
    """Hertz line pressure of half-width and peak 1."""
    return np.asarray(np.sqrt(np.maximum(1 - y**2, 0.0)) + 0 * x)


def strip_integral(y: FloatArray) -> FloatArray:
    """Integral of `strip` over y from the middle."""
    inside = np.clip(y, -1.0, 1.0)
    return np.asarray(0.5 * (inside * np.sqrt(1 - inside**2) + np.arcsin(inside)))


def point_pressure(grid: Grid, row: int, column: int) -> xr.DataArray:
    """Pressure of a unit load on one cell."""

    def pressure(grid: Grid) -> FloatArray:
        values = np.zeros(grid.shape)
        values[row, column] = 1 / grid.cell_area
        return values

    return on_grid(pressure, grid)
