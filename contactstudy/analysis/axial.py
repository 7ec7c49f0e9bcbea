"""The contact along the roller's axis: pressure, load, half-width and unloaded gap."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import cell_size, dimension_along, increasing, positions
from contactstudy.analysis.border import contact_borders
from contactstudy.analysis.reduced import reduced
from contactstudy.arrays.required import require
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import named, without_error
from contactstudy.errors import InvalidInputError


def axial_pressure(dataset: xr.Dataset) -> xr.DataArray:
    """Largest pressure across y at each position along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        With `pressure`, of any dimensions with one along y.

    Returns
    -------
    DataArray
        Pa, without the dimension along y.

    Raises
    ------
    InvalidInputError
        If there is no pressure.

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0, 1.0], [2.0, 0.0]], dims=("x", "y"))
    >>> axial_pressure(xr.Dataset({"pressure": pressure})).values.tolist()
    [1.0, 2.0]
    """
    pressure = required_in_si(dataset, "pressure", normalized=True)["pressure"]
    largest = pressure.max(dimension_along(pressure, "y"))
    return named("axial_pressure", largest)


def line_load(dataset: xr.Dataset) -> xr.DataArray:
    """Load per length at each position along the roller's axis, the integral of the pressure across y.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells.

    Returns
    -------
    DataArray
        N/m, without the dimension along y.

    Raises
    ------
    InvalidInputError
        If there is no pressure.

    Examples
    --------
    >>> cells = {"x": [0.0, 1.0], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[0.0, 1.0], [2.0, 3.0]], dims=("x", "y"), coords=cells)
    >>> line_load(xr.Dataset({"pressure": pressure})).values.tolist()
    [1.0, 5.0]
    """
    pressure = required_in_si(dataset, "pressure")["pressure"]
    if pressure.sizes[dimension_along(pressure, "y")] < 2:
        raise InvalidInputError("dataset", dict(pressure.sizes), "a result with two positions along y or more")
    load = pressure.sum(dimension_along(pressure, "y"), min_count=1) * cell_size(pressure, "y")
    return named("line_load", load)


def load_between(dataset: xr.Dataset, start: xr.DataArray | float, stop: xr.DataArray | float) -> xr.DataArray:
    """Load carried between two positions along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells.
    start, stop : float or DataArray
        Positions, metres; an array has a position for each case of a study. They may be infinite.

    Returns
    -------
    DataArray
        N, without the dimensions along x and y. A cell that a position cuts counts by its part, so that the load next
        to an end, unlike the pressure there, hardly depends on the grid.

    Raises
    ------
    InvalidInputError
        If there is no pressure, or the part is empty, misses the cells or is no number.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5, 2.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]], dims=("x", "y"), coords=cells)
    >>> float(load_between(xr.Dataset({"pressure": pressure}), 0.0, 1.5))
    4.0
    """
    for name, value in (("start", start), ("stop", stop)):
        checks.instance(name, value, (float, int, np.number, xr.DataArray), "a number (metres) or a DataArray")
    load = line_load(dataset)
    along, place, half_cell = dimension_along(load, "x"), positions(load, "x"), 0.5 * cell_size(load, "x")
    if np.any(np.greater_equal(start, stop)):
        raise InvalidInputError("start, stop", (start, stop), "increasing (metres)")
    low, high = float((place - half_cell).min()), float((place + half_cell).max())
    if np.all(np.greater_equal(start, high)) or np.all(np.less_equal(stop, low)):
        raise InvalidInputError("start, stop", (start, stop), f"a part of the cells, {low:.4g} to {high:.4g} m")
    shared = (np.minimum(place + half_cell, stop) - np.maximum(place - half_cell, start)).clip(0.0)
    carried = (load * shared).sum(along, min_count=1)
    return named("normal_load", carried).assign_attrs(comment="between two positions along the axis")


def half_width(dataset: xr.Dataset) -> xr.Dataset:
    """Half-width of the contact at each position along the roller's axis, and the y of its middle.

    The border is resolved finer than the cells, see :mod:`contactstudy.analysis.border`, from the pressure alone;
    where few cells are loaded across y it is that of whole cells.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells.

    Returns
    -------
    Dataset
        Along x: `half_width` (m; 0 where nothing is loaded) and `contact_middle` (m, the y of the contact's middle;
        NaN where nothing is loaded).

    Raises
    ------
    InvalidInputError
        If there is no pressure.

    Examples
    --------
    >>> y = xr.DataArray((np.arange(40) - 19.5) / 16, dims="y")
    >>> pressure = np.sqrt(np.maximum(1 - y**2, 0)).expand_dims(x=[0.0]).assign_coords(y=y)
    >>> half_width(xr.Dataset({"pressure": pressure})).half_width.values.round(9).tolist()
    [1.0]
    """
    pressure = increasing(required_in_si(dataset, "pressure", normalized=True)["pressure"], "y")
    along = dimension_along(pressure, "y")
    low, high = reduced(contact_borders, [(pressure, [along]), (positions(pressure, "y"), [along])], 2)
    exists = pressure.notnull().any(along)
    width = (0.5 * (high - low)).fillna(0.0).where(exists)
    return xr.Dataset(
        {
            "half_width": named("half_width", width),
            "contact_middle": named("contact_middle", 0.5 * (low + high)),
        }
    )


def unloaded_gap(dataset: xr.Dataset) -> xr.DataArray:
    """Gap before deformation at each position along the roller's axis: the profile's drop and the tilt.

    Parameters
    ----------
    dataset : Dataset
        With `initial_gap`.

    Returns
    -------
    DataArray
        The smallest across y, m; NaN beyond the roller's ends.

    Raises
    ------
    InvalidInputError
        If there is no initial gap.

    Examples
    --------
    >>> gap = xr.DataArray([[1e-6, 0.0], [np.inf, np.inf]], dims=("x", "y"))
    >>> unloaded_gap(xr.Dataset({"initial_gap": gap})).values.tolist()
    [0.0, nan]
    """
    require(dataset, "initial_gap")
    gap = dataset["initial_gap"]
    smallest = gap.min(dimension_along(gap, "y"))
    smallest = smallest.where(np.isfinite(smallest))
    return named("unloaded_gap", smallest)


def axial_profiles(dataset: xr.Dataset) -> xr.Dataset:
    """Everything about the contact along the roller's axis, in one Dataset.

    Parameters
    ----------
    dataset : Dataset
        With `pressure`, and `initial_gap` for the unloaded gap.

    Returns
    -------
    Dataset
        Along x: `axial_pressure` (Pa), `line_load` (N/m), `half_width` and `contact_middle` (m), `unloaded_gap` (m).

    Raises
    ------
    InvalidInputError
        If there is no pressure.

    Examples
    --------
    >>> cells = {"x": [0.0, 1.0], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[0.0, 0.0], [2.0, 3.0]], dims=("x", "y"), coords=cells)
    >>> sorted(axial_profiles(xr.Dataset({"pressure": pressure})).data_vars)
    ['axial_pressure', 'contact_middle', 'half_width', 'line_load']
    """
    result = half_width(dataset).assign(axial_pressure=axial_pressure(dataset), line_load=line_load(dataset))
    if "initial_gap" in dataset:
        result = result.assign(unloaded_gap=unloaded_gap(dataset))
    return without_error(result, *map(str, result.data_vars))
