"""Positions of fields: the tensor product of any x, y and z inside a body, and the default positions of stresses."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.variables import in_si
from contactstudy.bodies.models import Body, Extent
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.errors import InvalidInputError

MAX_DISTANCE = 1e4  # largest distance of a position over the size of load and body, for bounded work. Limit.
SPACING_GROWTH = 0.5  # growth of the default spacing with the distance from a peak or an end. Accuracy.
MAX_SPACING = 0.2  # default spacing at a free end and below the top over the half-width. Accuracy.
MAX_DEFAULT_DEPTH = 5.0  # largest default depth, over the Hertz half-width. Accuracy.

STRESS_DEPTH, STRESS_DEPTH_RANGE = 0.6, (0.01, 0.75)
"""Depth of the largest stress below a peak of the pressure, over the peak's width (under a line contact 0.70, under a
sphere 0.48), and its range over the Hertz half-width. Accuracy."""

Positions = Sequence[float] | npt.ArrayLike
Labels = tuple[FloatArray, FloatArray]


class FieldPositions(NamedTuple):
    """Checked positions, metres."""

    points: Points
    coordinates_x: FloatArray  # coordinates of the result; by default the unrounded coordinates of the pressure
    coordinates_y: FloatArray

    def dataset(self, fields: Mapping[str, FloatArray]) -> xr.Dataset:
        """Label fields (x, y, z)."""
        return xr.Dataset(
            {name: (("x", "y", "z"), components) for name, components in fields.items()},
            coords={"x": self.coordinates_x, "y": self.coordinates_y, "z": self.points.z},
        )


def field_positions(
    body: Body, grid: Grid, x: Positions | None, y: Positions | None, z: Positions, labels: Labels | None = None
) -> FieldPositions:
    """Positions of a field in a body."""
    body.check_span(grid)
    axes = {"x": grid.x if x is None else x, "y": grid.y if y is None else y, "z": z}
    points = Points(*(checks.coordinates(axis, in_si(axis, coordinates, "m")) for axis, coordinates in axes.items()))
    points = points._replace(x=_snap_into_body(body, points.x, grid))
    if (points.z < 0).any():
        raise InvalidInputError("z", float(points.z.min()), "not negative (metres below the top)")
    low, high = body.extent
    extent_size = max(grid.x_range[1] - grid.x_range[0], grid.y_range[1] - grid.y_range[0])
    extent_size = max(extent_size, high - low) if np.isfinite([low, high]).all() else extent_size
    for name, coordinates in zip("xyz", points, strict=True):
        farthest = float(coordinates[np.abs(coordinates).argmax()])
        if abs(farthest) > MAX_DISTANCE * extent_size:
            raise InvalidInputError(
                name,
                farthest,
                f"within {MAX_DISTANCE:g} times the size of load and body, {MAX_DISTANCE * extent_size:g} m",
            )
    coordinates_x, coordinates_y = labels or (grid.x, grid.y)
    return FieldPositions(points, coordinates_x if x is None else points.x, coordinates_y if y is None else points.y)


def _snap_into_body(body: Body, x: FloatArray, grid: Grid) -> FloatArray:
    """Move positions within rounding of an end onto the end; raise for positions outside the body."""
    low, high = body.extent
    rounding = 1e-9 * grid.dx
    is_outside = (x < low - rounding) | (x > high + rounding)
    if is_outside.any():
        raise InvalidInputError("x", float(x[is_outside][0]), f"inside the body, {low:g} to {high:g} m")
    return np.where(x < low + rounding, low, np.where(x > high - rounding, high, x))


def default_columns(grid: Grid, extent: Extent, is_loaded: BoolArray, half_width: float) -> FloatArray:
    """Positions along x from one end of the body, or of the grid, to the other, in either half graded from its end."""
    # The spacing equals two widths of a loaded column at its centre, and a fifth of the half-width at the ends.
    ends = np.array([end if np.isfinite(end) else edge for end, edge in zip(extent, grid.x_range, strict=True)])
    spacings = np.append(2 * grid.widths[is_loaded], np.full(2, MAX_SPACING * half_width))
    centres, half_length = np.append(grid.x[is_loaded], ends), 0.5 * float(ends[1] - ends[0])
    first_half, second_half = (
        _grade_positions([0.0, half_length], distances, spacings)
        for distances in (centres - ends[0], ends[1] - centres)
    )
    if grid.is_symmetric and np.array_equal(is_loaded, is_loaded[::-1]):
        second_half = first_half  # without their different rounding
    return np.concatenate([ends[0] + first_half, ends[1] - second_half[-2::-1]])


def default_depths(half_width: float, peak_width: float) -> FloatArray:
    """Depths from 0 to five half-widths, narrow from the top to the depth of the largest stress below a peak."""
    # The depth is rounded to a power of the square root of 2, so that similar cases share their positions.
    depth = np.clip(STRESS_DEPTH * peak_width / half_width, *STRESS_DEPTH_RANGE)
    peak_depth = 2.0 ** (0.5 * round(2 * float(np.log2(depth))))
    peak_spacing, fixed_depths = min(0.2 * peak_depth, MAX_SPACING), {0.0, min(peak_depth, 1.0), MAX_DEFAULT_DEPTH}
    depths = _grade_positions(
        sorted(fixed_depths),
        np.array([0.0, peak_depth, 0.5, 1.0]),
        np.array([peak_spacing, peak_spacing, MAX_SPACING, MAX_SPACING]),
    )
    return half_width * depths


def _grade_positions(fixed_positions: Sequence[float], centres: FloatArray, spacings: FloatArray) -> FloatArray:
    """Positions between increasing fixed positions; the spacing grows with the distance from each centre."""
    sections = []
    for start, stop in itertools.pairwise(fixed_positions):
        distances = [0.0]
        while distances[-1] < stop - start:
            centre_distances = np.abs(start + distances[-1] - centres)
            distances.append(distances[-1] + float((spacings + SPACING_GROWTH * centre_distances).min()))
        sections.append(start + np.array(distances[:-1]) * ((stop - start) / distances[-1]))
    return np.append(np.concatenate(sections), fixed_positions[-1])
