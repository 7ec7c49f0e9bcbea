"""What the free ends do, as one figure of a study over e/a."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis import dimension_along, in_plane, single_case
from contactstudy.arrays.named_places import place_of
from contactstudy.errors import InvalidInputError
from contactstudy.plots.chosen import in_lines, said
from contactstudy.plots.pressure import plot_axial_pressure
from contactstudy.plots.singular import capped
from contactstudy.plots.stress import plot_stress_plane
from contactstudy.plots.style import line_styles, units

if TYPE_CHECKING:
    from matplotlib.figure import Figure


Load = Callable[[xr.Dataset], xr.Dataset]
"""Takes the part of a study that is one case; returns that case with its surfaces, as `solve` does."""

NOTHING = "a study with finished cases that keep their pressure"

WIDEST_TITLE = 100
"""Characters after which the title goes on in the next line."""

AXES = ("e_over_a", "body")
"""Parameters of which the figure shows several values."""


def _chosen(dataset: xr.Dataset, selection: Mapping[str, Any]) -> tuple[xr.Dataset, list[str]]:
    """One case per e/a and body; other swept parameters at the value given, or at their first, which is said."""
    remarks = []
    for dim in map(str, dataset["status"].dims):
        if dim in AXES:
            continue
        count = dataset.sizes[dim]
        at = place_of(dataset, dim, selection[dim]) if dim in selection else 0
        dataset = dataset.isel({dim: at})
        if dim in dataset.coords and dim != "case":
            entry = dataset[dim]
            remarks.append(said(dim, entry.item(), str(entry.attrs.get("units", "1")), count))
    for name, entry in dataset["status"].coords.items():
        held = entry.ndim == 0 and str(name) not in (*AXES, "case")
        if held and not any(remark.startswith(said(str(name), "", "")) for remark in remarks):
            remarks.append(said(str(name), entry.item(), str(entry.attrs.get("units", "1"))))
    return dataset, remarks


def plot_edge_effect(
    dataset: xr.Dataset,
    *,
    distance: float = 8.0,
    depth: float = 3.0,
    most: int = 6,
    selection: Mapping[str, Any] | None = None,
) -> Figure:
    """Draw what the free ends do: pressure along the axis, and von Mises in the plane y = 0, for several e/a.

    Parameters
    ----------
    dataset : Dataset
        From :func:`contactstudy.open_study`, of a study over `e_over_a`; half-space cases (a dimension `body`) are
        drawn as the comparison. Stresses may be missing; then there are no panels of them.
    distance, depth : float
        Range of the panels in half-widths.
    most : int
        Largest number of values of e/a to draw, evenly chosen.
    selection : mapping, optional
        Values of other swept parameters; default: the first of each.

    Returns
    -------
    Figure
        Its title says at which values of the other parameters, and out of how many.

    Raises
    ------
    InvalidInputError
        If the study does not vary `e_over_a`, or has no finished case to draw.
    """
    if "e_over_a" not in dataset.dims or "status" not in dataset:
        raise InvalidInputError("dataset", list(map(str, dataset.dims)), "a study with the dimension e_over_a")
    if "pressure" not in dataset:
        raise InvalidInputError("dataset", dict(dataset.sizes), NOTHING)
    return edge_effect_figure(dataset, single_case, selection or {}, distance=distance, depth=depth, most=most)


def edge_effect_figure(
    dataset: xr.Dataset,
    load: Load,
    selection: Mapping[str, Any],
    *,
    distance: float = 8.0,
    depth: float = 3.0,
    most: int = 6,
) -> Figure:
    """Draw what :func:`plot_edge_effect` does, of cases that are read one by one when they are drawn."""
    from matplotlib import pyplot

    dataset, remarks = _chosen(dataset, selection)
    bodies = [str(name) for name in np.atleast_1d(dataset["body"].values)] if "body" in dataset.coords else [""]
    has_bodies = "body" in dataset.dims

    def cases(body: str) -> list[tuple[float, xr.Dataset]]:
        chosen = dataset.sel(body=body) if has_bodies else dataset
        rows = [(float(e), chosen.isel(e_over_a=i)) for i, e in enumerate(chosen["e_over_a"].values)]
        return [(e, case) for e, case in rows if np.isfinite(float(case["hertz_half_width"]))]

    def loaded(rows: list[tuple[float, xr.Dataset]]) -> list[tuple[float, xr.Dataset]]:
        read = [(e, load(case)) for e, case in rows]
        return [(e, case) for e, case in read if "pressure" in case]

    finite = next((body for body in bodies if body != "half-space"), bodies[0])
    known = cases(finite)
    picked = sorted(set(np.linspace(0, len(known) - 1, min(most, len(known))).round().astype(int)))
    drawn = loaded([known[index] for index in picked])
    if not drawn:
        raise InvalidInputError("dataset", dict(dataset.sizes), NOTHING)
    comparison = cases("half-space") if has_bodies and "half-space" in bodies and finite != "half-space" else []
    # On a half-space the distance changes nothing but the coordinate: one case stands for all.
    same = [entry for entry in comparison if entry[0] == drawn[0][0]] or comparison
    stressed = [entry for entry in drawn if "von_mises" in entry[1]]
    columns = 2 if len(stressed) > 1 else 1
    rows = -(-len(stressed) // columns)
    figure = pyplot.figure(figsize=(9.0, 4.2 + 2.0 * rows), layout="constrained")
    # matplotlib's annotations do not know that several subfigures come as an array
    parts: Any = figure.subfigures(2, 1, height_ratios=(4.2, 2.0 * rows)) if stressed else [figure]
    _draw_pressures(parts[0], drawn, loaded(same[:1]), distance)
    heading = "Pressure and stress near a free end" if stressed else "Pressure near a free end"
    figure.suptitle(in_lines(remarks, WIDEST_TITLE, f"{heading}:" if remarks else heading), fontsize="medium")
    if stressed:
        _draw_planes(parts[1], stressed, rows, columns, distance, depth)
    return figure


def _plane(case: xr.Dataset) -> tuple[Any, Any, Any]:
    """Positions x/a and z/a, and von Mises over p0 as an array (x, z), in the plane y = 0."""
    unit = units(case, si=False)
    field, _ = capped(case, case["von_mises"])
    plane = in_plane(case.assign(von_mises=field), y=0.0, variables="von_mises")["von_mises"]
    x, z = (dimension_along(plane, axis) for axis in "xz")
    return plane[x].values / unit.length, plane[z].values / unit.length, plane.transpose(x, z).values / unit.stress


def _draw_pressures(
    figure: Any, drawn: list[tuple[float, xr.Dataset]], comparison: list[tuple[float, xr.Dataset]], distance: float
) -> None:
    """Pressure along the axis, one line per e/a; dark to light, each with its own dashes."""
    ax, highest = figure.subplots(), 1.2
    for (e, case), style in zip(drawn, line_styles(len(drawn)), strict=True):
        plot_axial_pressure(case, ax, label=f"free end, $e/a$ = {e:g}", **style)
        highest = max(highest, float(np.nanmax(ax.lines[-1].get_ydata())))
    for e, case in comparison:
        plot_axial_pressure(
            case, ax, color="black", linestyle=":", linewidth=1.2, zorder=1, label=f"half-space, $e/a$ = {e:g}"
        )
        highest = max(highest, float(np.nanmax(ax.lines[-1].get_ydata())))
    ax.set_xlim(0.0, distance)
    ax.set_ylim(0.0, 1.05 * highest)
    ax.axhline(1.0, color="0.7", linewidth=0.8, zorder=0)
    # Below the axis: within the axes it would lie on the lines.
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), frameon=False, fontsize="small", ncols=4)


def _draw_planes(
    figure: Any, stressed: list[tuple[float, xr.Dataset]], rows: int, columns: int, distance: float, depth: float
) -> None:
    """One panel of von Mises per e/a, all with one colour scale."""
    from matplotlib.ticker import MaxNLocator

    planes = [_plane(case) for _, case in stressed]
    largest = max(float(np.nanmax(values[x <= distance][:, z <= depth])) for x, z, values in planes)
    levels = MaxNLocator(20).tick_values(0.0, largest)
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for ax in axes.ravel()[len(stressed) :]:
        ax.set_visible(False)
    for number, (e, case) in enumerate(stressed):
        ax = axes.ravel()[number]
        plot_stress_plane(case, "von_mises", 0.0, ax, levels=levels, colorbar=False)
        ax.set_xlim(0.0, min(distance, max(float(x.max()) for x, _, _ in planes)))
        ax.set_ylim(depth, 0.0)
        ax.set_title(f"$e/a$ = {e:g}", fontsize="medium")
        ax.set_xlabel(units(case, si=False).axis("x") if number + columns >= len(stressed) else "")
        ax.set_ylabel(units(case, si=False).axis("z") if number % columns == 0 else "")
        ax.tick_params(labelbottom=number + columns >= len(stressed))
    filled = next(entry for entry in axes[0, 0].collections if entry.get_array() is not None)
    figure.colorbar(filled, ax=axes, label=units(stressed[0][1], si=False).stress_label("von_mises") + "\nin $y=0$")
