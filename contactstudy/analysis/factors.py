"""Edge factors: what an end adds to the middle of the contact, and free ends to the half-space."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, cell_size, dimension_along, positions
from contactstudy.analysis.axial import axial_pressure
from contactstudy.analysis.cut_ends import cut_ends
from contactstudy.analysis.measures import measure
from contactstudy.analysis.peaks import section_peak
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import named, variable_of, without_error
from contactstudy.errors import InvalidInputError

PLACES = ("first", "last", "middle", "peak")
"""Where a value is compared with that of a reference: near both ends, at mid-length, and wherever it is largest."""

ROUNDING = 1e-9
"""A point may lie beyond the reach of an end by this part of it. Accuracy."""


def _along_axis(dataset: xr.Dataset, variable: str) -> xr.DataArray:
    """Largest value of a variable in each cross-section."""
    if variable == "pressure":
        return axial_pressure(dataset)
    array = measure(dataset, variable)
    if list(axis_dimensions(array)) == ["x"]:
        return array
    return section_peak(dataset, variable)[f"peak_{variable}"]


def _borders(dataset: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """First and last loaded position along x; NaN where the contact goes on beyond a part of it."""
    axial = axial_pressure(dataset)
    x = dimension_along(axial, "x")
    loaded = positions(axial, "x").where(axial > 0)
    cut_first, cut_last = cut_ends(dataset)
    return loaded.min(x).where(cut_first == 0).compute(), loaded.max(x).where(cut_last == 0).compute()


def _at(profile: xr.DataArray, position: xr.DataArray) -> xr.DataArray:
    """Value of `profile` at the point nearest to `position`; NaN if that lies beyond its points."""
    x = dimension_along(profile, "x")
    distance = abs(positions(profile, "x") - position)
    nearest = distance.fillna(np.inf).argmin(x)
    width = cell_size(profile, "x")
    reach = width.isel({x: nearest}) if x in width.dims else width
    return profile.isel({x: nearest}).where(distance.min(x) <= reach)


def _ends(
    profile: xr.DataArray, borders: tuple[xr.DataArray, xr.DataArray], reach: xr.DataArray | float
) -> list[xr.DataArray]:
    """Largest value within `reach` of either border; NaN if the profile has no point there."""
    x, place = dimension_along(profile, "x"), positions(profile, "x")
    near = reach * (1 + ROUNDING)
    return [profile.where(abs(place - border) <= near).max(x) for border in borders]


def edge_factors(
    dataset: xr.Dataset,
    variable: str = "pressure",
    reference: xr.Dataset | None = None,
    *,
    reach: float | None = None,
) -> xr.Dataset:
    """Largest value near each end of the contact over that in its middle, and over that of another model.

    Parameters
    ----------
    dataset : Dataset
        A result or an opened study, with `pressure` and `hertz_half_width`.
    variable : str
        `pressure`, or a stress or measure, see :func:`contactstudy.analysis.measure`, of which the largest in each
        cross-section is taken.
    reference : Dataset, optional
        The same contact on another body, usually the half-space, in the same coordinates. Its own borders of the
        contact count.
    reach : float, optional
        How far from the contact's border still counts as its end, m; default: one Hertz half-width.

    Returns
    -------
    Dataset
        `end_over_middle_first`, `end_over_middle_last`; with a reference also `over_reference_first` and
        `over_reference_last` (ends over its ends), `over_reference_middle`, and `over_reference_peak` (largest over
        its largest, anywhere). NaN where a result has no points: a stress known near one end only has no middle, and
        neither has a part of a contact that is cut. Infinite at a singular end. No error is known.

    Raises
    ------
    InvalidInputError
        If a variable is missing, or `reach` is not positive.

    Examples
    --------
    >>> pressure = xr.DataArray([[3.0], [1.0], [1.0], [1.0], [2.0]], dims=("x", "y"), coords={"x": range(5), "y": [0]})
    >>> result = edge_factors(xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0}))
    >>> float(result.end_over_middle_first), float(result.end_over_middle_last)
    (3.0, 2.0)
    """
    dataset = required_in_si(dataset, "pressure", "hertz_half_width")
    checks.instance("variable", variable, str, "a name; a second result is given as reference=")
    near = dataset["hertz_half_width"] if reach is None else checks.positive("reach", reach, "metres")
    first, last, middle, largest = _values(dataset, variable, near)
    values = {
        "end_over_middle_first": first / middle,
        "end_over_middle_last": last / middle,
    }
    if reference is not None:
        reference = required_in_si(reference, "pressure", argument="reference")
        others = _values(reference, variable, near)
        for name, own, other in zip(PLACES, (first, last, middle, largest), others, strict=True):
            values[f"over_reference_{name}"] = own / other
    base = variable_of(variable, dataset[variable].attrs if variable in dataset else {})
    found = xr.Dataset({name: named(name, value.reset_coords(drop=True), base) for name, value in values.items()})
    return without_error(found, *values)


def _values(
    dataset: xr.Dataset, variable: str, near: xr.DataArray | float
) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray, xr.DataArray]:
    """Largest value near the first and the last border, at mid-length, and anywhere."""
    borders = _borders(dataset)
    profile = _along_axis(dataset, variable).compute()
    if (profile < 0).any():
        raise InvalidInputError("variable", variable, "a measure that is not negative", "take a stress measure")
    endless = (np.isinf(dataset.get(f"end_pressure_{end}", xr.DataArray(0.0))) for end in ("first", "last"))
    # Beside a singular end pressure and stress have no largest value.
    first, last = (
        value.where(~singular | value.isnull(), np.inf)
        for value, singular in zip(_ends(profile, borders, near), endless, strict=True)
    )
    middle = _at(profile, 0.5 * (borders[0] + borders[1]))
    return first, last, middle, profile.max(dimension_along(profile, "x"))
