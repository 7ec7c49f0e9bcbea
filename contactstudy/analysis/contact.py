"""The contact as a whole: peak and edge pressure, area, length and its loss, and where the load acts."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import cell_size, dimension_along, increasing, positions
from contactstudy.analysis.axial import axial_pressure, unloaded_gap
from contactstudy.analysis.cut_ends import CUT, cut_ends
from contactstudy.analysis.peaks import peak
from contactstudy.analysis.reduced import reduced
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import UNBOUNDED, named, without_error
from contactstudy.checks import Array

OF_CELL = f"mean of the outermost loaded cell, {UNBOUNDED}; end_pressure of a settled result has one"


def _first_and_last(values: Array) -> tuple[Array, Array]:
    """First and last positive number along the last axis; NaN if there is none."""
    loaded = values > 0
    first, last = loaded.argmax(axis=-1), values.shape[-1] - 1 - loaded[..., ::-1].argmax(axis=-1)
    ends = [np.take_along_axis(values, at[..., None], axis=-1)[..., 0] for at in (first, last)]
    none = ~loaded.any(axis=-1)
    return np.where(none, np.nan, ends[0]), np.where(none, np.nan, ends[1])


def edge_pressure(dataset: xr.Dataset) -> xr.Dataset:
    """Pressure in the first and in the last loaded cells along the roller's axis, the largest across y.

    Parameters
    ----------
    dataset : Dataset
        With `pressure`.

    Returns
    -------
    Dataset
        `edge_pressure_first` and `edge_pressure_last`, Pa: means of a cell, which depend on the cells. Infinite where
        `end_pressure_first` or `end_pressure_last` of a result is; NaN if nothing is loaded, and at an end where the
        Dataset is only a part of the contact, which goes on there.

    Raises
    ------
    InvalidInputError
        If there is no pressure.

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0], [3.0], [1.0], [2.0]], dims=("x", "y"))
    >>> ends = edge_pressure(xr.Dataset({"pressure": pressure}))
    >>> float(ends.edge_pressure_first), float(ends.edge_pressure_last)
    (3.0, 2.0)
    """
    values: dict[str, xr.DataArray] = {}
    axial = increasing(axial_pressure(dataset), "x")
    first, last = reduced(_first_and_last, [(axial, [dimension_along(axial, "x")])], 2)
    cut_first, cut_last = cut_ends(dataset)
    first, last = first.where(cut_first == 0), last.where(cut_last == 0)
    for end, value in (("first", first), ("last", last)):
        # A cell beside a singular end has a height of its own only.
        endless = np.isinf(dataset.get(f"end_pressure_{end}", xr.DataArray(0.0)))
        values[f"edge_pressure_{end}"] = named(f"edge_pressure_{end}", value.where(~endless | value.isnull(), np.inf))
        values[f"edge_pressure_{end}"].attrs["comment"] = OF_CELL
    return xr.Dataset(values)


def _range(place: Array, chosen: Array) -> tuple[Array, Array]:
    """First and last of the chosen positions along the last axis; infinite if there is none."""
    return np.where(chosen, place, np.inf).min(axis=-1), np.where(chosen, place, -np.inf).max(axis=-1)


def _scalars(pressure: Array, facing: Array, x: Array, y: Array, dx: Array, dy: Array) -> tuple[Array, ...]:
    """Area, length, width, loss of length, resultant, its x, middle of what faces; of contacts (..., x, y), or NaN."""
    known = np.asarray(~np.isnan(pressure).all(axis=(-2, -1)))
    # A case that failed has no positions either.
    place_x, place_y, dx, dy = (np.where(known[..., None], place, 0.0) for place in (x, y, dx, dy))
    loaded = np.asarray(pressure > 0)
    in_row, in_column = (np.asarray(loaded.any(axis=axis)) for axis in (-1, -2))

    def length(place: Array, chosen: Array, width: Array) -> Array:
        first, last = _range(place - 0.5 * width, chosen)[0], _range(place + 0.5 * width, chosen)[1]
        return np.where(chosen.any(axis=-1), last - first, 0.0)

    along = length(place_x, in_row, dx)
    load = np.nansum(pressure * dy[..., None, :], axis=-1) * dx
    resultant = np.nansum(load, axis=-1)
    moment = np.nansum(load * place_x, axis=-1)
    acting = np.divide(moment, resultant, out=np.full(np.shape(moment), np.nan), where=resultant > 0)
    first, last = _range(place_x, facing)
    scalars = (
        np.nansum(loaded * dx[..., :, None] * dy[..., None, :], axis=(-2, -1)),
        along,
        length(place_y, in_column, dy),
        length(place_x, facing, dx) - along,
        resultant,
        acting,
        0.5 * np.where(first <= last, first, np.nan) + 0.5 * last,
    )
    return tuple(np.where(known, value, np.nan) for value in scalars)


def _width_at_each(pressure: xr.DataArray, axis: str) -> xr.DataArray:
    """Width of the cell at every position along an axis; NaN where a case has fewer than others."""
    place = positions(pressure, axis)
    return cell_size(pressure, axis) + 0.0 * place


def contact_results(dataset: xr.Dataset, about: float | None = None) -> xr.Dataset:
    """Scalars of the contact: peak and edge pressure, area, length and its loss, and where the load acts.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve` or of :func:`contactstudy.open_study`; `initial_gap` says how far
        roller and body face each other.
    about : float, optional
        Position x that the moment is taken about, m; default: the middle of where roller and body face each other
        (mid-length of the roller unless it overhangs), or of the grid if there is no `initial_gap`.

    Returns
    -------
    Dataset
        `peak_pressure` with ``_x`` and ``_y``, the settled one with its error where a whole result has it, and else
        that of the highest cell; `edge_pressure_first`, `edge_pressure_last` (Pa); `contact_area` (m2),
        `contact_length`, `contact_width` (m), in whole cells; `contact_length_loss` (m, what of the facing length
        carries nothing); `resultant` (N) of the pressure, `load_position` (m, the x where it acts) and `moment`
        (N m, positive if it acts beyond `about`). NaN for cases without pressure.

    Raises
    ------
    InvalidInputError
        If there is no pressure, or `about` is not a number.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5, 2.5, 3.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[0, 0], [3, 3], [1, 1], [0, 0]], dims=("x", "y"), coords=cells)
    >>> result = contact_results(xr.Dataset({"pressure": pressure, "initial_gap": 0 * pressure}))
    >>> [float(result[name]) for name in ("contact_area", "contact_length_loss", "resultant", "moment")]
    [4.0, 2.0, 8.0, -2.0]
    """
    dataset = required_in_si(dataset, "pressure", normalized=True)
    pressure = dataset["pressure"]
    x, y = dimension_along(pressure, "x"), dimension_along(pressure, "y")
    opposite = unloaded_gap(dataset) if "initial_gap" in dataset else axial_pressure(dataset)
    arguments = [
        (pressure, [x, y]),
        (opposite.notnull(), [x]),
        (positions(pressure, "x"), [x]),
        (positions(pressure, "y"), [y]),
        *((_width_at_each(pressure, axis), [dim]) for axis, dim in (("x", x), ("y", y))),
    ]
    area, length, width, loss, resultant, position, middle = reduced(_scalars, arguments, 7)
    centre = middle if about is None else checks.finite("about", about, "metres")
    values = {
        "contact_area": area,
        "contact_length": length,
        "contact_width": width,
        "resultant": resultant,
        "load_position": position,
        "moment": resultant * (position - centre),
    }
    if "initial_gap" in dataset:
        values["contact_length_loss"] = loss
    scalars = {name: named(name, value) for name, value in values.items()}
    for name in ("contact_area", "contact_length"):
        scalars[name].attrs["comment"] = "in whole cells"
    found = _peak(dataset, resultant).assign(edge_pressure(dataset).data_vars).assign(scalars).compute()
    return without_error(found, *scalars)


def _peak(dataset: xr.Dataset, resultant: xr.DataArray) -> xr.Dataset:
    """Largest pressure and its place: the settled one of a contact that is whole."""
    found = peak(dataset, "pressure")
    names = ("peak_pressure", "peak_pressure_error")
    if not {*names, "normal_load"} <= set(dataset.variables):
        return found
    whole = resultant > (1 - CUT) * dataset["normal_load"]
    settled = dataset[list(names)].reset_coords(drop=True)
    highest = settled["peak_pressure"].where(whole, found["peak_pressure"])
    comment = "settled where the contact is whole, else of the highest cell"
    return found.assign(
        peak_pressure=named("peak_pressure", highest).assign_attrs(comment=comment),
        peak_pressure_error=settled["peak_pressure_error"].where(whole),
    )
