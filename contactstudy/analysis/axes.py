"""Dimensions and positions along x, y and z, in a result of one case and in an opened study alike.

A result has the dimensions ``x``, ``y``, ``z`` with positions as coordinates; stresses at positions of their own have
``x_field``, ``y_field``. Where the cases of a study share positions over the half-width, the dimension is ``x_over_a``;
where they do not, it is ``x_index``. Each case's positions in metres are then the coordinate ``x``, padded with NaN.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.arrays.required import require
from contactstudy.arrays.variables import AXES
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


def axis_dimensions(array: xr.DataArray) -> dict[str, str]:
    """Axes that `array` extends along, each with its dimension.

    Examples
    --------
    >>> axis_dimensions(xr.DataArray(np.zeros((2, 3)), dims=("friction", "z_index")))
    {'z': 'z_index'}
    """
    along = {}
    for axis in AXES:
        if any(dim == axis or str(dim).startswith(f"{axis}_") for dim in array.dims):
            along[axis] = dimension_along(array, axis)
    return along


def positions(array: xr.DataArray, axis: str) -> xr.DataArray:
    """Positions of `array` along an axis, metres; NaN where a case of a study has fewer than others.

    Parameters
    ----------
    array : DataArray
        A field with its coordinates.
    axis : {"x", "y", "z"}
        The axis.

    Returns
    -------
    DataArray
        With the dimension along the axis, and those of the study if its cases differ.

    Raises
    ------
    InvalidInputError
        If there is not exactly one such dimension, or it has no positions.

    Examples
    --------
    >>> array = xr.DataArray([1.0, 2.0], dims="x_index", coords={"x": ("x_index", [0.0, 0.5])})
    >>> positions(array, "x").values.tolist()
    [0.0, 0.5]
    """
    dim = dimension_along(array, axis)
    name = position_name(dim)
    if name not in array.coords:
        raise no_positions(array, name)
    return array[name].reset_coords(drop=True)


def no_positions(array: xr.DataArray | xr.Dataset, name: str) -> InvalidInputError:
    """Return the error of an array that has no positions `name`."""
    return InvalidInputError("coords", sorted(map(str, array.coords)), f"with the positions {name} (metres)")


def position_name(dim: str) -> str:
    """Name of the coordinate with the positions along a dimension, metres.

    Examples
    --------
    >>> position_name("x_field_index"), position_name("y_over_a"), position_name("z")
    ('x_field', 'y', 'z')
    """
    return dim.removesuffix("_index").removesuffix("_over_a")


def in_order(dataset: xr.Dataset) -> xr.Dataset:
    """Return one case with its positions increasing, in which stresses may be asked for in any order.

    Examples
    --------
    >>> in_order(xr.Dataset({"von_mises": ("z", [3.0, 1.0])}, {"z": [1e-3, 0.0]})).von_mises.values.tolist()
    [1.0, 3.0]
    """
    turned = [
        dim for dim, index in dataset.indexes.items() if str(dim)[:1] in AXES and not index.is_monotonic_increasing
    ]
    return dataset.sortby(turned) if turned else dataset


def increasing(array: xr.DataArray, axis: str) -> xr.DataArray:
    """Return a field with its positions along an axis increasing; padded fields are in order already.

    Examples
    --------
    >>> increasing(xr.DataArray([3.0, 1.0], dims="x", coords={"x": [0.5, 0.0]}), "x").values.tolist()
    [1.0, 3.0]
    """
    dim = dimension_along(array, axis)
    known = array.indexes.get(dim)
    return array if known is None or known.is_monotonic_increasing else array.sortby(dim)


def cell_size(array: xr.DataArray, axis: str) -> xr.DataArray:
    """Width of the cells along an axis, metres: as told by ``<axis>_width``, or the distance of uniform positions.

    A single position has no width, 0.
    """
    if f"{axis}_width" in array.coords:
        return array[f"{axis}_width"].reset_coords(drop=True)
    dim, place = dimension_along(array, axis), positions(array, axis)
    return (place.max(dim) - place.min(dim)) / np.maximum(place.count(dim) - 1, 1)


def single_case(dataset: xr.Dataset) -> xr.Dataset:
    """One case, selected from a study, in the form that :func:`contactstudy.solve` returns.

    Parameters
    ----------
    dataset : Dataset
        A result of one case; or an opened study with one value of each swept parameter selected.

    Returns
    -------
    Dataset
        With positions as dimensions instead of ``x_index`` or ``x_over_a``, increasing, and without padding; a result
        of :func:`contactstudy.solve` mostly as it is.

    Raises
    ------
    InvalidInputError
        If there is more than one case.

    Examples
    --------
    >>> padded = xr.Dataset({"pressure": ("x_index", [1.0, 2.0, np.nan])}, {"x": ("x_index", [0.0, 0.5, np.nan])})
    >>> single_case(padded).pressure.x.values.tolist()
    [0.0, 0.5]
    """
    require(dataset)
    cases = dataset[["hertz_half_width"]].sizes if "hertz_half_width" in dataset else {}
    if any(size > 1 for size in cases.values()):
        raise InvalidInputError(
            "dataset", dict(cases), "a single case", "select one, for example with .isel(...) or .sel(...)"
        )
    one = dataset.isel(dict.fromkeys(cases, 0))
    for dim in [str(dim) for dim in one.dims if str(dim) != position_name(str(dim))]:
        name = position_name(dim)
        if name not in one.coords or one[name].dims != (dim,):
            raise InvalidInputError("dataset", dict(one.sizes), "a single case", f"with the positions {name}")
        kept = np.flatnonzero(np.isfinite(one[name].values))
        # A case without stresses has no positions at all.
        one = one.isel({dim: kept}).swap_dims({dim: name}) if kept.size else one.drop_dims(dim)
    return in_order(one)
