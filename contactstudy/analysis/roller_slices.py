"""Roller in slices: load, largest pressure, half-width and shear of equal parts of its length, with their errors.

The square of the pressure, linear where a contact ends, is interpolated linearly between the middles of the columns,
whose distance determines the error.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, cell_edges, cell_size, dimension_along, single_case
from contactstudy.analysis.axial import axial_profiles, under_roller
from contactstudy.analysis.contact import MISSING_LOAD, cut_ends
from contactstudy.analysis.peaks import largest_sample
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute
from contactstudy.arrays.peaks import section_maxima
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, STRESSES, describe, require_in_si, without_error
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

SIDES = ("first", "last")  # Halves of the contact, nearer to end I and to end II
SHEARS = ("von_mises", "maximum_shear", "orthogonal_shear_amplitude")  # Stress measures of a slice
# Error of a slice's largest pressure, over the pressure's step to the next column. Accuracy: of 801 tables of crowned,
# straight, tilted, rounded and sharp rollers, 0.3 left 1 uncovered, 0.4 none
STEP_ERROR = 0.5
ROUNDING = 1e-9  # Distance of a stress point beyond its slice, over the roller's length, that counts as rounding


class Columns(NamedTuple):
    """Columns of a contact."""

    edges: FloatArray  # (column, 2), first and last x, m
    midpoints: FloatArray  # (column), m
    values: FloatArray  # (column), a quantity

    def overlaps(self, borders: FloatArray) -> FloatArray:
        """Length of each column within each slice between two borders, m: array (slice, column)."""
        low, high = self.edges.T
        overlap = np.minimum(borders[1:, None], high) - np.maximum(borders[:-1, None], low)
        return np.asarray(np.clip(overlap, 0.0, None))

    def extrapolate_to_ends(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Middles and both ends, with values extrapolated linearly to the ends, not below 0."""
        x, end_x = self.midpoints, (self.edges[0, 0], self.edges[-1, 1])
        if x.size == 1:
            return np.array([end_x[0], x[0], end_x[1]]), np.repeat(values, 3)
        first_value, last_value = (
            max(values[i] + (values[i] - values[j]) * (end - x[i]) / (x[i] - x[j]), 0.0)
            for end, i, j in ((end_x[0], 0, 1), (end_x[1], -1, -2))
        )
        return np.concatenate([end_x[:1], x, end_x[1:]]), np.concatenate([[first_value], values, [last_value]])


def step_errors(values: FloatArray) -> FloatArray:
    """Error between neighbouring values: half their step; at the end of a contact their step, or a larger neighbour."""
    steps = np.abs(np.diff(values))
    neighbours = larger_neighbour_step(STEP_ERROR * steps)
    # A contact may end anywhere up to the middle of the next column.
    is_contact_end = (np.minimum(values[1:], values[:-1]) <= 0) & (steps > 0)
    end_errors = np.maximum(steps, np.maximum(neighbours[1:], neighbours[:-1]))
    return np.where(is_contact_end, end_errors, STEP_ERROR * steps)


def larger_neighbour_step(steps: FloatArray) -> FloatArray:
    """Return the larger of the steps from each column to its two neighbours."""
    return np.asarray(np.maximum(np.append(steps, 0.0), np.insert(steps, 0, 0.0)))


def find_maxima(pressure: Columns, borders: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the largest pressure of each slice between two borders, and its error from the columns, Pa."""
    x, squares = pressure.extrapolate_to_ends(pressure.values**2)
    pressures = np.sqrt(squares)
    steps = step_errors(pressures)
    # A border has the error of the step it lies in; a column's middle has the larger error of both steps.
    points = np.concatenate([borders, x])
    values = np.concatenate([np.sqrt(np.interp(borders, x, squares)), pressures])
    step_index = np.clip(np.searchsorted(x, borders, side="right") - 1, 0, steps.size - 1)
    upper_bounds = values + np.concatenate([steps[step_index], larger_neighbour_step(steps)])
    maxima, error = np.empty(borders.size - 1), np.empty(borders.size - 1)
    for index, (low, high) in enumerate(pairwise(borders)):
        in_slice = (points >= low) & (points <= high)
        maxima[index] = values[in_slice].max()
        error[index] = upper_bounds[in_slice].max() - maxima[index]
    return maxima, error


def power_means(columns: Columns, borders: FloatArray, power: float) -> tuple[FloatArray, FloatArray]:
    """Power mean ``mean(v**power)**(1/power)`` of each slice, and its error; `v` is linear between midpoints."""
    x, column_values = columns.extrapolate_to_ends(columns.values)
    steps = step_errors(column_values)
    step_borders = np.unique(np.concatenate([borders, x[(x > borders[0]) & (x < borders[-1])]]))
    midpoints, half_lengths = 0.5 * (step_borders[1:] + step_borders[:-1]), 0.5 * np.diff(step_borders)
    step_index = np.clip(np.searchsorted(x, midpoints) - 1, 0, steps.size - 1)
    slice_index = np.searchsorted(borders, midpoints) - 1
    nodes, weights = np.polynomial.legendre.leggauss(6)  # exact for a 12th power
    values = np.interp(midpoints[:, None] + half_lengths[:, None] * nodes, x, column_values)

    def mean(samples: FloatArray) -> FloatArray:
        scale = max(float(samples.max()), np.finfo(float).tiny)
        integrals = half_lengths * ((samples / scale) ** power @ weights)
        integral = np.bincount(slice_index, integrals, minlength=borders.size - 1)
        return np.asarray(scale * (integral / np.diff(borders)) ** (1 / power))

    means = mean(values)
    return means, mean(values + steps[step_index, None]) - means


def border_load_errors(line_load: Columns, borders: FloatArray) -> FloatArray:
    """Return the load that may lie beyond the borders of each slice, N: the load varies within a column."""
    low, high = line_load.edges.T
    lengths = np.minimum(high - low, np.diff(borders).min())
    load_errors = larger_neighbour_step(np.abs(np.diff(line_load.values))) * lengths
    errors = np.zeros(borders.size)
    for index, border in enumerate(borders[1:-1], start=1):
        first_column = int(np.searchsorted(high, border, side="left"))
        last_column = min(int(np.searchsorted(low, border, side="right")), low.size - 1)
        # Fraction of the line load's step to the next column that may lie beyond a border. Accuracy: of 629 tables 0.1
        # left 5 uncovered; at 0.25 the worst error is half of the stated error
        errors[index] = 0.25 * load_errors[max(first_column - 1, 0) : last_column + 1].max()
    return np.asarray(errors[:-1] + errors[1:])


def pressure_errors(result: xr.Dataset) -> tuple[float, float]:
    """Relative error of the largest pressure on either half: infinite at a singular end, NaN without an estimate."""
    # The errors refer to a complete contact on its original cells, not to a part or to common cells of a study.
    if "normal_load" not in result or result["pressure"].attrs.get(ERROR_KIND) == NOT_ESTIMATED:
        return np.nan, np.nan
    dx, dy = (cell_size(result["pressure"], axis) for axis in "xy")
    resultant = float((result["pressure"] * dx * dy).sum())
    if not resultant > (1 - MISSING_LOAD) * float(result["normal_load"]):  # also true of NaN
        return np.nan, np.nan
    accuracy = float(attribute(result, INPUTS_ATTRIBUTE).get("settings", {}).get("accuracy", np.nan))
    errors = []
    for side in SIDES:
        peak, error = (float(result.get(f"peak_pressure_{side}{suffix}", np.nan)) for suffix in ("", "_error"))
        is_estimated = np.isfinite(peak) and peak > 0 and not np.isnan(error)
        errors.append(error / peak if is_estimated else accuracy)
    return errors[0], errors[1]


def slices(dataset: xr.Dataset, count: int = 30) -> xr.Dataset:
    """Cut the facing length of roller and body into equal slices, and list load, pressure and stress of each.

    Parameters
    ----------
    dataset : Dataset
        One case, with `pressure`; with `initial_gap` the slices span the facing length, otherwise the grid.
    count : int
        Number of slices, at most the number of cells along that length.

    Returns
    -------
    Dataset
        Along `slice` = 1, 2, ...: `position` (m, its middle), `width` (m), `normal_load` (N), `axial_pressure` (Pa,
        largest between the cells; infinite at a singular end), these two with ``_error``, NaN unless a whole result
        has errors of its pressure; `half_width` (m, mean over its cells), `unloaded_gap` (m, mean). With stresses also
        `largest_von_mises`, `largest_maximum_shear`, `largest_orthogonal_shear_amplitude` (Pa) and their depths
        ``..._z`` (m); NaN for a slice without stress points. ``.to_dataframe()`` makes it a table.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure, more than one case, or fewer cells than slices.

    Examples
    --------
    >>> cells = {"x": np.arange(4) + 0.5, "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[1, 1], [3, 3], [3, 3], [0, 0]], dims=("x", "y"), coords=cells)
    >>> table = slices(xr.Dataset({"pressure": pressure}), 2).to_dataframe()
    >>> table["normal_load"].tolist(), table["axial_pressure"].tolist()
    ([8.0, 6.0], [3.0, 3.0])
    """
    case = single_case(require_in_si(dataset, "pressure"))
    slice_count = checks.count("count", count)
    profiles = axial_profiles(case)
    x = dimension_along(profiles["line_load"], "x")
    is_facing = under_roller(case).values
    cells = profiles.isel({x: is_facing})
    centres = cells[x].values
    if centres.size < slice_count:
        raise InvalidInputError("count", count, f"at most the number of cells, {centres.size}")
    edges = np.stack(cell_edges(cells["line_load"], "x"), axis=-1)
    borders = np.linspace(edges[0, 0], edges[-1, 1], slice_count + 1)

    maxima = section_maxima(case["pressure"].transpose(x, ...).values[is_facing])
    pressure, line_load = Columns(edges, centres, maxima), Columns(edges, centres, cells["line_load"].values)
    # A cell that a border cuts divides its load between both slices.
    overlaps = xr.DataArray(pressure.overlaps(borders), dims=("slice", x))
    position_comment = {"comment": "an equal part of the cells under the roller"}
    result = xr.Dataset(
        {
            "position": ("slice", 0.5 * (borders[1:] + borders[:-1]), position_comment),
            "width": ("slice", np.full(slice_count, borders[1] - borders[0]), position_comment),
        },
        coords={"slice": np.arange(1, slice_count + 1)},
    )
    load = (overlaps * cells["line_load"]).sum(x).values
    result = result.assign(_label_loads_and_pressures(case, borders, pressure, line_load, load).data_vars)
    averaged_names = [name for name in ("half_width", "unloaded_gap") if name in cells]
    for name in averaged_names:
        mean = (overlaps * cells[name]).sum(x) / overlaps.sum(x)
        result[name] = mean.assign_attrs(comment="mean over the cells of the slice")
    if all(name in case and "z" in axis_dimensions(case[name]) for name in STRESSES):
        position_tolerance = ROUNDING * (borders[-1] - borders[0])
        for name in SHEARS:
            sections = largest_sample(case, name, along="x")
            stress = sections[f"largest_{name}"]
            stress_dim = dimension_along(stress, "x")
            points = stress[stress_dim].values
            in_slice = (points >= borders[:-1, None] - position_tolerance) & (
                points <= borders[1:, None] + position_tolerance
            )
            samples = stress.where(xr.DataArray(in_slice, dims=("slice", stress_dim)))
            index, has_samples = samples.fillna(-np.inf).argmax(stress_dim), samples.notnull().any(stress_dim)
            for variable in (f"largest_{name}", f"largest_{name}_z"):
                value = sections[variable].isel({stress_dim: index}).where(has_samples).reset_coords(drop=True)
                result[variable] = value.assign_attrs(sections[variable].attrs)
    return describe(without_error(result, *averaged_names))


def _label_loads_and_pressures(
    case: xr.Dataset, borders: FloatArray, pressure: Columns, line_load: Columns, load: FloatArray
) -> xr.Dataset:
    """Load and largest pressure of each slice with their errors, from the refined pressures and the columns."""
    maxima, column_error = find_maxima(pressure, borders)
    relative_errors = pressure_errors(case)
    mid_length, position_tolerance = 0.5 * (borders[0] + borders[-1]), ROUNDING * (borders[-1] - borders[0])
    half_masks = (borders[:-1] < mid_length - position_tolerance, borders[1:] > mid_length + position_tolerance)
    peaks = [float(case.get(f"peak_pressure_{side}", np.nan)) for side in SIDES]
    pressure_error = np.max(
        [
            np.where(in_half, relative_error * (maxima if np.isinf(peak) else peak), 0.0)
            for in_half, relative_error, peak in zip(half_masks, relative_errors, peaks, strict=True)
        ],
        axis=0,
    )
    error = pressure_error + column_error
    for is_cut, side, end in zip(cut_ends(case), SIDES, (0, -1), strict=True):
        if np.isinf(float(case.get(f"end_pressure_{side}", 0.0))) and not is_cut:
            maxima[end] = error[end] = np.inf
    load_error = np.max(relative_errors) * np.maximum(load, load.mean()) + border_load_errors(line_load, borders)
    error_comment = "from the stated errors of the pressure and the distance of the columns"
    values = {
        "normal_load": (load, "of the slice"),
        "normal_load_error": (load_error, error_comment),
        "axial_pressure": (maxima, "largest of the slice"),
        "axial_pressure_error": (error, error_comment),
    }
    result = xr.Dataset({name: ("slice", array, {"comment": comment}) for name, (array, comment) in values.items()})
    return without_error(result, *values) if np.isnan(relative_errors).any() else result
