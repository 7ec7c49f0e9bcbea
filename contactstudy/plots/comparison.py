"""Several results in one picture: along the roller's axis, and against depth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from contactstudy.analysis import along_line, axial_pressure, dimension_along, positions, section_peak, single_case
from contactstudy.analysis.measures import measure
from contactstudy.arrays.required import require
from contactstudy.errors import InvalidInputError
from contactstudy.plots.labels import WIDEST_NAME, fold_labels, folded
from contactstudy.plots.singular import mark_at_top, near_singular, singular_ends
from contactstudy.plots.style import line_styles, new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_comparison(
    results: Mapping[str, xr.Dataset],
    variable: str = "pressure",
    ax: Axes | None = None,
    *,
    si: bool = False,
    centred: bool = False,
) -> Axes:
    """Largest value in each cross-section along the roller's axis, for several results: profiles, bodies, loads.

    Parameters
    ----------
    results : mapping
        Name for the legend to a single case; each is drawn over its own a and p0.
    variable : str
        `pressure`, or a stress or measure, see :func:`contactstudy.analysis.measure`.
    ax : Axes, optional
        Where to draw; default: a new figure.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and stresses over p0.
    centred : bool
        Whether positions count from the middle of the contact, for bodies of different length.

    Returns
    -------
    Axes

    Raises
    ------
    InvalidInputError
        If there is no result, or one lacks the variable or holds more than one case.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0.5, 1.5], "y": [0.0]})
    >>> one = xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> len(plot_comparison({"half": 0.5 * one, "whole": one}, si=True).lines)
    2
    """
    if not isinstance(results, Mapping) or not results:
        raise InvalidInputError("results", results, "a mapping of names to results, at least one")
    ax = new_axes(ax)
    for (name, dataset), style in zip(results.items(), line_styles(len(results)), strict=True):
        require(dataset)
        one = single_case(dataset)
        unit = units(one, si=si)
        profile = axial_pressure(one) if variable == "pressure" else section_peak(one, variable)[f"peak_{variable}"]
        place = profile[dimension_along(profile, "x")].values
        ends = singular_ends(one) if "pressure" in one else []
        shown = np.where(near_singular(one, ends, place), np.nan, profile.values)
        middle = 0.0
        if centred:
            axial = axial_pressure(one)
            loaded = positions(axial, "x").where(axial > 0)
            middle = 0.5 * float(loaded.min() + loaded.max())
        ax.plot((place - middle) / unit.length, shown / unit.stress, label=folded(name, WIDEST_NAME), **style)
        mark_at_top(ax, [(end - middle) / unit.length for end in ends], style["color"])
    ax.set_xlabel(unit.axis("x") if not centred else f"position from mid-length, $x{unit.over_length}$")
    ax.set_ylabel(unit.stress_label(variable))
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.legend(frameon=False, fontsize="small")
    fold_labels(ax)
    return ax


def plot_depth(
    dataset: xr.Dataset,
    variables: Sequence[str] = ("von_mises", "maximum_shear"),
    ax: Axes | None = None,
    *,
    x: float | None = None,
    y: float = 0.0,
    si: bool = False,
) -> Axes:
    """Stresses against depth below a point of the surface.

    Parameters
    ----------
    dataset : Dataset
        A single case with stresses.
    variables : sequence of str
        Stresses or measures, see :func:`contactstudy.analysis.measure`.
    ax : Axes, optional
        Where to draw; default: a new figure.
    x, y : float, optional
        The point, metres; default: the middle of the positions of stresses along x, and ``y = 0``.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and stresses over p0.

    Returns
    -------
    Axes
        With the depth downwards.

    Raises
    ------
    InvalidInputError
        If a variable is missing, the point lies outside the result, or there is more than one case.

    Examples
    --------
    >>> field = xr.DataArray([[[1.0, 4.0]]], dims=("x", "y", "z"), coords={"x": [0.0], "y": [0.0], "z": [0.0, 1.0]})
    >>> one = xr.Dataset({"von_mises": field, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_depth(one, ["von_mises"]).get_ylabel()
    'depth, $z/a$'
    """
    names = [variables] if isinstance(variables, str) else list(variables)
    if not names:
        raise InvalidInputError("variables", variables, "at least one")
    for name in names:
        measure(dataset, name)
    one = single_case(dataset)
    unit = units(one, si=si)
    field = measure(one, names[0])
    depth, along = positions(field, "z").values, positions(field, "x").values
    at = 0.5 * float(along.min() + along.max()) if x is None else x
    ends = ((at, y, float(depth.min())), (at, y, float(depth.max())))
    line = along_line(one, *ends, points=10 * np.size(depth) + 1, variables=names)
    ax = new_axes(ax, (4.8, 4.8))
    for name, style in zip(names, line_styles(len(names)), strict=True):
        ax.plot(
            line[name].values / unit.stress,
            line["z"].values / unit.length,
            label=folded(unit.stress_label(name), WIDEST_NAME),
            **style,
        )
    ax.set_ylim(depth.max() / unit.length, depth.min() / unit.length)
    ax.set_title(f"below {unit.place('x', at)}, {unit.place('y', y)}", fontsize="medium")
    ax.set_xlabel("stress over $p_0$" if not si else "stress (MPa)")
    ax.set_ylabel(unit.axis("z"))
    ax.legend(frameon=False, fontsize="small")
    fold_labels(ax)
    return ax
