"""How a profile wears: depth and load per length along the axis, one line for each distance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.required import require
from contactstudy.plots.style import line_styles, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHOWN = {"wear_depth": (1e6, "worn depth (µm)"), "line_load": (1e-3, "load per length (N/mm)")}
"""Variables that can be drawn, with their factor and label."""


def plot_wear(worn: xr.Dataset, ax: Axes | None = None, *, variable: str = "wear_depth") -> Axes:
    """Worn depth or load per length along the axis, dark to light with the distance.

    Parameters
    ----------
    worn : Dataset
        What `wear.wear_in` returned.
    ax : Axes, optional
        Where to draw; default: a new figure.
    variable : str
        "wear_depth" (downwards, as a profile's drop) or "line_load".

    Returns
    -------
    Axes
        The legend names the distances. Columns without load are not drawn.

    Raises
    ------
    InvalidInputError
        If the result lacks the variable, or it is another one.

    Examples
    --------
    >>> state = xr.DataArray([[0.0, 0.0], [2e-6, 1e-6]], dims=("distance", "x"))
    >>> worn = xr.Dataset({"wear_depth": state, "line_load": 1 + state}, {"distance": [0.0, 9.0], "x": [0.5, 1.5]})
    >>> [text.get_text() for text in plot_wear(worn).get_legend().get_texts()]
    ['0 m', '9 m']
    """
    checks.known_name("variable", variable, SHOWN)
    require(worn, variable, "line_load", argument="worn")
    factor, label = SHOWN[variable]
    ax = new_axes(ax)
    loaded = (worn["line_load"] > 0).any("distance").values
    places = 1e3 * worn["x"].values
    distances = worn["distance"].values
    for number, style in enumerate(line_styles(distances.size)):
        values = np.where(loaded, factor * worn[variable].transpose("distance", "x").values[number], np.nan)
        distance = np.format_float_positional(distances[number], precision=4, fractional=False, trim="-")
        ax.plot(places, values, label=f"{distance} m", **style)
    if variable == "wear_depth" and not ax.yaxis_inverted():
        ax.invert_yaxis()
    ax.set_xlabel("position along the axis, $x$ (mm)")
    ax.set_ylabel(label)
    ax.legend(frameon=False, fontsize="small", title=str(worn["distance"].attrs.get("long_name", "distance")))
    return ax
