"""Scalars of a contact on its cells: area, length, edge pressures, resultant; cut ends; numbers of a study's case."""

from __future__ import annotations

import contextlib

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import (
    axis_dimensions,
    cell_edges,
    cell_size,
    dimension_along,
    positions,
    sort_positions,
    without_coordinates,
)
from contactstudy.analysis.axial import axial_pressure, loaded_range, under_roller
from contactstudy.analysis.peaks import largest_sample, measure, peak
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, solved_case
from contactstudy.arrays.variables import (
    ERROR_KIND,
    NOT_ESTIMATED,
    STRESSES,
    describe,
    labels,
    name_array,
    require,
    require_in_si,
    variable_of,
    without_error,
)
from contactstudy.errors import InvalidInputError

MISSING_LOAD = 0.01  # Minimum fraction of the load that a cut contact lacks
END_TOLERANCE = 1e-6  # Largest distance, over the cell width, of a border of the cells from an end that it equals

# Comments of numbers that depend on the cells, with errors that are not estimated
WHOLE_CELLS, OUTERMOST_CELL = "in whole cells", "mean of the outermost loaded cell"


def contact_results(dataset: xr.Dataset, about: float | None = None) -> xr.Dataset:
    """Return scalars of the contact: peak and edge pressure, area, length and its loss, resultant and moment.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells; `initial_gap` contains the facing length of roller and body.
    about : float, optional
        Position x of the moment's axis, m; default: the middle of the facing length (mid-length of the roller unless it
        overhangs), or of the grid without `initial_gap`.

    Returns
    -------
    Dataset
        `peak_pressure` with ``_x`` and ``_y``: refined, with its error, in a complete result, otherwise of the
        highest cell; `edge_pressure_first`, `edge_pressure_last` (Pa); `contact_area` (m2), `contact_length`,
        `contact_width` (m), in whole cells; `contact_length_loss` (m, facing length without contact); `resultant` (N),
        `load_position` (m, its position x) and `moment` (N m, positive beyond `about`). NaN for cases without pressure.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure, or `about` is not a number.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5, 2.5, 3.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[0, 0], [3, 3], [1, 1], [0, 0]], dims=("x", "y"), coords=cells)
    >>> result = contact_results(xr.Dataset({"pressure": pressure, "initial_gap": 0 * pressure}))
    >>> [float(result[name]) for name in ("contact_area", "contact_length_loss", "resultant", "moment")]
    [4.0, 2.0, 8.0, -2.0]
    """
    dataset = require_in_si(dataset, "pressure", normalized=True)
    pressure, is_facing = dataset["pressure"], under_roller(dataset)
    (x, dx), (y, dy) = ((dimension_along(pressure, axis), cell_size(pressure, axis)) for axis in "xy")
    sample_x, is_loaded = positions(pressure, "x"), pressure > 0

    def measure_length(mask: xr.DataArray, axis: str) -> xr.DataArray:
        lower_edges, upper_edges = (edges.where(mask) for edges in cell_edges(pressure, axis))
        dim = dimension_along(pressure, axis)
        return (upper_edges.max(dim) - lower_edges.min(dim)).fillna(0.0)

    load = (pressure * dy).sum(y) * dx
    resultant = load.sum(x)
    numbers = {
        "contact_area": (is_loaded * dx * dy).sum((x, y)),
        "contact_length": measure_length(is_loaded.any(y), "x"),
        "contact_width": measure_length(is_loaded.any(x), "y"),
        "resultant": resultant,
        "load_position": (load * sample_x).sum(x) / resultant.where(resultant > 0),
    }
    facing_x = sample_x.where(is_facing)
    mid_position = 0.5 * facing_x.min(x) + 0.5 * facing_x.max(x)
    centre = mid_position if about is None else checks.finite("about", about, "metres")
    numbers["moment"] = resultant * (numbers["load_position"] - centre)
    if "initial_gap" in dataset:
        numbers["contact_length_loss"] = measure_length(is_facing, "x") - numbers["contact_length"]
    has_pressure = pressure.notnull().any((x, y))
    scalars = {name: name_array(name, value.where(has_pressure)) for name, value in numbers.items()}
    for name in ("contact_area", "contact_length"):
        scalars[name].attrs["comment"] = WHOLE_CELLS
    peak_pressure = _peak_pressure(dataset, scalars["resultant"])
    return without_error(peak_pressure.assign(edge_pressure(dataset).data_vars).assign(scalars).compute(), *scalars)


def _peak_pressure(dataset: xr.Dataset, resultant: xr.DataArray) -> xr.Dataset:
    """Largest pressure and its position: refined if the contact is complete."""
    sample = largest_sample(dataset, "pressure")
    largest_pressure = sample.rename({name: str(name).replace("largest_", "peak_") for name in sample})
    names = ("peak_pressure", "peak_pressure_error")
    if not {*names, "normal_load"} <= set(dataset.variables):
        return largest_pressure
    covers_contact = resultant > (1 - MISSING_LOAD) * dataset["normal_load"]
    stored_peak = dataset[list(names)].reset_coords(drop=True)
    value = stored_peak["peak_pressure"].where(covers_contact, largest_pressure["peak_pressure"])
    comment = "refined if the cells contain the contact, otherwise the largest sample"
    error = stored_peak["peak_pressure_error"].where(covers_contact)
    refined_peak = name_array("peak_pressure", value).assign_attrs(comment=comment)
    return describe(largest_pressure.assign(peak_pressure=refined_peak, peak_pressure_error=error))


def edge_pressure(dataset: xr.Dataset) -> xr.Dataset:
    """Return the pressure in the first and in the last loaded cells along the roller's axis, the largest across y.

    Parameters
    ----------
    dataset : Dataset
        With `pressure`.

    Returns
    -------
    Dataset
        `edge_pressure_first` and `edge_pressure_last`, Pa: means of a cell, which depend on the cells. Infinite where
        `end_pressure_first` or `end_pressure_last` is infinite; NaN without contact, and at a cut end.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure.

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0], [3.0], [1.0], [2.0]], dims=("x", "y"))
    >>> ends = edge_pressure(xr.Dataset({"pressure": pressure}))
    >>> float(ends.edge_pressure_first), float(ends.edge_pressure_last)
    (3.0, 2.0)
    """
    axial = sort_positions(axial_pressure(dataset), "x")
    x = dimension_along(axial, "x")
    is_loaded = (axial > 0).compute()
    indices = is_loaded.argmax(x), axial.sizes[x] - 1 - is_loaded.isel({x: slice(None, None, -1)}).argmax(x)
    edges = {}
    for end, index, is_cut in zip(("first", "last"), indices, cut_ends(dataset), strict=True):
        name = f"edge_pressure_{end}"
        value = without_coordinates(axial, x).isel({x: index}).where(is_loaded.any(x) & (is_cut == 0))
        # At a singular end the mean of a cell depends on the size of the cell.
        edges[name] = name_array(name, _replace_at_singular_end(dataset, end, value))
        edges[name].attrs["comment"] = OUTERMOST_CELL
    return without_error(xr.Dataset(edges), *edges)


def _replace_at_singular_end(dataset: xr.Dataset, end: str, value: xr.DataArray) -> xr.DataArray:
    """Value near an end; infinite at a singular end, where pressure and stress are unbounded."""
    is_singular = np.isinf(dataset.get(f"end_pressure_{end}", xr.DataArray(0.0)))
    return value.where(~is_singular | value.isnull(), np.inf)


def cut_ends(dataset: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Return 1 where the contact continues beyond the first or the last x, as in a part of a result, otherwise 0.

    A cut contact carries less than the load, and is loaded at a border of the cells inside the contact's range, which
    follows from the inputs of `solve`; without inputs it begins at x = 0.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells; without `normal_load` no end is cut.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure, or an unknown unit.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5, 2.5], "y": [-1.0, 0.0, 1.0]}
    >>> pressure = xr.DataArray([[0, 2, 0], [0, 1, 0], [0, 1, 0]], dims=("x", "y"), coords=cells)
    >>> contact = xr.Dataset({"pressure": pressure, "normal_load": 4.0})
    >>> [[float(end) for end in cut_ends(part)] for part in (contact, contact.isel(x=[1, 2]), contact.isel(x=[0, 1]))]
    [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    dataset = require_in_si(dataset, "pressure", normalized=True)
    pressure = dataset["pressure"]
    is_normalized = pressure.attrs.get("units") == "1"
    if "normal_load" not in dataset or is_normalized or pressure.sizes[dimension_along(pressure, "y")] < 2:
        return xr.DataArray(0.0), xr.DataArray(0.0)
    dataset = require_in_si(dataset, "normal_load")
    for axis in "xy":
        pressure = sort_positions(pressure, axis)
    (x, dx), (y, dy) = ((dimension_along(pressure, axis), cell_size(pressure, axis)) for axis in "xy")
    (lower_edges, upper_edges), in_contact = cell_edges(pressure, "x"), pressure > 0
    start, stop = 0.0, np.inf
    if "case" in attribute(dataset, INPUTS_ATTRIBUTE):
        with contextlib.suppress(InvalidInputError):  # inputs of another version
            start, stop = solved_case(dataset).contact_range
    lacks_load = (pressure * dx * dy).sum((x, y)) < (1 - MISSING_LOAD) * dataset["normal_load"]
    # The load alone is not enough: a cut along y, or omitted cells, also reduce the resultant.
    tolerance = END_TOLERANCE * dx
    omits_cells = (abs(lower_edges - upper_edges.shift({x: 1})) > tolerance).any(x)
    is_selection = lacks_load & ~in_contact.isel({y: [0, -1]}).any((x, y)) & ~omits_cells
    border_masks = (
        (lower_edges == lower_edges.min(x)) & (lower_edges > start + tolerance),
        (upper_edges == upper_edges.max(x)) & (upper_edges < stop - tolerance),
    )
    first_cut, last_cut = (is_selection & (in_contact.any(y) & border_mask).any(x) for border_mask in border_masks)
    return first_cut.astype(np.float64).drop_attrs(deep=False), last_cut.astype(np.float64).drop_attrs(deep=False)


def edge_factors(
    dataset: xr.Dataset, variable: str = "pressure", reference: xr.Dataset | None = None, *, reach: float | None = None
) -> xr.Dataset:
    """Return the largest value near each end of the contact over mid-length, and over another model.

    Parameters
    ----------
    dataset : Dataset
        A result or an opened study, with `pressure` and `hertz_half_width`.
    variable : str
        `pressure`, or a stress or measure, see :func:`contactstudy.analysis.measure`: largest in each cross-section.
    reference : Dataset, optional
        The same contact on another body, usually the half-space, in the same coordinates.
    reach : float, optional
        Length of an end from the contact's border, m; default: one Hertz half-width.

    Returns
    -------
    Dataset
        `end_over_middle_first`, `end_over_middle_last`; with a reference also `over_reference_first` and
        `over_reference_last` (over the reference's ends), `over_reference_middle`, and `over_reference_peak` (ratio of
        the largest values). NaN without points and at a cut end; infinite at a singular end; without an error.

    Raises
    ------
    InvalidInputError
        If a variable is missing or negative, or `reach` is not positive.

    Examples
    --------
    >>> pressure = xr.DataArray([[3.0], [1.0], [1.0], [1.0], [2.0]], dims=("x", "y"), coords={"x": range(5), "y": [0]})
    >>> result = edge_factors(xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0}))
    >>> float(result.end_over_middle_first), float(result.end_over_middle_last)
    (3.0, 2.0)
    """
    dataset = require_in_si(dataset, "pressure", "hertz_half_width")
    checks.instance("variable", variable, str, "a name; a second result is given as reference=")
    length = dataset["hertz_half_width"] if reach is None else checks.positive("reach", reach, "metres")
    values = _find_end_values(dataset, variable, length)
    factors = {f"end_over_middle_{end}": values[end] / values["middle"] for end in ("first", "last")}
    if reference is not None:
        reference = require_in_si(reference, "pressure", argument="reference")
        reference_values = _find_end_values(reference, variable, length)
        factors |= {f"over_reference_{name}": value / reference_values[name] for name, value in values.items()}
    specification = variable_of(variable, dataset[variable].attrs if variable in dataset else {})
    result = xr.Dataset(
        {name: name_array(name, value.reset_coords(drop=True), specification) for name, value in factors.items()}
    )
    return without_error(result, *factors)


def _find_end_values(dataset: xr.Dataset, variable: str, reach: xr.DataArray | float) -> dict[str, xr.DataArray]:
    """Largest value near the first and the last border, at mid-length, and anywhere."""
    axial = axial_pressure(dataset)
    axial_values = axial if variable == "pressure" else measure(dataset, variable)
    if list(axis_dimensions(axial_values)) != ["x"]:
        axial_values = largest_sample(dataset, variable, along="x")[f"largest_{variable}"]
    axial_values = axial_values.compute()
    if (axial_values < 0).any():
        raise InvalidInputError("variable", variable, "a measure that is not negative", "take a stress measure")
    x, sample_x = dimension_along(axial_values, "x"), positions(axial_values, "x")
    # At a cut end the border of the contact is unknown.
    ends_and_cuts = zip(loaded_range(axial), cut_ends(dataset), strict=True)
    borders = [border.where(is_cut == 0).compute() for border, is_cut in ends_and_cuts]
    values = {}
    for end, border in zip(("first", "last"), borders, strict=True):
        # The factor allows for rounding of a point's distance.
        value = axial_values.where(abs(sample_x - border) <= reach * (1 + 1e-9)).max(x)
        values[end] = _replace_at_singular_end(dataset, end, value)
    distance = abs(sample_x - 0.5 * (borders[0] + borders[1]))
    nearest_index = distance.fillna(np.inf).argmin(x)
    width = cell_size(axial_values, "x")
    # A mid-length beyond the points has no value.
    is_within = distance.min(x) <= (width.isel({x: nearest_index}) if x in width.dims else width)
    return values | {"middle": axial_values.isel({x: nearest_index}).where(is_within), "peak": axial_values.max(x)}


def stress_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Largest von Mises stress, its error and position; empty without stresses."""
    if "von_mises" not in dataset:
        return xr.Dataset()
    if np.isnan(dataset["von_mises"].values).all():
        raise InvalidInputError("von_mises", "nan everywhere", "a field with at least one number")
    has_all_stresses = all(name in dataset for name in STRESSES)
    return peak(dataset) if has_all_stresses else largest_sample(dataset, "von_mises")


def case_numbers(dataset: xr.Dataset) -> dict[str, xr.Variable]:
    """All numbers of a solved case: scalars of the Dataset (refined), or else numbers of its cells."""
    require(dataset, "pressure", "hertz_max_pressure")
    field, scale = dataset["pressure"].transpose("x", "y"), float(dataset["hertz_max_pressure"])
    pressure = field.values
    x_index, y_index = np.unravel_index(int(np.nanargmax(pressure)), pressure.shape)
    axial = pressure.max(axis=1)
    outermost_pressures = axial[axial > 0][[0, -1]] if (axial > 0).any() else np.full(2, np.nan)
    first, last = (
        float(dataset.get(f"end_pressure_{end}", value)) / scale
        for end, value in zip(("first", "last"), outermost_pressures, strict=True)
    )
    numbers = {
        "peak_pressure": (pressure[x_index, y_index], ""),
        "peak_pressure_x": (field["x"].values[x_index], WHOLE_CELLS),
        "peak_pressure_y": (field["y"].values[y_index], WHOLE_CELLS),
        "end_pressure_over_p0_first": (first, OUTERMOST_CELL),
        "end_pressure_over_p0_last": (last, OUTERMOST_CELL),
        "end_pressure_over_p0": (0.5 * (first + last), OUTERMOST_CELL),
    }
    for name, axis, other_axis in (("contact_length", "x", 1), ("contact_width", "y", 0)):
        is_loaded, centres = (pressure > 0).any(axis=other_axis), field[axis].values
        width = field.coords.get(f"{axis}_width")
        # Without labels: a study computes these numbers for every case.
        mean_width = np.full(centres.size, np.ptp(centres) / max(centres.size - 1, 1))
        widths = mean_width if width is None else width.values
        extent = np.ptp(centres[is_loaded]) + widths[is_loaded][[0, -1]].mean() if is_loaded.any() else 0.0
        numbers[name] = extent, WHOLE_CELLS
    result = {}
    for name, (value, comment) in numbers.items():
        attributes = {"comment": comment, ERROR_KIND: NOT_ESTIMATED} if comment else {}
        result[name] = xr.Variable((), value, labels(name) | attributes)
    for source in (stress_summary(dataset), dataset):
        scalars = {str(name): entry for name, entry in source.variables.items() if entry.ndim == 0}
        result |= {name: entry for name, entry in scalars.items() if name not in source.coords}
    return result
