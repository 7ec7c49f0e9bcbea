"""Stress contours in the planes x, y, z = const, and around the edge of the end face."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, in_plane, measure, positions, single_case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.plots.labels import fold_labels
from contactstudy.plots.singular import capped
from contactstudy.plots.style import COLORS, Units, new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import QuadContourSet

LEVELS = 12
"""About how many contours are drawn."""


def _contours(ax: Axes, across: FloatArray, down: FloatArray, values: FloatArray, levels: Any) -> QuadContourSet:
    """Draw filled contours with every second level drawn as a line."""
    drawn = ax.contourf(across, down, values, levels=levels, cmap=COLORS)
    ax.contour(drawn, levels=np.asarray(drawn.levels)[::2], colors="white", linewidths=0.5)
    return drawn


def _grid(plane: xr.DataArray, across: str, down: str, unit: Units) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions and values (down, across) of a plane in the units of the figure."""
    dims = [dimension_along(plane, axis) for axis in (across, down)]
    if min(plane.sizes[dim] for dim in dims) < 2:
        raise InvalidInputError(
            str(plane.name), dict(plane.sizes), f"given at two or more positions along {across} and along {down}"
        )
    plane = plane.sortby(dims)
    first, second = (plane[dim].values / unit.length for dim in dims)
    return first, second, plane.transpose(*dims[::-1]).values / unit.stress


def plot_stress_plane(
    dataset: xr.Dataset,
    variable: str = "von_mises",
    y: float | None = None,
    ax: Axes | None = None,
    *,
    x: float | None = None,
    z: float | None = None,
    levels: Any = None,
    colorbar: bool = True,
    si: bool = False,
) -> Axes:
    """Contours of a stress in a plane ``x``, ``y`` or ``z`` = const.

    Parameters
    ----------
    dataset : Dataset
        A single case with stresses.
    variable : str
        A stress, or a measure, see :func:`contactstudy.analysis.measure`.
    y, x, z : float, optional
        Where the plane is, metres, at most one of them; between the positions of the result it is interpolated.
        Default: ``y = 0``.
    ax : Axes, optional
        Where to draw; default: a new figure.
    levels : int or sequence of float, optional
        Contour levels, or about how many.
    colorbar : bool
        Whether to add one.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and stresses over p0.

    Returns
    -------
    Axes
        With the depth downwards.

    Raises
    ------
    InvalidInputError
        If the variable is missing or has fewer than two positions along an axis of the plane, the plane lies outside
        the result, more than one is given, or there is more than one case.

    Examples
    --------
    >>> field = xr.DataArray([[[1.0, 4.0]], [[2.0, 3.0]]], dims=("x", "y", "z"),
    ...                      coords={"x": [0.0, 1.0], "y": [0.0], "z": [0.0, 1.0]})
    >>> one = xr.Dataset({"von_mises": field, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_stress_plane(one).get_ylabel()
    'depth, $z/a$'
    """
    measure(dataset, variable)
    one = single_case(dataset)
    unit = units(one, si=si)
    given = {axis: value for axis, value in (("x", x), ("y", y), ("z", z)) if value is not None} or {"y": 0.0}
    field, most = capped(one, measure(one, variable))
    one = one.assign({variable: field})
    plane = in_plane(one, variables=variable, x=given.get("x"), y=given.get("y"), z=given.get("z"))[variable]
    ((at, value),) = given.items()
    across, down = (axis for axis in "xyz" if axis != at)
    first, second, values = _grid(plane, across, down, unit)
    ax = new_axes(ax, (6.4, 3.2))
    drawn = _contours(ax, first, second, values, LEVELS if levels is None else levels)
    if down == "z":
        ax.set_ylim(second.max(), second.min())
    ax.set_xlabel(unit.axis(across))
    ax.set_ylabel(unit.axis(down))
    ax.set_title(f"plane {unit.place(at, value)}", fontsize="medium")
    if colorbar:
        beyond = (
            " (more beside the singular end)"
            if most < np.inf and np.asarray(drawn.levels).max() >= most / unit.stress
            else ""
        )
        fold_labels(ax.figure.colorbar(drawn, ax=ax, label=unit.stress_label(variable) + beyond).ax)
    fold_labels(ax)
    return ax


def plot_end_face(
    dataset: xr.Dataset,
    variable: str = "von_mises",
    ax: Axes | None = None,
    *,
    end: str = "first",
    side: float = 1.0,
    distance: float | None = None,
    levels: Any = None,
    si: bool = False,
) -> Axes:
    """Contours of a stress around the edge of an end face: the face and the plane ``y = 0``, unfolded side by side.

    To the right of the fold lies the plane ``y = 0``, from the end face inwards; to its left the end face, from
    ``y = 0`` outwards. Both share the depth, and the contours meet at the fold.

    Parameters
    ----------
    dataset : Dataset
        A single case with stresses on the end face: positions of stresses with ``x = 0``, or the body's length.
    variable : str
        A stress, or a measure, see :func:`contactstudy.analysis.measure`.
    ax : Axes, optional
        Where to draw; default: a new figure.
    end : {"first", "last"}
        Which end: ``x = 0``, or the largest x of the stresses.
    side : {1, -1}
        Whether to show the face's half with y > 0 (where sliding drags the body to) or with y < 0.
    distance : float, optional
        How far to draw along x, in the unit of the figure; default: twice as far as along y.
    levels : int or sequence of float, optional
        Contour levels, or about how many.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and stresses over p0.

    Returns
    -------
    Axes

    Raises
    ------
    InvalidInputError
        If the variable is missing, or has fewer than two positions along an axis or on that side; if the stresses do
        not reach the face, or there is more than one case.

    Examples
    --------
    >>> points = {"x": [0.0, 1.0], "y": [0.0, 1.0], "z": [0.0, 1.0]}
    >>> field = xr.DataArray([[[1.0, 4.0], [1.0, 1.0]], [[2.0, 3.0], [1.0, 1.0]]], dims=tuple(points), coords=points)
    >>> one = xr.Dataset({"von_mises": field, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_end_face(one).get_ylabel()
    'depth, $z/a$'
    """
    measure(dataset, variable)
    one = single_case(dataset)
    unit = units(one, si=si)
    checks.known_name("end", end, ("first", "last"))
    if side not in (1, -1):
        raise InvalidInputError("side", side, "1 for y > 0 or -1 for y < 0")
    field = measure(one, variable)
    places = {axis: positions(field, axis).values for axis in "xy"}
    reach = float(places["x"].max() - places["x"].min())
    face = float(places["x"].max()) if end == "last" else 0.0
    if abs(float(places["x"].min()) - face) > 1e-9 * reach and end == "first":
        raise InvalidInputError(
            "x",
            float(places["x"].min()),
            "0, the end face, for the first position of stresses",
            "by default they are at the cells' centres: solve(case, x=...) with 0 among the positions",
        )
    inside = in_plane(one, variables=variable, y=0.0)[variable]
    on_face = in_plane(one, variables=variable, x=face)[variable]
    y_dim = dimension_along(on_face, "y")
    outer = side * on_face[y_dim] > 0
    # The fold itself belongs to both: its values are those of the plane y = 0.
    fold = in_plane(one, variables=variable, y=0.0)[variable].sel({dimension_along(inside, "x"): face})
    half = xr.concat([fold.reset_coords(drop=True).expand_dims({y_dim: [0.0]}), on_face[{y_dim: outer.values}]], y_dim)
    half = half.rename(variable)
    x, z, right = _grid(inside, "x", "z", unit)
    y, _, left = _grid(half, "y", "z", unit)
    x = np.abs(x - face / unit.length)
    shown = x <= (2 * np.abs(y).max() if distance is None else checks.positive("distance", distance)) * (1 + 1e-9)
    if levels is None or np.ndim(levels) == 0:
        from matplotlib.ticker import MaxNLocator

        both = np.concatenate([right[:, shown].ravel(), left.ravel()])
        levels = MaxNLocator(LEVELS if levels is None else levels).tick_values(both.min(), both.max())
    ax = new_axes(ax, (7.2, 3.4))
    drawn = _contours(ax, x[shown], z, right[:, shown], levels)
    _contours(ax, -np.abs(y), z, left, levels)
    ax.axvline(0.0, color="black", linewidth=1.0)
    ax.set_ylim(z.max(), z.min())
    # Distances count from the fold to both sides.
    ax.xaxis.set_major_formatter(lambda value, _: f"{abs(value):g}")
    sign = "" if side > 0 else "-"
    over = unit.over_length
    ax.set_xlabel(f"on the end face, ${sign}y{over}$   |   in the plane $y = 0$, $x{over}$ from the face")
    ax.set_ylabel(unit.axis("z"))
    fold_labels(ax, ax.figure.colorbar(drawn, ax=ax, label=unit.stress_label(variable)).ax)
    return ax
