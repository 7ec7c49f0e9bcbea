"""Dimensions and positions along x, y and z, in a result of one case and in an opened study.

Stresses at separate positions have ``x_field``, ``y_field``. In an opened study the dimension is ``x_over_a``, with
``cells="original"`` ``x_index``; the coordinate ``x`` contains the positions of each case in metres, padded with NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, solved_case
from contactstudy.arrays.variables import (
    AXES,
    COORDINATES,
    POSITIONS,
    Variable,
    labels,
    require,
    require_in_si,
    variable_of,
)
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import describe_profile


def dimension_along(array: xr.DataArray, axis: str) -> str:
    """Return the dimension of an array along an axis: named after the axis, or with this prefix, as ``x_field``.

    Parameters
    ----------
    array : DataArray
        Any field.
    axis : {"x", "y", "z"}
        The axis.

    Raises
    ------
    InvalidInputError
        If the array lacks such a dimension, or more than one.

    Examples
    --------
    >>> dimension_along(xr.DataArray(np.zeros((2, 3)), dims=("x_field", "z")), "x")
    'x_field'
    """
    dims = [str(dim) for dim in array.dims if dim == axis or str(dim).startswith(f"{axis}_")]
    if len(dims) != 1:
        raise InvalidInputError("dims", array.dims, f"with exactly one dimension along {axis}")
    return dims[0]


def axis_dimensions(array: xr.DataArray) -> dict[str, str]:
    """Return the dimensions of an array by the axis along which they extend."""
    axes = [axis for axis in AXES if any(dim == axis or str(dim).startswith(f"{axis}_") for dim in array.dims)]
    return {axis: dimension_along(array, axis) for axis in axes}


def positions(array: xr.DataArray, axis: str) -> xr.DataArray:
    """Return the positions of an array along an axis, metres; NaN in the padding of a study.

    Parameters
    ----------
    array : DataArray
        A field with its coordinates.
    axis : {"x", "y", "z"}
        The axis.

    Returns
    -------
    DataArray
        Along the dimension of the axis, and along the study's dimensions if its cases have different positions.

    Raises
    ------
    InvalidInputError
        If the array does not have exactly one such dimension, or lacks its positions.

    Examples
    --------
    >>> array = xr.DataArray([1.0, 2.0], dims="x_index", coords={"x": ("x_index", [0.0, 0.5])})
    >>> positions(array, "x").values.tolist()
    [0.0, 0.5]
    """
    name = position_name(dimension_along(array, axis))
    if name not in array.coords:
        raise missing_positions_error(array, name)
    return array[name].reset_coords(drop=True)


def missing_positions_error(array: xr.DataArray | xr.Dataset, name: str) -> InvalidInputError:
    """Return the error of an array without the positions `name`."""
    return InvalidInputError("coords", sorted(map(str, array.coords)), f"with the positions {name} (metres)")


def position_name(dim: str) -> str:
    """Return the name of the coordinate with the positions along a dimension, metres."""
    return dim.removesuffix("_index").removesuffix("_over_a")


def sort_positions(array: xr.DataArray, axis: str) -> xr.DataArray:
    """Return a field with increasing positions along an axis; padded fields are sorted already."""
    dim = dimension_along(array, axis)
    index = array.indexes.get(dim)
    return array if index is None or index.is_monotonic_increasing else array.sortby(dim)


def without_coordinates(array: xr.DataArray, *dims: str) -> xr.DataArray:
    """Return an array without its coordinates along some dimensions."""
    return array.drop_vars([name for name in array.coords if set(dims) & set(array[name].dims)])


def cell_size(array: xr.DataArray, axis: str) -> xr.DataArray:
    """Return the width of the cells along an axis, metres; a single position has the width 0."""
    if f"{axis}_width" in array.coords:
        return array[f"{axis}_width"].reset_coords(drop=True)
    dim, centres = dimension_along(array, axis), positions(array, axis)
    return (centres.max(dim) - centres.min(dim)) / np.maximum(centres.count(dim) - 1, 1)


def cell_edges(array: xr.DataArray, axis: str) -> tuple[xr.DataArray, xr.DataArray]:
    """Return the lower and the upper edge of each cell along an axis, metres; NaN in padding."""
    centres, half_width = positions(array, axis), 0.5 * cell_size(array, axis)
    return centres - half_width, centres + half_width


def single_case(dataset: xr.Dataset) -> xr.Dataset:
    """Return one case, selected from a study, in the form of a result of :func:`contactstudy.solve`.

    Parameters
    ----------
    dataset : Dataset
        A result of one case; or an opened study with one value of each swept parameter.

    Returns
    -------
    Dataset
        With increasing positions as dimensions instead of ``x_index`` or ``x_over_a``, and without padding.

    Raises
    ------
    InvalidInputError
        If the Dataset contains more than one case.

    Examples
    --------
    >>> padded = xr.Dataset({"pressure": ("x_index", [1.0, 2.0, np.nan])}, {"x": ("x_index", [0.0, 0.5, np.nan])})
    >>> single_case(padded).pressure.x.values.tolist()
    [0.0, 0.5]
    """
    require(dataset)
    sweep_sizes = dataset[["hertz_half_width"]].sizes if "hertz_half_width" in dataset else {}
    if any(size > 1 for size in sweep_sizes.values()):
        raise InvalidInputError(
            "dataset", dict(sweep_sizes), "a single case", "select one, for example with .isel(...) or .sel(...)"
        )
    case = dataset.isel(dict.fromkeys(sweep_sizes, 0))
    for dim in [str(dim) for dim in case.dims if str(dim) != position_name(str(dim))]:
        name = position_name(dim)
        if name not in case.coords or case[name].dims != (dim,):
            raise InvalidInputError("dataset", dict(case.sizes), "a single case", f"with the positions {name}")
        finite_indices = np.flatnonzero(np.isfinite(case[name].values))
        # A case without stresses has no finite positions of stresses.
        case = case.isel({dim: finite_indices}).swap_dims({dim: name}) if finite_indices.size else case.drop_dims(dim)
    if "x_field" in case.coords and case["x_field"].dims == ("x",):
        # Stresses that share an axis with the pressure move to their own positions.
        stress_names = [name for name, array in case.data_vars.items() if {"x", "z"} <= set(array.dims)]
        finite_indices = np.flatnonzero(np.isfinite(case["x_field"].values))
        stresses = case[stress_names]
        if stress_names:
            stresses = stresses.isel(x=finite_indices).swap_dims(x="x_field")
            stresses = stresses.drop_vars(["x", "x_over_a", "x_width"], errors="ignore")
        case = case.drop_vars([*stress_names, "x_field"]).assign(stresses.data_vars)
    unsorted = [
        dim for dim, index in case.indexes.items() if str(dim)[:1] in AXES and not index.is_monotonic_increasing
    ]
    return case.sortby(unsorted) if unsorted else case


def reduce_dims(
    function: Callable[..., tuple[Array, ...]], arguments: Sequence[tuple[xr.DataArray, Sequence[str]]], count: int
) -> tuple[xr.DataArray, ...]:
    """Apply a function that reduces the last axes of arrays to two or more outputs; dask arrays stay lazy."""
    results: tuple[xr.DataArray, ...] = xr.apply_ufunc(
        function,
        *(array for array, _ in arguments),
        input_core_dims=[list(dims) for _, dims in arguments],
        output_core_dims=[[]] * count,
        dask="parallelized",
        dask_gufunc_kwargs={"allow_rechunk": True},
        output_dtypes=[np.float64] * count,
    )
    return results


POWERS = {  # Powers of a and of p0 in the scale of each unit, and the scale's text
    "m": (1, 0, "a"),
    "m2": (2, 0, "a**2"),
    "Pa": (0, 1, "p0"),
    "N/m": (1, 1, "p0 a"),
    "N": (2, 1, "p0 a**2"),
    "N m": (3, 1, "p0 a**3"),
}
SCALES = ("hertz_half_width", "hertz_max_pressure")  # The scales themselves, which stay in SI


def normalized(dataset: xr.Dataset) -> xr.Dataset:
    """Return lengths over a, stresses over p0, loads over p0 a**2: variables and positions without unit.

    Parameters
    ----------
    dataset : Dataset
        With `hertz_half_width` and `hertz_max_pressure`.

    Returns
    -------
    Dataset
        The same variables; each variable with a unit in `POWERS` is divided by its scale, has the unit ``1``, and names
        the scale. `hertz_half_width` and `hertz_max_pressure` stay in SI; so do swept parameters, and positions in
        metres that cases of different a share: use the coordinates ``x_over_a`` and similar instead.

    Raises
    ------
    InvalidInputError
        If a scale is missing.

    Examples
    --------
    >>> pressure = xr.DataArray([2.0e9], dims="x", coords={"x": [1e-4]}, attrs={"units": "Pa"})
    >>> result = xr.Dataset({"pressure": pressure, "hertz_half_width": 5e-5, "hertz_max_pressure": 1e9})
    >>> scaled = normalized(result)
    >>> float(scaled.pressure[0]), float(scaled.x[0]), scaled.pressure.attrs["units"]
    (2.0, 2.0, '1')
    """
    require(dataset, *SCALES)
    # Divide variables, not arrays: arrays would be aligned by their positions, which change as well.
    half_width, max_pressure = (dataset[name].variable for name in SCALES)

    def scale_variable(array: xr.DataArray, specification: Variable) -> xr.Variable:
        length_power, pressure_power, scale = POWERS[specification.units]
        quotient = array.variable / (half_width**length_power * max_pressure**pressure_power)
        # Dimensions of the study come first, as in the result.
        quotient = quotient.transpose(*(dim for dim in quotient.dims if dim not in array.dims), *array.dims)
        quotient.attrs = {**array.attrs, "units": "1", "long_name": f"{specification.long_name}, over {scale}"}
        return quotient

    variables, coordinates = {}, {}
    for name, array in dataset.data_vars.items():
        specification = variable_of(str(name), array.attrs)
        if specification.units in POWERS and name not in SCALES:
            variables[name] = scale_variable(array, specification)
    for name, coordinate in dataset.coords.items():
        specification = variable_of(str(name), coordinate.attrs, coordinate=True)
        is_shared = name in dataset.dims and half_width.ndim > 0
        if name in COORDINATES and specification.units == "m" and not is_shared:
            coordinates[name] = scale_variable(coordinate, specification)
            coordinates[name].attrs |= labels(f"{name}_over_a", coordinate=True)  # as in positions_over_a
    return dataset.assign_coords(coordinates).assign(variables)


def positions_over_a(dataset: xr.Dataset) -> xr.Dataset:
    """Return a result with positions over a as dimensions, for ``.sel(x_over_a=1, method="nearest")``.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`; or an opened study whose cases share positions, in metres or over a.

    Returns
    -------
    Dataset
        The same values in SI along ``x_over_a``, ``y_over_a``, ``z_over_a``, and similar for stresses at separate
        positions; the coordinates ``x``, ``y``, ``z`` are in metres. A result of `solve` also has the coordinates
        `e_over_a`, `friction`, `gamma` and `profile` of an opened study, if its case has a single value of them:
        several results on the same cells can be joined along one of them. :func:`single_case` is the inverse.

    Raises
    ------
    InvalidInputError
        If half-width or positions are missing, positions over a differ between the cases, or `x` is over a already.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, solve
    >>> body = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9)
    >>> result = positions_over_a(solve(case, stresses=False))
    >>> row = result.pressure.sel(x_over_a=3.8, method="nearest").sel(y_over_a=slice(-0.5, 0.5))
    >>> row.dims, round(float(row.e_over_a), 2), round(float(row.gamma), 2)
    (('y_over_a',), 1.54, 0.1)
    """
    dataset = require_in_si(dataset, "hertz_half_width")
    half_width = dataset["hertz_half_width"]
    if half_width.size == 1:
        dataset = single_case(dataset)
        half_width = dataset["hertz_half_width"]
        dataset = dataset.assign_coords(_case_coordinates(dataset))
    for dim in map(str, dataset.dims):
        name = position_name(dim)
        scaled_name = f"{name}_over_a"
        if name not in POSITIONS or dim == scaled_name:
            continue
        if dataset[dim].attrs.get("units") == "1":
            raise InvalidInputError(dim, "over a", "in metres", "results of analysis.normalized are over a already")
        if half_width.ndim == 0:
            if dim not in dataset.coords:
                raise missing_positions_error(dataset, name)
            scaled_positions = dataset[dim].variable / half_width.variable
        elif scaled_name in dataset.coords and dataset[scaled_name].dims == (dim,):
            scaled_positions = dataset[scaled_name].variable
        else:
            allowed = f"with the same {scaled_name} in all cases"
            raise InvalidInputError("dataset", f"{dim} of {half_width.size} cases", allowed, "select one case")
        scaled_positions.attrs = labels(scaled_name, coordinate=True)
        dataset = dataset.assign_coords({scaled_name: scaled_positions}).swap_dims({dim: scaled_name})
    return dataset


def _case_coordinates(result: xr.Dataset) -> dict[str, Any]:
    """Coordinates of a result that identify its case: e/a, friction, gamma and profile, as far as present."""
    if "case" not in attribute(result, INPUTS_ATTRIBUTE):
        return {}
    case = solved_case(result)
    low, high = case.body.extent
    values: dict[str, float | str] = {}
    if np.isfinite(low):
        values["e_over_a"] = case.roller_start / float(result["hertz_half_width"])
    if isinstance(case.friction, float):
        values["friction"] = case.friction
    if np.isfinite(high - low):
        values["gamma"] = (high - low) / case.roller.radius
    values["profile"] = describe_profile(case.roller.profile)
    return {name: ((), value, labels(name, coordinate=True)) for name, value in values.items() if name not in result}
