"""Pressure: along the roller's axis, and on the top of the body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis import axial_pressure, dimension_along, single_case
from contactstudy.arrays.required import require
from contactstudy.plots.labels import fold_labels
from contactstudy.plots.singular import mark_at_top, near_singular, singular_ends
from contactstudy.plots.style import COLORS, new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_axial_pressure(
    dataset: xr.Dataset, ax: Axes | None = None, *, shift: float = 0.0, si: bool = False, **style: Any
) -> Axes:
    """Largest pressure across y along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        A single case with `pressure`.
    ax : Axes, optional
        Where to draw; default: a new figure.
    shift : float
        Added to the positions, in the unit that is drawn.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and pressures over p0.
    **style
        For the line, as in matplotlib.

    Returns
    -------
    Axes
        At a singular end an open triangle at the top stands for the pressure, which has no largest value; the last 0.05
        half-widths before it are not drawn.

    Raises
    ------
    InvalidInputError
        If there is no pressure, or more than one case.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0.5, 1.5], "y": [0.0]})
    >>> one = xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_axial_pressure(one).get_ylabel()
    'contact pressure, $p/p_0$'
    """
    require(dataset, "pressure")
    one = single_case(dataset)
    require(one, "pressure")
    unit = units(one, si=si)
    ax = new_axes(ax)
    axial = axial_pressure(one)
    ends = singular_ends(one)
    drawn = np.where(near_singular(one, ends), np.nan, axial.values)
    (line,) = ax.plot(axial[dimension_along(axial, "x")].values / unit.length + shift, drawn / unit.stress, **style)
    mark_at_top(ax, [end / unit.length + shift for end in ends], line.get_color())
    ax.set_xlabel(unit.axis("x"))
    ax.set_ylabel(unit.stress_label("pressure"))
    fold_labels(ax)
    return ax


def plot_pressure_map(dataset: xr.Dataset, ax: Axes | None = None, *, si: bool = False) -> Axes:
    """Pressure on the top of the body.

    Parameters
    ----------
    dataset : Dataset
        A single case with `pressure`.
    ax : Axes, optional
        Where to draw; default: a new figure.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and pressures over p0.

    Returns
    -------
    Axes

    Raises
    ------
    InvalidInputError
        If there is no pressure, or more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[1.0, 1.0], [2.0, 2.0]], dims=("x", "y"), coords=cells)
    >>> one = xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_pressure_map(one).get_ylabel()
    'position along rolling, $y/a$'
    """
    require(dataset, "pressure")
    one = single_case(dataset)
    require(one, "pressure")
    unit = units(one, si=si)
    ax = new_axes(ax)
    pressure = one["pressure"]
    x, y = (dimension_along(pressure, axis) for axis in "xy")
    # Beside a singular end the colours say "more than": the height there is that of a cell.
    near = near_singular(one, singular_ends(one))
    largest = float(pressure.isel({x: ~near}).max()) / unit.stress if near.any() else None
    drawn = ax.pcolormesh(
        pressure[x].values / unit.length,
        pressure[y].values / unit.length,
        pressure.transpose(y, x).values / unit.stress,
        cmap=COLORS,
        shading="nearest",
        vmax=largest,
        rasterized=True,
    )
    extend = "neither" if largest is None else "max"
    bar = ax.figure.colorbar(drawn, ax=ax, label=unit.stress_label("pressure"), extend=extend)
    ax.set_xlabel(unit.axis("x"))
    ax.set_ylabel(unit.axis("y"))
    fold_labels(ax, bar.ax)
    return ax
