"""From labelled arrays on cell centres to plain arrays and a grid, and back, with every check."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import SPACING_TOLERANCE, Grid, uniform_range
from contactstudy.checks import MAX_MAGNITUDE, REAL_KINDS, FloatArray
from contactstudy.errors import InvalidInputError


def labelled_cells(
    name: str, array: xr.DataArray, *, extent: tuple[float, float] = (-np.inf, np.inf), infinite: bool = False
) -> tuple[FloatArray, Grid]:
    """Values (x, y) and grid of a DataArray on cell centres; `x_width`, or else the body's end, gives the edges."""
    # A DataArray without the dimension `bounds` cannot contain `x_bounds`.
    checks.instance(name, array, xr.DataArray, "an xarray.DataArray with dimensions (x, y)")
    if set(array.dims) != {"x", "y"}:
        raise InvalidInputError(f"{name}.dims", array.dims, "('x', 'y')")
    for axis in ("x", "y"):
        if axis not in array.coords:
            raise InvalidInputError(f"{name}.coords", list(array.coords), f"with {axis} (cell centres, metres)")
    y_range, cells_y = uniform_range("y", array["y"].values)
    grid = _grid(array, extent, y_range, cells_y)
    try:
        if array.dtype.kind not in REAL_KINDS:
            raise TypeError
        values = np.ascontiguousarray(array.transpose("x", "y").values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInputError(f"{name}.dtype", array.dtype, "real numbers") from None
    is_invalid = ~(np.abs(values) <= MAX_MAGNITUDE)
    if infinite:
        is_invalid &= values != np.inf
    if is_invalid.any():
        i, j = np.argwhere(is_invalid)[0]
        raise InvalidInputError(
            name,
            f"{values[i, j]} at x = {grid.x[i]:g}, y = {grid.y[j]:g}",
            f"finite everywhere, of a size up to {MAX_MAGNITUDE:g}",
            f"{is_invalid.sum()} values are not",
        )
    return values, grid


def cell_coordinates(grid: Grid) -> dict[str, tuple[tuple[str, ...], FloatArray]]:
    """Coordinates `x_bounds` (CF conventions) and `x_width` of cells of different widths; empty for uniform cells."""
    if grid.uniform:
        return {}
    edges = grid.x_edges
    return {"x_bounds": (("x", "bounds"), np.stack([edges[:-1], edges[1:]], axis=1)), "x_width": (("x",), grid.widths)}


def _grid(array: xr.DataArray, extent: tuple[float, float], y_range: tuple[float, float], cells_y: int) -> Grid:
    """Grid of an array whose cells along y are known."""
    if "x_width" in array.coords:
        widths = checks.coordinates("x_width", array["x_width"].values)
        centres = checks.coordinates("x", array["x"].values)
        lower_edges, upper_edges = centres - 0.5 * widths, centres + 0.5 * widths
        gap_widths = np.abs(upper_edges[:-1] - lower_edges[1:])
        gap_indices = np.flatnonzero(gap_widths > SPACING_TOLERANCE * (upper_edges - lower_edges)[:-1])
        if gap_indices.size:
            index = int(gap_indices[0])
            borders = f"one cell ends at {upper_edges[index]:g} m, the next begins at {lower_edges[index + 1]:g} m"
            raise InvalidInputError("x_width", borders, "such that cells meet")
        edges = np.concatenate([lower_edges[:1], 0.5 * (upper_edges[:-1] + lower_edges[1:]), upper_edges[-1:]])
        return Grid.between(edges, y_range, cells_y)
    try:
        x_range, cells_x = uniform_range("x", array["x"].values)
    except InvalidInputError as error:
        centres = checks.coordinates("x", array["x"].values)
        if centres.size < 2 or not np.isfinite(extent[0]):
            raise InvalidInputError(
                error.parameter, error.value, error.allowed, "cells of different widths need a coordinate x_width (x)"
            ) from None
        # The cells follow each other from the body's end.
        positions = [extent[0]]
        for centre in centres:
            positions.append(2 * centre - positions[-1])
            if not positions[-2] < centre:
                raise InvalidInputError(
                    "x",
                    f"a cell centre at {centre:g} m",
                    "the middle of a cell that follows the others from the body's end",
                    "add a coordinate x_width (x) for cells of different widths",
                ) from None
        return Grid.between(positions, y_range, cells_y)
    return Grid(x_range=x_range, y_range=y_range, cells_x=cells_x, cells_y=cells_y)
