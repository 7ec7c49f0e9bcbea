"""Profile of a worn roller, for use in other cases: the unworn profile plus the worn depth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from contactstudy import checks
from contactstudy.analysis.provenance import check_solved_for
from contactstudy.arrays.grid import centres_of, growing_edges
from contactstudy.arrays.variables import require
from contactstudy.case.case import GAP_NODES, Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Sum
from contactstudy.profiles.measured_profile import Measured, interpolate_with_limited_slopes

ROUNDING = 1e-9  # Rounding of a relative distance
WORN_ATTRIBUTES = ("body", "roller", "end_distance")  # Equal in all cases of a worn profile, unlike load and motion
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(GAP_NODES)  # Gauss points of the mean depth of a column


def worn_profile(case: Case, worn: xr.Dataset, distance: float | None = None) -> Sum:
    """Profile of a worn roller.

    Parameters
    ----------
    case : Case
        The case of the wear.
    worn : Dataset
        Result of `wear_in` for the case.
    distance : float, optional
        Distance of the result, metres; default: the last.

    Returns
    -------
    Sum
        Sum of the unworn profile and a smooth `Measured`, whose means over the columns equal the worn depths.

    Raises
    ------
    InvalidInputError
        If the result lacks the distance, or belongs to another roller or body.

    Examples
    --------
    >>> import numpy as np
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller
    >>> body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.6e-3), max_pressure=1.5e9)
    >>> x = 1e-4 * (np.arange(6) + 0.5)
    >>> depth = xr.DataArray([[0.0] * 6, [2e-6, 1e-6, 1e-6, 1e-6, 1e-6, 2e-6]], dims=("distance", "x"))
    >>> pressure = xr.zeros_like(depth).expand_dims(y=[0.0], axis=-1)
    >>> worn = xr.Dataset({"wear_depth": depth, "pressure": pressure}, {"distance": [0.0, 1e3], "x": x})
    >>> (1e6 * worn_profile(case, worn).drop(x[:3] - 3e-4, 0.6e-3)).round(6).tolist()
    [2.0, 1.0, 1.0]
    """
    checks.instance("case", case, Case, "a Case")
    require(worn, "wear_depth", "pressure", argument="worn")
    check_solved_for(worn, case, "worn", compared_names=WORN_ATTRIBUTES)
    if "distance" not in worn.dims:
        worn = worn.expand_dims("distance")
    distances = worn["distance"].values
    index = distances.size - 1
    if distance is not None:
        requested = checks.not_negative("distance", distance, "metres")
        index = int(np.abs(distances - requested).argmin())
        if not np.isclose(distances[index], requested, rtol=1e-9, atol=0.0):
            raise InvalidInputError("distance", requested, f"a distance of the result, such as {distances[index]:g} m")
    mid_length = case.roller_middle
    x = worn["x"].values - mid_length
    start, stop = (end - mid_length for end in case.contact_range)
    rounding = ROUNDING * case.roller.length
    in_contact = (x >= start - rounding) & (x <= stop + rounding)
    columns = _Columns.of(worn, x, in_contact, start, stop)
    depth = worn["wear_depth"].values[index, in_contact]
    end_depth = _sharp_end_depth(case, columns, depth, worn["pressure"].values[index, in_contact])
    return Sum((case.roller.profile, _fit_profile(case, columns, end_depth, depth)))


@dataclass(frozen=True, eq=False)
class _Columns:
    """Columns in the contact, and the Gauss points (column, node) of each column's mean depth."""

    edges: FloatArray
    points: FloatArray

    @classmethod
    def of(cls, worn: xr.Dataset, x: FloatArray, in_contact: NDArray[np.bool_], start: float, stop: float) -> _Columns:
        """Return the columns of a result, with uniform or different widths."""
        centres = x[in_contact]
        uniform = "x_width" not in worn.coords
        widths = np.full(centres.size, (x[-1] - x[0]) / (x.size - 1)) if uniform else worn["x_width"].values[in_contact]
        edges = np.append(centres - 0.5 * widths, centres[-1] + 0.5 * widths[-1])
        clipped = np.clip(edges, start, stop)
        points = 0.5 * (clipped[1:] + clipped[:-1])[:, None] + 0.5 * np.diff(clipped)[:, None] * GAUSS_POINTS
        # A uniform cell has the gap at its midpoint, unless the end cuts the cell.
        rounding = ROUNDING * (stop - start)
        is_uncut = uniform & (edges[:-1] >= start - rounding) & (edges[1:] <= stop + rounding)
        return cls(clipped, np.where(is_uncut[:, None], centres[:, None], points))

    def mean_depths(self, profile: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Mean depths of a profile over the columns."""
        return np.asarray(0.5 * profile(self.points.ravel()).reshape(self.points.shape) @ GAUSS_WEIGHTS)


def _sharp_end_depth(
    case: Case, columns: _Columns, depth: FloatArray, pressure: FloatArray
) -> Callable[[FloatArray], FloatArray]:
    """Depth of the slope ``2 p / (pi E') ln s`` at a distance s from sharp ends (Johnson, section 2.5).

    The slope is at most the worn slope, and zero at an end of the body.
    """
    ends, length = np.array(case.contact_range), case.contact_length
    modulus = case.body.material.plane_strain_modulus
    inward_slopes = np.array([depth[0] - depth[1], depth[-1] - depth[-2]]) / np.diff(centres_of(columns.edges))[[0, -1]]
    outer_lengths = np.abs(ends - case.body.extent)
    pressures = [float(column[column > 0].mean()) if (column > 0).any() else 0.0 for column in pressure[[0, -1]]]
    slopes = np.clip(2 * np.array(pressures) / (np.pi * modulus), 0.0, np.maximum(inward_slopes, 0.0))
    slopes[outer_lengths <= np.diff(columns.edges)[[0, -1]]] = 0.0

    def depth_at(x: FloatArray) -> FloatArray:
        distances = np.abs(x[..., None] - (ends - case.roller_middle)) / length
        distances = np.maximum(distances, np.finfo(np.float64).tiny)
        return np.asarray((slopes * length * distances * np.log(distances)).sum(axis=-1))

    return depth_at


def _fit_profile(
    case: Case, columns: _Columns, end_depth: Callable[[FloatArray], FloatArray], depth: FloatArray
) -> Measured:
    """Smooth profile with the mean depth of every column: the slope of a spline through the area worn off up to x."""
    half_length = 0.5 * case.roller.length
    start, stop = (end - case.roller_middle for end in case.contact_range)
    remainder = depth - columns.mean_depths(end_depth)
    volume = np.concatenate([[0.0], np.cumsum(remainder * np.diff(columns.edges))])
    spline = make_interp_spline(columns.edges, volume, k=min(3, depth.size)).derivative()
    borders = _interpolate_borders(case, columns, depth)
    edges, midpoints = columns.edges, centres_of(columns.edges)
    # Points between the outer column's midpoint and the end; each point is half as far from the end as the one before
    fractions = 0.5 ** np.arange(1, 11)
    low, high = (start + fractions * (midpoints[0] - start), stop - fractions * (stop - midpoints[-1]))
    positions = np.concatenate([[start], np.sort(np.concatenate([low, high, edges[1:-1], midpoints])), [stop]])
    for border in borders:
        border_points = np.linspace(border.x[0], border.x[-1], 8 * border.x.size)  # points in each column
        is_distinct = np.abs(positions - border_points[:, None]).min(axis=1) > ROUNDING * case.roller.length
        positions = np.sort(np.append(positions, border_points[is_distinct]))
    points = np.maximum(spline(positions) + end_depth(positions), 0.0)
    is_corrected = np.ones(depth.size, dtype=bool)
    for border in borders:
        in_border = (positions >= border.x[0]) & (positions <= border.x[-1])
        unworn_drop = case.roller.profile.drop(positions[in_border], case.roller.length)
        points[in_border] = np.maximum(border(positions[in_border]) - unworn_drop, 0.0)
        is_corrected &= (midpoints < border.x[0]) | (midpoints > border.x[-1])
    index = np.searchsorted(positions, midpoints)
    profile = _create_measured(half_length, positions, points)
    for _ in range(8):  # Rounds that move the points until the interpolation has the depth of every column
        mean_depths = columns.mean_depths(lambda x: profile.drop(x, case.roller.length))  # noqa: B023, called at once
        points[index] = np.maximum(points[index] + np.where(is_corrected, depth - mean_depths, 0.0), 0.0)
        profile = _create_measured(half_length, positions, points)
    return profile


def _interpolate_borders(case: Case, columns: _Columns, depth: FloatArray) -> list[Any]:
    """Interpolation of the worn shape, without a ridge, next to the first unworn columns."""
    borders: list[Any] = []
    worn_columns = np.flatnonzero(depth > 0)
    if not worn_columns.size:
        return borders
    shape = depth + columns.mean_depths(lambda x: case.roller.profile.drop(x, case.roller.length))
    for first_unworn, step in ((worn_columns[0] - 1, 1), (worn_columns[-1] + 1, -1)):
        if 0 <= first_unworn < depth.size:
            # Columns next to the border, in which the worn shape is interpolated instead of the depth
            indices = np.sort(first_unworn + step * np.arange(5))
            indices = indices[(indices >= 0) & (indices < depth.size)]
            if np.isfinite(shape[indices]).all() and indices.size > 2:
                borders.append(interpolate_with_limited_slopes(centres_of(columns.edges)[indices], shape[indices]))
    return borders


def _create_measured(half_length: float, positions: FloatArray, depth: FloatArray) -> Measured:
    """Worn depth between the ends of the contact as a profile of the roller's length."""
    # The roller does not wear beyond the body; the steps of a measured profile may grow by this factor.
    edges_before = growing_edges(positions[0] + half_length, positions[1] - positions[0], 2.0)[::-1]
    edges_after = growing_edges(half_length - positions[-1], positions[-1] - positions[-2], 2.0)
    x = np.concatenate([positions[0] - edges_before, positions, positions[-1] + edges_after])
    drops = np.concatenate([np.zeros(edges_before.size), depth, np.zeros(edges_after.size)])
    return Measured((half_length + x).tolist(), drops.tolist(), largest_spike=half_length)
