"""The roller in slices: the table of position, load, pressure, half-width and shear that engineers work with."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, cell_size, dimension_along, single_case
from contactstudy.analysis.axial import axial_profiles
from contactstudy.analysis.between_columns import Columns, largest_between, moved_load
from contactstudy.analysis.cut_ends import CUT, cut_ends
from contactstudy.analysis.peaks import section_peak
from contactstudy.analysis.stated import SIDES, pressure_errors, singular_ends
from contactstudy.arrays.across import largest_across
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import STRESSES, UNBOUNDED, describe, named
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

SHEARS = ("von_mises", "maximum_shear", "orthogonal_shear_amplitude")
"""Measures of stress whose largest value in each slice is listed."""

EQUAL = "an equal part of the cells under the roller"
OF_COLUMNS = "from the stated errors of the pressure and the distance of the columns"

ROUNDING = 1e-9
"""A stress point may lie beyond a slice by this part of the whole length and still belong to it. Accuracy."""


def slices(dataset: xr.Dataset, count: int = 30) -> xr.Dataset:
    """Cut the length where roller and body face each other into equal slices and list what each carries.

    Parameters
    ----------
    dataset : Dataset
        One case, with `pressure`; with `initial_gap` the slices span the facing length, without it the grid.
    count : int
        Number of slices, at most the number of cells along that length.

    Returns
    -------
    Dataset
        Along `slice` = 1, 2, ...: `position` (m, its middle), `width` (m), `normal_load` (N), `axial_pressure` (Pa,
        largest between the cells; infinite at a singular end), each of these two with its ``_error``, which is NaN
        unless a whole result states errors of its pressure; `half_width` (m, mean over its cells), `unloaded_gap` (m,
        mean). With stresses also `peak_von_mises`, `peak_maximum_shear`, `peak_orthogonal_shear_amplitude` (Pa,
        largest of the points) and their depths ``..._z`` (m); NaN for a slice without stress points. What has no error
        says so in its `comment`. ``.to_dataframe()`` makes it a table.

    Raises
    ------
    InvalidInputError
        If there is no pressure, more than one case, or there are fewer cells than slices.

    Examples
    --------
    >>> cells = {"x": np.arange(4) + 0.5, "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[1, 1], [3, 3], [3, 3], [0, 0]], dims=("x", "y"), coords=cells)
    >>> table = slices(xr.Dataset({"pressure": pressure}), 2).to_dataframe()
    >>> table["normal_load"].tolist(), table["axial_pressure"].tolist()
    ([8.0, 6.0], [3.0, 3.0])
    """
    one = single_case(required_in_si(dataset, "pressure"))
    number = checks.count("count", count)
    profiles = axial_profiles(one)
    x = dimension_along(profiles["line_load"], "x")
    facing = profiles["unloaded_gap"].notnull() if "unloaded_gap" in profiles else profiles["line_load"].notnull()
    cells = profiles.isel({x: np.flatnonzero(facing.values)})
    place = cells[x].values
    if place.size < number:
        raise InvalidInputError("count", count, f"at most the number of cells, {place.size}")
    half = 0.5 * np.broadcast_to(cell_size(cells["line_load"], "x").values, place.shape)
    borders = np.linspace(place[0] - half[0], place[-1] + half[-1], number + 1)

    edges = np.stack([place - half, place + half], axis=-1)
    top = largest_across(one["pressure"].transpose(x, ...).values[facing.values])
    pressure, line_load = Columns(edges, place, top), Columns(edges, place, cells["line_load"].values)
    # Cells that a border cuts give each slice its share of the load.
    weights = xr.DataArray(pressure.shares(borders), dims=("slice", x))
    result = xr.Dataset(
        {
            "position": ("slice", 0.5 * (borders[1:] + borders[:-1]), {"comment": EQUAL}),
            "width": ("slice", np.full(number, borders[1] - borders[0]), {"comment": EQUAL}),
            "normal_load": named("normal_load", (weights * cells["line_load"]).sum(x)),
        },
        coords={"slice": np.arange(1, number + 1)},
    )
    result = result.assign(_with_errors(one, borders, pressure, line_load, result["normal_load"].values))
    for name in ("half_width", "unloaded_gap"):
        if name in cells:
            mean = (weights * cells[name]).sum(x) / weights.sum(x)
            result[name] = mean.assign_attrs(comment=f"mean over the cells of the slice, {UNBOUNDED}")
    deep = all(name in one and "z" in axis_dimensions(one[name]) for name in STRESSES)
    return describe(_with_shears(result, one, borders) if deep else result)


def _with_errors(
    one: xr.Dataset, borders: FloatArray, pressure: Columns, line_load: Columns, load: FloatArray
) -> dict[str, xr.DataArray]:
    """Label load and largest pressure of each slice with their errors: of the stated pressures, and of the columns."""
    largest, left_open = largest_between(pressure, borders)
    relative, singular = _stated(one), singular_ends(one)
    middle = 0.5 * (borders[0] + borders[-1])
    rounding = ROUNDING * (borders[-1] - borders[0])
    in_half = (borders[:-1] < middle - rounding, borders[1:] > middle + rounding)
    peaks = [float(one.get(f"peak_pressure_{side}", np.nan)) for side in SIDES]
    of_pressure = np.max(
        [
            np.where(inside, share * (largest if np.isinf(peak) else peak), 0.0)
            for inside, share, peak in zip(in_half, relative, peaks, strict=True)
        ],
        axis=0,
    )
    error = of_pressure + left_open
    for cut, endless, end in zip(cut_ends(one), singular, (0, -1), strict=True):
        if endless and not cut:
            largest[end] = error[end] = np.inf
    load_error = np.max(relative) * np.maximum(load, load.mean()) + moved_load(line_load, borders)
    values = {
        "normal_load": (load, "of the slice"),
        "normal_load_error": (load_error, OF_COLUMNS),
        "axial_pressure": (largest, "largest of the slice"),
        "axial_pressure_error": (error, OF_COLUMNS),
    }
    known = not np.isnan(relative).any()
    return {
        name: named(name, xr.DataArray(numbers, dims="slice")).assign_attrs(
            comment=comment if known else UNBOUNDED if name.endswith("_error") else f"{comment}, {UNBOUNDED}"
        )
        for name, (numbers, comment) in values.items()
    }


def _stated(one: xr.Dataset) -> tuple[float, float]:
    """Relative errors of the pressure on either half; NaN of a part of a contact, and of cells that cases share."""
    shared = "averaged" in str(one["pressure"].attrs.get("comment", ""))
    if "normal_load" not in one or shared:
        return np.nan, np.nan
    cells = (cell_size(one["pressure"], axis) for axis in "xy")
    resultant = float((one["pressure"] * next(cells) * next(cells)).sum())
    whole = resultant > (1 - CUT) * float(one["normal_load"])
    return pressure_errors(one) if whole else (np.nan, np.nan)


def _with_shears(result: xr.Dataset, one: xr.Dataset, borders: np.ndarray) -> xr.Dataset:
    """Add the largest stress measures of the points in each slice, and their depths."""
    for name in SHEARS:
        sections = section_peak(one, name)
        stress = sections[f"peak_{name}"]
        x = dimension_along(stress, "x")
        rounding = ROUNDING * (borders[-1] - borders[0])
        at = stress[x].values
        inside = (at >= borders[:-1, None] - rounding) & (at <= borders[1:, None] + rounding)
        owned = stress.where(xr.DataArray(inside, dims=("slice", x)))
        largest = owned.fillna(-np.inf).argmax(x)
        known = owned.notnull().any(x)
        for variable in (f"peak_{name}", f"peak_{name}_z"):
            chosen = sections[variable].isel({x: largest}).where(known).reset_coords(drop=True)
            result[variable] = chosen.assign_attrs(sections[variable].attrs)
    return result
