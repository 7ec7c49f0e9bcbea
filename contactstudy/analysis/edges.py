"""Edges of a contact to a few hundredths of a cell: half-width, length and area that hardly depend on the grid."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import single_case
from contactstudy.analysis.border import FITTED, SKIPPED, contact_borders
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import describe
from contactstudy.checks import FloatArray

WIDTHS = 4096
"""Points of the quadrature of the width over x. Accuracy."""


def contact_edges(contact: xr.Dataset) -> xr.Dataset:
    """Edges, half-width, length and area of a contact, to a few hundredths of a cell.

    See `contactstudy.analysis.border`. Where the contact ends because the shape or the body does, its edge is the face
    of the last cell.

    Parameters
    ----------
    contact : Dataset
        With `pressure` (Pa) and `gap` (metres, after deformation; infinite where there is nothing to touch) on
        (x, y), as from `solve_contact`; or one case selected from a study.

    Returns
    -------
    Dataset
        In metres: `y_left`, `y_right` and `half_width` (x), NaN where no cell is in contact (of several contacts at
        one x, the outermost edges); `x_first`, `x_last` and their distance `contact_length`; in square metres
        `contact_area`, the integral of the width. Without any contact, length and area are 0.

    Raises
    ------
    InvalidInputError
        If `pressure` or `gap` is missing or not on cells that tile a range.

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
    contact, pressure, gap, grid = _cells(contact)
    left, right = contact_borders(pressure, grid.y, gap)
    touches = bool(pressure.any())
    first, last = _ends(pressure, gap, grid) if touches else (np.nan, np.nan)
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


def contact_length(contact: xr.Dataset) -> xr.DataArray:
    """Length of a contact alone, as from `contact_edges`, metres."""
    _, pressure, gap, grid = _cells(contact)
    first, last = _ends(pressure, gap, grid) if pressure.any() else (0.0, 0.0)
    return describe(xr.Dataset({"contact_length": last - first}))["contact_length"]


def _cells(contact: xr.Dataset) -> tuple[xr.Dataset, FloatArray, FloatArray, Grid]:
    """Contact of one case, its pressure and its gap on its cells, and these."""
    require(contact, argument="contact")
    contact = single_case(contact)
    require(contact, "pressure", "gap", argument="contact")
    pressure, grid = labelled_cells("contact.pressure", contact["pressure"])
    gap, _ = labelled_cells("contact.gap", contact["gap"], infinite=True)
    return contact, pressure, gap, grid


def _ends(pressure: FloatArray, gap: FloatArray, grid: Grid) -> tuple[float, float]:
    """First and last x of the contact: within a uniform cell, or the faces of the outermost of other cells."""
    if grid.uniform:
        starts, stops = contact_borders(pressure.T, grid.x, gap.T)
        # A smooth end that is found beyond the shape or the body is one at its face.
        faced, edges = np.flatnonzero(np.isfinite(gap).any(axis=1)), grid.x_edges
        first, last = max(np.nanmin(starts), edges[faced[0]]), min(np.nanmax(stops), edges[faced[-1] + 1])
        return float(first), float(last)
    loaded, edges = np.flatnonzero(pressure.any(axis=1)), grid.x_edges
    return float(edges[loaded[0]]), float(edges[loaded[-1] + 1])


def _area(grid: Grid, gap: FloatArray, width: FloatArray, first: float, last: float) -> float:
    """Integral of the width over x."""
    columns = np.flatnonzero(np.isfinite(width))
    if np.any(np.diff(columns) > 1):
        return float(np.nansum(width * grid.widths))
    smooth = [
        int(0 <= beyond < grid.cells_x and np.isfinite(gap[beyond]).any())
        for beyond in (columns[0] - 1, columns[-1] + 1)
    ]
    # Near an end columns too narrow for the fits would spoil the interpolation, which has the zero at a smooth one.
    wide = columns[width[columns] > 2 * (SKIPPED + FITTED) * grid.dy]
    columns = columns[(columns >= wide[0]) & (columns <= wide[-1])] if wide.size > 3 else columns
    # A border found within its outermost column of cells may lie short of that column's centre.
    columns = columns[(grid.x[columns] > first) & (grid.x[columns] < last)]
    if columns.size < 2:
        return float(np.nansum(width * grid.widths))
    from scipy.interpolate import CubicSpline

    # At a smooth end the width goes to zero like a square root, so its square is what is interpolated.
    squared = width[columns] ** 2
    at = np.concatenate([[first][: smooth[0]], grid.x[columns], [last][: smooth[1]]])
    values = np.concatenate([[0.0][: smooth[0]], squared, [0.0][: smooth[1]]])
    angles = np.pi * (np.arange(WIDTHS) + 0.5) / WIDTHS
    x = 0.5 * (first + last) - 0.5 * (last - first) * np.cos(angles)
    between = np.sqrt(np.maximum(CubicSpline(at, values)(x), 0.0))
    return float((between * np.sin(angles)).sum() * 0.5 * (last - first) * np.pi / angles.size)
