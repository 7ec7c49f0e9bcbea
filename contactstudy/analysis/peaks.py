"""Largest values of a field and where they are: overall, and in each cross-section of the body."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy.analysis.axes import axis_dimensions, positions
from contactstudy.analysis.measures import measure
from contactstudy.dataset import COORDINATES, VARIABLES
from contactstudy.errors import InvalidInputError


def _largest(values: npt.NDArray[Any], axes: int) -> tuple[npt.NDArray[Any], npt.NDArray[np.int64]]:
    """Largest number over the last `axes` axes and its flat place; NaN and 0 where there is no number."""
    flat = values.reshape(*values.shape[: values.ndim - axes], -1)
    at = np.where(np.isnan(flat), -np.inf, flat).argmax(axis=-1)
    return np.take_along_axis(flat, at[..., None], axis=-1)[..., 0], at


def _peak(array: xr.DataArray, name: str, over: dict[str, str]) -> xr.Dataset:
    """Largest value of `array` over some axes, with the positions along them."""
    dims = list(over.values())
    value, flat = xr.apply_ufunc(
        _largest,
        array,
        input_core_dims=[dims],
        output_core_dims=[[], []],
        kwargs={"axes": len(dims)},
        dask="parallelized",
        dask_gufunc_kwargs={"allow_rechunk": True},
        output_dtypes=[np.float64, np.int64],
    )
    value, flat = value.compute(), flat.compute()
    meaning = str(array.attrs.get("long_name", name))
    known = VARIABLES.get(name)
    value.attrs = {"units": array.attrs.get("units", known.units if known else ""), "long_name": f"largest {meaning}"}
    result = {f"peak_{name}": value}
    shape = tuple(array.sizes[dim] for dim in dims)
    indices = np.unravel_index(flat.values, shape)
    for (axis, dim), index in zip(over.items(), indices, strict=True):
        chosen = flat.copy(data=index).reset_coords(drop=True)
        place = positions(array, axis).isel({dim: chosen}).where(value.notnull())
        place.attrs = {"units": COORDINATES[axis].units, "long_name": f"{axis} of the largest {meaning}"}
        result[f"peak_{name}_{axis}"] = place.reset_coords(drop=True)
    return xr.Dataset(result)


def peak(dataset: xr.Dataset, variable: str = "von_mises") -> xr.Dataset:
    """Largest value of a variable and its place.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, or of :func:`contactstudy.open_study`.
    variable : str
        A variable, or a measure computed from the stresses, see :func:`contactstudy.analysis.measure`: `pressure`,
        `von_mises`, `tresca`, `maximum_shear`, `orthogonal_shear_range` ...

    Returns
    -------
    Dataset
        ``peak_<variable>`` and its place ``peak_<variable>_x``, ``_y``, ``_z`` in metres, as far as the variable
        extends along these; scalars, or along the parameters of a study. NaN for cases without the variable.

    Raises
    ------
    InvalidInputError
        If there is no such variable or measure.

    Examples
    --------
    >>> stress = xr.DataArray([[[1.0, 4.0]]], dims=("x", "y", "z"), coords={"x": [0], "y": [0], "z": [0, 2]})
    >>> result = peak(xr.Dataset({"von_mises": stress}))
    >>> float(result.peak_von_mises), float(result.peak_von_mises_z)
    (4.0, 2.0)
    """
    array = measure(dataset, variable)
    over = axis_dimensions(array)
    if not over:
        raise InvalidInputError("variable", variable, "a field along x, y or z")
    return _peak(array, variable, over)


def section_peak(dataset: xr.Dataset, variable: str = "von_mises") -> xr.Dataset:
    """Largest value of a variable in each cross-section ``x = const``, and its place in it.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, or of :func:`contactstudy.open_study`.
    variable : str
        As for :func:`peak`.

    Returns
    -------
    Dataset
        Along x: ``peak_<variable>`` and its place ``peak_<variable>_y``, ``_z`` (the depth) in metres.

    Raises
    ------
    InvalidInputError
        If there is no such variable or measure, or it does not extend along x and another axis.

    Examples
    --------
    >>> stress = xr.DataArray([[1.0, 4.0], [3.0, 2.0]], dims=("x", "z"), coords={"x": [0, 1], "z": [0, 2]})
    >>> section_peak(xr.Dataset({"tresca": stress}), "tresca").peak_tresca_z.values.tolist()
    [2.0, 0.0]
    """
    array = measure(dataset, variable)
    over = axis_dimensions(array)
    if "x" not in over or len(over) < 2:
        raise InvalidInputError("variable", variable, "a field along x and at least one of y and z")
    del over["x"]
    return _peak(array, variable, over)
