"""Stress contours in the planes x, y, z = const, and around the edge of the end face."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, in_plane, measure, positions, single_case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.plots.style import COLORS, Units, cap_field, fold_labels, label_axes, new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import QuadContourSet

LEVELS = 12  # Approximate number of contours


def _draw_contours(
    ax: Axes, horizontal: FloatArray, vertical: FloatArray, values: FloatArray, levels: Any
) -> QuadContourSet:
    """Draw filled contours, and every second level as a line."""
    contours = ax.contourf(horizontal, vertical, values, levels=levels, cmap=COLORS)
    ax.contour(contours, levels=np.asarray(contours.levels)[::2], colors="white", linewidths=0.5)
    return contours


def _plane_arrays(
    plane: xr.DataArray, horizontal: str, vertical: str, unit: Units
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions and values (down, across) of a plane in the units of the figure."""
    dims = [dimension_along(plane, axis) for axis in (horizontal, vertical)]
    if min(plane.sizes[dim] for dim in dims) < 2:
        raise InvalidInputError(
            str(plane.name),
            dict(plane.sizes),
            f"given at two or more positions along {horizontal} and along {vertical}",
        )
    plane = plane.sortby(dims)
    across, down = (plane[dim].values / unit.length for dim in dims)
    return across, down, plane.transpose(*dims[::-1]).values / unit.stress


def interpolate_plane(
    case: xr.Dataset, field: xr.DataArray, position: dict[str, float], unit: Units
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions and values (down, across) of a field in a plane."""
    name = str(field.name)
    plane = in_plane(case.assign({name: field}), variables=name, **position)[name]
    horizontal, vertical = (axis for axis in "xyz" if axis not in position)
    return _plane_arrays(plane, horizontal, vertical, unit)


def plot_stress_plane(
    dataset: xr.Dataset,
    variable: str = "von_mises",
    *,
    y: float | None = None,
    ax: Axes | None = None,
    x: float | None = None,
    z: float | None = None,
    levels: Any = None,
    colorbar: bool = True,
    si: bool = False,
) -> Axes:
    """Contours of a stress in a plane ``x``, ``y`` or ``z`` = const.

    Parameters
    ----------
    dataset, ax, si
        As for :func:`plot_depth`.
    variable : str
        A stress, or a measure, see :func:`contactstudy.analysis.measure`.
    y, x, z : float, optional
        Position of the plane, metres, at most one; default: ``y = 0``. Interpolated between positions of the result.
    levels : int or sequence of float, optional
        Contour levels, or their approximate number.
    colorbar : bool
        Whether to add a colour bar.

    Returns
    -------
    Axes
        Depth points downwards. A cross marks the largest value in the body, its label the position off the plane.

    Raises
    ------
    InvalidInputError
        If the variable is missing or has fewer than two positions along an axis of the plane, the plane lies outside
        the result, more than one position is given, or the Dataset contains more than one case.

    Examples
    --------
    >>> field = xr.DataArray([[[1.0, 4.0]], [[2.0, 3.0]]], dims=("x", "y", "z"),
    ...                      coords={"x": [0.0, 1.0], "y": [0.0], "z": [0.0, 1.0]})
    >>> case = xr.Dataset({"von_mises": field, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_stress_plane(case).get_ylabel()
    'depth, $z/a$'
    """
    case = single_case(dataset)
    unit = units(case, si=si)
    plane_position = {axis: value for axis, value in (("x", x), ("y", y), ("z", z)) if value is not None} or {"y": 0.0}
    field, bound = cap_field(case, measure(case, variable))
    across, depths, values = interpolate_plane(case, field, plane_position, unit)
    ((normal, position),) = plane_position.items()
    horizontal, vertical = (axis for axis in "xyz" if axis != normal)
    ax = new_axes(ax, (6.4, 3.2))
    contours = _draw_contours(ax, across, depths, values, LEVELS if levels is None else levels)
    if vertical == "z":
        ax.set_ylim(depths.max(), depths.min())
    ax.set_title(f"plane {unit.position(normal, position)}", fontsize="medium")
    mark_largest(ax, case, variable, {normal: position}, unit)
    if colorbar:
        is_clipped = bound < np.inf and np.asarray(contours.levels).max() >= bound / unit.stress
        label = unit.stress_label(variable) + (" (unbounded at the singular end)" if is_clipped else "")
        fold_labels(ax.figure.colorbar(contours, ax=ax, label=label).ax)
    label_axes(ax, unit.axis_label(horizontal), unit.axis_label(vertical))
    return ax


def mark_largest(ax: Axes, case: xr.Dataset, variable: str, plane: dict[str, float], unit: Units) -> None:
    """Mark the largest value in the body, ``peak_<variable>``, with its distance from the plane unless it is 0."""
    name = f"peak_{variable}"
    if any(f"{name}{suffix}" not in case for suffix in ("", "_x", "_y", "_z")) or not np.isfinite(float(case[name])):
        return
    ((normal, position),) = plane.items()
    location = {axis: float(case[f"{name}_{axis}"]) for axis in "xyz"}
    label = np.format_float_positional(float(case[name]) / unit.stress, precision=3, fractional=False, trim="-")
    if abs(location[normal] - position) > 1e-9:
        label += f" at {unit.position(normal, location[normal])}"
    horizontal, vertical = (location[axis] / unit.length for axis in "xyz" if axis != normal)
    ax.plot(horizontal, vertical, "+", color="#e8513a", markersize=9, markeredgewidth=1.6)
    is_right = horizontal > np.mean(ax.get_xlim())  # the label lies towards the middle of the axes
    box = {"boxstyle": "round,pad=0.1", "facecolor": "white", "alpha": 0.7, "linewidth": 0}
    style: dict[str, Any] = {"bbox": box, "fontsize": "small", "va": "top", "ha": "right" if is_right else "left"}
    ax.annotate(label, (horizontal, vertical), (-6 if is_right else 6, -6), textcoords="offset points", **style)


def plot_end_face(
    dataset: xr.Dataset,
    variable: str = "von_mises",
    *,
    ax: Axes | None = None,
    end: str = "first",
    side: float = 1.0,
    distance: float | None = None,
    levels: Any = None,
    si: bool = False,
) -> Axes:
    """Contours of a stress around the edge of an end face: the face and the plane ``y = 0``, unfolded side by side.

    To the right of the fold lies the plane ``y = 0``, to its left the end face, from ``y = 0`` outwards.

    Parameters
    ----------
    dataset : Dataset
        A single case with stresses on the end face: positions of stresses with ``x = 0``, or the body's length.
    variable, ax, levels, si
        As for :func:`plot_stress_plane`.
    end : {"first", "last"}
        End: ``x = 0``, or the largest x of the stresses.
    side : {1, -1}
        Half of the face: y > 0 (the direction of sliding) or y < 0.
    distance : float, optional
        Extent along x, in the unit of the figure; default: twice the extent along y.

    Raises
    ------
    InvalidInputError
        If the variable is missing or has fewer than two positions along an axis or on the chosen side, if the stresses
        do not reach the face, or the Dataset contains more than one case.

    Examples
    --------
    >>> points = {"x": [0.0, 1.0], "y": [0.0, 1.0], "z": [0.0, 1.0]}
    >>> field = xr.DataArray([[[1.0, 4.0], [1.0, 1.0]], [[2.0, 3.0], [1.0, 1.0]]], dims=tuple(points), coords=points)
    >>> case = xr.Dataset({"von_mises": field, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_end_face(case).get_ylabel()
    'depth, $z/a$'
    """
    case = single_case(dataset)
    unit = units(case, si=si)
    checks.known_name("end", end, ("first", "last"))
    if side not in (1, -1):
        raise InvalidInputError("side", side, "1 for y > 0 or -1 for y < 0")
    x_field = positions(measure(case, variable), "x").values
    length = float(x_field.max() - x_field.min())
    face_x = float(x_field.max()) if end == "last" else 0.0
    if abs(float(x_field.min()) - face_x) > 1e-9 * length and end == "first":
        raise InvalidInputError(
            "x",
            float(x_field.min()),
            "0, the end face, for the first position of stresses",
            "include the face: solve(case, x=...) with 0 among the positions",
        )
    section = in_plane(case, variables=variable, y=0.0)[variable]
    face_stress = in_plane(case, variables=variable, x=face_x)[variable]
    y_dim = dimension_along(face_stress, "y")
    is_on_side = side * face_stress[y_dim] > 0
    # The fold belongs to both halves, and takes its values from the plane y = 0.
    fold = section.sel({dimension_along(section, "x"): face_x}).reset_coords(drop=True).expand_dims({y_dim: [0.0]})
    half_stress = xr.concat([fold, face_stress[{y_dim: is_on_side.values}]], y_dim).rename(variable)
    x, z, section_values = _plane_arrays(section, "x", "z", unit)
    y, _, face_values = _plane_arrays(half_stress, "y", "z", unit)
    x = np.abs(x - face_x / unit.length)
    limit = 2 * np.abs(y).max() if distance is None else checks.positive("distance", distance)
    near_face = x <= limit * (1 + 1e-9)
    if levels is None or np.ndim(levels) == 0:
        from matplotlib.ticker import MaxNLocator

        values = np.concatenate([section_values[:, near_face].ravel(), face_values.ravel()])
        levels = MaxNLocator(LEVELS if levels is None else levels).tick_values(values.min(), values.max())
    ax = new_axes(ax, (7.2, 3.4))
    contours = _draw_contours(ax, x[near_face], z, section_values[:, near_face], levels)
    _draw_contours(ax, -np.abs(y), z, face_values, levels)
    ax.axvline(0.0, color="black", linewidth=1.0)
    ax.set_ylim(z.max(), z.min())
    ax.xaxis.set_major_formatter(lambda value, _: f"{abs(value):g}")  # distances from the fold to both sides
    sign, unit_suffix = "" if side > 0 else "-", unit.over_length
    bar = ax.figure.colorbar(contours, ax=ax, label=unit.stress_label(variable))
    x_label = f"on the end face, ${sign}y{unit_suffix}$   |   in the plane $y = 0$, $x{unit_suffix}$ from the face"
    label_axes(ax, x_label, unit.axis_label("z"), bar.ax)
    return ax
