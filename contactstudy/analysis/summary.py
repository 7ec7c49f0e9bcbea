"""Numbers of one solved case, which a parametric study compares."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis import largest_sample, peak
from contactstudy.analysis.contact import contact_numbers
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, STRESSES, labels, require
from contactstudy.errors import InvalidInputError

# Comments of numbers that depend on the cells, with errors that are not estimated
COMMENTS = dict.fromkeys(
    ("contact_length", "contact_width", "peak_pressure_x", "peak_pressure_y"), "in whole cells"
) | dict.fromkeys(
    ("end_pressure_over_p0", "end_pressure_over_p0_first", "end_pressure_over_p0_last"),
    "mean of the outermost loaded cell",
)


def pressure_numbers(dataset: xr.Dataset) -> dict[str, float]:
    """Numbers of the pressure; end pressures from the Dataset, or else from the outermost loaded columns."""
    require(dataset, "pressure", "hertz_max_pressure")
    array = dataset["pressure"].transpose("x", "y")
    pressure, x, y, scale = array.values, array["x"].values, array["y"].values, float(dataset["hertz_max_pressure"])
    in_contact = pressure > 0
    has_contact = np.asarray(in_contact.any(axis=1))
    columns = np.flatnonzero(has_contact)
    widths = [
        dataset[f"{axis}_width"].values
        if f"{axis}_width" in dataset.variables
        else np.full(centres.size, np.ptp(centres) / max(centres.size - 1, 1))
        for axis, centres in (("x", x), ("y", y))
    ]
    numbers = contact_numbers(pressure, has_contact, x, y, *widths)
    x_index, y_index = np.unravel_index(int(np.nanargmax(pressure)), pressure.shape)
    end_pressures = [float(pressure[column].max()) for column in columns[[0, -1]]] if columns.size else [np.nan, np.nan]
    first, last = (
        float(dataset.get(f"end_pressure_{end}", value)) / scale
        for end, value in zip(("first", "last"), end_pressures, strict=True)
    )
    return {
        "peak_pressure": float(pressure[x_index, y_index]),
        "peak_pressure_x": float(x[x_index]),
        "peak_pressure_y": float(y[y_index]),
        "end_pressure_over_p0_first": first,
        "end_pressure_over_p0_last": last,
        "end_pressure_over_p0": 0.5 * (first + last),
        "contact_length": float(numbers.contact_length),
        "contact_width": float(numbers.contact_width),
    }


def stress_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Largest von Mises stress, its error and position; empty without stresses."""
    if "von_mises" not in dataset:
        return xr.Dataset()
    if np.isnan(dataset["von_mises"].values).all():
        raise InvalidInputError("von_mises", "nan everywhere", "a field with at least one number")
    has_all_stresses = all(name in dataset for name in STRESSES)
    result = peak(dataset) if has_all_stresses else largest_sample(dataset, "von_mises")
    return result.reset_coords(drop=True)


class Number(NamedTuple):
    """One number of a case with the attributes of its variable."""

    value: float
    attributes: dict[str, Any]


def case_numbers(dataset: xr.Dataset) -> dict[str, Number]:
    """All numbers of a solved case by name: scalars of the Dataset (refined), then numbers of its cells."""
    numbers = {}
    for name, value in pressure_numbers(dataset).items():
        estimate = {"comment": COMMENTS[name], ERROR_KIND: NOT_ESTIMATED} if name in COMMENTS else {}
        numbers[name] = Number(value, labels(name) | estimate)
    for source in (stress_summary(dataset), dataset):
        for key, variable in source.variables.items():
            if variable.ndim == 0 and key not in source.coords:
                numbers[str(key)] = Number(float(variable.values), dict(variable.attrs))
    return numbers
