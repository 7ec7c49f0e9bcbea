"""What the free ends do, as one figure of a study over e/a."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis import dimension_along, in_plane, single_case
from contactstudy.errors import InvalidInputError
from contactstudy.plots.pressure import plot_axial_pressure
from contactstudy.plots.singular import capped
from contactstudy.plots.stress import plot_stress_plane
from contactstudy.plots.style import as_written, line_styles, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def _chosen(dataset: xr.Dataset, selection: Mapping[str, Any]) -> tuple[xr.Dataset, list[str]]:
    """One case per e/a and body; other swept parameters at the value given, or at their first."""
    remarks = []
    for dim in dataset["status"].dims:
        if dim in ("e_over_a", "body"):
            continue
        dataset = dataset.sel({dim: selection[str(dim)]}) if dim in selection else dataset.isel({dim: 0})
    for name in dataset["status"].coords:
        entry = dataset[name]
        if entry.ndim == 0 and name not in ("case", "body", "e_over_a"):
            value = entry.item()
            if name == "max_pressure":
                remarks.append(f"$p_0$ = {value / 1e9:.3g} GPa")
            else:
                shown = f"{value:.4g}" if isinstance(value, float) else as_written(value)
                remarks.append(f"{str(name).replace('_', ' ')} {shown}")
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

    Raises
    ------
    InvalidInputError
        If the study does not vary `e_over_a`, or has no finished case to draw.
    """
    from matplotlib import pyplot

    if "e_over_a" not in dataset.dims or "status" not in dataset:
        raise InvalidInputError("dataset", list(map(str, dataset.dims)), "a study with the dimension e_over_a")
    dataset, remarks = _chosen(dataset, selection or {})
    bodies = [str(name) for name in np.atleast_1d(dataset["body"].values)] if "body" in dataset.coords else [""]
    has_bodies = "body" in dataset.dims

    def cases(body: str) -> list[tuple[float, xr.Dataset]]:
        chosen = dataset.sel(body=body) if has_bodies else dataset
        rows = [(float(e), chosen.isel(e_over_a=i)) for i, e in enumerate(chosen["e_over_a"].values)]
        return [(e, single_case(case)) for e, case in rows if np.isfinite(float(case["hertz_half_width"]))]

    finite = next((body for body in bodies if body != "half-space"), bodies[0])
    drawn = cases(finite)
    if not drawn or "pressure" not in dataset:
        raise InvalidInputError("dataset", dict(dataset.sizes), "a study with finished cases that keep their pressure")
    picked = sorted(set(np.linspace(0, len(drawn) - 1, min(most, len(drawn))).round().astype(int)))
    drawn = [drawn[index] for index in picked]
    stressed = [entry for entry in drawn if "von_mises" in entry[1]]
    columns = 2 if len(stressed) > 1 else 1
    rows = -(-len(stressed) // columns)
    figure = pyplot.figure(figsize=(9.0, 3.9 + 2.0 * rows), layout="constrained")
    # matplotlib's annotations do not know that several subfigures come as an array
    parts: Any = figure.subfigures(2, 1, height_ratios=(3.9, 2.0 * rows)) if stressed else [figure]
    comparison = cases("half-space") if has_bodies and "half-space" in bodies and finite != "half-space" else []
    _draw_pressures(parts[0].subplots(), drawn, comparison, distance)
    heading = "Pressure and stress near a free end" if stressed else "Pressure near a free end"
    figure.suptitle(heading + (": " + ", ".join(remarks) if remarks else ""), fontsize="medium", wrap=True)
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
    ax: Axes, drawn: list[tuple[float, xr.Dataset]], comparison: list[tuple[float, xr.Dataset]], distance: float
) -> None:
    """Pressure along the axis, one line per e/a; dark to light, each with its own dashes."""
    highest = 1.2
    for (e, case), style in zip(drawn, line_styles(len(drawn)), strict=True):
        plot_axial_pressure(case, ax, label=f"free end, $e/a$ = {e:g}", **style)
        highest = max(highest, float(np.nanmax(ax.lines[-1].get_ydata())))
    if comparison:
        # On a half-space the distance changes nothing but the coordinate: one case stands for all.
        e, case = next((entry for entry in comparison if entry[0] == drawn[0][0]), comparison[0])
        plot_axial_pressure(
            case, ax, color="black", linestyle=":", linewidth=1.2, zorder=1, label=f"half-space, $e/a$ = {e:g}"
        )
        highest = max(highest, float(np.nanmax(ax.lines[-1].get_ydata())))
    ax.set_xlim(0.0, distance)
    ax.set_ylim(0.0, 1.05 * highest)
    ax.axhline(1.0, color="0.7", linewidth=0.8, zorder=0)
    ax.legend(frameon=False, fontsize="small", ncols=2)


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
