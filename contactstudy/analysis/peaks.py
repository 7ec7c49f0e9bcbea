"""Largest values of a field and where they are: overall, and in each cross-section of the body."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import axis_dimensions, positions
from contactstudy.analysis.measures import measure
from contactstudy.analysis.reduced import reduced
from contactstudy.arrays.variables import UNBOUNDED, named, variable_of
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError

AT_POINT = f"one of the given points, {UNBOUNDED}"
OF_POINTS = f"largest of the given points, {UNBOUNDED}; beside a singular end it has no limit"


def _largest(values: Array, *places: Array) -> tuple[Array, ...]:
    """Largest number over the last axes, one for each of `places`, and where it is; NaN where there is no number."""
    lead, shape = values.shape[: values.ndim - len(places)], values.shape[values.ndim - len(places) :]
    flat = values.reshape(*lead, -1)
    at = np.where(np.isnan(flat), -np.inf, flat).argmax(axis=-1)
    largest = np.take_along_axis(flat, at[..., None], axis=-1)[..., 0]
    found = []
    for place, index in zip(places, np.unravel_index(at, shape), strict=True):
        everywhere = np.broadcast_to(place, (*lead, place.shape[-1]))
        position = np.take_along_axis(everywhere, np.asarray(index)[..., None], axis=-1)[..., 0]
        found.append(np.where(np.isnan(largest), np.nan, position))
    return (largest, *found)


def _peak(array: xr.DataArray, name: str, over: dict[str, str]) -> xr.Dataset:
    """Largest value of `array` over some axes, with the positions along them."""
    places = [(positions(array, axis), [dim]) for axis, dim in over.items()]
    found = reduced(_largest, [(array, list(over.values())), *places], 1 + len(over))
    base = variable_of(name, array.attrs)
    names = (f"peak_{name}", *(f"peak_{name}_{axis}" for axis in over))
    labelled = {each: named(each, value, base) for each, value in zip(names, found, strict=True)}
    for each, value in labelled.items():
        value.attrs["comment"] = OF_POINTS if each == f"peak_{name}" else AT_POINT
    return xr.Dataset(labelled).compute()


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
