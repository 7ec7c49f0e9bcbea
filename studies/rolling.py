"""Figure of the four studies of rolling, from their folders.

contactstudy run studies/traction_curve.toml
contactstudy run studies/axial_slip.toml
contactstudy run studies/spin.toml
contactstudy run studies/partial_slip.toml
python studies/rolling.py
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import contactstudy as cs
from contactstudy.plots.style import MARKERS, line_styles

NAMES = ("traction_curve", "axial_slip", "spin", "partial_slip")

MIN_DEPTH = 0.19
"""Least depth over a of the compared von Mises stresses."""


def marked_styles(count: int) -> Iterator[dict[str, Any]]:
    """Styles of lines with different dashes, colours and markers."""
    for style, marker in zip(line_styles(count), MARKERS, strict=False):
        yield style | {"marker": marker, "markersize": 5}


def sliding_force(study: xr.Dataset) -> xr.DataArray:
    """Force of full sliding, N."""
    return study["friction"] * study["normal_load"]


def draw_curve(ax: Axes, study: xr.Dataset) -> None:
    """Traction curves: free ends flush and inside the face, and half-spaces."""
    ratio = study["force_y"] / sliding_force(study)
    a = study["hertz_half_width"]
    styles = marked_styles(6)
    for length in study["roller_length"].values:
        size = f"roller of {float(length / a.max()):.0f}a"
        for body, e_over_a in (("finite-length", 0.0), ("finite-length", 2.0), ("half-space", 0.0)):
            curve = ratio.sel(roller_length=length, e_over_a=e_over_a, body=body)
            position = "half-spaces" if body == "half-space" else f"e = {e_over_a:g}a"
            ax.plot(1e3 * curve["longitudinal_creepage"], curve, label=f"{size}, {position}", **next(styles))
    ax.axhline(0.0, color="0.8", linewidth=0.8, zorder=0)
    ax.set_xlabel(r"longitudinal creepage, $10^3\,\xi$")
    ax.set_ylabel("force over full sliding's")


def draw_micro_slip(ax: Axes, study: xr.Dataset) -> None:
    """Work lost and part that slips when a roller of the same material rolls freely."""
    slipping_part = 1 - study["sticking_part"]
    loss = study["friction_work"] / sliding_force(study)
    error = 1e3 * study["friction_work_error"] / sliding_force(study)
    styles = marked_styles(3)
    ax.errorbar(study["e_over_a"], 1e3 * loss, error, label="work lost over $f W$, times $10^3$", **next(styles))
    ax.plot(study["e_over_a"], slipping_part, label="part of the contact that slips", **next(styles))
    creepage = 1e3 * study["longitudinal_creepage"]
    ax.plot(study["e_over_a"], creepage, label=r"longitudinal creepage, $10^3\,\xi$", **next(styles))
    ax.set_xlabel("distance of the roller's ends, $e/a$")


def draw_spin(ax: Axes, study: xr.Dataset) -> None:
    """Moment over full sliding's in opposite directions from mid-length, free ends and half-spaces."""
    ratio = study["moment_z"] / (0.25 * sliding_force(study) * study["contact_length"])
    styles = marked_styles(4)
    for length in study["roller_length"].values:
        size = f"{float(length / study['hertz_half_width'].max()):.0f}a"
        for body in ("finite-length", "half-space"):
            curve = ratio.sel(roller_length=length, body=body)
            ends = "free ends" if body == "finite-length" else "half-spaces"
            ax.plot(curve["spin"], curve, label=f"roller of {size}, {ends}", **next(styles))
    ax.set_xlabel(r"spin, $\varphi$ (rad/m)")
    ax.set_ylabel("moment over $f W L / 4$")


def draw_stress(ax: Axes, study: xr.Dataset) -> None:
    """Largest von Mises stress below the surface near a free end, and tension on the surface there."""
    creepage = study["longitudinal_creepage"]
    p0 = study["hertz_max_pressure"]
    near_end = study.sel(x_over_a=slice(0.0, 1.0))
    # A transverse traction that ends at the edge makes the stress unbounded at the corner.
    stress = near_end["von_mises"].sel(z_over_a=slice(MIN_DEPTH, None))
    max_stress = stress.max(("x_over_a", "y_field_over_a", "z_over_a")) / p0
    tension = near_end["sigma_yy"].sel(z_over_a=0.0).max(("x_over_a", "y_field_over_a")) / p0
    styles = marked_styles(4)
    ticks = np.arange(creepage.size)
    for friction in study["friction"].values:
        for values, quantity in ((max_stress, "von Mises below $0.2a$"), (tension, "tension on the surface")):
            curve = values.sel(friction=friction)
            ax.plot(ticks, curve, label=f"{quantity}, $f$ = {friction:g}", **next(styles))
    ax.set_ylim(0.0, 1.15)
    ax.set_xticks(ticks, [f"{1e3 * value:g}" for value in creepage.values])
    ax.set_xlabel(r"creepage, $10^3\,\xi$ (the last is full sliding)")
    ax.set_ylabel("within $a$ of the free end, over $p_0$")


def draw(studies: dict[str, xr.Dataset]) -> Figure:
    """One panel for each study."""
    figure, axes = plt.subplots(2, 2, figsize=(8.0, 7.4), layout="constrained")
    panels = (draw_curve, draw_micro_slip, draw_spin, draw_stress)
    for ax, name, panel in zip(axes.ravel(), NAMES, panels, strict=True):
        panel(ax, studies[name])
        ax.set_title(name.replace("_", " "), fontsize="medium")
        ax.legend(frameon=False, fontsize="small")
        ax.grid(color="0.9", linewidth=0.6)
    return figure


def main() -> None:
    """Open the studies and draw them."""
    parser = argparse.ArgumentParser(description="Figure of the studies of rolling.")
    parser.add_argument("--results", type=Path, default=Path("results"))
    options = parser.parse_args()
    studies = {name: cs.open_study(options.results / name) for name in NAMES}
    draw(studies).savefig(options.results / "rolling.png", dpi=110)


if __name__ == "__main__":
    main()
