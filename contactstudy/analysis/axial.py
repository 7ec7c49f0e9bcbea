"""Edges of a contact to a few hundredths of a cell: half-width, length and area.

The squared pressure inside a smooth edge and the gap to the power 2/3 outside are linear in the distance from the edge
(K. L. Johnson, Contact Mechanics, 1985, section 5.1): the edge is the mean of the zeros of quadratics fitted to both.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import (
    cell_edges,
    cell_size,
    dimension_along,
    positions,
    reduce_dims,
    single_case,
    sort_positions,
)
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, labelled_cells, name_array, require, require_in_si, without_error
from contactstudy.checks import Array, FloatArray, IntArray
from contactstudy.errors import InvalidInputError

SKIPPED_CELLS, FITTED_CELLS = 2, 5  # Cells next to an edge, too inaccurate for the fit; further cells, which it fits
# Largest error of an edge in cells, measured on Hertz contacts at all positions of the edge in a cell
EDGE_UNCERTAINTY = 0.04


def contact_borders(pressure: Array, centres: Array, gap: Array | None = None) -> tuple[Array, Array]:
    """First and last y in contact of each row of cells (..., y), from pressure and gap; NaN without contact."""
    shape, cell_count = pressure.shape[:-1], pressure.shape[-1]
    pressure_rows = np.nan_to_num(np.asarray(pressure, np.float64)).reshape(-1, cell_count)
    gap_rows = np.full_like(pressure_rows, np.nan) if gap is None else np.asarray(gap).reshape(-1, cell_count)
    positions = np.broadcast_to(centres, pressure.shape).reshape(-1, cell_count)
    first_centre, row_cell_counts = np.nanmin(positions, axis=1, initial=np.inf), np.isfinite(positions).sum(axis=1)
    step = (np.nanmax(positions, axis=1, initial=-np.inf) - first_centre) / np.maximum(row_cell_counts - 1, 1)
    first_edges = cell_count - 1 - _last_edges(pressure_rows[:, ::-1], gap_rows[:, ::-1])
    last_edges = _last_edges(pressure_rows, gap_rows)
    return (first_centre + step * first_edges).reshape(shape), (first_centre + step * last_edges).reshape(shape)


def _last_edges(pressure: FloatArray, gap: FloatArray) -> FloatArray:
    """Last edge of each row, in cells from the centre of the first cell; NaN without contact."""
    edges = np.full(pressure.shape[0], np.nan)
    loaded_rows = np.flatnonzero(pressure.any(axis=1))
    last_loaded = pressure.shape[1] - 1 - (pressure[loaded_rows, ::-1] > 0).argmax(axis=1)
    inner, outer = last_loaded - SKIPPED_CELLS, last_loaded + 1 + SKIPPED_CELLS
    square = _select_samples(pressure[loaded_rows], inner, -1) ** 2
    gap_power = _select_samples(gap[loaded_rows], outer, 1) ** (2 / 3)
    cell_face = last_loaded + 0.5
    estimates = np.stack([inner + _distance_to_zero(square), outer - _distance_to_zero(gap_power)])
    # For a contact of fewer than 7 cells the gap alone determines the edge.
    is_valid = np.abs(estimates - cell_face) <= 1
    estimate_sum = np.where(is_valid, estimates, 0.0).sum(axis=0)
    edges[loaded_rows] = np.where(is_valid.any(axis=0), estimate_sum / np.maximum(is_valid.sum(axis=0), 1), cell_face)
    return edges


def _select_samples(values: FloatArray, start: IntArray, direction: int) -> FloatArray:
    """Values of each row from the cell `start`: array (row, `FITTED_CELLS`); NaN unless all are positive and finite."""
    cells = start[:, None] + direction * np.arange(FITTED_CELLS)
    in_range = (cells >= 0) & (cells < values.shape[1])
    samples = np.take_along_axis(values, np.where(in_range, cells, 0), axis=1)
    is_valid = (in_range & (samples > 0) & np.isfinite(samples)).all(axis=1)
    return np.where(is_valid[:, None], samples, np.nan)


def _distance_to_zero(samples: FloatArray) -> FloatArray:
    """Distance, in cells, from the zero of a quadratic fitted to growing samples to the first sample; NaN if none."""
    fit_matrix = np.linalg.pinv(np.vander(np.arange(float(FITTED_CELLS)), 3))
    curvature, slope, constant_term = fit_matrix @ samples.T
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(2 * constant_term / (slope + np.sqrt(slope**2 - 4 * curvature * constant_term)))


def contact_edges(dataset: xr.Dataset) -> xr.Dataset:
    """Return edges, half-width, length and area of a contact, to a few hundredths of a cell.

    Where the contact ends with the shape or the body, its edge is the face of the last cell.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` (Pa) and `gap` (metres, after deformation; infinite beyond the surfaces) on (x, y), as from
        `solve_contact`; or one case selected from a study.

    Returns
    -------
    Dataset
        In metres: `y_left`, `y_right` and `half_width` (x), NaN without contact (of several contacts at one x, the
        outermost edges); `x_first`, `x_last` and their distance `contact_length`; in square metres `contact_area`, the
        integral of the width. Without contact, length and area are 0.

    Raises
    ------
    InvalidInputError
        If `pressure` or `gap` is missing, or the cells do not tile a range.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material, solve_contact
    >>> centres = np.linspace(-1.5, 1.5, 97)
    >>> gap = xr.DataArray(
    ...     0.5 * (centres[:, None] ** 2 + centres**2), coords={"x": centres, "y": centres}, dims=("x", "y")
    ... )
    >>> contact = solve_contact(HalfSpace(material=Material(0.75, 0.5)), gap, load=4 / 3)  # Hertz: radius 1
    >>> edges = contact_edges(contact)
    >>> round(float(edges.half_width.sel(x=0, method="nearest")), 3), round(float(edges.contact_area / np.pi), 3)
    (1.0, 1.0)
    """
    contact = single_case(dataset)
    require(contact, "pressure", "gap")
    pressure, grid = labelled_cells("dataset.pressure", contact["pressure"])
    gap, _ = labelled_cells("dataset.gap", contact["gap"], infinite=True)
    y_left, y_right = contact_borders(pressure, grid.y, gap)
    has_contact, cell_edges = bool(pressure.any()), grid.x_edges
    x_first = x_last = np.nan
    if has_contact and grid.uniform:
        starts, stops = contact_borders(pressure.T, grid.x, gap.T)
        # A smooth end lies within the face of the shape or the body.
        under_roller = np.flatnonzero(np.isfinite(gap).any(axis=1))
        x_first = float(max(np.nanmin(starts), cell_edges[under_roller[0]]))
        x_last = float(min(np.nanmax(stops), cell_edges[under_roller[-1] + 1]))
    elif has_contact:
        loaded_columns = np.flatnonzero(pressure.any(axis=1))
        x_first, x_last = float(cell_edges[loaded_columns[0]]), float(cell_edges[loaded_columns[-1] + 1])
    result = xr.Dataset(
        {
            "y_left": ("x", y_left),
            "y_right": ("x", y_right),
            "half_width": ("x", 0.5 * (y_right - y_left)),
            "x_first": x_first,
            "x_last": x_last,
            "contact_length": x_last - x_first if has_contact else 0.0,
            "contact_area": _integrate_width(grid, gap, y_right - y_left, (x_first, x_last)) if has_contact else 0.0,
        },
        coords={"x": contact["x"].values},
    )
    return describe(result, "edges of a contact, within a cell")


def _integrate_width(grid: Grid, gap: FloatArray, width: FloatArray, ends: tuple[float, float]) -> float:
    """Integral of the width over x, by a spline of the squared width, which is smooth at the ends."""
    first_x, last_x = ends
    columns = np.flatnonzero(np.isfinite(width))
    if np.any(np.diff(columns) > 1):
        return float(np.nansum(width * grid.widths))
    is_smooth = [
        int(0 <= neighbour < grid.cells_x and np.isfinite(gap[neighbour]).any())
        for neighbour in (columns[0] - 1, columns[-1] + 1)
    ]
    # Omit columns near an end whose contact is too narrow for the fits; the zero at a smooth end replaces them.
    wide = columns[width[columns] > 2 * (SKIPPED_CELLS + FITTED_CELLS) * grid.dy]
    columns = columns[(columns >= wide[0]) & (columns <= wide[-1])] if wide.size > 3 else columns
    # The border within an outermost column may not reach the column's centre.
    columns = columns[(grid.x[columns] > first_x) & (grid.x[columns] < last_x)]
    if columns.size < 2:
        return float(np.nansum(width * grid.widths))
    from scipy.interpolate import CubicSpline

    x = np.concatenate([[first_x][: is_smooth[0]], grid.x[columns], [last_x][: is_smooth[1]]])
    squared_width = np.concatenate([[0.0][: is_smooth[0]], width[columns] ** 2, [0.0][: is_smooth[1]]])
    angles = np.pi * (np.arange(4096) + 0.5) / 4096
    nodes = 0.5 * (first_x + last_x) - 0.5 * (last_x - first_x) * np.cos(angles)
    widths = np.sqrt(np.maximum(CubicSpline(x, squared_width)(nodes), 0.0))
    return float((widths * np.sin(angles)).sum() * 0.5 * (last_x - first_x) * np.pi / angles.size)


def axial_pressure(dataset: xr.Dataset) -> xr.DataArray:
    """Return the largest pressure across y at each position along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        With `pressure`, of any dimensions with one along y.

    Returns
    -------
    DataArray
        Pa, without the dimension along y.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure.

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0, 1.0], [2.0, 0.0]], dims=("x", "y"))
    >>> axial_pressure(xr.Dataset({"pressure": pressure})).values.tolist()
    [1.0, 2.0]
    """
    pressure = require_in_si(dataset, "pressure", normalized=True)["pressure"]
    return name_array("axial_pressure", pressure.max(dimension_along(pressure, "y")))


def loaded_range(axial: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    """Return the first and the last loaded position along the axis, metres; NaN without contact."""
    x, loaded_x = dimension_along(axial, "x"), positions(axial, "x").where(axial > 0)
    return loaded_x.min(x), loaded_x.max(x)


def line_load(dataset: xr.Dataset) -> xr.DataArray:
    """Return the load per length along the roller's axis, the integral of the pressure across y.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells.

    Returns
    -------
    DataArray
        N/m, without the dimension along y.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure, or less than two positions along y.

    Examples
    --------
    >>> cells = {"x": [0.0, 1.0], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[0.0, 1.0], [2.0, 3.0]], dims=("x", "y"), coords=cells)
    >>> line_load(xr.Dataset({"pressure": pressure})).values.tolist()
    [1.0, 5.0]
    """
    pressure = require_in_si(dataset, "pressure")["pressure"]
    y = dimension_along(pressure, "y")
    if pressure.sizes[y] < 2:
        raise InvalidInputError("dataset", dict(pressure.sizes), "a result with two positions along y or more")
    return name_array("line_load", pressure.sum(y, min_count=1) * cell_size(pressure, "y"))


def load_between(dataset: xr.Dataset, start: xr.DataArray | float, stop: xr.DataArray | float) -> xr.DataArray:
    """Return the load between two positions along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells.
    start, stop : float or DataArray
        Positions, metres, also infinite; an array has a position for each case of a study.

    Returns
    -------
    DataArray
        N, without the dimensions along x and y. A cut cell contributes the load on its length between the positions.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure, or the interval is empty, outside the cells or not a number.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5, 2.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]], dims=("x", "y"), coords=cells)
    >>> float(load_between(xr.Dataset({"pressure": pressure}), 0.0, 1.5))
    4.0
    """
    for name, value in (("start", start), ("stop", stop)):
        checks.instance(name, value, (float, int, np.number, xr.DataArray), "a number (metres) or a DataArray")
    load = line_load(dataset)
    lower_edges, upper_edges = cell_edges(load, "x")
    if np.any(np.greater_equal(start, stop)):
        raise InvalidInputError("start, stop", (start, stop), "increasing (metres)")
    low, high = float(lower_edges.min()), float(upper_edges.max())
    if np.all(np.greater_equal(start, high)) or np.all(np.less_equal(stop, low)):
        raise InvalidInputError("start, stop", (start, stop), f"a part of the cells, {low:.4g} to {high:.4g} m")
    overlap = (np.minimum(upper_edges, stop) - np.maximum(lower_edges, start)).clip(0.0)
    total = (load * overlap).sum(dimension_along(load, "x"), min_count=1)
    return name_array("normal_load", total).assign_attrs(comment="between two positions along the axis")


def half_width(dataset: xr.Dataset) -> xr.Dataset:
    """Return the half-width of the contact at each position along the roller's axis, and its middle.

    The border follows from the pressure alone; with few loaded cells across y the border is the face of a cell.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells.

    Returns
    -------
    Dataset
        Along x: `half_width` (m; 0 without contact) and `contact_middle` (m, y of the middle; NaN without contact).

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure.

    Examples
    --------
    >>> y = xr.DataArray((np.arange(40) - 19.5) / 16, dims="y")
    >>> pressure = np.sqrt(np.maximum(1 - y**2, 0)).expand_dims(x=[0.0]).assign_coords(y=y)
    >>> half_width(xr.Dataset({"pressure": pressure})).half_width.values.round(9).tolist()
    [1.0]
    """
    pressure = sort_positions(require_in_si(dataset, "pressure", normalized=True)["pressure"], "y")
    y = dimension_along(pressure, "y")
    first_y, last_y = reduce_dims(contact_borders, [(pressure, [y]), (positions(pressure, "y"), [y])], 2)
    width = (0.5 * (last_y - first_y)).fillna(0.0).where(pressure.notnull().any(y))
    contact_middle = 0.5 * (first_y + last_y)
    return xr.Dataset(
        {"half_width": name_array("half_width", width), "contact_middle": name_array("contact_middle", contact_middle)}
    )


def unloaded_gap(dataset: xr.Dataset) -> xr.DataArray:
    """Return the gap before deformation along the roller's axis: drop of the profile and tilt.

    Parameters
    ----------
    dataset : Dataset
        With `initial_gap`.

    Returns
    -------
    DataArray
        Smallest gap across y, m; NaN beyond the roller's ends.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks the initial gap.

    Examples
    --------
    >>> gap = xr.DataArray([[1e-6, 0.0], [np.inf, np.inf]], dims=("x", "y"))
    >>> unloaded_gap(xr.Dataset({"initial_gap": gap})).values.tolist()
    [0.0, nan]
    """
    require(dataset, "initial_gap")
    gap = dataset["initial_gap"]
    min_gap = gap.min(dimension_along(gap, "y"))
    return name_array("unloaded_gap", min_gap.where(np.isfinite(min_gap)))


def under_roller(dataset: xr.Dataset) -> xr.DataArray:
    """Return whether roller and body face each other at each x: from the initial gap, else from the pressure."""
    return (unloaded_gap(dataset) if "initial_gap" in dataset else axial_pressure(dataset)).notnull()


def axial_profiles(dataset: xr.Dataset) -> xr.Dataset:
    """Return pressure, load, half-width and gap along the roller's axis in one Dataset.

    Parameters
    ----------
    dataset : Dataset
        With `pressure`, and `initial_gap` for the unloaded gap.

    Returns
    -------
    Dataset
        Along x: `axial_pressure` (Pa), `line_load` (N/m), `half_width` and `contact_middle` (m), `unloaded_gap` (m).

    Raises
    ------
    InvalidInputError
        If the Dataset lacks pressure.

    Examples
    --------
    >>> cells = {"x": [0.0, 1.0], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[0.0, 0.0], [2.0, 3.0]], dims=("x", "y"), coords=cells)
    >>> sorted(axial_profiles(xr.Dataset({"pressure": pressure})).data_vars)
    ['axial_pressure', 'contact_middle', 'half_width', 'line_load']
    """
    result = half_width(dataset).assign(axial_pressure=axial_pressure(dataset), line_load=line_load(dataset))
    if "initial_gap" in dataset:
        result = result.assign(unloaded_gap=unloaded_gap(dataset))
    return without_error(result, *map(str, result.data_vars))
