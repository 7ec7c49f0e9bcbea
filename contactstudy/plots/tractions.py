"""Stick and slip: where the surfaces stick, the tractions there, and the force against the creepage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, single_case
from contactstudy.arrays.engineering import unit_for
from contactstudy.arrays.required import require
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.plots.labels import WIDEST_NAME, fold_labels, folded
from contactstudy.plots.study_lines import MARKERS
from contactstudy.plots.study_map import one_value, readable
from contactstudy.plots.style import COLORS, as_written, line_styles, new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STICK, SLIP = "0.55", "0.88"
"""Greys of the areas that stick and slip."""

MAPPED = ("traction", "slip")
"""Vectors of which a map shows the size."""

BORDER: dict[str, Any] = {"colors": "0.35", "linewidths": 0.9}
STICK_BORDER: dict[str, Any] = {"colors": "#e8513a", "linewidths": 1.8}
"""Lines around the contact and around the area that sticks; this one is seen on every colour."""

FORCES = {"longitudinal_creepage": ("force_y", "F_y"), "lateral_creepage": ("force_x", "F_x")}
"""Force that goes with a creepage, and its symbol."""


def plot_stick_and_slip(dataset: xr.Dataset, ax: Axes | None = None, *, si: bool = False, arrows: int = 24) -> Axes:
    """Areas that stick and slip, with arrows of the tractions on the body.

    Parameters
    ----------
    dataset : Dataset
        A single case with stick and slip.
    ax : Axes, optional
        Where to draw; default: a new figure.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and tractions over p0.
    arrows : int
        Arrows along the longer side of the contact.

    Returns
    -------
    Axes
        The arrow above the contact says how long the largest traction is.

    Raises
    ------
    InvalidInputError
        If there are no tractions, or more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> pressed = xr.DataArray(np.ones((2, 2)), dims=("x", "y"), coords=cells)
    >>> one = xr.Dataset({"pressure": pressed, "traction_x": 0 * pressed, "traction_y": 0.1 * pressed,
    ...                   "stick": pressed > 0, "hertz_half_width": 1.0, "hertz_max_pressure": 1.0})
    >>> len(plot_stick_and_slip(one).get_legend().get_texts())
    2
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    needed = ("pressure", "traction_x", "traction_y", "stick")
    require(dataset, *needed)
    one = single_case(dataset)
    require(one, *needed)
    checks.count("arrows", arrows)
    unit, ax = units(one, si=si), new_axes(ax)
    pressure = one["pressure"]
    x, y = (dimension_along(pressure, axis) for axis in "xy")
    pressed = (pressure > 0).transpose(x, y).values
    stick = one["stick"].transpose(x, y).values.astype(bool)
    across, along = pressure[x].values / unit.length, pressure[y].values / unit.length
    area = np.ma.masked_where(~pressed, np.where(stick, 0.0, 1.0))
    ax.pcolormesh(
        across, along, area.T, cmap=ListedColormap([STICK, SLIP]), vmin=0, vmax=1, shading="nearest", rasterized=True
    )
    rows, columns = _spread(pressed, across, along, arrows)
    traction = [one[f"traction_{axis}"].transpose(x, y).values[rows, columns] / unit.stress for axis in "xy"]
    largest = float(np.hypot(*traction).max(initial=0.0))
    ax.set_aspect("equal")
    ends = along[pressed.any(axis=0)][[0, -1]]
    ax.set_ylim(ends[0] - 0.2 * np.ptp(ends), ends[1] + 0.2 * np.ptp(ends))
    if largest > 0:
        step = max(np.ptp(across[pressed.any(axis=1)]), np.ptp(along[pressed.any(axis=0)])) / arrows
        drawn = ax.quiver(
            across[rows],
            along[columns],
            *traction,
            angles="xy",
            scale_units="xy",
            scale=largest / (1.5 * step),
            width=3e-3,
        )
        shown = f"${largest:.3g}\\,p_0$" if not si else f"{largest:.3g} MPa"
        ax.quiverkey(drawn, 0.95, 1.06, largest, shown, labelpos="W", coordinates="axes")
    handles = [Patch(facecolor=STICK, label="sticks"), Patch(facecolor=SLIP, label="slips")]
    ax.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize="small")
    ax.set_xlabel(unit.axis("x"))
    ax.set_ylabel(unit.axis("y"))
    fold_labels(ax)
    return ax


def _spread(pressed: BoolArray, across: FloatArray, along: FloatArray, arrows: int) -> tuple[IntArray, IntArray]:
    """Rows and columns of cells of the contact that lie about evenly, so many along its longer side."""
    spans = [values[pressed.any(axis=axis)] for values, axis in ((across, 1), (along, 0))]
    step = max(float(np.ptp(span)) for span in spans) / arrows or 1.0
    chosen = []
    for values, span in zip((across, along), spans, strict=True):
        count = max(1, round(float(np.ptp(span)) / step))
        places = span[0] + (np.arange(count) + 0.5) * float(np.ptp(span)) / count
        chosen.append(np.unique(np.abs(values[:, None] - places).argmin(axis=0)))
    rows, columns = (each.ravel() for each in np.meshgrid(*chosen, indexing="ij"))
    inside = pressed[rows, columns]
    return rows[inside], columns[inside]


def plot_traction_map(
    dataset: xr.Dataset, ax: Axes | None = None, *, variable: str = "traction", si: bool = False
) -> Axes:
    """Size of the traction or of the slip on the top, with the borders of the contact and of the area that sticks.

    Parameters
    ----------
    dataset : Dataset
        A single case with stick and slip.
    ax : Axes, optional
        Where to draw; default: a new figure.
    variable : {"traction", "slip"}
        What to draw. The slip is that of the roller against the body: per distance rolled, or of a shift.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and tractions over p0.

    Returns
    -------
    Axes
        Its two axes have different scales. Nothing is drawn outside the contact.

    Raises
    ------
    InvalidInputError
        If the variable or stick is missing, or there is more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> pressed = xr.DataArray(np.ones((2, 2)), dims=("x", "y"), coords=cells)
    >>> one = xr.Dataset({"pressure": pressed, "traction_x": 0.3 * pressed, "traction_y": 0.4 * pressed,
    ...                   "stick": pressed > 0, "hertz_half_width": 1.0, "hertz_max_pressure": 1.0})
    >>> float(plot_traction_map(one).collections[0].get_array().max())
    0.5
    """
    checks.known_name("variable", variable, MAPPED)
    needed = ("pressure", "stick", f"{variable}_x", f"{variable}_y")
    require(dataset, *needed)
    one = single_case(dataset)
    require(one, *needed)
    unit, ax = units(one, si=si), new_axes(ax)
    pressure = one["pressure"]
    x, y = (dimension_along(pressure, axis) for axis in "xy")
    places = [pressure[dim].values / unit.length for dim in (x, y)]
    pressed = (pressure > 0).transpose(y, x).values
    size = np.hypot(*(one[f"{variable}_{axis}"].transpose(y, x).values for axis in "xy"))
    factor, label = unit.stress, f"traction{' (MPa)' if si else ' over $p_0$'}"
    if variable == "slip":
        own = str(one["slip_y"].attrs.get("units", "1"))
        factor, name = unit_for(float(size[pressed].max(initial=0.0)), own)
        label = f"slip ({name})" if name else "slip per distance rolled"
    drawn = ax.pcolormesh(
        *places, np.ma.masked_where(~pressed, size) / factor, cmap=COLORS, vmin=0.0, shading="nearest", rasterized=True
    )
    sticks = one["stick"].transpose(y, x).values.astype(bool) & pressed
    for area, style in ((pressed, BORDER), (sticks, STICK_BORDER)):
        _draw_border(ax, _edges(places[0]), _edges(places[1]), area, **style)
    bar = ax.figure.colorbar(drawn, ax=ax, label=label)
    ax.set_xlabel(unit.axis("x"))
    ax.set_ylabel(unit.axis("y"))
    reach = places[1][pressed.any(axis=1)]
    if reach.size > 1:
        ax.set_ylim(reach[0] - 0.1 * np.ptp(reach), reach[-1] + 0.1 * np.ptp(reach))
    fold_labels(ax, bar.ax)
    return ax


def _edges(centres: FloatArray) -> FloatArray:
    """Edges of cells halfway between their centres, as they are drawn."""
    if centres.size == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    inner = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])


def _draw_border(ax: Axes, across: FloatArray, along: FloatArray, area: BoolArray, **style: Any) -> None:
    """Draw the edges of cells between an area (along, across) and what is around it."""
    from matplotlib.collections import LineCollection

    around = np.pad(area, 1)
    lying = np.argwhere(around[1:, 1:-1] != around[:-1, 1:-1])
    upright = np.argwhere(around[1:-1, 1:] != around[1:-1, :-1])
    pieces = [[(across[i], along[j]), (across[i + 1], along[j])] for j, i in lying]
    pieces += [[(across[i], along[j]), (across[i], along[j + 1])] for j, i in upright]
    ax.add_collection(LineCollection(pieces, capstyle="round", **style), autolim=False)


def plot_traction_curve(
    dataset: xr.Dataset,
    hue: str | None = None,
    ax: Axes | None = None,
    *,
    creepage: str = "longitudinal_creepage",
    selection: Mapping[str, Any] | None = None,
) -> Axes:
    """Force over that of full sliding against the creepage.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`, with a creepage that is swept.
    hue : str, optional
        Swept parameter with a line for each of its values.
    ax : Axes, optional
        Where to draw; default: a new figure.
    creepage : {"longitudinal_creepage", "lateral_creepage"}
        Which one.
    selection : mapping, optional
        Values of the other swept parameters.

    Returns
    -------
    Axes
        A thin line at 1 is full sliding.

    Raises
    ------
    InvalidInputError
        If the creepage is not swept, or another swept parameter has no value selected.

    Examples
    --------
    >>> swept = {"longitudinal_creepage": [0.0, 1e-3]}
    >>> forces = xr.DataArray([0.0, 0.06], dims="longitudinal_creepage", coords=swept)
    >>> study = xr.Dataset({"force_y": forces, "normal_load": xr.full_like(forces, 1.0)}, coords={"friction": 0.1})
    >>> plot_traction_curve(study).lines[0].get_ydata().tolist()
    [0.0, 0.6]
    """
    checks.known_name("creepage", creepage, FORCES)
    name, symbol = FORCES[creepage]
    require(dataset, name, "normal_load")
    if creepage not in dataset[name].dims or "friction" not in dataset.coords:
        swept = ", ".join(map(str, dataset[name].dims))
        raise InvalidInputError("dataset", f"with {swept or 'no parameter'} swept", f"an opened study over {creepage}")
    kept = (creepage,) if hue is None else (creepage, hue)
    if hue is not None and hue not in dataset[name].dims:
        raise InvalidInputError("hue", hue, f"a swept parameter: {', '.join(map(str, dataset[name].dims))}")
    force = dataset[name] / (dataset["friction"] * dataset["normal_load"])
    values = one_value(force, kept, selection or {})
    ax = new_axes(ax)
    lines = [values] if hue is None else [values.isel({hue: number}) for number in range(values.sizes[hue])]
    for number, (line, style) in enumerate(zip(lines, line_styles(len(lines)), strict=True)):
        label = None
        if hue is not None:
            own = line[hue].item()
            label = f"{own:g}" if isinstance(own, float) else as_written(own)
        drawn = line.dropna(creepage)
        marker = MARKERS[number % len(MARKERS)]
        ax.plot(
            drawn[creepage],
            drawn.values,
            **style,
            marker=marker,
            markersize=4,
            label=label and folded(label, WIDEST_NAME),
        )
    ax.axhline(1.0, color="0.6", linewidth=0.8)
    if hue is not None:
        title = readable(dataset[hue], hue)[1] if np.issubdtype(dataset[hue].dtype, np.number) else hue
        ax.legend(
            title=folded(title.replace("_", " "), WIDEST_NAME), frameon=False, fontsize="small", title_fontsize="small"
        )
    ax.set_xlabel(rf"{creepage.replace('_', ' ')}, $\{'xi' if name == 'force_y' else 'eta'}$")
    ax.set_ylabel(f"force over full sliding's, ${symbol}/(f W)$")
    ax.grid(color="0.9", linewidth=0.6)
    fold_labels(ax)
    return ax
