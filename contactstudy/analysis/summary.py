"""Numbers of one solved case, which a parametric study compares: computed on arrays, labelled once."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis import largest_sample, peak
from contactstudy.analysis.axes import cell_widths
from contactstudy.analysis.contact import contact_numbers
from contactstudy.arrays.variables import STRESSES, describe, require, without_error
from contactstudy.errors import InvalidInputError

# Comments of numbers that depend on the cells, with errors that are not estimated
COMMENTS = {
    "contact_length": "in whole cells",
    "contact_width": "in whole cells",
    "end_pressure_over_p0_first": "mean of the outermost loaded cell",
    "end_pressure_over_p0_last": "mean of the outermost loaded cell",
}


def pressure_numbers(dataset: xr.Dataset) -> xr.Dataset:
    """Numbers of the pressure; at the ends those of the Dataset, else of the outer pressed columns."""
    require(dataset, "pressure", "hertz_max_pressure")
    array = dataset["pressure"].transpose("x", "y")
    pressure, x, y, scale = array.values, array["x"].values, array["y"].values, float(dataset["hertz_max_pressure"])
    pressed = pressure > 0
    facing = np.asarray(pressed.any(axis=1))
    columns = np.flatnonzero(facing)
    numbers = contact_numbers(pressure, facing, x, y, *(cell_widths(array, axis).values for axis in "xy"))
    at_x, at_y = np.unravel_index(int(np.nanargmax(pressure)), pressure.shape)
    outermost = [float(pressure[column].max()) for column in columns[[0, -1]]] if columns.size else [np.nan, np.nan]
    first, last = (
        float(dataset.get(f"end_pressure_{end}", value)) / scale
        for end, value in zip(("first", "last"), outermost, strict=True)
    )
    values = {
        "peak_pressure": float(pressure[at_x, at_y]),
        "peak_pressure_x": float(x[at_x]),
        "peak_pressure_y": float(y[at_y]),
        "end_pressure_over_p0_first": first,
        "end_pressure_over_p0_last": last,
        "end_pressure_over_p0": 0.5 * (first + last),
        "contact_length": float(numbers.contact_length),
        "contact_width": float(numbers.contact_width),
    }
    result = describe(xr.Dataset(values))
    for name, comment in COMMENTS.items():
        result[name].attrs["comment"] = comment
    return without_error(result, *COMMENTS)


def stress_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Largest von Mises stress, its error and position; empty without stresses."""
    if "von_mises" not in dataset:
        return xr.Dataset()
    if np.isnan(dataset["von_mises"].values).all():
        raise InvalidInputError("von_mises", "nan everywhere", "a field with at least one number")
    complete = all(name in dataset for name in STRESSES)
    result = peak(dataset) if complete else largest_sample(dataset, "von_mises")
    return result.reset_coords(drop=True)


def case_numbers(dataset: xr.Dataset) -> xr.Dataset:
    """All numbers of a solved case: scalars of the Dataset (settled), then those of its cells."""
    scalars = {
        name: array.variable
        for source in (stress_summary(dataset), dataset)
        for name, array in source.data_vars.items()
        if not array.ndim
    }
    return pressure_numbers(dataset).assign(scalars)
