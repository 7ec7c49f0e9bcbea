"""What the page shows of one case, as plain arrays: pressure along the axis and on the top, stress in a plane."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis import axial_pressure, in_plane, positions
from contactstudy.analysis.axes import dimension_along
from contactstudy.checks import FloatArray
from contactstudy.explorer.pixels import Span, pixels
from contactstudy.plots.singular import near_singular, singular_ends

PIXELS = (360, 150)
"""Pixels of a picture across and up."""

NEAR = 8.0
"""What "near an end" shows, over the Hertz half-width."""

REGIONS = ("whole length", "near end I", "near end II")

PLANES = ("y = 0, along the roller", "x, across the roller", "z, at a depth")
"""Planes of the stresses, each named by its axis first."""


class Scale(NamedTuple):
    """Units of a page: what a length and a stress are divided by, and their names."""

    length: float
    stress: float
    length_name: str
    stress_name: str


class Line(NamedTuple):
    """Pressure along the axis, and the positions of singular ends."""

    x: FloatArray
    pressure: FloatArray
    singular: list[float]


class Image(NamedTuple):
    """Picture of a field: its values, what it shows along both axes, the largest value to draw, its axes' names."""

    values: FloatArray
    across: Span
    up: Span
    most: float
    names: tuple[str, str]


def scale_of(one: xr.Dataset, *, relative: bool) -> Scale:
    """Return mm and MPa, or the half-width and the pressure of Hertz' line contact."""
    if relative and "hertz_half_width" in one:
        return Scale(float(one["hertz_half_width"]), float(one["hertz_max_pressure"]), "/a", "/p0")
    return Scale(1e-3, 1e6, " (mm)", " (MPa)")


def region(one: xr.Dataset, name: str) -> Span:
    """Positions along the axis that a region shows, metres."""
    x = positions(one["pressure"], "x").values
    low, high = float(x.min()), float(x.max())
    loaded = x[one["pressure"].max(dimension_along(one["pressure"], "y")).values > 0]
    if name == REGIONS[0] or not loaded.size or "hertz_half_width" not in one:
        return low, high
    near = NEAR * float(one["hertz_half_width"])
    if name == REGIONS[1]:
        return max(low, loaded[0] - 0.25 * near), min(high, loaded[0] + 0.75 * near)
    return max(low, loaded[-1] - 0.75 * near), min(high, loaded[-1] + 0.25 * near)


def axial(one: xr.Dataset, scale: Scale) -> Line:
    """Largest pressure across the contact, along the axis; not drawn beside a singular end."""
    along = axial_pressure(one)
    x = positions(along, "x").values
    ends = singular_ends(one)
    values = np.where(near_singular(one, ends, x), np.nan, along.values / scale.stress)
    return Line(x / scale.length, values, [end / scale.length for end in ends])


def top(one: xr.Dataset, scale: Scale, shown: Span) -> Image:
    """Pressure on the top of the body."""
    pressure = one["pressure"].transpose(*(dimension_along(one["pressure"], axis) for axis in "xy"))
    x, y = (positions(pressure, axis).values for axis in "xy")
    near = near_singular(one, singular_ends(one), x)
    most = float(pressure.values[~near].max(initial=0.0)) if not near.all() else float(pressure.max())
    span = (float(y[0]), float(y[-1]))
    return _image(pressure.values, (x, y), (shown, span), most, scale, ("x", "y"))


def plane(one: xr.Dataset, scale: Scale, shown: Span, kind: str, part: float) -> Image | None:
    """Von Mises stress in a plane; None if there are no stresses, or too few points for it.

    Parameters
    ----------
    one : Dataset
        A single case.
    scale : Scale
        Units.
    shown : tuple of float
        What of the x axis is shown, metres.
    kind : str
        One of the planes.
    part : float
        Where the plane is, from the first to the last of the positions.
    """
    if "von_mises" not in one or bool(one["von_mises"].isnull().all()):
        return None
    field = one["von_mises"]
    axes = {axis: positions(field, axis).values for axis in "xyz"}
    at = kind[0]
    across, up = (axis for axis in "xyz" if axis != at)
    if min(axes[across].size, axes[up].size) < 2 or (at == "y" and not axes["y"][0] <= 0 <= axes["y"][-1]):
        return None
    first, last = shown if at == "x" else (float(axes[at][0]), float(axes[at][-1]))
    place = float(np.clip(0.0 if at == "y" else first + part * (last - first), axes[at][0], axes[at][-1]))
    values = in_plane(one[["von_mises"]], variables="von_mises", **{at: place})["von_mises"]
    values = values.transpose(*(dimension_along(values, axis) for axis in (across, up)))
    near = near_singular(one, singular_ends(one), axes["x"]) if "pressure" in one else np.zeros(axes["x"].size, bool)
    kept = field.isel({dimension_along(field, "x"): ~near}) if not near.all() else field
    spans = [(float(axes[axis][0]), float(axes[axis][-1])) for axis in (across, up)]
    if across == "x":
        spans[0] = (max(spans[0][0], shown[0]), min(spans[0][1], shown[1]))
    most = float(kept.max())
    return _image(values.values, (axes[across], axes[up]), (spans[0], spans[1]), most, scale, (across, up))


def _image(
    values: FloatArray,
    axes: tuple[FloatArray, FloatArray],
    spans: tuple[Span, Span],
    most: float,
    scale: Scale,
    names: tuple[str, str],
) -> Image:
    """Picture in the units of the page."""
    drawn = pixels(values, axes, spans, PIXELS) / scale.stress
    (left, right), (low, high) = spans
    labels = {"x": "distance from the free end, x", "y": "position along rolling, y", "z": "depth, z"}
    texts = tuple(f"{labels[name]}{scale.length_name}" for name in names)
    return Image(
        np.minimum(drawn, most / scale.stress).astype(np.float32),
        (left / scale.length, right / scale.length),
        (low / scale.length, high / scale.length),
        most / scale.stress,
        (texts[0], texts[1]),
    )
