"""Contact results that engineers read off: along the roller's axis, and of the contact as a whole."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import cell_size, dimension_along, positions, require
from contactstudy.analysis.border import contact_borders
from contactstudy.analysis.peaks import peak


def _labelled(array: xr.DataArray, name: str, units: str, long_name: str) -> xr.DataArray:
    named = array.rename(name)
    named.attrs = {"units": units, "long_name": long_name}
    return named


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
    require(dataset, "pressure")
    pressure = dataset["pressure"]
    largest = pressure.max(dimension_along(pressure, "y"))
    return _labelled(largest, "axial_pressure", "Pa", "largest pressure across y")


def line_load(dataset: xr.Dataset) -> xr.DataArray:
    """Load per length at each position along the roller's axis, the integral of the pressure across y.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on uniform cells.

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
    require(dataset, "pressure")
    pressure = dataset["pressure"]
    load = pressure.sum(dimension_along(pressure, "y"), min_count=1) * cell_size(pressure, "y")
    return _labelled(load, "line_load", "N/m", "load per length along the axis")


def half_width(dataset: xr.Dataset) -> xr.Dataset:
    """Half-width of the contact at each position along the roller's axis, and the y of its middle.

    The border is resolved finer than the cells, see :mod:`contactstudy.analysis.border`, from the pressure alone;
    where few cells are loaded across y it is that of whole cells.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on uniform cells.

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
    require(dataset, "pressure")
    pressure = dataset["pressure"]
    along = dimension_along(pressure, "y")
    low, high = xr.apply_ufunc(
        contact_borders,
        pressure,
        positions(pressure, "y"),
        input_core_dims=[[along], [along]],
        output_core_dims=[[], []],
        dask="parallelized",
        dask_gufunc_kwargs={"allow_rechunk": True},
        output_dtypes=[np.float64, np.float64],
    )
    exists = pressure.notnull().any(along)
    width = (0.5 * (high - low)).fillna(0.0).where(exists)
    return xr.Dataset(
        {
            "half_width": _labelled(width, "half_width", "m", "half-width of the contact"),
            "contact_middle": _labelled(0.5 * (low + high), "contact_middle", "m", "y of the contact's middle"),
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
    return _labelled(smallest, "unloaded_gap", "m", "smallest gap across y before deformation")


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
    return result


def _first_and_last(values: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """First and last positive number along the last axis; NaN if there is none."""
    loaded = values > 0
    first, last = loaded.argmax(axis=-1), values.shape[-1] - 1 - loaded[..., ::-1].argmax(axis=-1)
    ends = [np.take_along_axis(values, at[..., None], axis=-1)[..., 0] for at in (first, last)]
    none = ~loaded.any(axis=-1)
    return np.where(none, np.nan, ends[0]), np.where(none, np.nan, ends[1])


def edge_pressure(dataset: xr.Dataset) -> xr.Dataset:
    """Pressure in the first and in the last loaded cells along the roller's axis, the largest across y.

    Parameters
    ----------
    dataset : Dataset
        With `pressure`.

    Returns
    -------
    Dataset
        `edge_pressure_first` and `edge_pressure_last`, Pa; NaN if nothing is loaded.

    Raises
    ------
    InvalidInputError
        If there is no pressure.

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0], [3.0], [1.0], [2.0]], dims=("x", "y"))
    >>> ends = edge_pressure(xr.Dataset({"pressure": pressure}))
    >>> float(ends.edge_pressure_first), float(ends.edge_pressure_last)
    (3.0, 2.0)
    """
    axial = axial_pressure(dataset)
    first, last = xr.apply_ufunc(
        _first_and_last,
        axial,
        input_core_dims=[[dimension_along(axial, "x")]],
        output_core_dims=[[], []],
        dask="parallelized",
        dask_gufunc_kwargs={"allow_rechunk": True},
        output_dtypes=[axial.dtype, axial.dtype],
    )
    return xr.Dataset(
        {
            "edge_pressure_first": _labelled(first, "first", "Pa", "pressure in the first loaded cells along x"),
            "edge_pressure_last": _labelled(last, "last", "Pa", "pressure in the last loaded cells along x"),
        }
    )


def _extent(pressure: xr.DataArray, axis: str, touched: xr.DataArray) -> xr.DataArray:
    """Length of whole cells from the first to the last that `touched` marks; 0 if there is none."""
    dim = dimension_along(pressure, axis)
    place = positions(pressure, axis).where(touched)
    extent = place.max(dim) - place.min(dim) + cell_size(pressure, axis)
    return extent.where(touched.any(dim), 0.0)


def contact_results(dataset: xr.Dataset, about: float | None = None) -> xr.Dataset:
    """Scalars of the contact: peak and edge pressure, area, length and its loss, and where the load acts.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve` or of :func:`contactstudy.open_study`; `initial_gap` says how far
        roller and body face each other.
    about : float, optional
        Position x that the moment is taken about, m; default: the middle of where roller and body face each other
        (mid-length of the roller unless it overhangs), or of the grid if there is no `initial_gap`.

    Returns
    -------
    Dataset
        `peak_pressure` with ``_x`` and ``_y``; `edge_pressure_first`, `edge_pressure_last` (Pa); `contact_area` (m2),
        `contact_length`, `contact_width` (m), in whole cells; `contact_length_loss` (m, what of the facing length
        carries nothing); `resultant` (N) of the pressure, `load_position` (m, the x where it acts) and `moment`
        (N m, positive if it acts beyond `about`). NaN for cases without pressure.

    Raises
    ------
    InvalidInputError
        If there is no pressure, or `about` is not a number.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5, 2.5, 3.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[0, 0], [3, 3], [1, 1], [0, 0]], dims=("x", "y"), coords=cells)
    >>> result = contact_results(xr.Dataset({"pressure": pressure, "initial_gap": 0 * pressure}))
    >>> [float(result[name]) for name in ("contact_area", "contact_length_loss", "resultant", "moment")]
    [4.0, 2.0, 8.0, -2.0]
    """
    require(dataset, "pressure")
    pressure = dataset["pressure"]
    x, y = dimension_along(pressure, "x"), dimension_along(pressure, "y")
    known = pressure.notnull().any([x, y]).compute()
    loaded = (pressure > 0).compute()
    dx, dy = cell_size(pressure, "x"), cell_size(pressure, "y")
    along, across = loaded.any(y), loaded.any(x)
    length = _extent(pressure, "x", along)
    load = line_load(dataset).compute()
    place = positions(pressure, "x")
    resultant = load.sum(x) * dx
    position = (load * place).sum(x) * dx / resultant.where(resultant > 0)
    facing = unloaded_gap(dataset).notnull().compute() if "initial_gap" in dataset else along.notnull()
    opposite = place.where(facing)
    middle = 0.5 * (opposite.min(x) + opposite.max(x)) if about is None else checks.finite("about", about, "metres")
    values: dict[str, tuple[xr.DataArray, str, str]] = {
        "contact_area": (loaded.sum([x, y]) * dx * dy, "m2", "area of the loaded cells"),
        "contact_length": (length, "m", "contact length, in whole cells"),
        "contact_width": (_extent(pressure, "y", across), "m", "contact width, in whole cells"),
        "resultant": (resultant, "N", "resultant of the pressure"),
        "load_position": (position, "m", "x where the resultant acts"),
        "moment": (resultant * (position - middle), "N m", "moment of the pressure, positive for a load at larger x"),
    }
    if "initial_gap" in dataset:
        loss = _extent(pressure, "x", facing) - length
        values["contact_length_loss"] = (loss, "m", "length where roller and body face each other without load")
    result = xr.merge([peak(dataset, "pressure"), edge_pressure(dataset)])
    return result.assign(
        {
            name: _labelled(value.where(known).reset_coords(drop=True), name, units, meaning)
            for name, (value, units, meaning) in values.items()
        }
    )
