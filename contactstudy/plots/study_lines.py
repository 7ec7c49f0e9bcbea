"""Figures of a study over its swept parameters: quantities of the cases, traction, and the end effect over e/a."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import axial_pressure, dimension_along, measure, single_case
from contactstudy.arrays.variables import DERIVED, UNKNOWN_ERROR, index_of, require
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.plots.axial import plot_axial_pressure
from contactstudy.plots.stress import interpolate_plane, plot_stress_plane
from contactstudy.plots.study_map import TICK_WIDTH, choose_unit, choose_values, describe_value, scale_values, select
from contactstudy.plots.style import (
    LEGEND_STYLE,
    MARKERS,
    SINGULAR_LABEL,
    SINGULAR_MARK,
    cap_field,
    escape_dollars,
    fold_labels,
    fold_text,
    line_styles,
    mark_at_top,
    new_axes,
    units,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DistanceCase = tuple[float, xr.Dataset]  # e/a and the case
LoadCase = Callable[[xr.Dataset], xr.Dataset]  # Function that returns the case of a selection of a study

EDGE_AXES = ("e_over_a", "body")  # Parameters with several values in the figure
TITLE_WIDTH = 60  # Maximum number of letters in a line of the title
LEVEL_TOLERANCE = 0.1  # Largest relative deviation from the pressure at mid-length of a level curve

QUANTITIES = ("peak_pressure", "peak_von_mises", "peak_von_mises_z")  # Default quantities
END_LOADS = ("end_load_first", "end_load_last")  # Replace the peak pressure if it is singular in every case
OPEN_MARK: dict[str, Any] = {"markersize": 6, "markerfacecolor": "white", "linestyle": "none"}

ESTIMATED_PREFIXES = ("peak_", "end_pressure_", "end_load_", "end_intensity", "contact_")  # with errors
LINE_HEIGHT = 0.17  # Height of a line of text, inches
LEGEND_COLUMN = 22  # Maximum number of letters of a name in a legend beside the axes
FORCES = {"longitudinal_creepage": ("force_y", "F_y"), "lateral_creepage": ("force_x", "F_x")}
"""Force conjugate to a creepage, and its symbol."""


def plot_study_lines(
    dataset: xr.Dataset,
    variables: Sequence[str] = QUANTITIES,
    *,
    x: str,
    hue: str | None = None,
    selection: Mapping[str, Any] | None = None,
) -> Figure:
    """Draw one panel for each quantity, against a swept parameter.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`.
    variables : sequence of str
        Scalars of each case; missing scalars are omitted.
    x : str
        Swept parameter along the horizontal axis; names are spaced evenly.
    hue : str, optional
        Swept parameter with a line for each of its values.
    selection : mapping, optional
        Values of the other swept parameters; default: the first values with most solved cases.

    Returns
    -------
    Figure
        The title lists the values of the other parameters. Bars are stated errors, an open triangle at the top is an
        unbounded value, an open marker is a value whose error is not estimated.

    Raises
    ------
    InvalidInputError
        If a parameter is not swept, or the study lacks every quantity.

    Examples
    --------
    >>> values = xr.DataArray([[1.0, 2.0], [3.0, 4.0]], dims=("friction", "e_over_a"),
    ...                       coords={"friction": [0.0, 0.1], "e_over_a": [0.0, 1.0]})
    >>> figure = plot_study_lines(xr.Dataset({"peak_pressure": values}), x="friction", hue="e_over_a")
    >>> len(figure.axes[0].lines)
    2
    """
    from matplotlib import pyplot

    names = [name for name in variables if name in dataset]
    if not names:
        require(dataset, *variables)
    axes_of_study = (x,) if hue is None else (x, hue)
    for parameter in axes_of_study:
        if parameter not in dataset[names[0]].dims:
            swept_text = ", ".join(map(str, dataset[names[0]].dims))
            raise InvalidInputError("x, hue", axes_of_study, f"swept parameters: {swept_text}")
    columns = 2 - len(names) % 2  # without an empty panel
    rows = len(names) // columns
    size = (4.0 * columns + (0.6 if hue is None else 2.0), 3.2 * rows + 0.4)
    figure, panels = pyplot.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained", sharex=True)
    fixed_parameters = choose_values(dataset[names[0]], axes_of_study, selection or {})
    stored_names = [stored_name for name in names for stored_name in (name, f"{name}_error") if stored_name in dataset]
    lines = select(dataset[stored_names], axes_of_study, fixed_parameters)
    marks: dict[str, dict[str, Any]] = {}
    for ax, name in zip(panels.flat, names, strict=True):
        marks |= _draw_panel(ax, lines, name, x, hue)
    figure.set_figheight(figure.get_figheight() + LINE_HEIGHT * rows * max(map(_count_extra_lines, panels.flat)))
    if hue is not None:
        handles, labels = panels[0, 0].get_legend_handles_labels()
        title = fold_text(_legend_texts(dataset[hue], hue)[0], LEGEND_COLUMN)
        figure.legend(handles, labels, loc="outside right center", title=title, **LEGEND_STYLE, title_fontsize="small")
    if marks:
        from matplotlib.lines import Line2D

        handles = [Line2D([], [], color="0.3", **style) for style in marks.values()]
        figure.legend(handles, list(marks), loc="outside lower right", ncols=2, **LEGEND_STYLE)
    if fixed_parameters:
        values_text = [
            describe_value(dim, value, str(dataset[dim].attrs.get("units", "1")), dataset.sizes[dim])
            for dim, value in fixed_parameters.items()
        ]
        figure.suptitle(fold_text("; ".join(values_text), 40 * columns), fontsize="medium")
    return figure


def _draw_panel(ax: Axes, dataset: xr.Dataset, name: str, x: str, hue: str | None) -> dict[str, dict[str, Any]]:
    """Draw one quantity; return the styles of the marks that a legend must explain, by label."""
    marks: dict[str, dict[str, Any]] = {}
    values, label = scale_values(dataset[name], name)
    errors, lacks_estimate = _select_errors(dataset, name)
    is_numeric = np.issubdtype(values[x].dtype, np.number)
    x_values, x_label = scale_values(values[x], x) if is_numeric else (values[x], x.replace("_", " "))
    positions = x_values.values if is_numeric else np.arange(x_values.size)
    for selection, style in _style_lines(values, hue, LEGEND_COLUMN):
        line, bars, is_open = (array.isel(selection).values for array in (values, errors, lacks_estimate))
        finite_line = np.where(np.isinf(line), np.nan, line)
        (curve,) = ax.plot(positions, finite_line, **style)
        if np.isnan(line).all():
            curve.set_label("_unsolved")  # omitted in the legend
        if np.isfinite(bars).any():
            ax.errorbar(positions, finite_line, bars, fmt="none", ecolor=style["color"], elinewidth=1.0, capsize=3.0)
        if np.isfinite(finite_line[is_open]).any():
            marks[UNKNOWN_ERROR] = {"marker": "o", **OPEN_MARK}
            if (np.isfinite(finite_line) & ~is_open).any():
                open_values = np.where(is_open, finite_line, np.nan)
                ax.plot(positions, open_values, color=style["color"], marker=style["marker"], **OPEN_MARK)
            else:
                curve.set(**OPEN_MARK | {"linestyle": style["linestyle"]})
        if np.isinf(line).any():
            marks[SINGULAR_LABEL] = SINGULAR_MARK
        mark_at_top(ax, list(positions[np.isinf(line)]), style["color"])
    if not is_numeric:
        ticks = [fold_text(escape_dollars(value), TICK_WIDTH) for value in x_values.values]
        ax.set_xticks(positions, ticks, rotation=20)
    ax.set_xlabel(x_label)
    ax.set_ylabel(label)
    fold_labels(ax)
    bar_tops = values + errors.fillna(0.0)
    ax.set_ylim(0.0, 1.08 * max(np.nan_to_num(float(bar_tops.where(np.isfinite(bar_tops)).max())), 1e-300))
    ax.grid(color="0.9", linewidth=0.6)
    return marks


def _style_lines(values: xr.DataArray, hue: str | None, width: int) -> Iterator[tuple[dict[str, int], dict[str, Any]]]:
    """Yield the index along `hue`, and the style with the folded label, of each line; one line without `hue`."""
    labels = [None] if hue is None else [fold_text(text, width) for text in _legend_texts(values[hue], hue)[1]]
    for index, (label, style) in enumerate(zip(labels, line_styles(len(labels)), strict=True)):
        marker = MARKERS[index % len(MARKERS)]
        yield {} if hue is None else {hue: index}, style | {"marker": marker, "markersize": 4, "label": label}


def _count_extra_lines(ax: Axes) -> int:
    """Return the number of text lines below an axis in excess of two: one of ticks and one of the label."""
    tick_lines = max((tick.get_text().count("\n") for tick in ax.get_xticklabels()), default=0)
    return tick_lines + ax.get_xlabel().count("\n")


def _select_errors(dataset: xr.Dataset, name: str) -> tuple[xr.DataArray, xr.DataArray]:
    """Finite errors in the unit of the panel, and the finite values whose error is not estimated."""
    values, missing_error = dataset[name], np.inf if name.startswith(ESTIMATED_PREFIXES) else np.nan
    errors = dataset.get(f"{name}_error", xr.full_like(values, missing_error, dtype=np.float64))
    factor, _ = choose_unit(values)
    return errors.where(np.isfinite(errors)) / factor, (errors == np.inf) & (abs(values) < np.inf)


def _legend_texts(values: xr.DataArray, name: str) -> tuple[str, list[str]]:
    """Title of a legend, and texts of a parameter's values in the title's unit, or of zipped parameters."""
    zipped_values = [
        coordinate.values
        for parameter, coordinate in values.coords.items()
        if parameter != name and coordinate.dims == values.dims and coordinate.attrs.get("comment") != DERIVED
    ]
    if np.issubdtype(values.dtype, np.number) and not zipped_values:
        scaled_values, title = scale_values(values, name)
        return title, [f"{value:g}" for value in scaled_values.values]
    entries = zip(*(zipped_values or [values.values]), strict=True)
    return name.replace("_", " "), [", ".join(map(escape_dollars, entry)) for entry in entries]


def plot_traction_curve(
    dataset: xr.Dataset,
    hue: str | None = None,
    *,
    ax: Axes | None = None,
    creepage: str = "longitudinal_creepage",
    selection: Mapping[str, Any] | None = None,
) -> Axes:
    """Force over the force of full sliding against the creepage.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`, with a swept creepage.
    hue : str, optional
        Swept parameter with a line for each of its values.
    ax : Axes, optional
        Axes to draw in; default: a new figure.
    creepage : {"longitudinal_creepage", "lateral_creepage"}
        Creepage along the horizontal axis.
    selection : mapping, optional
        Values of the other swept parameters.

    Returns
    -------
    Axes
        A thin line at 1 is full sliding.

    Raises
    ------
    InvalidInputError
        If the creepage is not swept, or `selection` lacks a value of another swept parameter.

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
    names = ", ".join(map(str, dataset[name].dims))
    if creepage not in dataset[name].dims or "friction" not in dataset.coords:
        raise InvalidInputError("dataset", f"with {names or 'no parameter'} swept", f"an opened study over {creepage}")
    if hue is not None and hue not in dataset[name].dims:
        raise InvalidInputError("hue", hue, f"a swept parameter: {names}")
    axes_of_study = (creepage,) if hue is None else (creepage, hue)
    values = select(dataset[name] / (dataset["friction"] * dataset["normal_load"]), axes_of_study, selection or {})
    ax = new_axes(ax)
    for selection_of_line, style in _style_lines(values, hue, TICK_WIDTH):
        line = values.isel(selection_of_line).dropna(creepage)
        ax.plot(line[creepage], line.values, **style)
    ax.axhline(1.0, color="0.6", linewidth=0.8)
    if hue is not None:
        ax.legend(
            title=fold_text(_legend_texts(dataset[hue], hue)[0], TICK_WIDTH), **LEGEND_STYLE, title_fontsize="small"
        )
    ax.set_xlabel(rf"{creepage.replace('_', ' ')}, $\{'xi' if name == 'force_y' else 'eta'}$")
    ax.set_ylabel(f"force over full sliding's, ${symbol}/(f W)$")
    ax.grid(color="0.9", linewidth=0.6)
    fold_labels(ax)
    return ax


def plot_edge_effect(
    dataset: xr.Dataset,
    *,
    distance: float | None = None,
    depth: float = 3.0,
    most: int = 6,
    selection: Mapping[str, Any] | None = None,
    load: LoadCase = single_case,
) -> Figure:
    """Draw the pressure along the axis, and von Mises stress in the plane y = 0, for several e/a.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`, of a study over `e_over_a`. Half-space cases (a dimension `body`) are
        drawn for comparison; panels of stress need stored stresses.
    distance : float, optional
        Range along the axis in half-widths; default: up to the level part of every curve, or mid-length.
    depth : float
        Range of depth in half-widths.
    most : int
        Largest number of values of e/a, evenly selected.
    selection : mapping, optional
        Values of other swept parameters; default: the first.
    load : callable
        Returns the case of a selection of the study, with its surfaces; default: reads the Dataset.

    Returns
    -------
    Figure
        The title lists the values of the other parameters. A cross marks the largest stress of a case.

    Raises
    ------
    InvalidInputError
        If the study does not vary `e_over_a`, or contains no finished case with a pressure.
    """
    if "e_over_a" not in dataset.dims or "status" not in dataset:
        raise InvalidInputError("dataset", list(map(str, dataset.dims)), "a study with the dimension e_over_a")
    allowed = "a study with finished cases and stored pressures"
    if "hertz_half_width" not in dataset:
        raise InvalidInputError("dataset", dict(dataset.sizes), allowed)
    from matplotlib import pyplot

    dataset, remarks = _select_other_dims(dataset, selection or {})
    has_bodies = "body" in dataset.dims
    bodies = [str(name) for name in np.atleast_1d(dataset["body"].values)] if "body" in dataset.coords else [""]

    def select_body(body: str) -> list[DistanceCase]:
        body_cases = (dataset.sel(body=body) if has_bodies else dataset).dropna("e_over_a", subset=["hertz_half_width"])
        return [(float(e), body_cases.isel(e_over_a=i)) for i, e in enumerate(body_cases["e_over_a"].values)]

    def load_surfaces(entries: list[DistanceCase]) -> list[DistanceCase]:
        return [(e, case) for e, selection_of_case in entries if "pressure" in (case := load(selection_of_case))]

    body = next((body for body in bodies if body != "half-space"), bodies[0])
    candidates = select_body(body)
    indices = sorted(set(np.linspace(0, len(candidates) - 1, min(most, len(candidates))).round().astype(int)))
    entries = load_surfaces([candidates[index] for index in indices])
    if not entries:
        raise InvalidInputError("dataset", dict(dataset.sizes), allowed)
    half_spaces = select_body("half-space") if has_bodies and "half-space" in bodies and body != "half-space" else []
    # On a half-space e/a only shifts the coordinate: one case suffices.
    same_distance = [(e, case) for e, case in half_spaces if e == entries[0][0]] or half_spaces
    comparison = load_surfaces(same_distance[:1])
    stress_entries = [(e, case) for e, case in entries if "von_mises" in case]
    height = 0.5 + 1.1 * len(stress_entries)
    figure = pyplot.figure(figsize=(5.4, 4.0 + height), layout="constrained")
    subfigures: Any = figure.subfigures(2, 1, height_ratios=(4.0, height)) if stress_entries else [figure]
    ax = subfigures[0].subplots()
    _draw_pressures(ax, entries, comparison)
    distance = _level_distance([*entries, *comparison]) if distance is None else distance
    ax.set_xlim(0.0, distance)
    base_title = "Pressure and stress near a free end" if stress_entries else "Pressure near a free end"
    title = f"{base_title}: {'; '.join(remarks)}" if remarks else base_title
    figure.suptitle(fold_text(title, TITLE_WIDTH), fontsize="medium")
    if stress_entries:
        _draw_planes(subfigures[1], stress_entries, distance, depth)
    return figure


def _select_other_dims(dataset: xr.Dataset, selection: Mapping[str, Any]) -> tuple[xr.Dataset, list[str]]:
    """One case per e/a and body, and the text of the values of the other parameters."""
    sizes = {str(dim): dataset.sizes[dim] for dim in dataset["status"].dims if dim not in EDGE_AXES}
    indices = {dim: index_of(dataset, dim, selection[dim]) if dim in selection else 0 for dim in sizes}
    dataset = dataset.isel(indices)
    scalars = {str(name): entry for name, entry in dataset["status"].coords.items() if entry.ndim == 0}
    names = [name for name in dict.fromkeys([*sizes, *scalars]) if name in scalars and name not in (*EDGE_AXES, "case")]
    remarks = [
        describe_value(name, scalars[name].item(), str(scalars[name].attrs.get("units", "1")), sizes.get(name, 1))
        for name in names
    ]
    return dataset, remarks


def _draw_pressures(ax: Axes, entries: list[DistanceCase], comparison: list[DistanceCase]) -> None:
    """Pressure along the axis, one line per e/a."""
    for (end_distance, case), style in zip(entries, line_styles(len(entries)), strict=True):
        plot_axial_pressure(case, ax, label=f"free end, $e/a$ = {end_distance:g}", **style)
    line_style: dict[str, Any] = {"color": "black", "linestyle": ":", "linewidth": 1.2, "zorder": 1}
    for end_distance, case in comparison:
        plot_axial_pressure(case, ax, label=f"half-space, $e/a$ = {end_distance:g}", **line_style)
    pressures = [np.asarray(line.get_ydata(), dtype=np.float64) for line in ax.lines]
    max_pressure = max(float(np.nanmax(pressure, initial=1.2)) for pressure in pressures)
    ax.set_ylim(0.0, 1.05 * max_pressure)
    ax.axhline(1.0, color="0.7", linewidth=0.8, zorder=0)
    # The legend lies below the axis: within the axes it would cover the lines.
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), frameon=False, fontsize="small", ncols=3)


def _level_distance(entries: list[DistanceCase]) -> float:
    """Distance from the free end, in half-widths, beyond which every pressure is level up to mid-length."""
    distances = []
    for _, case in entries:
        unit = units(case, si=False)
        axial = axial_pressure(case)
        x, values = axial[dimension_along(axial, "x")].values / unit.length, axial.values
        mid_length = 0.5 * (x[0] + x[-1])
        in_half = x <= mid_length
        is_level = np.abs(values[in_half] / values[in_half][-1] - 1) < LEVEL_TOLERANCE
        varying_x = x[in_half][~is_level]
        distances.append(min(1.25 * float(varying_x[-1]) + 1.0 if varying_x.size else 1.0, float(mid_length)))
    return max(distances)


def _draw_planes(figure: Any, entries: list[DistanceCase], distance: float, depth: float) -> None:
    """One panel of von Mises stress per e/a below each other, with one colour scale."""
    from matplotlib.colors import PowerNorm
    from matplotlib.ticker import MaxNLocator

    fields = [(case, cap_field(case, measure(case, "von_mises"))[0]) for _, case in entries]
    planes = [interpolate_plane(case, field, {"y": 0.0}, units(case, si=False)) for case, field in fields]
    max_stress = max(float(np.nanmax(values[z <= depth][:, x <= distance])) for x, z, values in planes)
    levels = MaxNLocator(20).tick_values(0.0, max_stress)
    axes = figure.subplots(len(entries), sharex=True, sharey=True, squeeze=False)[:, 0]
    unit = units(entries[0][1], si=False)
    for ax, (end_distance, case) in zip(axes, entries, strict=True):
        plot_stress_plane(case, "von_mises", y=0.0, ax=ax, levels=levels, colorbar=False)
        ax.set(xlabel="", ylabel=f"$z{unit.over_length}$", ylim=(depth, 0.0), title=f"$e/a$ = {end_distance:g}")
    axes[0].set_xlim(0.0, min(distance, max(float(x.max()) for x, *_ in planes)))
    axes[-1].set_xlabel(unit.axis_label("x"))
    for ax in axes:
        # The stress below the end is several times that below mid-length: the square root separates both by colour.
        ax.collections[0].set_norm(PowerNorm(0.5, 0.0, levels[-1]))
    figure.colorbar(axes[0].collections[0], ax=axes, label=unit.stress_label("von_mises") + "\nin $y=0$")


def study_figures(dataset: xr.Dataset, *, selection: Mapping[str, Any] | None = None) -> dict[str, Figure]:
    """Draw the figures of a study, by name.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`.
    selection : mapping, optional
        Values of swept parameters. The title lists the values of parameters without an axis, line or panel; default:
        the first with most solved cases.

    Returns
    -------
    dict
        "edge_effect" for a study over e/a with stored surfaces, see `plot_edge_effect`; "study" if a parameter takes
        several values: `plot_study_lines` over the longest swept parameter, with a line for each value of the next
        longest. Where every peak is singular it contains the loads on the last half-width instead.

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
    figures = figures_with_selections(dataset, selection or {}, single_case)
    return {name: figure for name, (figure, _) in figures.items()}


def figures_with_selections(
    dataset: xr.Dataset, selection: Mapping[str, Any], load: LoadCase
) -> dict[str, tuple[Figure, list[str]]]:
    """Figures of :func:`study_figures`, each with the parameters that the figure shows at one of several values."""
    dataset = dataset.isel({name: [index_of(dataset, name, value)] for name, value in selection.items()})
    sizes = {str(dim): dataset.sizes[dim] for dim in dataset["status"].dims if dataset.sizes[dim] > 1}
    swept = sorted(sizes, key=lambda dim: -sizes[dim])
    figures = {}
    if "e_over_a" in dataset.dims and "hertz_half_width" in dataset:
        fixed_parameters = choose_values(dataset["hertz_half_width"], EDGE_AXES, {})
        with contextlib.suppress(ContactStudyError):  # no case has a pressure
            figure = plot_edge_effect(dataset, selection=fixed_parameters, load=load)
            figures["edge_effect"] = (figure, [name for name in swept if name not in EDGE_AXES])
    names = [name for name in swept if name != "case"]
    if names and (quantities := _choose_quantities(dataset)):
        figures["study"] = (
            plot_study_lines(dataset, quantities, x=names[0], hue=names[1] if len(names) > 1 else None),
            names[2:],
        )
    return figures


def _choose_quantities(dataset: xr.Dataset) -> list[str]:
    """Quantities with finite values; the end loads where every peak is singular."""
    stored = [name for name in QUANTITIES if name in dataset]
    finite_names = [name for name in (*stored, *END_LOADS) if name in dataset and np.isfinite(dataset[name]).any()]
    if "peak_pressure" in stored and "peak_pressure" not in finite_names and set(finite_names) & set(END_LOADS):
        return sorted(finite_names, key=lambda name: name not in END_LOADS)
    return [name for name in finite_names if name in QUANTITIES] or stored
