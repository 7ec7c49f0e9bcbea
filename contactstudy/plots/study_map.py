"""A quantity of a study over two of its swept parameters: where ends, friction and length matter."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.arrays.named_places import place_of
from contactstudy.arrays.required import require
from contactstudy.errors import InvalidInputError
from contactstudy.plots.labels import fold_labels, folded
from contactstudy.plots.style import COLORS, SYMBOLS, as_written, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCALES = {
    "Pa": ((1e9, 1e9, "GPa"), (0.0, 1e6, "MPa")),
    "m": ((1e-4, 1e-3, "mm"), (0.0, 1e-6, "\N{MICRO SIGN}m")),
    "rad": ((0.0, 1e-3, "mrad"),),
}
"""Units that figures show: from which size on, how much it is in SI, and its name."""

STATES = ("failed", "skipped", "excluded", "missing")
"""What a study says of a case without a result."""

WIDEST_STEP = 18
"""Letters after which a name at an axis goes on in the next line."""

MOST_NUMBERS = 80
"""Cells up to which each is labelled with its value."""


def readable(array: xr.DataArray, name: str) -> tuple[xr.DataArray, str]:
    """Values and label of a parameter or of a quantity; stresses in MPa or GPa, lengths in um or mm."""
    text = SYMBOLS.get(name) or str(array.attrs.get("long_name", name.replace("_", " ")))
    if text.startswith("z of "):
        text = f"depth of {text.removeprefix('z of ')}"
    factor, unit = scale_of(array)
    return (array if factor == 1.0 else array / factor), f"{text} ({unit})" if unit else text


def scale_of(array: xr.DataArray) -> tuple[float, str]:
    """Size in SI and name of the unit in which figures show values; no name for a pure number."""
    unit = str(array.attrs.get("units", "1"))
    if unit in ("", "1"):
        return 1.0, ""
    if unit not in SCALES:
        return 1.0, unit
    largest = float(abs(array).where(np.isfinite(array)).max())
    return next((entry[1:] for entry in SCALES[unit] if largest >= entry[0]), SCALES[unit][-1][1:])


def one_value(array: xr.DataArray, kept: tuple[str, ...], selection: Mapping[str, Any]) -> xr.DataArray:
    """Array over the two kept dimensions; others at the value selected."""
    for name in selection:
        if name not in array.dims or name in kept:
            others = [str(dim) for dim in array.dims if dim not in kept]
            raise InvalidInputError("selection", name, f"of {', '.join(others) or 'nothing'}")
    for dim in [str(dim) for dim in array.dims if dim not in kept]:
        if dim in selection:
            array = array.isel({dim: place_of(array, dim, selection[dim])})
        elif array.sizes[dim] == 1:
            array = array.isel({dim: 0})
        else:
            raise InvalidInputError(
                "selection", dict(selection), f"with a value of {dim}", f"it has {array.sizes[dim]} in this study"
            )
    return array


def plot_study_map(
    dataset: xr.Dataset,
    variable: str | xr.DataArray,
    x: str = "e_over_a",
    y: str = "friction",
    ax: Axes | None = None,
    *,
    selection: Mapping[str, Any] | None = None,
    levels: Any = None,
    label: str | None = None,
) -> Axes:
    """Heat map of a quantity over two swept parameters, with contour lines or numbers.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`.
    variable : str or DataArray
        A scalar of each case, such as `peak_von_mises`; or an array computed from the study, such as an edge factor.
    x, y : str
        Swept parameters across and up; of cases that are listed along one dimension two of the values that they have.
    ax : Axes, optional
        Where to draw; default: a new figure.
    selection : mapping, optional
        Values of the other swept parameters.
    levels : sequence of float, optional
        Contour lines to draw and label; default: every cell is labelled with its value if there are not too many.
    label : str, optional
        For the colour bar; default: the quantity's name and unit.

    Returns
    -------
    Axes
        Steps of the parameters are drawn evenly, whatever their values. Cells without a value are hatched, and the
        legend says how many there are and what became of these cases. A value without a limit, such as a singular
        peak, has the sign of infinity as well.

    Raises
    ------
    InvalidInputError
        If there is no such quantity or parameter, another swept parameter has no value selected, or nothing is left
        to draw.

    Examples
    --------
    >>> values = xr.DataArray([[1.0, 2.0], [3.0, 4.0]], dims=("e_over_a", "friction"),
    ...                       coords={"e_over_a": [0.0, 1.0], "friction": [0.0, 0.1]})
    >>> plot_study_map(xr.Dataset({"end_pressure_over_p0": values}), "end_pressure_over_p0").get_ylabel()
    'friction, $f$'
    """
    if isinstance(variable, xr.DataArray):
        array, name = variable, str(variable.name or "value")
    else:
        require(dataset, variable)
        array, name = dataset[variable], variable
    array = _spread(array, x, y)
    for parameter in (x, y):
        if parameter not in array.dims or parameter not in array.indexes or x == y:
            raise InvalidInputError("x, y", (x, y), f"two swept parameters among {', '.join(map(str, array.dims))}")
    if not np.issubdtype(array.dtype, np.number):
        raise InvalidInputError("variable", name, "a number of each case")
    values = one_value(array, (x, y), selection or {}).transpose(y, x)
    values, meaning = readable(values, name)
    numbers = np.asarray(values.values, dtype=np.float64)
    if not np.isfinite(numbers).any():
        raise InvalidInputError("dataset", name, "with a number for at least one of these cases")
    ax = new_axes(ax, (6.4, 4.4))
    ax.set_facecolor("0.85")
    across, up = np.arange(values.sizes[x]), np.arange(values.sizes[y])
    masked = np.ma.masked_invalid(numbers)
    drawn = ax.pcolormesh(across, up, masked, cmap=COLORS, shading="nearest")
    for row, column in np.argwhere(~np.isfinite(numbers)):
        ax.fill_between(
            [column - 0.5, column + 0.5], row - 0.5, row + 0.5, facecolor="none", edgecolor="0.6", hatch="//"
        )
    if levels is not None:
        from matplotlib.patheffects import AbstractPathEffect, withStroke

        # White on a dark rim is seen on every colour.
        rim: list[AbstractPathEffect] = [withStroke(linewidth=2.5, foreground="0.2")]
        lines = ax.contour(across, up, masked, levels=levels, colors="white", linewidths=1.2)
        lines.set_path_effects(rim)
        for number in ax.clabel(lines, fmt="%g", fontsize="small"):
            number.set_path_effects(rim)
    for row, column in np.argwhere(np.isinf(numbers)):
        ax.text(column, row, "\N{INFINITY}", ha="center", va="center", color="black", fontsize="medium")
    if levels is None and numbers.size <= MOST_NUMBERS:
        middle = 0.5 * (masked.min() + masked.max())
        for row, column in np.argwhere(np.isfinite(numbers)):
            value = numbers[row, column]
            color = "white" if value < middle else "black"
            ax.text(column, row, f"{value:.3g}", ha="center", va="center", color=color, fontsize="small")
    _say_missing(ax, dataset, values, selection or {})
    for parameter, ticks, axis in ((x, across, ax.xaxis), (y, up, ax.yaxis)):
        numeric = np.issubdtype(values[parameter].dtype, np.number)
        steps, text = readable(values[parameter], parameter) if numeric else (values[parameter], parameter)
        axis.set_ticks(
            ticks, [f"{step:g}" if numeric else folded(as_written(step), WIDEST_STEP) for step in steps.values]
        )
        axis.set_label_text(text)
    bar = ax.figure.colorbar(drawn, ax=ax, label=label or meaning)
    fold_labels(ax, bar.ax)
    return ax


def _spread(array: xr.DataArray, x: str, y: str) -> xr.DataArray:
    """Cases listed along one dimension, spread over two parameters; nothing stands where there is no case."""
    listed = [
        str(dim) for dim in array.dims if all(name in array.coords and array[name].dims == (dim,) for name in (x, y))
    ]
    if x == y or not listed or listed[0] in (x, y):
        return array
    (dim,) = listed
    pairs = list(zip(array[x].values.tolist(), array[y].values.tolist(), strict=True))
    twice = next((pair for pair in pairs if pairs.count(pair) > 1), None)
    if twice is not None:
        raise InvalidInputError(
            "x, y", (x, y), "parameters that tell the cases apart", f"several have {x} = {twice[0]}, {y} = {twice[1]}"
        )
    others = [name for name in array.coords if name not in (x, y)]
    attributes = {name: array[name].attrs for name in (x, y)}
    spread = array.drop_vars(others).set_index({dim: (x, y)}).unstack(dim)
    for name, entries in attributes.items():
        spread[name].attrs = entries
    return spread


def _say_missing(ax: Axes, dataset: xr.Dataset, values: xr.DataArray, selection: Mapping[str, Any]) -> None:
    """Say below a map how many cells are hatched, and what became of their cases."""
    missing = values.isnull()
    count = int(missing.sum())
    if not count:
        return
    from matplotlib.patches import Patch

    text = f"no value: {count} of {missing.size} cases"
    y, x = map(str, values.dims)
    if "status" in dataset:
        status = _spread(dataset["status"], x, y)
        if {x, y} <= set(status.dims):
            chosen = {name: value for name, value in selection.items() if name in status.dims}
            states = one_value(status, (x, y), chosen).transpose(y, x).values[missing.values]
            known = Counter(str(state) for state in states if str(state) in STATES)
            text += f" ({', '.join(f'{number} {state}' for state, number in known.items())})" if known else ""
    patch = Patch(facecolor="0.85", edgecolor="0.6", hatch="//", label=text)
    ax.legend(handles=[patch], loc="upper left", bbox_to_anchor=(0.0, -0.18), frameon=False, fontsize="small")
