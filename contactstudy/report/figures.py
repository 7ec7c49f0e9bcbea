"""Figures of a report, drawn without a screen and kept inside the page as SVG."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis import positions, section_peak
from contactstudy.analysis.measures import measure
from contactstudy.arrays.engineering import quantity
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.errors import ContactStudyError
from contactstudy.plots import (
    plot_axial_pressure,
    plot_pressure_map,
    plot_profile,
    plot_stress_plane,
    plot_traction_map,
)
from contactstudy.plots.singular import capped, mark_at_top, near_singular, singular_ends
from contactstudy.profiles.base import checked_drop

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDE, TALL = 6.4, 3.3
"""Size of a figure, inches."""

NEAR_END = 6.0
"""Distance from the end that its own panel shows, over the Hertz half-width."""

LONG = 15.0
"""Length over the Hertz half-width from which on an end has a panel of its own."""

DOTS = 110
"""Dots per inch of the parts of a figure that are pictures."""


PIXELS = 96
"""Pixels of a page per inch."""

LEAST, MOST = 0.5, 1.4
"""How much smaller and larger than it is a figure may be shown: its words stay readable."""

NARROW = 380
"""Width that a narrow screen has for a figure, pixels."""


class Picture(NamedTuple):
    """A figure in a page: its address, which holds it, its caption, and its own width in pixels where that binds."""

    address: str
    caption: str
    width: int = 0

    @property
    def least(self) -> int:
        """Width below which the figure is scrolled."""
        return round(LEAST * self.width)

    @property
    def most(self) -> int:
        """Width beyond which the figure does not grow."""
        return round(MOST * self.width)

    @property
    def scrolls(self) -> bool:
        """Whether a narrow screen has to scroll it."""
        return self.least > NARROW


def as_address(figure: Figure) -> str:
    """Return a figure as an address that holds it, the same bytes each time."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    target = io.BytesIO()
    # `savefig` would draw twice: once to place everything, which drawing does as well.
    figure.set_dpi(DOTS)
    canvas: Any = FigureCanvasSVG(figure)
    with matplotlib.rc_context({"svg.hashsalt": "contactstudy"}):
        canvas.print_svg(target, metadata={"Date": None, "Creator": None})
    return "data:image/svg+xml;base64," + base64.b64encode(target.getvalue()).decode()


def _new(columns: int = 1) -> tuple[Figure, list[Axes]]:
    """Return a new figure that no window knows of, with axes side by side."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDE, TALL), layout="constrained")
    return figure, list(figure.subplots(1, columns, squeeze=False)[0])


def case_pictures(one: xr.Dataset, case: Case | None) -> list[Picture]:
    """Every figure that a case's result and its inputs allow.

    Parameters
    ----------
    one : Dataset
        A single case.
    case : Case or None
        What was solved, if that is known.
    """
    drawn: list[Callable[[], Picture]] = []
    if "pressure" in one:
        drawn += [lambda: _axial(one), lambda: _map(one)]
    if {"pressure", "stick", "traction_x", "slip_x"} <= set(one.data_vars):
        drawn += [lambda: _tractions(one), lambda: _slip(one)]
    if case is not None and checked_drop(case.roller.profile, _along(case, 0.5), case.roller.length).any():
        drawn.append(lambda: _profile(case))
    if "von_mises" in one and bool(one["von_mises"].notnull().any()):
        drawn += [lambda: _plane(one, "y"), lambda: _plane(one, "x"), lambda: _sections(one)]
    found = []
    for draw in drawn:
        try:
            found.append(draw())
        except ContactStudyError:  # too few positions for this plane
            continue
    return found


def _axial(one: xr.Dataset) -> Picture:
    """Pressure along the axis, and near the end that is pressed more."""
    x = positions(one["pressure"], "x").values
    half_width = float(one["hertz_half_width"]) if "hertz_half_width" in one else np.inf
    zoomed = np.ptp(x) > LONG * half_width
    figure, axes = _new(2 if zoomed else 1)
    for ax in axes:
        plot_axial_pressure(one, ax, si=True, color="#1f4e79", linewidth=1.6)
        if "hertz_max_pressure" in one:
            ax.axhline(1e-6 * float(one["hertz_max_pressure"]), color="0.6", linewidth=0.9, linestyle="--")
        ax.set_ylim(bottom=0.0)
    said = "Largest pressure across the contact, along the roller's axis. Dashed: Hertz' line contact."
    if zoomed:
        along = one["pressure"].max([dim for dim in one["pressure"].dims if dim != one["pressure"].dims[0]]).values
        loaded = np.flatnonzero(along > 0)
        first, last = x[loaded[0]], x[loaded[-1]]
        near = NEAR_END * half_width
        ends = [along[x <= first + near].max(), along[x >= last - near].max()]
        at_first = ends[0] >= ends[1]
        span = (first - 0.1 * near, first + near) if at_first else (last - near, last + 0.1 * near)
        axes[1].set_xlim(1e3 * span[0], 1e3 * span[1])
        axes[1].set_ylabel("")
        axes[1].set_title(f"near end {'I' if at_first else 'II'}", fontsize="medium")
    if "peak_pressure" in one and np.isinf(float(one["peak_pressure"])):
        said += " The open triangle marks an end where the pressure is singular: it has no largest value."
    return Picture(as_address(figure), said)


def _map(one: xr.Dataset) -> Picture:
    """Pressure on the top."""
    figure, (ax,) = _new()
    plot_pressure_map(one, ax, si=True)
    return Picture(as_address(figure), "Pressure on the top of the body. The two axes have different scales.")


def _tractions(one: xr.Dataset) -> Picture:
    """Tractions on the top, with the border of the area that sticks."""
    figure, (ax,) = _new()
    plot_traction_map(one, ax, si=True)
    if not bool(one["stick"].where(one["pressure"] > 0, False).any()):
        border = "The surfaces slip everywhere."
    elif bool(one["stick"].where(one["pressure"] > 0, True).all()):
        border = "The surfaces stick everywhere."
    else:
        border = "The surfaces stick within the red line, and slip between it and the grey one."
    said = f"Size of the traction on the body. {border} The two axes have different scales."
    return Picture(as_address(figure), said)


def _slip(one: xr.Dataset) -> Picture:
    """Slip on the top, with the border of the area that sticks."""
    figure, (ax,) = _new()
    plot_traction_map(one, ax, variable="slip", si=True)
    shifted = str(one["slip_y"].attrs.get("units", "1")) == "m"
    said = (
        "in the last step"
        if shifted
        else "per distance rolled; the contact moves along +y, so its leading edge is at the top"
    )
    return Picture(as_address(figure), f"Size of the slip of the roller against the body, {said}.")


def _profile(case: Case) -> Picture:
    """Profile of the roller."""
    roller = case.roller
    figure, (ax,) = _new()
    drop = checked_drop(roller.profile, _along(case, 0.47), roller.length)
    crown = float(drop[np.isfinite(drop)].max(initial=0.0))
    plot_profile(roller.profile, roller.length, ax, deepest=3 * crown if crown > 0 else None, color="#1f4e79")
    return Picture(as_address(figure), "Profile of the roller: material that is missing, downwards.")


def _along(case: Case, reach: float) -> FloatArray:
    """Positions along the roller, up to a part of its length from the middle."""
    return np.linspace(-reach, reach, 201) * case.roller.length


def _plane(one: xr.Dataset, axis: str) -> Picture:
    """Von Mises stress in the plane of the axis, or across it where it is largest."""
    figure, (ax,) = _new()
    stress, said = measure(one, "von_mises"), ""
    if (most := capped(one, stress)[1]) < np.inf:
        said = f" Beside a singular end it is larger than the {quantity(most, 'Pa')} that are drawn."
    if axis == "y":
        plot_stress_plane(one, "von_mises", 0.0, ax, si=True)
        return Picture(as_address(figure), f"Von Mises stress in the plane y = 0, along the roller.{said}")
    at = int(np.nanargmax(stress.max([dim for dim in stress.dims if dim != stress.dims[0]]).values))
    place = float(positions(stress, "x").values[at])
    plot_stress_plane(one, "von_mises", ax=ax, x=place, si=True)
    return Picture(as_address(figure), f"Von Mises stress across the roller, in the section where it is largest.{said}")


def _sections(one: xr.Dataset) -> Picture:
    """Largest von Mises stress of each cross-section."""
    found = section_peak(one, "von_mises")["peak_von_mises"]
    figure, (ax,) = _new()
    x: Any = positions(found, "x").values
    ends = singular_ends(one)
    drawn = np.where(near_singular(one, ends, x), np.nan, 1e-6 * found.values)
    ax.plot(1e3 * x, drawn, color="#1f4e79", linewidth=1.6)
    mark_at_top(ax, [1e3 * end for end in ends], "#1f4e79")
    ax.set_xlabel("distance from the free end, x (mm)")
    ax.set_ylabel("largest von Mises stress (MPa)")
    ax.set_ylim(bottom=0.0)
    return Picture(as_address(figure), "Largest von Mises stress of each section across the roller.")
