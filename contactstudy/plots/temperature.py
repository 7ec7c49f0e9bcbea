"""Temperature that friction raises on the surfaces of a contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, single_case
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import variable_of
from contactstudy.plots.labels import fold_labels
from contactstudy.plots.style import new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEAT_COLORS = "inferno"
"""Colour map of temperatures: its lightness grows from end to end as well."""

SURFACES = {"body": "temperature_rise", "roller": "roller_temperature_rise"}
"""Variables of the surfaces that have a temperature."""


def plot_temperature_map(
    dataset: xr.Dataset, ax: Axes | None = None, *, surface: str = "body", si: bool = False
) -> Axes:
    """Temperature rise of a surface, with a cross where it is largest and the contact's edge as a line.

    Parameters
    ----------
    dataset : Dataset
        What `flash_temperature` returned.
    ax : Axes, optional
        Where to draw; default: a new figure.
    surface : str
        "body" or "roller".
    si : bool
        Whether to draw lengths in mm instead of over a.

    Returns
    -------
    Axes

    Raises
    ------
    InvalidInputError
        If the surface has no temperature, or there is more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> rise = xr.DataArray([[1.0, 1.0], [2.0, 2.5]], dims=("x", "y"), coords=cells)
    >>> hot = xr.Dataset({"temperature_rise": rise, "frictional_heat": 0 * rise, "hertz_half_width": 1.0})
    >>> plot_temperature_map(hot.assign(hertz_max_pressure=1.0)).get_ylabel()
    'position along rolling, $y/a$'
    """
    checks.known_name("surface", surface, SURFACES)
    name = SURFACES[surface]
    require(dataset, name, "frictional_heat")
    one = single_case(dataset)
    unit = units(one, si=si)
    ax = new_axes(ax)
    rise = one[name]
    x, y = (dimension_along(rise, axis) for axis in "xy")
    places = [rise[dim].values / unit.length for dim in (x, y)]
    values = rise.transpose(y, x).values
    drawn = ax.pcolormesh(*places, values, cmap=HEAT_COLORS, shading="nearest", rasterized=True)
    heat = one["frictional_heat"].transpose(y, x).values
    if heat.any() and min(heat.shape) > 1:
        ax.contour(*places, heat, levels=[1e-3 * heat.max()], colors="white", linewidths=0.8)
    j, i = divmod(int(values.argmax()), values.shape[1])
    ax.plot(places[0][i], places[1][j], "+", color="black", markersize=9)
    known = variable_of(name, rise.attrs)
    bar = ax.figure.colorbar(drawn, ax=ax, label=f"{known.long_name} (K)")
    ax.set_xlabel(unit.axis("x"))
    ax.set_ylabel(unit.axis("y"))
    fold_labels(ax, bar.ax)
    return ax
