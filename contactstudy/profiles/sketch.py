"""Small drawing of a profile for a notebook, as SVG: its drop along the roller, much deeper than it is."""

from __future__ import annotations

from html import escape

import numpy as np

from contactstudy.arrays.engineering import quantity
from contactstudy.profiles.base import Profile, checked_drop

WIDTH, HEIGHT, MARGIN = 420.0, 90.0, 6.0
"""Size of the drawing and room around it, in its own units."""

ROLLER_HEIGHT, DEEPEST = 62.0, 44.0
"""Height of the roller that is drawn, and of the deepest drop."""

POINTS = 211
"""Points of the generatrix."""

INSIDE, SHOWN = 0.45, 3.0
"""Place of the drop that sets the scale, over the length, and how many times this drop is drawn; more is cut off."""

ROLLER, LINE = "#b9c6d2", "#24313d"


def sketch(profile: Profile, length: float, title: str) -> str:
    """Draw a profile from end to end.

    Parameters
    ----------
    profile : Profile
        Any profile.
    length : float
        Length of the roller, metres.
    title : str
        What a reader without the picture is told.

    Examples
    --------
    >>> from contactstudy.profiles import FullCrown
    >>> svg = sketch(FullCrown(crown_radius=1.25), 10e-3, "a crown")
    >>> svg.startswith("<svg"), "10 µm" in svg
    (True, True)
    """
    x = np.linspace(-0.5, 0.5, POINTS)
    drop = checked_drop(profile, x * length, length)
    deepest, inner = (float(each[np.isfinite(each)].max(initial=0.0)) for each in (drop, drop[np.abs(x) <= INSIDE]))
    if inner > 0 and not np.isfinite(drop).all():
        deepest = SHOWN * inner
    elif inner > 0:
        deepest = min(deepest, SHOWN * inner)
    # Without any finite drop there is no scale; what is infinite is cut off all the same.
    cut_off = drop > deepest
    height = ROLLER_HEIGHT - np.where(cut_off, 1.0, drop / (deepest or 1.0)) * DEEPEST
    across = MARGIN + (x + 0.5) * (WIDTH - 2 * MARGIN)
    line = " ".join(f"{at:.1f},{y:.1f}" for at, y in zip(across, height, strict=True))
    said = f"drop drawn up to {quantity(deepest, 'm')}" if deepest else "no drop"
    if cut_off.any():
        # Within, the scale has room for all that is finite.
        said += ", cut off where it is infinite" if cut_off[np.abs(x) <= INSIDE].any() else ", cut off at the ends"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}" '
        f'style="max-width:100%" role="img" aria-label="{escape(title)}" font-family="sans-serif" font-size="13">'
        f'<polygon points="{across[0]:.1f},{MARGIN} {line} {across[-1]:.1f},{MARGIN}" fill="{ROLLER}"/>'
        f'<polyline points="{line}" fill="none" stroke="{LINE}" stroke-width="2"/>'
        f'<text x="{WIDTH / 2}" y="{HEIGHT - 8}" text-anchor="middle" fill="currentColor">'
        f"{escape(said)}; L = {escape(quantity(length, 'm'))}</text></svg>"
    )
