"""The roller in slices: the table of position, load, pressure, half-width and shear that engineers work with."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, cell_size, dimension_along, single_case
from contactstudy.analysis.axial import axial_profiles
from contactstudy.analysis.peaks import section_peak
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import STRESSES, describe, named
from contactstudy.errors import InvalidInputError

SHEARS = ("von_mises", "maximum_shear", "orthogonal_shear_amplitude")
"""Measures of stress whose largest value in each slice is listed."""

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
        largest), `half_width` (m, mean over its cells), `unloaded_gap` (m, mean). With stresses also `peak_von_mises`,
        `peak_maximum_shear`, `peak_orthogonal_shear_amplitude` (Pa, largest) and their depths ``..._z`` (m); NaN for
        a slice without stress points. ``.to_dataframe()`` makes it a table.

    Raises
    ------
    InvalidInputError
        If there is no pressure, more than one case, or there are fewer cells than slices.

    Examples
    --------
    >>> cells = {"x": np.arange(4) + 0.5, "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[1, 1], [3, 3], [1, 1], [0, 0]], dims=("x", "y"), coords=cells)
    >>> table = slices(xr.Dataset({"pressure": pressure}), 2).to_dataframe()
    >>> table["normal_load"].tolist(), table["axial_pressure"].tolist()
    ([8.0, 2.0], [3.0, 1.0])
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
    width = borders[1] - borders[0]

    # Cells that a border cuts give each slice its share of the load.
    share = np.clip(np.minimum(borders[1:, None], place + half) - np.maximum(borders[:-1, None], place - half), 0, None)
    weights = xr.DataArray(share, dims=("slice", x))
    result = xr.Dataset(
        {
            "position": ("slice", 0.5 * (borders[1:] + borders[:-1])),
            "width": ("slice", np.full(number, width)),
            "normal_load": named("normal_load", (weights * cells["line_load"]).sum(x)).assign_attrs(
                comment="of the slice"
            ),
        },
        coords={"slice": np.arange(1, number + 1)},
    )
    result["axial_pressure"] = cells["axial_pressure"].where(weights > 0.5 * weights.max(x)).max(x)
    for name in ("half_width", "unloaded_gap"):
        if name in cells:
            result[name] = (weights * cells[name]).sum(x) / weights.sum(x)
    deep = all(name in one and "z" in axis_dimensions(one[name]) for name in STRESSES)
    return describe(_with_shears(result, one, borders) if deep else result)


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
