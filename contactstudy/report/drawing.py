"""Side view of roller and body to scale, as SVG; the crown is drawn deeper than it is, by a factor that is said."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from markupsafe import Markup, escape

from contactstudy.arrays.engineering import quantity
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.profiles.base import checked_drop, local_radius

WIDTH, MARGIN = 760.0, 56.0
"""Width of the drawing and of the room on either side, in its own units."""

BEYOND = 0.12
"""How far a body without an end is drawn beyond the roller, over the roller's length."""

TALLEST, DEPTH = 0.42, 0.13
"""Height of the roller and depth of the body that are drawn at most, over the width of what is drawn."""

CROWN_PLACE, CROWN_HEIGHT = 0.45, 0.16
"""Where the crown is measured, over the roller's length, and the part of the height that it is drawn with."""

CUT_OFF = 0.45
"""Drop beyond which the generatrix is cut off, over the height of the roller, as drawn."""

VISIBLE = 0.02
"""Part of the height from which on a crown is seen without being drawn deeper."""

POINTS = 241
"""Points of the generatrix."""

ROUNDING = 1e-12
"""Distance that counts as none, metres."""

BODY, ROLLER, LINE = "#d9dee3", "#b9c6d2", "#24313d"


class Drawing(NamedTuple):
    """The SVG and what must be said under it."""

    svg: Markup
    caption: str


def draw(case: Case) -> Drawing:
    """Draw a case from the side.

    Parameters
    ----------
    case : Case
        Roller, body and place.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material, Roller
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> drawing = draw(Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9))
    >>> str(drawing.svg[:4]), "to scale" in drawing.caption
    ('<svg', True)
    """
    roller = case.roller
    start, stop = case.roller_start, case.roller_start + roller.length
    low, high = case.body.extent
    left = min(low if math.isfinite(low) else start - BEYOND * roller.length, start)
    right = max(high if math.isfinite(high) else stop + BEYOND * roller.length, stop)
    scale = (WIDTH - 2 * MARGIN) / (right - left)
    height = min(roller.radius, TALLEST * (right - left))
    cut = height < roller.radius
    x = np.linspace(-0.5, 0.5, POINTS) * roller.length
    drop = checked_drop(roller.profile, x, roller.length)
    factor = _factor(drop, x / roller.length, height)
    deepest = CUT_OFF * height
    outline = np.minimum(np.where(np.isfinite(drop), drop * factor, deepest), deepest)
    surface = 44.0 + height * scale
    bottom = surface + DEPTH * WIDTH

    def across(position: float) -> float:
        return MARGIN + (position - left) * scale

    parts = [
        _body(
            across(max(low, left)), across(min(high, right)), surface, bottom, math.isfinite(low), math.isfinite(high)
        ),
        _roller([across(start + 0.5 * roller.length + at) for at in x], surface - outline * scale, 44.0, cut=cut),
        _dimension(across(start), across(stop), 18.0, f"L = {quantity(roller.length, 'm')}"),
        _height(across(start + 0.5 * roller.length), 44.0, surface, f"R = {quantity(roller.radius, 'm')}", cut=cut),
    ]
    if math.isfinite(high - low):
        length = f"body {quantity(high - low, 'm')}"
        parts.append(_dimension(across(low), across(high), bottom + 62.0, length))
    for end, edge, face in (("I", low, start), ("II", high, stop)):
        if math.isfinite(edge):
            parts.append(_end(across(edge), across(face), bottom, end, (face - edge) * (1 if end == "I" else -1)))
    full = bottom + 84.0
    label = "Side view of the roller on the body"
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {full:.0f}" role="img" '
        f'aria-label="{label}" font-family="sans-serif" font-size="21" fill="{LINE}">{"".join(parts)}</svg>'
    )
    crown = "so is the profile"
    if factor > 1:
        crown = f"the drop of the profile is drawn {factor:g} times as deep as it is"
        crown += ", and cut off at the ends" if (drop * factor > deepest).any() else ""
    said = f"Side view, to scale in both directions: lower half of the roller on the body; {crown}."
    if cut:
        said += " The roller is cut below its axis."
    if np.ptp(local_radius(roller.profile, x, roller.length, roller.radius)) > ROUNDING:
        first, last = local_radius(roller.profile, x[[0, -1]], roller.length, roller.radius)
        said += (
            f" The radius across the roller changes from {quantity(float(first), 'm')} to "
            f"{quantity(float(last), 'm')} along it; the drawing has the radius at mid-length all along."
        )
    if case.tilt or case.load_position is not None:
        said += " The tilt is not drawn."
    return Drawing(Markup(svg), said)


def _factor(drop: FloatArray, place: FloatArray, height: float) -> float:
    """Factor on the drop, 1, 2 or 5 times a power of ten, with which the crown is seen."""
    within = np.abs(place) <= CROWN_PLACE
    crown = float(drop[within & np.isfinite(drop)].max(initial=0.0))
    if crown <= 0 or crown >= VISIBLE * height:
        return 1.0
    wanted = CROWN_HEIGHT * height / crown
    power = 10.0 ** math.floor(math.log10(wanted))
    return float(next(step for step in (5 * power, 2 * power, power) if step <= wanted * (1 + 1e-9)))


def _body(left: float, right: float, top: float, bottom: float, first: bool, last: bool) -> str:
    """Body, its free ends as thick lines, and wavy edges where it goes on."""
    filled = (
        f'<rect x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" height="{bottom - top:.1f}" fill="{BODY}"/>'
    )
    thick = f'stroke="{LINE}" stroke-width="2.5"'
    lines = f'<line x1="{left:.1f}" y1="{top:.1f}" x2="{right:.1f}" y2="{top:.1f}" {thick}/>'
    for at, free in ((left, first), (right, last)):
        if free:
            lines += f'<line x1="{at:.1f}" y1="{top:.1f}" x2="{at:.1f}" y2="{bottom:.1f}" {thick}/>'
        else:
            lines += _wave(at, top, at, bottom)
    return filled + lines + _wave(left, bottom, right, bottom)


def _wave(x1: float, y1: float, x2: float, y2: float) -> str:
    """Line of a cut."""
    count = 24
    part = np.linspace(0.0, 1.0, count + 1)
    swing = 3.0 * np.sin(np.arange(count + 1) * math.pi / 2)
    upright = x1 == x2
    xs = x1 + (x2 - x1) * part + (swing if upright else 0.0)
    ys = y1 + (y2 - y1) * part + (0.0 if upright else swing)
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(xs, ys, strict=True))
    return f'<polyline points="{points}" fill="none" stroke="{LINE}" stroke-width="1" stroke-dasharray="4 3"/>'


def _roller(x: list[float], z: FloatArray, top: float, *, cut: bool) -> str:
    """Roller from its generatrix up to its axis."""
    points = " ".join(f"{at:.1f},{height:.1f}" for at, height in zip(x, z, strict=True))
    shape = f'<polygon points="{x[0]:.1f},{top:.1f} {points} {x[-1]:.1f},{top:.1f}" fill="{ROLLER}"/>'
    edge = f'<polyline points="{x[0]:.1f},{top:.1f} {points} {x[-1]:.1f},{top:.1f}" fill="none" stroke="{LINE}"'
    above = _wave(x[0], top, x[-1], top)
    if not cut:
        above = (
            f'<line x1="{x[0] - 18:.1f}" y1="{top:.1f}" x2="{x[-1] + 18:.1f}" y2="{top:.1f}" stroke="{LINE}" '
            'stroke-dasharray="16 4 3 4"/>'
        )
    return f'{shape}{edge} stroke-width="2"/>{above}'


def _arrow(x1: float, y1: float, x2: float, y2: float) -> str:
    """Line with a head at either end."""
    angle = math.atan2(y2 - y1, x2 - x1)
    heads = ""
    for x, y, towards in ((x1, y1, angle), (x2, y2, angle + math.pi)):
        corners = [
            f"{x + 9 * math.cos(towards + turn):.1f},{y + 9 * math.sin(towards + turn):.1f}" for turn in (-0.35, 0.35)
        ]
        heads += f'<polygon points="{x:.1f},{y:.1f} {corners[0]} {corners[1]}" fill="{LINE}"/>'
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{LINE}"/>{heads}'


def _text(x: float, y: float, text: str, anchor: str = "middle", ground: str = "#fff") -> str:
    """Text with a halo, so that lines do not cross it."""
    style = f'stroke="{ground}" stroke-width="14" paint-order="stroke" stroke-linejoin="round"'
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" {style}>{escape(text)}</text>'


def _dimension(left: float, right: float, y: float, text: str) -> str:
    """Dimension along x."""
    return _arrow(left, y, right, y) + _text(0.5 * (left + right), y + 7, text)


def _height(x: float, top: float, bottom: float, text: str, *, cut: bool) -> str:
    """Dimension of the radius; an arrow at the surface only where the roller is cut."""
    line = _arrow(x, top, x, bottom)
    if cut:
        head = f'<polygon points="{x:.1f},{bottom:.1f} {x - 3:.1f},{bottom - 9:.1f} {x + 3:.1f},{bottom - 9:.1f}"/>'
        line = f'<line x1="{x:.1f}" y1="{top:.1f}" x2="{x:.1f}" y2="{bottom:.1f}" stroke="{LINE}"/>{head}'
    return line + _text(x + 10, 0.5 * (top + bottom) + 7, text, "start", ROLLER)


def _end(edge: float, face: float, bottom: float, name: str, distance: float) -> str:
    """Distance between an end of the body and the roller's face, and the name of the end."""
    low, high = sorted((edge, face))
    y = bottom + 16
    lines = "".join(
        f'<line x1="{at:.1f}" y1="{bottom - 8:.1f}" x2="{at:.1f}" y2="{y + 6:.1f}" stroke="{LINE}" stroke-width="0.8"/>'
        for at in (low, high)
    )
    # The difference of two positions may be a rounding error, of either sign.
    text = f"end {name}: e = {quantity(0.0 if abs(distance) < ROUNDING else distance, 'm')}"
    at = min(edge, face) if name == "I" else max(edge, face)
    first = name == "I"
    label = _text(max(at - 40, 4) if first else min(at + 40, WIDTH - 4), y + 22, text, "start" if first else "end")
    return f'{lines}<line x1="{low:.1f}" y1="{y:.1f}" x2="{high:.1f}" y2="{y:.1f}" stroke="{LINE}"/>{label}'
