"""Quantities of a study against one of its swept parameters, a line for each value of another."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import require
from contactstudy.errors import InvalidInputError
from contactstudy.plots.edge_effect import plot_edge_effect
from contactstudy.plots.study_map import one_value, readable
from contactstudy.plots.style import line_styles

if TYPE_CHECKING:
    from matplotlib.figure import Figure

QUANTITIES = ("peak_pressure", "peak_von_mises", "peak_von_mises_z")
"""What is drawn if nothing else is asked for."""

MARKERS = "osD^vPX*"
WIDEST_LABEL = 34


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
        Values of the other swept parameters; the first of each if left out.

    Returns
    -------
    Figure

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

    drawn = [name for name in variables if name in dataset]
    if not drawn:
        require(dataset, *variables)
    kept = (x,) if hue is None else (x, hue)
    for parameter in kept:
        if parameter not in dataset[drawn[0]].dims:
            swept = ", ".join(map(str, dataset[drawn[0]].dims))
            raise InvalidInputError("x, hue", kept, f"swept parameters: {swept}")
    figure, axes = plt.subplots(
        1, len(drawn), figsize=(4.0 * len(drawn) + 0.6, 3.6), squeeze=False, layout="constrained", sharex=True
    )
    for ax, name in zip(axes[0], drawn, strict=True):
        array = dataset[name]
        first = {str(dim): array[dim].values[0] for dim in array.dims if str(dim) not in kept}
        chosen = {dim: (selection or {}).get(dim, value) for dim, value in first.items()}
        values, meaning = readable(one_value(array, kept, chosen), name)
        numeric = np.issubdtype(values[x].dtype, np.number)
        across, label = readable(values[x], x) if numeric else (values[x], x.replace("_", " "))
        places = across.values if numeric else np.arange(across.size)
        levels = [None] if hue is None else list(values[hue].values)
        for number, (level, style) in enumerate(zip(levels, line_styles(len(levels)), strict=True)):
            line = values if level is None else values.sel({hue: level})
            text = f"{level:g}" if isinstance(level, int | float | np.number) else str(level)
            ax.plot(
                places,
                line.values,
                **style,
                marker=MARKERS[number % len(MARKERS)],
                markersize=4,
                label=None if level is None else text,
            )
        if not numeric:
            ax.set_xticks(places, [str(value) for value in across.values], rotation=20)
        ax.set_xlabel(label)
        ax.set_ylabel("\n".join(textwrap.wrap(meaning, WIDEST_LABEL)))
        ax.set_ylim(0.0, 1.08 * max(float(values.max()), 1e-300))
        ax.grid(color="0.9", linewidth=0.6)
    if hue is not None:
        title = readable(dataset[hue], hue)[1] if np.issubdtype(dataset[hue].dtype, np.number) else hue
        axes[0, 0].legend(title=title, frameon=False, fontsize="small", title_fontsize="small")
    return figure


def study_figures(dataset: xr.Dataset) -> dict[str, Figure]:
    """Draw the figures that suit a study, by name.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`.

    Returns
    -------
    dict
        "edge_effect" for a study over e/a that kept its surfaces, see `plot_edge_effect`; "study" if any parameter
        takes several values: `plot_study_lines` over the longest swept parameter, with a line for each value of the
        next longest.

    Examples
    --------
    >>> values = xr.DataArray([1.0, 2.0], dims="friction", coords={"friction": [0.0, 0.1]})
    >>> list(study_figures(xr.Dataset({"peak_pressure": values, "status": values})))
    ['study']
    """
    figures = {}
    if "e_over_a" in dataset.dims and "pressure" in dataset:
        figures["edge_effect"] = plot_edge_effect(dataset)
    swept = sorted(
        (dim for dim in dataset["status"].dims if dataset.sizes[dim] > 1), key=lambda dim: -dataset.sizes[dim]
    )
    names = [str(dim) for dim in swept if dim != "case"]
    if names and any(name in dataset for name in QUANTITIES):
        figures["study"] = plot_study_lines(dataset, *names[:2])
    return figures
