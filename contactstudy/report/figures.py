"""Figures of a case in a report: side view of roller and body, pressure, tractions, stresses, as SVG in the page."""

from __future__ import annotations

import base64
import contextlib
import io
import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis import axial_pressure, largest_sample, positions
from contactstudy.arrays.engineering import format_quantity
from contactstudy.case.case import Case
from contactstudy.case.roller import Roller
from contactstudy.checks import FloatArray
from contactstudy.errors import ContactStudyError
from contactstudy.plots import (
    plot_axial_pressure,
    plot_film_line,
    plot_film_map,
    plot_pressure_map,
    plot_profile,
    plot_stress_plane,
    plot_traction_map,
)
from contactstudy.plots.axial import draw_section_maxima
from contactstudy.plots.style import MILLIMETRES, cap_field
from contactstudy.profiles.base import check_drop, local_radius

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 6.4, 3.3  # Size of a figure, inches
END_PANEL, LONG_CONTACT = 6.0, 15.0  # Length of the panel of an end, least length with a panel, in half-widths
DOTS_PER_INCH = 110  # Dots per inch of images within a figure
PIXELS_PER_INCH = 96  # Pixels of a page per inch

BLUE = "#1f4e79"
BODY, ROLLER, LINE = "#d9dee3", "#b9c6d2", "#24313d"  # Colours of the side view
ARROW: dict[str, Any] = {"arrowstyle": "<->", "color": LINE, "shrinkA": 0.0, "shrinkB": 0.0}


class Picture(NamedTuple):
    """Figure in a page: a data URL, its caption, and its width in pixels, 0 if the page decides."""

    address: str
    caption: str
    width: int = 0


def encode_figure(figure: Figure) -> str:
    """Return a figure as a data URL, with the same bytes in each run."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    target = io.BytesIO()
    # Write the canvas directly: `savefig` would draw the figure twice.
    figure.set_dpi(DOTS_PER_INCH)
    canvas: Any = FigureCanvasSVG(figure)
    with matplotlib.rc_context({"svg.hashsalt": "contactstudy"}):
        canvas.print_svg(target, metadata={"Date": None, "Creator": None})
    return "data:image/svg+xml;base64," + base64.b64encode(target.getvalue()).decode()


def _create_figure(height: float = HEIGHT) -> Figure:
    """Return a figure without a window."""
    from matplotlib.figure import Figure

    return Figure(figsize=(WIDTH, height), layout="constrained")


def case_pictures(result: xr.Dataset, case: Case | None) -> list[Picture]:
    """Return every figure that a result of one case and its inputs allow."""
    # Each function draws into a figure and returns the figure's caption.
    drawing_functions: list[Callable[[Figure, xr.Dataset], str]] = []
    if "pressure" in result and bool((result["pressure"] > 0).any()):
        pressure_caption = "Pressure on the top of the body. The two axes have different scales."
        drawing_functions += [_draw_axial_pressure, partial(_draw_map, plot_pressure_map, pressure_caption)]
        if {"stick", "traction_x", "slip_x"} <= set(result.data_vars):
            drawing_functions += [_draw_traction_map, _draw_slip_map]
    if "film_thickness" in result:
        film_caption = "Film thickness. Cross: least film. The two axes have different scales."
        drawing_functions += [_draw_film_lines, partial(_draw_map, plot_film_map, film_caption)]
    if case is not None:
        roller = case.roller
        if check_drop(roller.profile, np.linspace(-0.5, 0.5, 201) * roller.length, roller.length).any():
            drawing_functions.append(partial(_draw_profile, roller))
    if "von_mises" in result and bool(result["von_mises"].notnull().any()):
        x = float(largest_sample(result, "von_mises")["largest_von_mises_x"])
        section_text = f"across the roller, in the section of its largest value, x = {format_quantity(x, 'm')}"
        drawing_functions += [partial(_draw_plane, "in the plane y = 0, along the roller", {"y": 0.0})]
        drawing_functions += [partial(_draw_plane, section_text, {"x": x}), _draw_section_maxima]
    pictures = []
    for function in drawing_functions:
        figure = _create_figure()
        with contextlib.suppress(ContactStudyError):  # fewer positions than the plane needs
            caption = function(figure, result)
            pictures.append(Picture(encode_figure(figure), caption))
    return pictures


def _draw_axial_pressure(figure: Figure, result: xr.Dataset) -> str:
    """Pressure along the axis, and near the end of larger pressure."""
    x = positions(result["pressure"], "x").values
    half_width = float(result.get("hertz_half_width", np.inf))
    length = END_PANEL * half_width
    has_end_panel = np.ptp(x) > LONG_CONTACT * half_width
    axes = figure.subplots(1, 2 if has_end_panel else 1, squeeze=False)[0]
    for ax in axes:
        plot_axial_pressure(result, ax, si=True, color=BLUE, linewidth=1.6)
        if "hertz_max_pressure" in result:
            ax.axhline(1e-6 * float(result["hertz_max_pressure"]), color="0.6", linewidth=0.9, linestyle="--")
        ax.set_ylim(bottom=0.0)
    caption = "Largest pressure across the contact, along the roller's axis. Dashed: Hertz line contact."
    if has_end_panel:
        line_pressure = axial_pressure(result).values
        loaded_x = x[line_pressure > 0]
        at_end_1 = line_pressure[x <= loaded_x[0] + length].max() >= line_pressure[x >= loaded_x[-1] - length].max()
        end, panel_offset = (loaded_x[0], length) if at_end_1 else (loaded_x[-1], -length)
        axes[1].set_xlim(*sorted((1e3 * (end - 0.1 * panel_offset), 1e3 * (end + panel_offset))))
        axes[1].set_ylabel("")
        axes[1].set_title(f"near end {'I' if at_end_1 else 'II'}", fontsize="medium")
    if np.isinf(float(result.get("peak_pressure", 0.0))):
        caption += " Open triangle: the pressure is singular at this end."
    return caption


def _draw_map(plot: Callable[..., Axes], caption: str, figure: Figure, result: xr.Dataset) -> str:
    """Draw one map."""
    plot(result, figure.subplots(), si=True)
    return caption


def _draw_film_lines(figure: Figure, result: xr.Dataset) -> str:
    """Film and pressure along the axis, and along y at the least film."""
    axes = figure.subplots(1, 2)
    plot_film_line(result, axes[0], si=True)
    plot_film_line(result, axes[1], x=float(result["least_film_x"]), si=True)
    return "Film and pressure along the axis at y = 0, and across the least film."


def _draw_traction_map(figure: Figure, result: xr.Dataset) -> str:
    """Traction on the top, with the border of the sticking area."""
    plot_traction_map(result, figure.subplots(), si=True)
    in_contact = result["pressure"] > 0
    if not bool(result["stick"].where(in_contact, False).any()):
        border = "The surfaces slip everywhere."
    elif bool(result["stick"].where(in_contact, True).all()):
        border = "The surfaces stick everywhere."
    else:
        border = "The surfaces stick within the red line, and slip between it and the grey one."
    return f"Size of the traction on the body. {border} The two axes have different scales."


def _draw_slip_map(figure: Figure, result: xr.Dataset) -> str:
    """Slip on the top, with the border of the sticking area."""
    plot_traction_map(result, figure.subplots(), variable="slip", si=True)
    is_shift = str(result["slip_y"].attrs.get("units", "1")) == "m"
    reference = (
        "in the last step"
        if is_shift
        else "per distance rolled; the contact moves along +y, so its leading edge is at the top"
    )
    return f"Size of the slip of the roller against the body, {reference}."


def _draw_profile(roller: Roller, figure: Figure, result: xr.Dataset) -> str:
    """Profile of the roller."""
    drop = check_drop(roller.profile, np.linspace(-0.47, 0.47, 201) * roller.length, roller.length)
    crown = float(drop[np.isfinite(drop)].max(initial=0.0))
    max_depth = 3 * crown if crown > 0 else None
    plot_profile(roller.profile, roller.length, ax=figure.subplots(), deepest=max_depth, color=BLUE)
    return "Profile of the roller: drop from the cylinder, downwards."


def _draw_plane(text: str, position: dict[str, Any], figure: Figure, result: xr.Dataset) -> str:
    """Von Mises stress in a plane."""
    plot_stress_plane(result, "von_mises", ax=figure.subplots(), si=True, **position)
    _, limit = cap_field(result, result["von_mises"])
    bound_text = f" Near a singular end the stress exceeds the largest colour, {format_quantity(limit, 'Pa')}."
    return f"Von Mises stress {text}.{bound_text if limit < np.inf else ''}"


def _draw_section_maxima(figure: Figure, result: xr.Dataset) -> str:
    """Largest von Mises stress of each cross-section."""
    ax = figure.subplots()
    draw_section_maxima(ax, result, "von_mises", MILLIMETRES, color=BLUE, linewidth=1.6)
    caption = "Largest von Mises stress of each section across the roller."
    peak, peak_x = (float(result.get(f"peak_von_mises{suffix}", np.nan)) for suffix in ("", "_x"))
    if np.isfinite(peak) and np.isfinite(peak_x):
        ax.plot(1e3 * peak_x, 1e-6 * peak, "o", color=BLUE, markersize=5)
        x, z = (format_quantity(float(result.get(f"peak_von_mises_{axis}", np.nan)), "m") for axis in "xz")
        caption += f" Dot: largest in the body, {format_quantity(peak, 'Pa')} at x = {x}, z = {z}."
    ax.set_xlabel("distance from the free end, x (mm)")
    ax.set_ylabel("largest von Mises stress (MPa)")
    ax.set_ylim(bottom=0.0)
    return caption


class SideView(NamedTuple):
    """Geometry of the side view, metres: body and roller, with the drop of the profile magnified."""

    x: FloatArray
    generatrix: FloatArray  # heights of the roller's lower line above the body
    roller: tuple[float, float]  # ends along x
    body: tuple[float, float]  # ends along x; infinite where the body has no end
    limits: tuple[float, float]
    height: float  # of the roller in the drawing
    magnification: float  # factor on the drop
    is_clipped: bool  # whether the magnified drop is deeper than the drawing


def side_geometry(case: Case) -> SideView:
    """Return the geometry of the side view of a case."""
    roller, ends = case.roller, (case.roller_start, case.roller_start + case.roller.length)
    low, high = case.body.extent
    margin = 0.12 * roller.length  # of a body without an end
    limits = (
        min(low if math.isfinite(low) else ends[0] - margin, ends[0]),
        max(high if math.isfinite(high) else ends[1] + margin, ends[1]),
    )
    height = min(roller.radius, 0.42 * (limits[1] - limits[0]))
    x_roller = np.linspace(-0.5, 0.5, 241) * roller.length
    drop = check_drop(roller.profile, x_roller, roller.length)
    is_inner = (np.abs(x_roller) <= 0.45 * roller.length) & np.isfinite(drop)
    magnification, max_depth = _choose_magnification(float(drop[is_inner].max(initial=0.0)), height), 0.45 * height
    generatrix = np.minimum(np.where(np.isfinite(drop), drop * magnification, max_depth), max_depth)
    x = x_roller + ends[0] + 0.5 * roller.length
    is_clipped = bool((drop * magnification > max_depth).any())
    return SideView(
        x, generatrix, ends, (low, high), limits, height=height, magnification=magnification, is_clipped=is_clipped
    )


def _choose_magnification(crown: float, height: float) -> float:
    """Factor, 1, 2 or 5 times a power of ten, that magnifies a crown to at most 0.16 of the height; 1 if visible."""
    if crown <= 0 or crown >= 0.02 * height:
        return 1.0
    max_factor = 0.16 * height / crown
    power = 10.0 ** math.floor(math.log10(max_factor))
    return float(next(factor for factor in (5 * power, 2 * power, power) if factor <= max_factor * (1 + 1e-9)))


def side_view(case: Case) -> Picture:
    """Draw roller and body from the side, to scale except for the magnified drop of the profile."""
    view = side_geometry(case)
    width = view.limits[1] - view.limits[0]
    depth = 0.13 * width
    figure = _create_figure(WIDTH * (view.height + 2.2 * depth) / width + 0.6)
    ax = figure.subplots()
    _draw_body(ax, view, depth)
    _draw_roller(ax, view, case.roller.radius)
    _draw_dimension(ax, view.roller, view.height + 0.25 * depth, f"L = {format_quantity(case.roller.length, 'm')}")
    if all(map(math.isfinite, view.body)):
        _draw_dimension(ax, view.body, -1.9 * depth, f"body {format_quantity(view.body[1] - view.body[0], 'm')}")
    for name, end_x, face_x, sign in zip(("I", "II"), view.body, view.roller, (1, -1), strict=True):
        if math.isfinite(end_x):
            distance = sign * (face_x - end_x)
            # The difference of two positions may be a rounding error.
            text = f"end {name}: e = {format_quantity(0.0 if abs(distance) < 1e-12 else distance, 'm')}"
            ax.plot([end_x, face_x], [-1.15 * depth] * 2, "|-", color=LINE, linewidth=0.8)
            x, alignment = (min(end_x, face_x), "left") if sign > 0 else (max(end_x, face_x), "right")
            ax.text(x, -1.3 * depth, text, ha=alignment, va="top")
    ax.set_aspect("equal")
    ax.set_axis_off()
    return Picture(encode_figure(figure), _write_side_caption(case, view))


def _draw_body(ax: Axes, view: SideView, depth: float) -> None:
    """Body with its free ends as lines, and dashed edges where the body continues."""
    ends = [max(view.body[0], view.limits[0]), min(view.body[1], view.limits[1])]
    ax.fill_between(ends, -depth, 0.0, color=BODY, linewidth=0)
    ax.plot(ends, [0.0, 0.0], color=LINE, linewidth=1.5)
    ax.plot(ends, [-depth, -depth], color=LINE, linewidth=0.8, linestyle="--")
    for x, end_x in zip(ends, view.body, strict=True):
        style = {"linewidth": 1.5} if math.isfinite(end_x) else {"linewidth": 0.8, "linestyle": "--"}
        ax.plot([x, x], [-depth, 0.0], color=LINE, **style)


def _draw_roller(ax: Axes, view: SideView, radius: float) -> None:
    """Roller from its generatrix up to its axis, or up to a cut."""
    x, z = view.x[[0, *range(view.x.size), -1]], np.pad(view.generatrix, 1, constant_values=view.height)
    ax.fill(x, z, color=ROLLER, linewidth=0)
    ax.plot(x, z, color=LINE, linewidth=1.2)
    is_cut = view.height < radius
    ax.plot(view.x[[0, -1]], [view.height] * 2, color=LINE, linewidth=0.8, linestyle="--" if is_cut else "-.")
    mid_length = float(view.x.mean())
    arrow = ARROW | {"arrowstyle": "->" if is_cut else "<->"}
    ax.annotate("", (mid_length, 0.0), (mid_length, view.height), arrowprops=arrow)
    ax.text(mid_length, 0.5 * view.height, f"  R = {format_quantity(radius, 'm')}", va="center", color=LINE)


def _draw_dimension(ax: Axes, ends: tuple[float, float], z: float, text: str) -> None:
    """Dimension line along x with its text."""
    ax.annotate("", (ends[0], z), (ends[1], z), arrowprops=ARROW)
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
    ax.text(0.5 * (ends[0] + ends[1]), z, text, ha="center", va="center", bbox=box)


def _write_side_caption(case: Case, view: SideView) -> str:
    """Caption: scale, magnification, cut, cone and tilt."""
    roller = case.roller
    profile_text = "the profile is to scale"
    if view.magnification > 1:
        profile_text = f"the drop of the profile is magnified {view.magnification:g} times"
        profile_text += ", and clipped at the ends" if view.is_clipped else ""
    caption = f"Side view, to scale in both directions: lower half of the roller on the body; {profile_text}."
    if view.height < roller.radius:
        caption += " The roller is cut below its axis."
    x_roller = view.x - 0.5 * sum(view.roller)
    radii = local_radius(roller.profile, x_roller, roller.length, roller.radius)
    if np.ptp(radii) > 1e-12:
        caption += (
            f" The radius across the roller changes from {format_quantity(float(radii[0]), 'm')} to "
            f"{format_quantity(float(radii[-1]), 'm')} along it; the drawing has the radius at mid-length throughout."
        )
    if case.tilt or case.load_position is not None:
        caption += " The tilt is not drawn."
    return caption
