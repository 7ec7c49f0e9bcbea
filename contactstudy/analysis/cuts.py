"""Fields along a line and in a plane of the body, interpolated between the points of a result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, positions, single_case
from contactstudy.analysis.peaks import measure
from contactstudy.arrays.variables import AXES, labels
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


def select_arrays(dataset: xr.Dataset, variables: str | Sequence[str] | None) -> dict[str, xr.DataArray]:
    """Return variables or measures by name; default: all variables."""
    if variables is None:
        return {str(name): array for name, array in dataset.data_vars.items()}
    return {name: measure(dataset, name) for name in ([variables] if isinstance(variables, str) else variables)}


def fields_on_same_points(
    dataset: xr.Dataset, variables: str | Sequence[str] | None, *, along: Sequence[str] = ()
) -> dict[str, xr.DataArray]:
    """Return fields on the same points, by name; default: fields along the axes `along`, in the body or on its top."""
    if variables is not None:
        fields = select_arrays(dataset, variables)
    else:
        axes = {str(name): axis_dimensions(array) for name, array in dataset.data_vars.items()}
        field_names = [name for name, dims in axes.items() if len(dims) > 1 and set(along) <= set(dims)]
        stresses = [name for name in field_names if "z" in axes[name]]
        fields = {name: dataset[name] for name in stresses or field_names}
    point_dims = {tuple(axis_dimensions(array).values()) for array in fields.values()}
    if len(point_dims) != 1 or point_dims == {()}:
        raise InvalidInputError(
            "variables", variables or "all", "fields on the same points along x, y or z", describe_points(fields)
        )
    return fields


def describe_points(arrays: dict[str, xr.DataArray]) -> str:
    """Return the text of a hint: the variables, grouped by their points."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for name, array in arrays.items():
        groups.setdefault(tuple(map(str, array.dims)), []).append(name)
    texts = [f"{', '.join(names)} ({', '.join(dims) or 'a single number'})" for dims, names in groups.items()]
    return f"name variables on the same points: {' or '.join(texts)}" if texts else "the dataset has no such variable"


def along_line(
    dataset: xr.Dataset,
    start: Sequence[float],
    end: Sequence[float],
    *,
    points: int = 101,
    variables: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Return fields along a straight line, linearly interpolated.

    Parameters
    ----------
    dataset : Dataset
        One case.
    start, end : sequence of float
        Ends of the line, metres: (x, y, z), or (x, y) for fields on the surface.
    points : int
        Number of points, at least 2.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`; default: all stresses, else all surfaces.

    Returns
    -------
    Dataset
        Along `distance` (m, from `start`), with the coordinates `x`, `y`, `z` of the points.

    Raises
    ------
    InvalidInputError
        If the line leaves the points of the result, its ends are not two or three finite numbers or coincide, or
        the variables are missing or lie on different points.

    Examples
    --------
    >>> field = xr.DataArray([[0.0, 1.0], [2.0, 3.0]], dims=("x", "z"), coords={"x": [0.0, 1.0], "z": [0.0, 1.0]})
    >>> cut = along_line(xr.Dataset({"tresca": field}), (0, 0, 0), (1, 0, 1), points=3, variables="tresca")
    >>> cut.tresca.values.tolist()
    [0.0, 1.5, 3.0]
    """
    point_count = checks.count("points", points, minimum=2)
    fields = fields_on_same_points(single_case(dataset), variables, along=("x", "y"))
    start_point, end_point = (checks.coordinates(name, values) for name, values in (("start", start), ("end", end)))
    if start_point.size not in (2, 3) or end_point.size != start_point.size:
        raise InvalidInputError("start, end", (start, end), "both (x, y, z), or both (x, y), in metres")
    field = next(iter(fields.values()))
    axes = axis_dimensions(field)
    if "z" in axes and start_point.size == 2:
        raise InvalidInputError("start, end", (start, end), "(x, y, z) for fields below the surface")
    length = float(np.linalg.norm(end_point - start_point))
    if length == 0:
        raise InvalidInputError("end", end, "different from start")
    fraction = np.linspace(0.0, 1.0, point_count)
    targets = {}
    for axis, start_coordinate, end_coordinate in zip(AXES, start_point, end_point, strict=False):
        values = start_coordinate + fraction * (end_coordinate - start_coordinate)
        if axis in axes:
            values = _clip_to_points(axis, values, positions(field, axis).values)
        targets[axis] = xr.DataArray(values, dims="distance", attrs=labels(axis, coordinate=True))
    distance = ("distance", fraction * length, labels("distance", coordinate=True))
    values = {name: _interpolate(array, targets) for name, array in fields.items()}
    return xr.Dataset(values).assign_coords({"distance": distance, **targets})


def in_plane(
    dataset: xr.Dataset,
    *,
    x: float | None = None,
    y: float | None = None,
    z: float | None = None,
    variables: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Return fields in a plane ``x``, ``y`` or ``z`` = const, by linear interpolation between the nearest points.

    Parameters
    ----------
    dataset, variables
        As for :func:`along_line`.
    x, y, z : float, optional
        Position of the plane, metres; exactly one of them.

    Returns
    -------
    Dataset
        Along the other two axes, with the plane's position as a scalar coordinate.

    Raises
    ------
    InvalidInputError
        Unless exactly one position is a number within the result; if variables are missing or on different points.

    Examples
    --------
    >>> field = xr.DataArray([[0.0, 1.0], [2.0, 3.0]], dims=("x", "z"), coords={"x": [0.0, 1.0], "z": [0.0, 1.0]})
    >>> in_plane(xr.Dataset({"tresca": field}), x=0.5, variables="tresca").tresca.values.tolist()
    [1.0, 2.0]
    """
    planes = {axis: value for axis, value in zip(AXES, (x, y, z), strict=True) if value is not None}
    if len(planes) != 1:
        raise InvalidInputError("x, y, z", (x, y, z), "exactly one of them a number, the others None")
    ((axis, value),) = planes.items()
    fields = fields_on_same_points(single_case(dataset), variables, along=("x", "y"))
    field = next(iter(fields.values()))
    if axis not in axis_dimensions(field):
        raise InvalidInputError("variables", list(fields), f"fields along {axis}")
    position = _clip_to_points(axis, np.array([checks.finite(axis, value, "metres")]), positions(field, axis).values)
    target = xr.DataArray(position[0], attrs=labels(axis, coordinate=True))
    values = {name: _interpolate(array, {axis: target}) for name, array in fields.items()}
    return xr.Dataset(values).assign_coords({axis: target})


def _clip_to_points(name: str, values: FloatArray, points: FloatArray) -> FloatArray:
    """Clip values to the range of `points`; raise for values beyond the range by more than rounding."""
    low, high = float(points.min()), float(points.max())
    # Distance beyond the points of a result that counts as rounding, m
    rounding = 1e-9 * max(high - low, abs(high), abs(low))
    is_outside = (values < low - rounding) | (values > high + rounding)
    if is_outside.any():
        hint = "solve with positions at this plane" if low < high else "the result contains this plane only"
        raise InvalidInputError(name, float(values[is_outside][0]), f"within the result, {low:g} to {high:g} m", hint)
    return np.clip(values, low, high)


def _interpolate(array: xr.DataArray, targets: dict[str, xr.DataArray]) -> xr.DataArray:
    """Interpolate linearly along the axes of `targets`, which may share a new dimension; they become coordinates."""
    line_targets, axes, attributes = {}, axis_dimensions(array), array.attrs
    for axis, target in targets.items():
        if axis not in axes:
            continue
        dim = axes[axis]
        if array.sizes[dim] == 1:
            array = array.isel({dim: 0}, drop=True)
            continue
        array = array.assign_coords({dim: positions(array, axis)}).sortby(dim)
        if target.ndim:
            line_targets[dim] = target
        else:
            position = float(target)
            values = array[dim].values
            upper_index = int(np.clip(np.searchsorted(values, position), 1, values.size - 1))
            weight = float((position - values[upper_index - 1]) / (values[upper_index] - values[upper_index - 1]))
            lower, upper = (array.isel({dim: index}, drop=True) for index in (upper_index - 1, upper_index))
            # At a plane of points the neighbouring plane has zero weight, but its values may be infinite.
            array = lower if weight == 0 else upper if weight == 1 else (1 - weight) * lower + weight * upper
    return (array.interp(line_targets) if line_targets else array).assign_attrs(attributes).reset_coords(drop=True)
