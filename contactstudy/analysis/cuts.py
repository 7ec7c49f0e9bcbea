"""Fields along any line and in any plane of the body, interpolated between the points of a result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, positions, single_case
from contactstudy.analysis.fields import fields_on_one_grid
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import AXES, labels
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

ROUNDING = 1e-9
"""Positions may lie outside the points of a result by this fraction of their range. Accuracy."""


def _inside(name: str, values: FloatArray, place: FloatArray) -> FloatArray:
    """Values clipped by rounding errors to the range of `place`; raise for any outside."""
    low, high = float(place.min()), float(place.max())
    rounding = ROUNDING * max(high - low, abs(high), abs(low))
    outside = (values < low - rounding) | (values > high + rounding)
    if outside.any():
        hint = "solve with positions there" if low < high else "the result holds this plane only"
        raise InvalidInputError(name, float(values[outside][0]), f"within the result, {low:g} to {high:g} m", hint)
    return np.clip(values, low, high)


def _interpolate(array: xr.DataArray, where: dict[str, xr.DataArray]) -> xr.DataArray:
    """Linear interpolation along the axes in `where`, which may share a new dimension."""
    targets, along = {}, axis_dimensions(array)
    for axis, target in where.items():
        if axis not in along:
            continue
        dim = along[axis]
        place = positions(array, axis)
        if array.sizes[dim] == 1:
            array = array.isel({dim: 0}, drop=True)
        else:
            array = array.assign_coords({dim: place}).sortby(dim)
            if target.ndim:
                targets[dim] = target
            else:
                array = _at(array, dim, float(target))
    return array.interp(targets) if targets else array


def _at(array: xr.DataArray, dim: str, place: float) -> xr.DataArray:
    """Linear interpolation to one position: between two planes only, and so without SciPy, which takes long to load."""
    values = array[dim].values
    right = int(np.clip(np.searchsorted(values, place), 1, values.size - 1))
    part = float((place - values[right - 1]) / (values[right] - values[right - 1]))
    before, after = (array.isel({dim: at}, drop=True) for at in (right - 1, right))
    # The nearer plane alone where that is exact: what lies beside it may be infinite.
    return before if part == 0 else after if part == 1 else (1 - part) * before + part * after


def along_line(
    dataset: xr.Dataset,
    start: Sequence[float],
    end: Sequence[float],
    *,
    points: int = 101,
    variables: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Fields along a straight line, linearly interpolated.

    Parameters
    ----------
    dataset : Dataset
        One case.
    start, end : sequence of float
        Ends of the line, metres: (x, y, z), or (x, y) for fields on the surface.
    points : int
        Number of points, at least 2.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`, on the same points; default: all stresses,
        or all surfaces if there are none.

    Returns
    -------
    Dataset
        Along `distance` (m, from `start`), with the coordinates `x`, `y`, `z` of the points. For values without
        interpolation, see `contactstudy.stress_field` at these positions.

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
    require(dataset)
    one = single_case(dataset)
    count = checks.count("points", points, least=2)
    fields = fields_on_one_grid(one, variables, along=("x", "y"))
    ends = [checks.coordinates(name, values) for name, values in (("start", start), ("end", end))]
    size = ends[0].size
    if size not in (2, 3) or ends[1].size != size:
        raise InvalidInputError("start, end", (start, end), "both (x, y, z), or both (x, y), in metres")
    along = axis_dimensions(next(iter(fields.values())))
    if "z" in along and size == 2:
        raise InvalidInputError("start, end", (start, end), "(x, y, z) for fields below the surface")
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if length == 0:
        raise InvalidInputError("end", end, "different from start")
    share = np.linspace(0.0, 1.0, count)
    where = {}
    for axis, low, high in zip(AXES, *ends, strict=False):
        values = low + share * (high - low)
        if axis in along:
            values = _inside(axis, values, positions(next(iter(fields.values())), axis).values)
        where[axis] = xr.DataArray(values, dims="distance", attrs=labels(axis, coordinate=True))
    distance = ("distance", share * length, labels("distance", coordinate=True))
    return _assemble(fields, where).assign_coords({"distance": distance, **where})


def in_plane(
    dataset: xr.Dataset,
    *,
    x: float | None = None,
    y: float | None = None,
    z: float | None = None,
    variables: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Fields in a plane ``x``, ``y`` or ``z`` = const, linearly interpolated between the two nearest ones.

    Parameters
    ----------
    dataset : Dataset
        One case.
    x, y, z : float, optional
        Position of the plane, metres; exactly one of them.
    variables : str or sequence of str, optional
        As for :func:`along_line`.

    Returns
    -------
    Dataset
        Along the other two axes, with the plane's position as a scalar coordinate.

    Raises
    ------
    InvalidInputError
        If not exactly one position is given, the plane lies outside the result, or the variables are missing or lie
        on different points.

    Examples
    --------
    >>> field = xr.DataArray([[0.0, 1.0], [2.0, 3.0]], dims=("x", "z"), coords={"x": [0.0, 1.0], "z": [0.0, 1.0]})
    >>> in_plane(xr.Dataset({"tresca": field}), x=0.5, variables="tresca").tresca.values.tolist()
    [1.0, 2.0]
    """
    require(dataset)
    one = single_case(dataset)
    given = {axis: value for axis, value in zip(AXES, (x, y, z), strict=True) if value is not None}
    if len(given) != 1:
        raise InvalidInputError("x, y, z", (x, y, z), "exactly one of them a number, the others None")
    ((axis, value),) = given.items()
    fields = fields_on_one_grid(one, variables, along=("x", "y"))
    first = next(iter(fields.values()))
    if axis not in axis_dimensions(first):
        raise InvalidInputError("variables", list(fields), f"fields along {axis}")
    place = _inside(axis, np.array([checks.finite(axis, value, "metres")]), positions(first, axis).values)
    at = xr.DataArray(place[0], attrs=labels(axis, coordinate=True))
    return _assemble(fields, {axis: at}).assign_coords({axis: at})


def _assemble(fields: dict[str, xr.DataArray], where: dict[str, xr.DataArray]) -> xr.Dataset:
    """Every field interpolated; the coordinates that the positions replace are dropped."""
    cut = {}
    for name, array in fields.items():
        value = _interpolate(array, where)
        replaced = [coordinate for coordinate in value.coords if coordinate not in value.dims]
        cut[name] = value.drop_vars(replaced).assign_attrs(array.attrs)
    return xr.Dataset(cut)
