"""From labelled arrays on cell centres to plain arrays and a grid, with every check."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


def labelled_cells(name: str, array: xr.DataArray, *, infinite: bool = False) -> tuple[FloatArray, Grid]:
    """Values ``(x, y)`` and grid of a DataArray on cell centres.

    Parameters
    ----------
    name : str
        Name of the argument, for error messages.
    array : DataArray
        Two-dimensional, with dimensions and coordinates `x` and `y` in either order.
    infinite : bool
        Whether positive infinity is allowed among the values.

    Raises
    ------
    InvalidInputError
        If it is not such an array, the coordinates are not uniform, or a value is not a number.
    """
    checks.instance(name, array, xr.DataArray, "an xarray.DataArray with dimensions (x, y)")
    if set(array.dims) != {"x", "y"}:
        raise InvalidInputError(f"{name}.dims", array.dims, "('x', 'y')")
    for axis in ("x", "y"):
        if axis not in array.coords:
            raise InvalidInputError(f"{name}.coords", list(array.coords), f"with {axis} (cell centres, metres)")
    grid = Grid.from_centres(array["x"].values, array["y"].values)
    try:
        values = np.ascontiguousarray(array.transpose("x", "y").values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInputError(f"{name}.dtype", array.dtype, "real numbers") from None
    bad = ~np.isfinite(values)
    if infinite:
        bad &= values != np.inf
    if bad.any():
        i, j = np.argwhere(bad)[0]
        raise InvalidInputError(
            name,
            f"{values[i, j]} at x = {grid.x[i]:g}, y = {grid.y[j]:g}",
            "finite everywhere",
            f"{bad.sum()} values are not",
        )
    return values, grid
