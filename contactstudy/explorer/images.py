"""Arrays of the page's figures: pressure along the axis and on the top, stress in a plane, on equal pixels."""

from __future__ import annotations

from functools import cache, partial
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis import axial_pressure, in_plane, measure, positions
from contactstudy.analysis.axes import axis_dimensions
from contactstudy.checks import Array, FloatArray
from contactstudy.plots.style import AXIS_MEANINGS, Units, cap_field, near_singular, singular_ends

PIXELS = (360, 150)  # Pixels of an image, horizontal and vertical
END_REGION = 8.0  # Length of the region near an end, over the Hertz half-width
REGIONS = ("whole length", "near end I", "near end II")

PLANES = ("y = 0, along the roller", "x, across the roller", "z, at a depth")  # first the axis across the plane

Span = tuple[float, float]


class CaseFields:
    """Fields of a case as arrays."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self.dataset = dataset
        self.stress = cache(partial(measure, dataset))  # by its name
        self.hertz: tuple[float, float] | None = None  # half-width and pressure of Hertz' line contact
        if "hertz_half_width" in dataset:
            self.hertz = float(dataset["hertz_half_width"]), float(dataset["hertz_max_pressure"])
        self.singular_ends = singular_ends(dataset)
        self.has_pressure = "pressure" in dataset
        if self.has_pressure:
            axial = axial_pressure(dataset)
            self.x, self.axial_pressure = positions(axial, "x").values, axial.values
        self.has_stress = "von_mises" in dataset and not bool(dataset["von_mises"].isnull().all())
        if self.has_stress:
            self.points = {axis: positions(dataset["von_mises"], axis).values for axis in "xyz"}


class Line(NamedTuple):
    """Pressure along the axis, positions of singular ends, limits of the positions, and labels of both axes."""

    x: FloatArray
    pressure: FloatArray
    singular: list[float]
    span: Span
    names: tuple[str, str]


class Image(NamedTuple):
    """Image (vertical, horizontal) of a field in a plane, limits and labels of both axes, and limit of the colours."""

    values: Array
    horizontal: Span
    vertical: Span
    limit: float
    names: tuple[str, str]
    largest: tuple[float, float, float]  # size and position of the largest value, which pixels may miss
    position: str = ""


def choose_scale(case: CaseFields, *, relative: bool) -> Units:
    """Return mm and MPa, or half-width and pressure of Hertz' line contact, with suffixes as plain text."""
    if relative and case.hertz is not None:
        return Units(*case.hertz, "/a", "/p0")
    return Units(1e-3, 1e6, " (mm)", " (MPa)")


def region_limits(case: CaseFields, name: str) -> Span:
    """Return the limits of a region along the axis, metres."""
    low, high = float(case.x.min()), float(case.x.max())
    loaded = case.x[case.axial_pressure > 0]
    if name == REGIONS[0] or not loaded.size or case.hertz is None:
        return low, high
    length = END_REGION * case.hertz[0]
    end, before = (loaded[0], 0.25) if name == REGIONS[1] else (loaded[-1], 0.75)
    return max(low, end - before * length), min(high, end + (1 - before) * length)


def axial_line(case: CaseFields, scale: Units, limits: Span) -> Line:
    """Return the largest pressure across the contact along the axis, without the vicinity of singular ends."""
    values = np.where(near_singular(case.dataset, case.x), np.nan, case.axial_pressure / scale.stress)
    singular = [end / scale.length for end in case.singular_ends]
    names = f"{AXIS_MEANINGS['x']}, x{scale.over_length}", f"pressure along the axis{scale.over_stress}"
    return Line(case.x / scale.length, values, singular, (limits[0] / scale.length, limits[1] / scale.length), names)


def top_image(case: CaseFields, scale: Units, limits: Span) -> Image:
    """Return the pressure on the top of the body."""
    pressure = case.dataset["pressure"]
    y = positions(pressure, "y").values
    return _image(pressure, (limits, (float(y[0]), float(y[-1]))), _limit(case, pressure), scale)


def plane_image(
    case: CaseFields, scale: Units, limits: Span, kind: str, fraction: float, *, name: str = "von_mises"
) -> Image | None:
    """Return a stress measure in a plane at a fraction of its points; None without stresses or with too few points."""
    if not case.has_stress:
        return None
    points, normal = case.points, kind[0]
    horizontal, vertical = (axis for axis in "xyz" if axis != normal)
    contains_axis = points["y"][0] <= 0 <= points["y"][-1]
    if min(points[horizontal].size, points[vertical].size) < 2 or (normal == "y" and not contains_axis):
        return None
    plane_start, plane_stop = limits if normal == "x" else (float(points[normal][0]), float(points[normal][-1]))
    position = 0.0 if normal == "y" else plane_start + fraction * (plane_stop - plane_start)
    # Beyond the points the stress is constant.
    nearest = float(np.clip(position, points[normal][0], points[normal][-1]))
    plane = in_plane(case.stress(name).to_dataset(name=name), variables=name, **{normal: nearest})[name]
    left, right = float(points[horizontal][0]), float(points[horizontal][-1])
    if horizontal == "x":
        left, right = max(left, limits[0]), min(right, limits[1])
    spans = ((left, right), (float(points[vertical][0]), float(points[vertical][-1])))
    image = _image(plane, spans, _limit(case, case.stress(name)), scale)
    unit = scale.over_length.strip(" ()/")
    return image._replace(position=f"{normal} = {position / scale.length:.3g} {unit}")


def _limit(case: CaseFields, field: xr.DataArray) -> float:
    """Largest value away from singular ends, or of all values."""
    return max(0.0, float(cap_field(case.dataset, field)[0].max()))


def _image(plane: xr.DataArray, spans: tuple[Span, Span], limit: float, scale: Units) -> Image:
    """Image in the units of the page."""
    names = axis_dimensions(plane)
    values = plane.transpose(*names.values()).values
    axes = tuple(positions(plane, axis).values for axis in names)
    horizontal_label, vertical_label = (f"{AXIS_MEANINGS[axis]}, {axis}{scale.over_length}" for axis in names)
    (left, right), (low, high) = ((start / scale.length, stop / scale.length) for start, stop in spans)
    # The largest value of the field up to the limit, which may lie between the pixels.
    in_span = [(points >= start) & (points <= stop) for points, (start, stop) in zip(axes, spans, strict=True)]
    visible = np.where(in_span[0][:, None] & in_span[1] & (values <= limit), values, -np.inf)
    row, column = np.unravel_index(int(visible.argmax()), visible.shape)
    largest = (visible[row, column] / scale.stress, axes[0][row] / scale.length, axes[1][column] / scale.length)
    return Image(
        values=(np.minimum(to_pixels(values, axes, spans), limit) / scale.stress).astype(np.float32),
        horizontal=(left, right),
        vertical=(low, high),
        limit=limit / scale.stress,
        names=(horizontal_label, vertical_label),
        largest=largest if np.isfinite(largest[0]) else (np.nan, np.nan, np.nan),
    )


def to_pixels(values: FloatArray, axes: tuple[FloatArray, ...], spans: tuple[Span, Span]) -> FloatArray:
    """Return values (horizontal, vertical) at the centres of pixels (vertical, horizontal), constant beyond points."""
    for axis, (points, (start, stop), count) in enumerate(zip(axes, spans, PIXELS, strict=True)):
        centres = start + (np.arange(count) + 0.5) * (stop - start) / count
        values = np.apply_along_axis(partial(np.interp, centres, points), axis, values)
    return np.ascontiguousarray(values.T)
