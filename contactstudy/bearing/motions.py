"""Arguments and results of a contact law as labelled arrays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.units import in_si
from contactstudy.arrays.variables import describe
from contactstudy.bearing.energy_spline import Motion
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

Values = float | list[float] | tuple[float, ...] | FloatArray | xr.DataArray
"""A number, several, or labelled ones."""

UNITS = {"approach": "m", "tilt": "rad", "normal_load": "N", "moment": "N m"}
"""Of the arguments."""


def broadcast(**values: Values) -> tuple[xr.DataArray, ...]:
    """Arguments as arrays of the same dimensions: a sequence has a dimension of its own name."""
    labelled = [_labelled(*item) for item in values.items()]
    try:
        aligned = xr.align(*labelled, join="exact")
    except ValueError:
        shown = {name: dict(each.sizes) for name, each in zip(values, labelled, strict=True)}
        allowed = "with the same coordinates along common dimensions, or without"
        raise InvalidInputError(", ".join(values), shown, allowed) from None
    return tuple(each.astype(np.float64) for each in xr.broadcast(*aligned))


def _labelled(name: str, value: Values) -> xr.DataArray:
    """One argument as a DataArray of finite numbers."""
    if isinstance(value, xr.DataArray):
        value = in_si(name, value, UNITS[name])
        checks.coordinates(name, value.values.ravel(), UNITS[name])
        return value.drop_vars(name, errors="ignore") if name not in value.dims else value
    if np.ndim(value) == 0:
        return xr.DataArray(checks.finite(name, value, UNITS[name]))
    numbers = checks.coordinates(name, value, UNITS[name])
    return xr.DataArray(numbers, dims=name, coords={name: numbers})


def each_pair(
    first: xr.DataArray, second: xr.DataArray, found: Callable[[float, float], tuple[float, float]]
) -> tuple[xr.DataArray, xr.DataArray]:
    """Return what a function finds for every pair of values."""
    results = [found(float(a), float(b)) for a, b in zip(first.values.ravel(), second.values.ravel(), strict=True)]
    one, other = np.array(results, dtype=np.float64).reshape(-1, 2).T
    return first.copy(data=one.reshape(first.shape)), second.copy(data=other.reshape(second.shape))


def dataset(
    approach: xr.DataArray, tilt: xr.DataArray, motion: Motion, errors: tuple[FloatArray, FloatArray]
) -> xr.Dataset:
    """Label loads and stiffness at pairs of approach and tilt; `errors` of load and moment are over the load."""
    values = {
        "approach": approach.values,
        "tilt": tilt.values,
        "normal_load": motion.load,
        "moment": motion.moment,
        "normal_stiffness": motion.normal,
        "coupling_stiffness": motion.coupling,
        "tilting_stiffness": motion.tilting,
        "normal_load_error": errors[0] * motion.load,
        "moment_error": errors[1] * motion.load,
    }
    coords = {str(name): coordinate for name, coordinate in approach.coords.items()}
    data = {name: (approach.dims, array) for name, array in values.items() if name not in coords}
    return describe(xr.Dataset(data, coords=coords))
