"""Figures of a film: contours over the contact, film and pressure along a line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import single_case
from contactstudy.arrays.variables import require
from contactstudy.errors import InvalidInputError
from contactstudy.plots.style import COLORS, label_axes, line_styles, new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HALF_RANGE = 1.4  # Half of the range along y in a figure, over the Hertz half-width


def plot_film_map(dataset: xr.Dataset, ax: Axes | None = None, *, fringes: int = 12, si: bool = False) -> Axes:
    """Film thickness with contours, like an interferogram.

    Parameters
    ----------
    dataset : Dataset
        Result of `solve_film`.
    ax, si
        As for :func:`contactstudy.plots.plot_axial_pressure`.
    fringes : int
        Number of contours up to 1.5 times the central film.

    Returns
    -------
    Axes
        A cross marks the least film.

    Raises
    ------
    InvalidInputError
        If the film is missing, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> film = xr.DataArray([[1e-6, 2e-6], [1e-6, 3e-6]], dims=("x", "y"), coords=cells)
    >>> scalars = {"central_film": 2e-6, "least_film_x": 0.5, "least_film_y": -0.5, "hertz_half_width": 1.0}
    >>> case = xr.Dataset({"film_thickness": film, **scalars, "hertz_max_pressure": 1.0})
    >>> plot_film_map(case).get_ylabel()
    'position along rolling, $y/a$'
    """
    checks.count("fringes", fringes)
    case = single_case(dataset)
    require(case, "film_thickness", "central_film", "least_film_x", "least_film_y")
    unit, ax = units(case, si=si), new_axes(ax)
    film = 1e6 * case["film_thickness"].transpose("y", "x")
    x, y = (film[axis].values / unit.length for axis in "xy")
    max_film = 1.5e6 * float(case["central_film"])
    levels = np.linspace(0.0, max_film, fringes + 1)
    contours = ax.contourf(x, y, film.values, levels=levels, cmap=COLORS, extend="max")
    ax.contour(x, y, film.values, levels=levels[1:], colors="0.25", linewidths=0.5)
    ax.plot(float(case["least_film_x"]) / unit.length, float(case["least_film_y"]) / unit.length, "x", color="#e8513a")
    half_range = HALF_RANGE * float(case["hertz_half_width"]) / unit.length
    ax.set_ylim(max(-half_range, y.min()), min(half_range, y.max()))
    bar = ax.figure.colorbar(contours, ax=ax, label="film thickness, $h$ (µm)")
    label_axes(ax, unit.axis("x"), unit.axis("y"), bar.ax)
    return ax


def plot_film_line(
    dataset: xr.Dataset, ax: Axes | None = None, *, x: float | None = None, y: float | None = None, si: bool = False
) -> Axes:
    """Film thickness and pressure along the axis, or along y.

    Parameters
    ----------
    dataset : Dataset
        Result of `solve_film`.
    ax, si
        As for :func:`contactstudy.plots.plot_axial_pressure`.
    x, y : float, optional
        Position of the line along y or along the axis, metres; default: along the axis at ``y = 0``.

    Returns
    -------
    Axes
        Axes of the film; the pressure has axes on the right.

    Raises
    ------
    InvalidInputError
        If the film is missing, both positions are given, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> film = xr.DataArray([[1e-6, 2e-6], [1e-6, 3e-6]], dims=("x", "y"), coords=cells)
    >>> case = xr.Dataset({"film_thickness": film, "pressure": 0 * film, "central_film": 1e-6,
    ...                    "hertz_half_width": 1.0, "hertz_max_pressure": 1.0})
    >>> plot_film_line(case, x=0.5).get_xlabel()
    'position along rolling, $y/a$'
    """
    if x is not None and y is not None:
        raise InvalidInputError("x, y", (x, y), "one of the two")
    case = single_case(dataset)
    require(case, "film_thickness", "pressure", "central_film")
    unit, ax = units(case, si=si), new_axes(ax)
    axis, fixed_axis, position = ("x", "y", y or 0.0) if x is None else ("y", "x", x)
    line = case[["film_thickness", "pressure"]].dropna("x").interp({fixed_axis: position})
    along = line[axis].values / unit.length
    film_style, pressure_style, slice_style = line_styles(3)
    ax.plot(along, 1e6 * line["film_thickness"].values, label="film", **film_style)
    if axis == "x" and "slice_film" in case:
        slices = case["slice_film"].sel(x=line["x"])
        ax.plot(along, 1e6 * slices.values, label="slices, Moes' formula", **slice_style)
    pressure_axes = ax.twinx()
    pressure_axes.plot(along, line["pressure"].values / unit.stress, label="pressure", **pressure_style)
    ax.set_ylim(0.0, 3e6 * float(case["central_film"]))
    pressure_axes.set_ylim(bottom=0.0)
    if axis == "y":
        half_range = HALF_RANGE * float(case["hertz_half_width"]) / unit.length
        ax.set_xlim(-half_range, half_range)
    pressure_axes.set_ylabel(unit.stress_label("pressure"))
    ax.legend(handles=[*ax.lines, *pressure_axes.lines], loc="lower center", frameon=False, fontsize="small")
    label_axes(ax, unit.axis(axis), "film thickness, $h$ (µm)", pressure_axes)
    return ax
