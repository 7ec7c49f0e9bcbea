"""Edges of a contact to a few hundredths of a cell: half-width, length and area that hardly depend on the grid."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from contactstudy import checks
from contactstudy.checks import FloatArray, IntArray
from contactstudy.dataset import describe
from contactstudy.errors import InvalidInputError
from contactstudy.grid import Grid
from contactstudy.labelled import labelled_cells

# The cells on either side of an edge carry the error of a cell that the edge cuts; the fits begin behind them.
SKIPPED = 2
FITTED = 5
EDGE_UNCERTAINTY = 0.04
"""Largest error of an edge in cells, as seen at Hertz' contacts whose edge lies anywhere in a cell."""


def contact_edges(contact: xr.Dataset) -> xr.Dataset:
    """Edges, half-width, length and area of a contact, to a few hundredths of a cell.

    Across the smooth edge of a contact the pressure goes to zero like the square root of the distance, and the gap
    opens like its power 3/2 (K. L. Johnson, Contact Mechanics, 1985, section 5.1). So the squared pressure inside and
    the gap to the power 2/3 outside are straight lines through the edge; quadratics are fitted to both, and their
    zeros averaged. Where the contact is too narrow for that, or ends because the shape or the body does, its edge is
    the face of the last cell.

    Parameters
    ----------
    contact : Dataset
        With `pressure` (Pa) and `gap` (metres, after deformation; infinite where there is nothing to touch) on
        (x, y), as from `solve_contact`.

    Returns
    -------
    Dataset
        In metres: `y_left`, `y_right` and `half_width` (x), NaN where no cell is in contact (of several contacts at
        one x, the outermost edges); `x_first`, `x_last` and their distance `contact_length`; in square metres
        `contact_area`, the integral of the width. Without any contact, length and area are 0.

    Raises
    ------
    InvalidInputError
        If `pressure` or `gap` is missing or not on the cells of one uniform grid.

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
    checks.instance("contact", contact, xr.Dataset, "a Dataset")
    for name in ("pressure", "gap"):
        if name not in contact:
            raise InvalidInputError("contact", sorted(map(str, contact.data_vars)), f"a Dataset with {name}")
    pressure, grid = labelled_cells("contact.pressure", contact["pressure"])
    gap, _ = labelled_cells("contact.gap", contact["gap"], infinite=True)
    left, right = _edges_across(pressure, gap, grid.y)
    starts, stops = _edges_across(pressure.T, gap.T, grid.x)
    touches = bool(pressure.any())
    first, last = (float(np.nanmin(starts)), float(np.nanmax(stops))) if touches else (np.nan, np.nan)
    result = xr.Dataset(
        {
            "y_left": ("x", left),
            "y_right": ("x", right),
            "half_width": ("x", 0.5 * (right - left)),
            "x_first": first,
            "x_last": last,
            "contact_length": last - first if touches else 0.0,
            "contact_area": _area(grid, gap, right - left, first, last) if touches else 0.0,
        },
        coords={"x": contact["x"].values},
    )
    return describe(result, "edges of a contact, within a cell")


def _edges_across(pressure: FloatArray, gap: FloatArray, centres: FloatArray) -> tuple[FloatArray, FloatArray]:
    """First and last edge along the second axis, for each row; NaN where open."""
    step = centres[1] - centres[0]
    first = centres[-1] - step * _last_edges(pressure[:, ::-1], gap[:, ::-1])
    return first, centres[0] + step * _last_edges(pressure, gap)


def _last_edges(pressure: FloatArray, gap: FloatArray) -> FloatArray:
    """Last edge along each row, in cells from the centre of the first; NaN where open."""
    edges = np.full(pressure.shape[0], np.nan)
    rows = np.flatnonzero(pressure.any(axis=1))
    last = pressure.shape[1] - 1 - (pressure[rows, ::-1] > 0).argmax(axis=1)
    begin_inside, begin_outside = last - SKIPPED, last + 1 + SKIPPED
    squared = _samples(pressure[rows], begin_inside, -1) ** 2
    opening = _samples(gap[rows], begin_outside, 1) ** (2 / 3)
    face = last + 0.5
    estimates = np.stack([begin_inside + _distance_to_zero(squared), begin_outside - _distance_to_zero(opening)])
    valid = np.abs(estimates - face) <= 1
    total = np.where(valid, estimates, 0.0).sum(axis=0)
    edges[rows] = np.where(valid.any(axis=0), total / np.maximum(valid.sum(axis=0), 1), face)
    return edges


def _samples(values: FloatArray, begin: IntArray, direction: int) -> FloatArray:
    """Values of each row from the cell `begin` on: array (row, `FITTED`); NaN unless all are positive numbers."""
    cells = begin[:, None] + direction * np.arange(FITTED)
    inside = (cells >= 0) & (cells < values.shape[1])
    found = np.take_along_axis(values, np.where(inside, cells, 0), axis=1)
    good = (inside & (found > 0) & np.isfinite(found)).all(axis=1)
    return np.where(good[:, None], found, np.nan)


def _distance_to_zero(values: FloatArray) -> FloatArray:
    """How many steps before the first of growing values (of each row) the quadratic fitted to them is zero, or NaN."""
    to_quadratic = np.linalg.pinv(np.vander(np.arange(float(FITTED)), 3))
    bend, slope, level = to_quadratic @ values.T
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(2 * level / (slope + np.sqrt(slope**2 - 4 * bend * level)))


def _area(grid: Grid, gap: FloatArray, width: FloatArray, first: float, last: float) -> float:
    """Integral of the width over x.

    At a smooth end the width goes to zero like a square root, so its square is what is interpolated between columns.
    """
    columns = np.flatnonzero(np.isfinite(width))
    if np.any(np.diff(columns) > 1):
        return float(np.nansum(width) * grid.dx)
    smooth = [
        int(0 <= beyond < grid.cells_x and np.isfinite(gap[beyond]).any())
        for beyond in (columns[0] - 1, columns[-1] + 1)
    ]
    # Columns too narrow for the fits would spoil the interpolation, which has the exact zero at a smooth end.
    wide = columns[width[columns] > 2 * (SKIPPED + FITTED) * grid.dy]
    columns = wide if wide.size > 3 else columns
    squared = width[columns] ** 2
    at = np.concatenate([[first][: smooth[0]], grid.x[columns], [last][: smooth[1]]])
    values = np.concatenate([[0.0][: smooth[0]], squared, [0.0][: smooth[1]]])
    angles = np.pi * (np.arange(4096) + 0.5) / 4096
    x = 0.5 * (first + last) - 0.5 * (last - first) * np.cos(angles)
    between = np.sqrt(np.maximum(CubicSpline(at, values)(x), 0.0))
    return float((between * np.sin(angles)).sum() * 0.5 * (last - first) * np.pi / angles.size)
