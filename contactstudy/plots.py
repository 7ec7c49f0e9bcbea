"""Figures of solved cases and of studies; lengths over the Hertz half-width a, stresses over p0.

Every function takes a Dataset of :func:`contactstudy.solve`, or of :func:`contactstudy.open_study` with one case
selected, and draws into given axes or a new figure. Colours keep their order in grey.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis import axial_pressure, dimension_along
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLORS = "viridis"
AXIS_LABELS = {
    "x": "distance from the free end, $x/a$",
    "y": "position along rolling, $y/a$",
    "z": "depth, $z/a$",
}
SYMBOLS = {
    "von_mises": r"von Mises stress, $\sigma_{vM}/p_0$",
    "sigma_xx": r"$\sigma_{xx}/p_0$",
    "sigma_yy": r"$\sigma_{yy}/p_0$",
    "sigma_zz": r"$\sigma_{zz}/p_0$",
    "tau_xy": r"$\tau_{xy}/p_0$",
    "tau_xz": r"$\tau_{xz}/p_0$",
    "tau_yz": r"$\tau_{yz}/p_0$",
}


def _new_axes(ax: Axes | None, size: tuple[float, float] = (6.4, 4.0)) -> Axes:
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.subplots(figsize=size, layout="constrained")[1]


def _scale(dataset: xr.Dataset) -> tuple[float, float]:
    """Half-width a and pressure p0 of a single case."""
    half_width = dataset["hertz_half_width"]
    if half_width.size != 1:
        raise InvalidInputError(
            "dataset", dict(half_width.sizes), "a single case", "select one, for example with .isel or .sel"
        )
    return float(half_width), float(dataset["hertz_max_pressure"])


def _position(dataset: xr.Dataset, array: xr.DataArray, axis: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Positions of `array` along an axis over a; NaN where a case has fewer than others."""
    dim = dimension_along(array, axis)
    name = dim.removesuffix("_index")
    return np.asarray(dataset[name].values, dtype=np.float64) / _scale(dataset)[0]


def _check(dataset: xr.Dataset, variable: str) -> None:
    if variable not in dataset:
        raise InvalidInputError(
            "dataset",
            sorted(map(str, dataset.data_vars)),
            f"a Dataset with {variable}",
            "a study keeps it at level 'fields', pressure already at 'surface'",
        )


def plot_axial_pressure(dataset: xr.Dataset, ax: Axes | None = None, *, shift: float = 0.0, **style: Any) -> Axes:
    """Largest pressure across y, over p0, along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        A single case with `pressure`.
    ax : Axes, optional
        Where to draw; default: a new figure.
    shift : float
        Added to the positions, in half-widths.
    **style
        For the line, as in matplotlib.

    Returns
    -------
    Axes

    Raises
    ------
    InvalidInputError
        If there is no pressure, or more than one case.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0.5, 1.5], "y": [0.0]})
    >>> one = xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_axial_pressure(one).get_ylabel()
    'pressure, $p/p_0$'
    """
    _check(dataset, "pressure")
    pressure_scale = _scale(dataset)[1]
    ax = _new_axes(ax)
    x = _position(dataset, dataset["pressure"], "x")
    ax.plot(x + shift, axial_pressure(dataset).values / pressure_scale, **style)
    ax.set_xlabel(AXIS_LABELS["x"])
    ax.set_ylabel("pressure, $p/p_0$")
    return ax


def plot_pressure_map(dataset: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Pressure over p0 on the top of the body.

    Parameters
    ----------
    dataset : Dataset
        A single case with `pressure`.
    ax : Axes, optional
        Where to draw; default: a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    InvalidInputError
        If there is no pressure, or more than one case.
    """
    _check(dataset, "pressure")
    ax = _new_axes(ax)
    pressure = dataset["pressure"]
    dims = dimension_along(pressure, "x"), dimension_along(pressure, "y")
    x, y = (_position(dataset, pressure, axis) for axis in "xy")
    values = pressure.transpose(*dims).values[np.isfinite(x)][:, np.isfinite(y)] / _scale(dataset)[1]
    drawn = ax.pcolormesh(x[np.isfinite(x)], y[np.isfinite(y)], values.T, cmap=COLORS, shading="nearest")
    ax.figure.colorbar(drawn, ax=ax, label="pressure, $p/p_0$")
    ax.set_xlabel(AXIS_LABELS["x"])
    ax.set_ylabel(AXIS_LABELS["y"])
    return ax


def _plane(dataset: xr.Dataset, variable: str, y: float) -> tuple[Any, Any, Any]:
    """Positions x/a and z/a, and the variable over p0 as an array (x, z) in the plane nearest to `y` (metres)."""
    _check(dataset, variable)
    array = dataset[variable]
    x_dim, y_dim, z_dim = (dimension_along(array, axis) for axis in "xyz")
    half_width, pressure = _scale(dataset)
    nearest = int(np.nanargmin(np.abs(_position(dataset, array, "y") - y / half_width)))
    values = array.isel({y_dim: nearest}).transpose(x_dim, z_dim).values / pressure
    x, z = _position(dataset, array, "x"), _position(dataset, array, "z")
    return x[np.isfinite(x)], z[np.isfinite(z)], values[np.isfinite(x)][:, np.isfinite(z)]


def plot_stress_plane(
    dataset: xr.Dataset,
    variable: str = "von_mises",
    y: float = 0.0,
    ax: Axes | None = None,
    *,
    levels: Any = None,
    colorbar: bool = True,
) -> Axes:
    """Contours of a stress over p0 in a plane along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        A single case with stresses.
    variable : str
        Which stress.
    y : float
        Where the plane is, metres; the nearest one with stresses is drawn.
    ax : Axes, optional
        Where to draw; default: a new figure.
    levels : sequence of float, optional
        Contour levels.
    colorbar : bool
        Whether to add one.

    Returns
    -------
    Axes

    Raises
    ------
    InvalidInputError
        If the variable is missing, has fewer than two positions along x or z, or there is more than one case.
    """
    x, z, values = _plane(dataset, variable, y)
    if min(x.size, z.size) < 2:
        raise InvalidInputError(variable, values.shape, "given at two or more positions along x and along z")
    ax = _new_axes(ax, (6.4, 3.2))
    chosen = 12 if levels is None else levels
    drawn = ax.contourf(x, z, values.T, levels=chosen, cmap=COLORS)
    ax.contour(drawn, levels=np.asarray(drawn.levels)[::2], colors="white", linewidths=0.5)
    ax.set_ylim(z.max(), z.min())
    ax.set_xlabel(AXIS_LABELS["x"])
    ax.set_ylabel(AXIS_LABELS["z"])
    if colorbar:
        ax.figure.colorbar(drawn, ax=ax, label=SYMBOLS.get(variable, f"{variable} over $p_0$"))
    return ax


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
                shown = f"{value:.4g}" if isinstance(value, float) else str(value)
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
        return [(e, case) for e, case in rows if np.isfinite(float(case["hertz_half_width"]))]

    finite = next((body for body in bodies if body != "half-space"), bodies[0])
    drawn = cases(finite)
    if not drawn or "pressure" not in dataset:
        raise InvalidInputError("dataset", dict(dataset.sizes), "a study with finished cases that keep their pressure")
    picked = sorted(set(np.linspace(0, len(drawn) - 1, min(most, len(drawn))).round().astype(int)))
    drawn = [drawn[index] for index in picked]
    stressed = [entry for entry in drawn if "von_mises" in dataset and np.isfinite(_plane_of(entry[1])).any()]
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


def _plane_of(case: xr.Dataset) -> Any:
    return _plane(case, "von_mises", 0.0)[2]


def _draw_pressures(
    ax: Axes, drawn: list[tuple[float, xr.Dataset]], comparison: list[tuple[float, xr.Dataset]], distance: float
) -> None:
    """Pressure along the axis, one line per e/a; dark to light, each with its own dashes."""
    import matplotlib

    colors = matplotlib.colormaps[COLORS](np.linspace(0.0, 0.85, len(drawn)))
    dashes: list[Any] = ["-", (0, (6, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (3, 1.5)), (0, (1, 1)), (0, (8, 2, 1, 2, 1, 2))]
    highest = 1.2
    for number, ((e, case), color) in enumerate(zip(drawn, colors, strict=True)):
        plot_axial_pressure(
            case,
            ax,
            color=color,
            linestyle=dashes[number % len(dashes)],
            linewidth=1.8,
            label=f"free end, $e/a$ = {e:g}",
        )
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

    planes = [_plane(case, "von_mises", 0.0) for _, case in stressed]
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
        ax.set_xlabel(AXIS_LABELS["x"] if number + columns >= len(stressed) else "")
        ax.set_ylabel(AXIS_LABELS["z"] if number % columns == 0 else "")
        ax.tick_params(labelbottom=number + columns >= len(stressed))
    filled = next(entry for entry in axes[0, 0].collections if entry.get_array() is not None)
    figure.colorbar(filled, ax=axes, label=SYMBOLS["von_mises"] + " in $y=0$")
