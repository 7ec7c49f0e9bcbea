"""Arguments and results of a contact law as labelled arrays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import UNBOUNDED, describe, named
from contactstudy.bearing.energy_spline import Motion
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.unit_sizes import factor_to

Values = float | list[float] | tuple[float, ...] | FloatArray | xr.DataArray
"""A number, several, or labelled ones."""

MOST_SHOWN = 5
"""Labels that a message shows."""

UNITS = {"approach": "m", "tilt": "rad", "normal_load": "N", "moment": "N m"}
"""Of the arguments."""


def broadcast(**values: Values) -> tuple[xr.DataArray, ...]:
    """Arguments as arrays of the same dimensions: a sequence has a dimension of its own name."""
    labelled = [_labelled(*item) for item in values.items()]
    for dim in {str(dim) for each in labelled for dim in each.dims}:
        having = [each.indexes[dim] for each in labelled if dim in each.indexes]
        if any(set(labels) != set(having[0]) for labels in having):
            shown = " and ".join(str(labels.tolist()[:MOST_SHOWN]) for labels in having)
            raise InvalidInputError(
                ", ".join(values), f"{dim} = {shown}", f"with the same labels along {dim}, or without"
            )
    try:
        aligned = xr.align(*labelled, join="left")
    except ValueError as error:
        sizes = {name: dict(each.sizes) for name, each in zip(values, labelled, strict=True)}
        allowed = "as many values along each common dimension"
        raise InvalidInputError(", ".join(values), sizes, allowed, str(error)) from None
    return tuple(each.astype(np.float64) for each in xr.broadcast(*aligned))


def _labelled(name: str, value: Values) -> xr.DataArray:
    """One argument as a DataArray of finite numbers."""
    if isinstance(value, xr.DataArray):
        if (said := value.attrs.get("units")) is not None:
            value = value * factor_to(UNITS[name], f"{name}.attrs['units']", said)
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


def with_position_errors(found: xr.Dataset) -> xr.Dataset:
    """Return a motion under a load with the errors of approach and tilt, from those of load and moment."""
    names = ("normal_stiffness", "coupling_stiffness", "tilting_stiffness")
    normal, coupling, tilting = (np.abs(found[name]) for name in names)
    size = np.abs(found["normal_stiffness"] * found["tilting_stiffness"] - found["coupling_stiffness"] ** 2)
    load, moment = found["normal_load_error"], found["moment_error"]
    errors = {
        "approach_error": (tilting * load + coupling * moment) / size,
        "tilt_error": (coupling * load + normal * moment) / size,
    }
    return found.assign({name: named(name, error.drop_attrs()) for name, error in errors.items()})


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
    labelled = describe(xr.Dataset(data, coords=coords))
    for name in ("normal_stiffness", "coupling_stiffness", "tilting_stiffness"):
        labelled[name].attrs["comment"] = UNBOUNDED
    return labelled
