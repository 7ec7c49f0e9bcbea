"""Quantities of a study against one of its swept parameters, a line for each value of another."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis import single_case
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import DERIVED
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.plots.chosen import in_lines, narrowed, said
from contactstudy.plots.edge_effect import AXES, Load, edge_effect_figure
from contactstudy.plots.labels import fold_labels, folded
from contactstudy.plots.singular import MARK, MEANING, mark_at_top
from contactstudy.plots.study_map import one_value, readable, scale_of
from contactstudy.plots.style import as_written, line_styles

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

QUANTITIES = ("peak_pressure", "peak_von_mises", "peak_von_mises_z")
"""What is drawn if nothing else is asked for."""

AT_SINGULAR = ("end_load_first", "end_load_last")
"""What is drawn in the place of a peak that no case has: the loads on the last half-width."""

MARKERS = "osD^vPX*"
"""Of the lines, in turn."""

OPEN: dict[str, Any] = {"markersize": 6, "markerfacecolor": "white", "linestyle": "none"}
"""Marker of a value of which no error is known."""

NO_ERROR = "no error known"

FOUND = ("peak_", "end_pressure_", "end_load_", "end_intensity", "contact_")
"""How names of results begin that have an error; of other scalars, such as a load that was given, none is missed."""

LINE = 0.17
"""Height of a line of text, inches."""

WIDEST_NAME, WIDEST_LEGEND = 18, 22
"""Letters after which a name at the axis, and the legend's title and names, go on in the next line."""


def plot_study_lines(
    dataset: xr.Dataset,
    x: str,
    hue: str | None = None,
    *,
    variables: Sequence[str] = QUANTITIES,
    selection: Mapping[str, Any] | None = None,
) -> Figure:
    """Draw one panel for each quantity, against a swept parameter.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`.
    x : str
        Swept parameter along the horizontal axis: numbers in steps of their own, names evenly.
    hue : str, optional
        Swept parameter with a line for each of its values.
    variables : sequence of str
        Scalars of each case; those that the study lacks are left out.
    selection : mapping, optional
        Values of the other swept parameters; those with most solved cases, or the first of these, if left out.

    Returns
    -------
    Figure
        Its title says at which values of the other parameters. Bars are stated errors. An open triangle at the top
        stands for a value without a limit, such as the peak pressure at a sharp end inside the face. An open marker is
        a value of which no error is known, such as the depth of the largest stress.

    Raises
    ------
    InvalidInputError
        If a parameter is not swept, or the study has none of the quantities.

    Examples
    --------
    >>> values = xr.DataArray([[1.0, 2.0], [3.0, 4.0]], dims=("friction", "e_over_a"),
    ...                       coords={"friction": [0.0, 0.1], "e_over_a": [0.0, 1.0]})
    >>> figure = plot_study_lines(xr.Dataset({"peak_pressure": values}), "friction", "e_over_a")
    >>> len(figure.axes[0].lines)
    2
    """
    from matplotlib import pyplot as plt
    from matplotlib.lines import Line2D

    drawn = [name for name in variables if name in dataset]
    if not drawn:
        require(dataset, *variables)
    kept = (x,) if hue is None else (x, hue)
    for parameter in kept:
        if parameter not in dataset[drawn[0]].dims:
            swept = ", ".join(map(str, dataset[drawn[0]].dims))
            raise InvalidInputError("x, hue", kept, f"swept parameters: {swept}")
    figure, axes = plt.subplots(
        1,
        len(drawn),
        figsize=(4.0 * len(drawn) + (0.6 if hue is None else 2.0), 3.6),
        squeeze=False,
        layout="constrained",
        sharex=True,
    )
    chosen = _first_solved(dataset[drawn[0]], kept, selection or {})
    singular = at_edge = False
    for ax, name in zip(axes[0], drawn, strict=True):
        values, meaning = readable(one_value(dataset[name], kept, chosen), name)
        unsure = _without_error(dataset, name, kept, chosen)
        errors = _errors(dataset, name, kept, chosen)
        numeric = np.issubdtype(values[x].dtype, np.number)
        across, label = readable(values[x], x) if numeric else (values[x], x.replace("_", " "))
        places = across.values if numeric else np.arange(across.size)
        lines = [values] if hue is None else [values.isel({hue: number}) for number in range(values.sizes[hue])]
        labels = [None] if hue is None else _texts(values[hue], hue)
        for number, (line, text, style) in enumerate(zip(lines, labels, line_styles(len(lines)), strict=True)):
            marker = MARKERS[number % len(MARKERS)]
            endless = np.isinf(line.values)
            shown = np.where(endless, np.nan, line.values)
            (curve,) = ax.plot(
                places, shown, **style, marker=marker, markersize=4, label=text and folded(text, WIDEST_LEGEND)
            )
            if np.isnan(line.values).all():  # nothing of it is solved: the legend does without it
                curve.set_label("_unsolved")
            if errors is not None:
                bars = (errors if hue is None else errors.isel({hue: number})).values
                ax.errorbar(places, shown, bars, fmt="none", ecolor=style["color"], elinewidth=1.0, capsize=3.0)
            if unsure is not None:
                own = unsure if hue is None else unsure.isel({hue: number})
                open_marks = np.where(own.values, shown, np.nan)
                known = np.isfinite(shown) & ~own.values
                if np.isfinite(open_marks).any():
                    at_edge = True
                    if known.any():
                        ax.plot(places, open_marks, color=style["color"], marker=marker, **OPEN)
                    else:
                        curve.set(markersize=OPEN["markersize"], markerfacecolor=OPEN["markerfacecolor"])
            mark_at_top(ax, list(places[endless]), style["color"])
            singular |= bool(endless.any())
        if not numeric:
            names = [folded(as_written(value), WIDEST_NAME) for value in across.values]
            ax.set_xticks(places, names, rotation=20)
        ax.set_xlabel(label)
        ax.set_ylabel(meaning)
        fold_labels(ax)
        tops = values if errors is None else values + errors.fillna(0.0)
        ax.set_ylim(0.0, 1.08 * max(np.nan_to_num(float(tops.where(np.isfinite(tops)).max())), 1e-300))
        ax.grid(color="0.9", linewidth=0.6)
    figure.set_figheight(figure.get_figheight() + LINE * max(map(_more_lines, axes[0])))
    if hue is not None:
        numeric = np.issubdtype(dataset[hue].dtype, np.number) and not _parameters_of(dataset[hue], hue)
        title = readable(dataset[hue], hue)[1] if numeric else hue.replace("_", " ")
        handles, labels = axes[0, 0].get_legend_handles_labels()
        small = {"fontsize": "small", "title_fontsize": "small"}
        figure.legend(
            handles, labels, loc="outside right center", title=folded(title, WIDEST_LEGEND), frameon=False, **small
        )
    keys = {MEANING: MARK} if singular else {}
    if at_edge:
        keys[NO_ERROR] = {"marker": "o", **OPEN}
    if keys:
        marks = [Line2D([], [], color="0.3", **style) for style in keys.values()]
        figure.legend(marks, list(keys), loc="outside lower right", frameon=False, fontsize="small", ncols=2)
    if chosen:
        parts = [
            said(dim, value, str(dataset[dim].attrs.get("units", "1")), dataset.sizes[dim])
            for dim, value in chosen.items()
        ]
        figure.suptitle(in_lines(parts, 40 * len(drawn)), fontsize="medium")
    return figure


def _more_lines(ax: Axes) -> int:
    """Lines below an axis beyond one of numbers and one of the label."""
    names = max((tick.get_text().count("\n") for tick in ax.get_xticklabels()), default=0)
    return names + ax.get_xlabel().count("\n")


def _errors(dataset: xr.Dataset, name: str, kept: tuple[str, ...], chosen: Mapping[str, Any]) -> xr.DataArray | None:
    """Stated errors of a quantity in the unit that it is drawn in, NaN where there is none; None without estimates."""
    if f"{name}_error" not in dataset:
        return None
    stated = one_value(dataset[f"{name}_error"], kept, chosen)
    factor, _ = scale_of(one_value(dataset[name], kept, chosen))
    return stated.where(np.isfinite(stated)) / factor


def _without_error(
    dataset: xr.Dataset, name: str, kept: tuple[str, ...], chosen: Mapping[str, Any]
) -> xr.DataArray | None:
    """Where no error of a result is known: it has no estimate, as the place of a largest value, or an infinite one."""
    if f"{name}_error" not in dataset:
        if not name.startswith(FOUND):
            return None
        values = one_value(dataset[name], kept, chosen)
        return values.where(np.isfinite(values)).notnull()
    endless = one_value(dataset[f"{name}_error"], kept, chosen) == np.inf
    return endless & (one_value(dataset[name], kept, chosen) < np.inf)


def _texts(values: xr.DataArray, name: str) -> list[str]:
    """Values of a parameter as a figure states them, in the unit of its label; of a table those of its parameters."""
    if together := _parameters_of(values, name):
        return [", ".join(as_written(values[own].values[i]) for own in together) for i in range(values.size)]
    if not np.issubdtype(values.dtype, np.number):
        return [as_written(value) for value in values.values]
    return [f"{value:g}" for value in readable(values, name)[0].values]


def _parameters_of(values: xr.DataArray, name: str) -> list[str]:
    """Parameters that change together along a dimension of a study; none if it is a parameter itself."""
    return [
        str(own)
        for own in values.coords
        if own != name and values[own].dims == values.dims and values[own].attrs.get("comment") != DERIVED
    ]


def _first_solved(array: xr.DataArray, kept: tuple[str, ...], selection: Mapping[str, Any]) -> dict[str, Any]:
    """Value of every other parameter: the one selected, or the first ones for which most cases were solved."""
    others = [str(dim) for dim in array.dims if str(dim) not in kept]
    choices = [[selection[dim]] if dim in selection else list(array[dim].values) for dim in others]
    combinations = [dict(zip(others, values, strict=True)) for values in itertools.product(*choices)]
    return max(combinations, key=lambda each: int(np.isfinite(one_value(array, kept, each)).sum()))


def study_figures(dataset: xr.Dataset, *, selection: Mapping[str, Any] | None = None) -> dict[str, Figure]:
    """Draw the figures that suit a study, by name.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`.
    selection : mapping, optional
        Values of swept parameters, to which the figures keep. Of others that have no axis, line or panel the figures
        show the value with most solved cases, or the first of these, and their titles say which.

    Returns
    -------
    dict
        "edge_effect" for a study over e/a that kept its surfaces, see `plot_edge_effect`; "study" if any parameter
        takes several values: `plot_study_lines` over the longest swept parameter, with a line for each value of the
        next longest. Where every peak is singular it has the loads on the last half-width instead.

    Raises
    ------
    InvalidInputError
        If a parameter of the selection is not swept, or does not take the value.

    Examples
    --------
    >>> values = xr.DataArray([1.0, 2.0], dims="friction", coords={"friction": [0.0, 0.1]})
    >>> list(study_figures(xr.Dataset({"peak_pressure": values, "status": values})))
    ['study']
    """
    part = narrowed(dataset, selection or {})
    load = single_case if "pressure" in dataset else None
    return {name: figure for name, (figure, _) in suiting_figures(part, load).items()}


def suiting_figures(dataset: xr.Dataset, load: Load | None) -> dict[str, tuple[Figure, list[str]]]:
    """Figures of :func:`study_figures`, each with the parameters of which it shows one value among several.

    Parameters
    ----------
    dataset : Dataset
        Scalars of the cases are enough.
    load : callable or None
        Takes the part of the Dataset that is one case, returns the case with its surfaces; None: none are kept.
    """
    swept = sorted(
        (str(dim) for dim in dataset["status"].dims if dataset.sizes[dim] > 1), key=lambda dim: -dataset.sizes[dim]
    )
    figures = {}
    if "e_over_a" in dataset.dims and load is not None and "hertz_half_width" in dataset:
        chosen = _first_solved(dataset["hertz_half_width"], AXES, {})
        with contextlib.suppress(ContactStudyError):  # nothing of it is solved yet, or is there any more
            figures["edge_effect"] = (
                edge_effect_figure(dataset, load, chosen),
                [name for name in swept if name not in AXES],
            )
    names = [name for name in swept if name != "case"]
    if names and (drawn := _with_values(dataset)):
        figures["study"] = (plot_study_lines(dataset, *names[:2], variables=drawn), names[2:])
    return figures


def _with_values(dataset: xr.Dataset) -> list[str]:
    """Quantities to draw: those that are finite somewhere, and loads at the ends where no peak is."""
    present = [name for name in QUANTITIES if name in dataset]
    finite = [name for name in (*present, *AT_SINGULAR) if name in dataset and np.isfinite(dataset[name]).any()]
    if "peak_pressure" in present and "peak_pressure" not in finite and set(finite) & set(AT_SINGULAR):
        return sorted(finite, key=lambda name: name not in AT_SINGULAR)
    return [name for name in finite if name in QUANTITIES] or present
