"""Numbers of one solved case, which a parametric study compares."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis import contact_results, largest_sample, peak
from contactstudy.arrays.variables import STRESSES, name_array, require, without_error
from contactstudy.errors import InvalidInputError

# Comments of numbers that depend on the cells, with errors that are not estimated
COMMENTS = dict.fromkeys(
    ("contact_length", "contact_width", "peak_pressure_x", "peak_pressure_y"), "in whole cells"
) | dict.fromkeys(
    ("end_pressure_over_p0", "end_pressure_over_p0_first", "end_pressure_over_p0_last"),
    "mean of the outermost loaded cell",
)


def pressure_numbers(dataset: xr.Dataset) -> xr.Dataset:
    """Numbers of the pressure; end pressures from the Dataset, or else from the outermost loaded columns."""
    require(dataset, "pressure", "hertz_max_pressure")
    results = contact_results(dataset)
    first, last = (
        dataset.get(f"end_pressure_{end}", results[f"edge_pressure_{end}"]) / dataset["hertz_max_pressure"]
        for end in ("first", "last")
    )
    numbers = {name: results[name] for name in ("peak_pressure", "peak_pressure_x", "peak_pressure_y")} | {
        "end_pressure_over_p0_first": first,
        "end_pressure_over_p0_last": last,
        "end_pressure_over_p0": 0.5 * (first + last),
        "contact_length": results["contact_length"],
        "contact_width": results["contact_width"],
    }
    result = xr.Dataset({name: name_array(name, value) for name, value in numbers.items()})
    for name, comment in COMMENTS.items():
        result[name].attrs["comment"] = comment
    return without_error(result, *COMMENTS)


def stress_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Largest von Mises stress, its error and position; empty without stresses."""
    if "von_mises" not in dataset:
        return xr.Dataset()
    if np.isnan(dataset["von_mises"].values).all():
        raise InvalidInputError("von_mises", "nan everywhere", "a field with at least one number")
    has_all_stresses = all(name in dataset for name in STRESSES)
    return peak(dataset) if has_all_stresses else largest_sample(dataset, "von_mises")


def case_numbers(dataset: xr.Dataset) -> xr.Dataset:
    """All numbers of a solved case: scalars of the Dataset (refined), or else numbers of its cells."""
    scalars = dataset[[name for name, entry in dataset.data_vars.items() if entry.ndim == 0]]
    numbers = pressure_numbers(dataset).assign(stress_summary(dataset).data_vars).assign(scalars.data_vars)
    return numbers.reset_coords(drop=True)
