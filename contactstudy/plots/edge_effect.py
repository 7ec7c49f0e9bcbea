"""Figure of the end effect: pressure and stress near a free end over the distance e/a."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis import axial_pressure, dimension_along, single_case
from contactstudy.arrays.variables import index_of
from contactstudy.errors import InvalidInputError
from contactstudy.plots.axial import plot_axial_pressure
from contactstudy.plots.selection import describe_value
from contactstudy.plots.stress import plane_stress, plot_stress_plane
from contactstudy.plots.style import fold_text, line_styles, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Entry = tuple[float, xr.Dataset]  # e/a and the case
LoadCase = Callable[[xr.Dataset], xr.Dataset]  # Takes the part of a study with one case; returns the case

EDGE_AXES = ("e_over_a", "body")  # Parameters with several values in the figure
TITLE_WIDTH = 60  # letters in a line of the title
PLATEAU = 0.1  # Largest relative deviation from the pressure at mid-length of a level curve


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
        Takes the part of a study with one case, returns the case with its surfaces; default: reads the Dataset.

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

    def entries_of(body: str) -> list[Entry]:
        body_cases = (dataset.sel(body=body) if has_bodies else dataset).dropna("e_over_a", subset=["hertz_half_width"])
        return [(float(e), body_cases.isel(e_over_a=i)) for i, e in enumerate(body_cases["e_over_a"].values)]

    def with_surfaces(entries: list[Entry]) -> list[Entry]:
        loaded = [(e, load(case)) for e, case in entries]
        return [(e, case) for e, case in loaded if "pressure" in case]

    finite = next((body for body in bodies if body != "half-space"), bodies[0])
    candidates = entries_of(finite)
    indices = sorted(set(np.linspace(0, len(candidates) - 1, min(most, len(candidates))).round().astype(int)))
    entries = with_surfaces([candidates[index] for index in indices])
    if not entries:
        raise InvalidInputError("dataset", dict(dataset.sizes), allowed)
    half_spaces = entries_of("half-space") if has_bodies and "half-space" in bodies and finite != "half-space" else []
    # On a half-space e/a only shifts the coordinate: one case suffices.
    same_distance = [(e, case) for e, case in half_spaces if e == entries[0][0]] or half_spaces
    comparison = with_surfaces(same_distance[:1])
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


def _draw_pressures(ax: Axes, entries: list[Entry], comparison: list[Entry]) -> None:
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


def _level_distance(entries: list[Entry]) -> float:
    """Distance from the free end, in half-widths, beyond which every pressure is level up to mid-length."""
    limits = []
    for _, case in entries:
        unit = units(case, si=False)
        axial = axial_pressure(case)
        x, values = axial[dimension_along(axial, "x")].values / unit.length, axial.values
        mid_length = 0.5 * (x[0] + x[-1])
        in_half = x <= mid_length
        is_level = np.abs(values[in_half] / values[in_half][-1] - 1) < PLATEAU
        varying_x = x[in_half][~is_level]
        limits.append(min(1.25 * float(varying_x[-1]) + 1.0 if varying_x.size else 1.0, float(mid_length)))
    return max(limits)


def _draw_planes(figure: Any, entries: list[Entry], distance: float, depth: float) -> None:
    """One panel of von Mises stress per e/a below each other, with one colour scale."""
    from matplotlib.colors import PowerNorm
    from matplotlib.ticker import MaxNLocator

    planes = [plane_stress(case, "von_mises", {"y": 0.0}, units(case, si=False)) for _, case in entries]
    max_stress = max(float(np.nanmax(values[z <= depth][:, x <= distance])) for x, z, values, _ in planes)
    levels = MaxNLocator(20).tick_values(0.0, max_stress)
    axes = figure.subplots(len(entries), sharex=True, sharey=True, squeeze=False)[:, 0]
    unit = units(entries[0][1], si=False)
    for ax, (end_distance, case) in zip(axes, entries, strict=True):
        plot_stress_plane(case, "von_mises", y=0.0, ax=ax, levels=levels, colorbar=False)
        ax.set(xlabel="", ylabel=f"$z{unit.over_length}$", ylim=(depth, 0.0), title=f"$e/a$ = {end_distance:g}")
    axes[0].set_xlim(0.0, min(distance, max(float(x.max()) for x, *_ in planes)))
    axes[-1].set_xlabel(unit.axis("x"))
    for ax in axes:
        # The stress below the end is several times that below mid-length: the square root separates both by colour.
        ax.collections[0].set_norm(PowerNorm(0.5, 0.0, levels[-1]))
    figure.colorbar(axes[0].collections[0], ax=axes, label=unit.stress_label("von_mises") + "\nin $y=0$")
