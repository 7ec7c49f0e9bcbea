"""Map of a quantity of a study over two of its swept parameters; selection of the values that a figure shows."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import xarray as xr

from contactstudy.arrays.engineering import format_quantity, unit_for
from contactstudy.arrays.variables import index_of, require
from contactstudy.errors import InvalidInputError
from contactstudy.plots.style import COLORS, SYMBOLS, escape_dollars, fold_labels, fold_text, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = TypeVar("Array", xr.DataArray, xr.Dataset)


def select(array: Array, axes: tuple[str, ...], selection: Mapping[str, Any]) -> Array:
    """Array, or Dataset, over the dimensions `axes`, with the selected value of every other dimension."""
    swept = [str(dim) for dim in array.dims if dim not in axes]
    for name in selection:
        if name not in swept:
            raise InvalidInputError("selection", name, f"of {', '.join(swept) or 'nothing'}")
    for dim in swept:
        if dim in selection:
            array = array.isel({dim: index_of(array, dim, selection[dim])})
        elif array.sizes[dim] == 1:
            array = array.isel({dim: 0})
        else:
            raise InvalidInputError(
                "selection", dict(selection), f"with a value of {dim}", f"the study has {array.sizes[dim]} of them"
            )
    return array


def choose_values(array: xr.DataArray, axes: tuple[str, ...], selection: Mapping[str, Any]) -> dict[str, Any]:
    """Values of the parameters other than `axes`: selected, or the first combination with the most solved cases."""
    dims = [str(dim) for dim in array.dims if str(dim) not in axes]
    choices = [[selection[dim]] if dim in selection else list(array[dim].values) for dim in dims]
    combinations = [dict(zip(dims, values, strict=True)) for values in itertools.product(*choices)]
    return max(combinations, key=lambda values: int(np.isfinite(select(array, axes, values)).sum()))


def choose_unit(array: xr.DataArray) -> tuple[float, str]:
    """Size in SI, and name, of the unit that suits a figure's axis; an empty name for a pure number."""
    max_magnitude = float(abs(array).where(np.isfinite(array)).max())
    return unit_for(max_magnitude, str(array.attrs.get("units", "1")))


def scale_values(array: xr.DataArray, name: str) -> tuple[xr.DataArray, str]:
    """Values and label of a parameter or quantity: stresses in MPa or GPa, lengths in µm or mm."""
    text = SYMBOLS.get(name) or str(array.attrs.get("long_name", name.replace("_", " ")))
    factor, unit = choose_unit(array)
    return (array if factor == 1.0 else array / factor), f"{text} ({unit})" if unit else text


def describe_value(name: str, value: Any, units: str, count: int = 1) -> str:
    """Text of one value of a parameter, with the number of values in the study if several."""
    is_number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    text = format_quantity(float(value), units or "1") if is_number else escape_dollars(value)
    symbol = "$p_0$" if name == "max_pressure" else name.replace("_over_a", "/a").replace("_", " ")
    return f"{symbol} = {text}" + (f", one of {count} values" if count > 1 else "")


STATES = ("failed", "skipped", "excluded", "missing")  # States of cases without a result
TICK_WIDTH = 18  # Maximum number of letters of a name at an axis
MAX_CELL_LABELS = 80  # Maximum number of cells with their values as text


def plot_study_map(
    dataset: xr.Dataset,
    variable: str | xr.DataArray,
    *,
    ax: Axes | None = None,
    x: str = "e_over_a",
    y: str = "friction",
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
    ax
        As for :func:`plot_axial_pressure`.
    x, y : str
        Swept parameters across and up; for cases along one dimension, two of its coordinates.
    selection : mapping, optional
        Values of the other swept parameters.
    levels : sequence of float, optional
        Labelled contour lines; default: the value as text in every cell, up to 80 cells.
    label : str, optional
        Label of the colour bar; default: name and unit of the quantity.

    Returns
    -------
    Axes
        Values of the parameters are spaced evenly. Cells without a value are hatched; the legend contains their number
        and states. Unbounded values, such as a singular peak, have the sign of infinity.

    Raises
    ------
    InvalidInputError
        If the quantity or a parameter is missing, `selection` lacks another swept parameter, or every value is NaN.

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
    array = _unstack_cases(array, x, y)
    for parameter in (x, y):
        if parameter not in array.dims or parameter not in array.indexes or x == y:
            raise InvalidInputError("x, y", (x, y), f"two swept parameters among {', '.join(map(str, array.dims))}")
    if not np.issubdtype(array.dtype, np.number):
        raise InvalidInputError("variable", name, "a number of each case")
    values = select(array, (x, y), selection or {}).transpose(y, x)
    values, meaning = scale_values(values, name)
    array_values = np.asarray(values.values, dtype=np.float64)
    if not np.isfinite(array_values).any():
        raise InvalidInputError("dataset", name, "with a number for at least one of these cases")
    ax = new_axes(ax, (6.4, 4.4))
    ax.set_facecolor("0.85")
    x_ticks, y_ticks = np.arange(values.sizes[x]), np.arange(values.sizes[y])
    finite_values = np.ma.masked_invalid(array_values)
    mesh = ax.pcolormesh(x_ticks, y_ticks, finite_values, cmap=COLORS, shading="nearest")
    for row, column in np.argwhere(~np.isfinite(array_values)):
        ax.fill_between(
            [column - 0.5, column + 0.5], row - 0.5, row + 0.5, facecolor="none", edgecolor="0.6", hatch="//"
        )
    if levels is not None:
        from matplotlib.patheffects import AbstractPathEffect, withStroke

        # White text with a dark rim is legible on every colour.
        outline: list[AbstractPathEffect] = [withStroke(linewidth=2.5, foreground="0.2")]
        level_lines = ax.contour(x_ticks, y_ticks, finite_values, levels=levels, colors="white", linewidths=1.2)
        level_lines.set_path_effects(outline)
        for level_text in ax.clabel(level_lines, fmt="%g", fontsize="small"):
            level_text.set_path_effects(outline)
    for row, column in np.argwhere(np.isinf(array_values)):
        ax.text(column, row, "\N{INFINITY}", ha="center", va="center", color="black", fontsize="medium")
    if levels is None and array_values.size <= MAX_CELL_LABELS:
        mid_value = 0.5 * (finite_values.min() + finite_values.max())
        for row, column in np.argwhere(np.isfinite(array_values)):
            value = array_values[row, column]
            color = "white" if value < mid_value else "black"
            ax.text(column, row, f"{value:.3g}", ha="center", va="center", color=color, fontsize="small")
    _draw_missing_legend(ax, dataset, values, selection or {})
    for parameter, ticks, axis in ((x, x_ticks, ax.xaxis), (y, y_ticks, ax.yaxis)):
        is_numeric = np.issubdtype(values[parameter].dtype, np.number)
        coordinate, title = scale_values(values[parameter], parameter) if is_numeric else (values[parameter], parameter)
        entries = coordinate.values
        texts = [f"{value:g}" if is_numeric else fold_text(escape_dollars(value), TICK_WIDTH) for value in entries]
        axis.set_ticks(ticks, texts)
        axis.set_label_text(title)
    bar = ax.figure.colorbar(mesh, ax=ax, label=label or meaning)
    fold_labels(ax, bar.ax)
    return ax


def _unstack_cases(array: xr.DataArray, x: str, y: str) -> xr.DataArray:
    """Array over two parameters, from cases along one dimension; NaN for a pair of values without a case."""
    case_dims = [
        str(dim) for dim in array.dims if all(name in array.coords and array[name].dims == (dim,) for name in (x, y))
    ]
    if x == y or not case_dims or case_dims[0] in (x, y):
        return array
    (dim,) = case_dims
    stacked = array.drop_vars([name for name in array.coords if name not in (x, y)]).set_index({dim: (x, y)})
    index = stacked.indexes[dim]
    if index.has_duplicates:
        x_value, y_value = index[index.duplicated()][0]
        hint = f"several have {x} = {x_value}, {y} = {y_value}"
        raise InvalidInputError("x, y", (x, y), "parameters that distinguish the cases", hint)
    unstacked = stacked.unstack(dim)
    for name in (x, y):
        unstacked[name].attrs = array[name].attrs
    return unstacked


def _draw_missing_legend(ax: Axes, dataset: xr.Dataset, values: xr.DataArray, selection: Mapping[str, Any]) -> None:
    """Legend below a map: number and states of hatched cells."""
    is_missing = values.isnull()
    count = int(is_missing.sum())
    if not count:
        return
    from matplotlib.patches import Patch

    text = f"no value: {count} of {is_missing.size} cases"
    y, x = map(str, values.dims)
    if "status" in dataset:
        status = _unstack_cases(dataset["status"], x, y)
        if {x, y} <= set(status.dims):
            other_values = {name: value for name, value in selection.items() if name in status.dims}
            states = select(status, (x, y), other_values).transpose(y, x).values[is_missing.values]
            counts = Counter(str(state) for state in states if str(state) in STATES)
            text += f" ({', '.join(f'{number} {state}' for state, number in counts.items())})" if counts else ""
    patch = Patch(facecolor="0.85", edgecolor="0.6", hatch="//", label=text)
    ax.legend(handles=[patch], loc="upper left", bbox_to_anchor=(0.0, -0.18), frameon=False, fontsize="small")
