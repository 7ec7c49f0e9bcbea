"""Summaries of one solved case: the scalars that a parametric study compares."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.errors import InvalidInputError


def dimension_along(array: xr.DataArray, axis: str) -> str:
    """Dimension of `array` along an axis: the axis' own name, or one that begins with it, such as ``x_field``.

    Parameters
    ----------
    array : DataArray
        Any field.
    axis : {"x", "y", "z"}
        The axis.

    Raises
    ------
    InvalidInputError
        If there is no such dimension, or more than one.

    Examples
    --------
    >>> dimension_along(xr.DataArray(np.zeros((2, 3)), dims=("x_field", "z")), "x")
    'x_field'
    """
    found = [str(dim) for dim in array.dims if dim == axis or str(dim).startswith(f"{axis}_")]
    if len(found) != 1:
        raise InvalidInputError("dims", array.dims, f"with exactly one dimension along {axis}")
    return found[0]


def _scalar(value: float, units: str, long_name: str) -> xr.DataArray:
    return xr.DataArray(float(value), attrs={"units": units, "long_name": long_name})


def _peak(array: xr.DataArray, name: str, meaning: str) -> dict[str, xr.DataArray]:
    """Largest value of a field and where it is."""
    values = np.asarray(array.values)
    if np.isnan(values).all():
        raise InvalidInputError(name, "nan everywhere", "a field with at least one number")
    at = np.unravel_index(int(np.nanargmax(values)), values.shape)
    peak = {f"peak_{name}": _scalar(values[at], "Pa", f"largest {meaning}")}
    for dim, index in zip(array.dims, at, strict=True):
        axis = str(dim)[0]
        position = float(array[dim].values[index])
        peak[f"peak_{name}_{axis}"] = _scalar(position, "m", f"{axis} of the largest {meaning}")
    return peak


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

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0, 1.0], [2.0, 0.0]], dims=("x", "y"))
    >>> axial_pressure(xr.Dataset({"pressure": pressure})).values.tolist()
    [1.0, 2.0]
    """
    pressure = dataset["pressure"]
    axial = pressure.max(dimension_along(pressure, "y"))
    axial.attrs = {"units": "Pa", "long_name": "largest pressure across y"}
    return axial


def pressure_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Peak pressure and its place, the pressure at both ends of the contact, and the contact's length.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`: `pressure`, and for the ratios `hertz_max_pressure`.

    Returns
    -------
    Dataset
        Scalars `peak_pressure` with ``_x`` and ``_y``, `end_pressure_first` and `end_pressure_last` (the pressure over
        p0 in the first and the last loaded cells along the axis), their mean `end_pressure`, `contact_length` and
        `contact_width` (m, over whole cells).

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0], [3.0], [1.0], [2.0]], dims=("x", "y"), coords={"x": [0, 1, 2, 3], "y": [0]})
    >>> result = pressure_summary(xr.Dataset({"pressure": pressure, "hertz_max_pressure": 2.0}))
    >>> float(result.peak_pressure_x), float(result.end_pressure), float(result.contact_length)
    (1.0, 1.25, 3.0)
    """
    pressure = dataset["pressure"]
    x, y = dimension_along(pressure, "x"), dimension_along(pressure, "y")
    result = _peak(pressure, "pressure", "contact pressure")
    scale = float(dataset["hertz_max_pressure"])
    ratios = axial_pressure(dataset).values / scale
    loaded = np.flatnonzero(ratios > 0)
    first, last = (ratios[loaded[0]], ratios[loaded[-1]]) if loaded.size else (np.nan, np.nan)
    result["end_pressure_first"] = _scalar(first, "1", "pressure in the first loaded cells, over p0")
    result["end_pressure_last"] = _scalar(last, "1", "pressure in the last loaded cells, over p0")
    result["end_pressure"] = _scalar(0.5 * (first + last), "1", "mean of the pressures at both ends, over p0")
    for name, dim, other in (("contact_length", x, y), ("contact_width", y, x)):
        positions = pressure[dim].values
        touched = positions[(pressure > 0).any(other).values]
        step = (positions[-1] - positions[0]) / max(positions.size - 1, 1)
        extent = touched[-1] - touched[0] + step if touched.size else 0.0
        result[name] = _scalar(extent, "m", f"{name.replace('_', ' ')}, in whole cells")
    return xr.Dataset(result)


def stress_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Largest von Mises stress and its place; empty if the Dataset holds no stresses.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`.

    Returns
    -------
    Dataset
        Scalars `peak_von_mises` (Pa) and `peak_von_mises_x`, ``_y``, ``_z`` (m).

    Examples
    --------
    >>> stress = xr.DataArray([[[1.0, 4.0]]], dims=("x", "y", "z"), coords={"x": [0], "y": [0], "z": [0, 2]})
    >>> float(stress_summary(xr.Dataset({"von_mises": stress})).peak_von_mises_z)
    2.0
    """
    if "von_mises" not in dataset:
        return xr.Dataset()
    return xr.Dataset(_peak(dataset["von_mises"], "von_mises", "von Mises stress"))


def summarize(dataset: xr.Dataset) -> xr.Dataset:
    """Every summary of a solved case, together with the scalars that it has already.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`; stresses may be absent.

    Returns
    -------
    Dataset
        Scalars only: those of `dataset`, of :func:`pressure_summary` and of :func:`stress_summary`.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0, 1], "y": [0]})
    >>> result = summarize(xr.Dataset({"pressure": pressure, "hertz_max_pressure": 2.0, "iterations": 7}))
    >>> int(result.iterations), float(result.peak_pressure)
    (7, 2.0)
    """
    own = dataset[[name for name, variable in dataset.data_vars.items() if variable.ndim == 0]]
    own = own.reset_coords(drop=True).drop_attrs(deep=False)
    return own.assign(pressure_summary(dataset).data_vars).assign(stress_summary(dataset).data_vars)
