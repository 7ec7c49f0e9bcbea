"""What the page shows of one case, as plain arrays: pressure along the axis and on the top, stress in a plane."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.explorer.looked import Looked
from contactstudy.explorer.pixels import Span, between, pixels

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
    """Picture of a field: values, what it shows along both axes, largest value to draw, names of axes, its place."""

    values: FloatArray
    across: Span
    up: Span
    most: float
    names: tuple[str, str]
    place: str = ""


def scale_of(one: Looked, *, relative: bool) -> Scale:
    """Return mm and MPa, or the half-width and the pressure of Hertz' line contact."""
    if relative and one.hertz is not None:
        return Scale(*one.hertz, "/a", "/p0")
    return Scale(1e-3, 1e6, " (mm)", " (MPa)")


def region(one: Looked, name: str) -> Span:
    """Positions along the axis that a region shows, metres."""
    x, _ = one.cells
    low, high = float(x.min()), float(x.max())
    loaded = x[one.along > 0]
    if name == REGIONS[0] or not loaded.size or one.hertz is None:
        return low, high
    near = NEAR * one.hertz[0]
    if name == REGIONS[1]:
        return max(low, loaded[0] - 0.25 * near), min(high, loaded[0] + 0.75 * near)
    return max(low, loaded[-1] - 0.75 * near), min(high, loaded[-1] + 0.25 * near)


def axial(one: Looked, scale: Scale) -> Line:
    """Largest pressure across the contact, along the axis; not drawn beside a singular end."""
    x, _ = one.cells
    values = np.where(one.near(x), np.nan, one.along / scale.stress)
    return Line(x / scale.length, values, [end / scale.length for end in one.ends])


def top(one: Looked, scale: Scale, shown: Span) -> Image:
    """Pressure on the top of the body."""
    _, y = one.cells
    span = (float(y[0]), float(y[-1]))
    return _image(one.pressure, one.cells, (shown, span), one.most_pressure, scale, ("x", "y"))


def plane(one: Looked, scale: Scale, shown: Span, kind: str, part: float) -> Image | None:
    """Von Mises stress in a plane; None if there are no stresses, or too few points for it.

    Parameters
    ----------
    one : Looked
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
    if not one.has_stress:
        return None
    axes = one.points
    at = kind[0]
    across, up = (axis for axis in "xyz" if axis != at)
    if min(axes[across].size, axes[up].size) < 2 or (at == "y" and not axes["y"][0] <= 0 <= axes["y"][-1]):
        return None
    first, last = shown if at == "x" else (float(axes[at][0]), float(axes[at][-1]))
    position = 0.0 if at == "y" else first + part * (last - first)
    values = between(one.stress, axes[at], position, "xyz".index(at))
    spans = [(float(axes[axis][0]), float(axes[axis][-1])) for axis in (across, up)]
    if across == "x":
        spans[0] = (max(spans[0][0], shown[0]), min(spans[0][1], shown[1]))
    image = _image(values, (axes[across], axes[up]), (spans[0], spans[1]), one.most_stress, scale, (across, up))
    return image._replace(place=f" at {at} = {position / scale.length:.3g} {scale.length_name.strip(' ()/')}")


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
