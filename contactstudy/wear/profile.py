"""A worn profile as one that other cases can take: the unworn one, and the worn depth on top of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator, make_interp_spline

from contactstudy import checks
from contactstudy.analysis.provenance import check_solved_for
from contactstudy.arrays.grid import growing_edges
from contactstudy.arrays.variables import require
from contactstudy.case.case import Case
from contactstudy.case.roller import GAP_NODES
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Sum
from contactstudy.profiles.measured import Measured

ROUNDING = 1e-9  # Distance over another that is rounding
SAME_ROLLER = ("body", "roller", "end_distance")  # Parts of the case that wear; load, friction and motion may differ
NODES, WEIGHTS = np.polynomial.legendre.leggauss(GAP_NODES)  # Gauss points of the mean depth of a column


def worn_profile(case: Case, worn: xr.Dataset, distance: float | None = None) -> Sum:
    """Profile of a worn roller.

    Parameters
    ----------
    case : Case
        The case that wore.
    worn : Dataset
        Result of `wear_in` for the case.
    distance : float, optional
        One of its distances, metres; default: the last.

    Returns
    -------
    Sum
        Of the unworn profile and of the worn depth as a smooth `Measured`. Over columns of different widths its means
        are the depths that wore off.

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
    check_solved_for(worn, case, "worn", only=SAME_ROLLER)
    if "distance" not in worn.dims:
        worn = worn.expand_dims("distance")
    distances = worn["distance"].values
    index = distances.size - 1
    if distance is not None:
        requested = checks.not_negative("distance", distance, "metres")
        index = int(np.abs(distances - requested).argmin())
        if not np.isclose(distances[index], requested, rtol=1e-9, atol=0.0):
            raise InvalidInputError("distance", requested, f"a distance of the result, such as {distances[index]:g} m")
    middle = case.roller_middle
    x = worn["x"].values - middle
    start, stop = (end - middle for end in case.contact_range)
    rounding = ROUNDING * case.roller.length
    under = (x >= start - rounding) & (x <= stop + rounding)
    columns = _Columns.of(worn, x, under, start, stop)
    depth = worn["wear_depth"].values[index, under]
    ends = _Ends.of(case, columns, depth, worn["pressure"].values[index, under])
    profile = _through(case, columns, ends, depth)
    unworn = case.roller.profile
    return Sum((*(unworn.terms if isinstance(unworn, Sum) else (unworn,)), profile))


@dataclass(frozen=True, eq=False)
class _Columns:
    """Columns in the contact, from mid-length, and the points (column, node) at which a profile gives their depth."""

    edges: FloatArray
    points: FloatArray

    @classmethod
    def of(cls, worn: xr.Dataset, x: FloatArray, under: NDArray[np.bool_], start: float, stop: float) -> _Columns:
        """Columns of a result, of different widths or all alike."""
        centres = x[under]
        alike = "x_width" not in worn.coords
        widths = np.full(centres.size, (x[-1] - x[0]) / (x.size - 1)) if alike else worn["x_width"].values[under]
        edges = np.append(centres - 0.5 * widths, centres[-1] + 0.5 * widths[-1])
        within = np.clip(edges, start, stop)
        points = 0.5 * (within[1:] + within[:-1])[:, None] + 0.5 * np.diff(within)[:, None] * NODES
        # The gap of a uniform cell is taken at its middle, unless the end cuts the cell.
        slack = ROUNDING * (stop - start)
        uncut = alike & (edges[:-1] >= start - slack) & (edges[1:] <= stop + slack)
        return cls(within, np.where(uncut[:, None], centres[:, None], points))

    @property
    def middles(self) -> FloatArray:
        """Middles of the columns."""
        return np.asarray(0.5 * (self.edges[1:] + self.edges[:-1]))

    def depths(self, profile: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Depth that each column takes of a profile."""
        return np.asarray(0.5 * profile(self.points.ravel()).reshape(self.points.shape) @ WEIGHTS)


@dataclass(frozen=True, eq=False)
class _Ends:
    """Depth from pressure up to a sharp end: near it the body sinks in like ``s ln s``, s from the end.

    The slope is ``2 p / (pi E') ln s`` (Johnson, section 2.5); a profile without it is a punch of unbounded pressure.
    """

    places: tuple[float, float]
    slopes: tuple[float, float]
    length: float

    @classmethod
    def of(cls, case: Case, columns: _Columns, depth: FloatArray, pressure: FloatArray) -> _Ends:
        """Both ends of the contact: where the body goes on beyond it, and as far as the part has worn in already."""
        low, high = case.contact_range
        middle = case.roller_middle
        modulus = case.body.material.plane_strain_modulus
        inward = np.array([depth[0] - depth[1], depth[-1] - depth[-2]]) / np.diff(columns.middles)[[0, -1]]
        beyond = np.array([low - case.body.extent[0], case.body.extent[1] - high])
        loaded = [float(column[column > 0].mean()) if (column > 0).any() else 0.0 for column in pressure[[0, -1]]]
        slopes = np.clip(2 * np.array(loaded) / (np.pi * modulus), 0.0, np.maximum(inward, 0.0))
        slopes[beyond <= np.diff(columns.edges)[[0, -1]]] = 0.0
        return cls((low - middle, high - middle), (float(slopes[0]), float(slopes[1])), high - low)

    def depth(self, x: FloatArray) -> FloatArray:
        """Return this part of the depth, at distances from mid-length."""
        total = np.zeros_like(x)
        for end, slope in zip(self.places, self.slopes, strict=True):
            distance = np.maximum(np.abs(x - end) / self.length, np.finfo(np.float64).tiny)
            total += slope * self.length * distance * np.log(distance)
        return total


def _through(case: Case, columns: _Columns, ends: _Ends, depth: FloatArray) -> Measured:
    """Smooth profile with the depth of every column: slope of a spline of the worn area without the ends."""
    half, (start, stop) = 0.5 * case.roller.length, ends.places
    remainder = depth - columns.depths(ends.depth)
    volume = np.concatenate([[0.0], np.cumsum(remainder * np.diff(columns.edges))])
    spline = make_interp_spline(columns.edges, volume, k=min(3, depth.size)).derivative()
    borders = _borders(case, columns, depth)
    edges, middles = columns.edges, columns.middles
    # Points between the outer column's middle and the end, each half as far from it as the one before
    closer = 0.5 ** np.arange(1, 11)
    first, last = start + closer * (middles[0] - start), stop - closer * (stop - middles[-1])
    places = np.concatenate([[start], np.sort(np.concatenate([first, last, edges[1:-1], middles])), [stop]])
    for border in borders:
        more = np.linspace(border.x[0], border.x[-1], 8 * border.x.size)  # points in each column
        apart = np.abs(places - more[:, None]).min(axis=1) > ROUNDING * case.roller.length
        places = np.sort(np.append(places, more[apart]))
    points = np.maximum(spline(places) + ends.depth(places), 0.0)
    corrected = np.ones(depth.size, dtype=bool)
    for border in borders:
        near = (places >= border.x[0]) & (places <= border.x[-1])
        unworn = case.roller.profile.drop(places[near], case.roller.length)
        points[near] = np.maximum(border(places[near]) - unworn, 0.0)
        corrected &= (middles < border.x[0]) | (middles > border.x[-1])
    nearest = np.searchsorted(places, middles)
    profile = _measured(half, places, points)
    for _ in range(8):  # Rounds that move the points until the interpolation has the depth of every column
        means = columns.depths(lambda x: profile.drop(x, case.roller.length))  # noqa: B023, called at once
        points[nearest] = np.maximum(points[nearest] + np.where(corrected, depth - means, 0.0), 0.0)
        profile = _measured(half, places, points)
    return profile


def _borders(case: Case, columns: _Columns, depth: FloatArray) -> list[PchipInterpolator]:
    """Worn shape beside the borders of the wear, up to the first unworn column: monotone, without a ridge."""
    borders: list[PchipInterpolator] = []
    worn = np.flatnonzero(depth > 0)
    if not worn.size:
        return borders
    shape = depth + columns.depths(lambda x: case.roller.profile.drop(x, case.roller.length))
    for outer, step in ((worn[0] - 1, 1), (worn[-1] + 1, -1)):
        if 0 <= outer < depth.size:
            # Worn columns beside the border of the wear with an interpolation of the worn shape instead of the depth
            numbers = np.sort(outer + step * np.arange(5))
            numbers = numbers[(numbers >= 0) & (numbers < depth.size)]
            if np.isfinite(shape[numbers]).all() and numbers.size > 2:
                borders.append(PchipInterpolator(columns.middles[numbers], shape[numbers]))
    return borders


def _measured(half: float, places: FloatArray, depth: FloatArray) -> Measured:
    """Worn depth from the one end of the contact to the other as a profile of the roller's length."""
    # Where the roller overhangs the body nothing is worn off; a measured profile may have steps of this growth.
    before = growing_edges(places[0] + half, places[1] - places[0], 2.0)[::-1]
    behind = growing_edges(half - places[-1], places[-1] - places[-2], 2.0)
    x = np.concatenate([places[0] - before, places, places[-1] + behind])
    drops = np.concatenate([np.zeros(before.size), depth, np.zeros(behind.size)])
    return Measured((half + x).tolist(), drops.tolist(), largest_spike=half)
