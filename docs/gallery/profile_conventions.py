"""Drop, length, corner radius and distance e of a roller on a body."""

from __future__ import annotations

import numpy as np
from matplotlib import pyplot
from matplotlib.axes import Axes

from contactstudy import profiles

STEEL, ROLLER = "0.88", "0.72"


def draw_dimension(ax: Axes, start: tuple[float, float], stop: tuple[float, float], text: str = "") -> None:
    """Draw a line with an arrow at both ends, and its name in the middle."""
    ax.annotate("", start, stop, arrowprops={"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0, "linewidth": 0.9})
    if text:
        middle = (0.5 * (start[0] + stop[0]), 0.5 * (start[1] + stop[1]))
        box = {"facecolor": "white", "edgecolor": "none", "pad": 2.0}
        ax.text(*middle, text, ha="center", va="center", fontsize="small", bbox=box)


def draw_roller(ax: Axes, start: float, length: float, profile: profiles.Profile, top: float) -> None:
    """Fill a roller over the surface z = 0, its drop as it is."""
    x = 0.5 * length * np.linspace(-1, 1, 801)
    outline = np.minimum(profile.drop(x, length), top)
    middle = start + 0.5 * length
    ax.fill_between(middle + x, outline, top, facecolor=ROLLER, edgecolor="none")
    ax.plot(middle + x, outline, color="black", linewidth=1.2)
    for end, height in ((x[0], outline[0]), (x[-1], outline[-1])):
        ax.plot([middle + end] * 2, [height, top], color="black", linewidth=1.2)


def draw_conventions(ax: Axes) -> None:
    """One roller on one body with all the words."""
    body, start, length, fillet, top = 12.0, 1.4, 9.2, 1.0, 3.6
    crown = profiles.PartialCrown(3.6, 14.0) + profiles.Cylinder(fillet)
    middle = start + length / 2
    ax.fill_between([0, body], -2.2, 0, facecolor=STEEL, edgecolor="none")
    ax.plot([0, 0, body, body], [-2.2, 0, 0, -2.2], color="black", linewidth=1.2)
    draw_roller(ax, start, length, crown, top)
    ax.plot([start - 0.6, start + length + 0.6], [top, top], color="black", linewidth=0.8, linestyle=(0, (8, 2, 2, 2)))
    ax.text(start + length + 0.75, top, "axis", va="center", fontsize="small")
    position = start + 0.14 * fillet
    depth = float(crown.drop(np.array([position - middle]), length)[0])
    draw_dimension(ax, (position, 0), (position, depth))
    ax.text(position - 0.25, 0.5 * depth, "drop", ha="right", va="center", fontsize="small")
    draw_dimension(ax, (middle - 2.4, 0), (middle - 2.4, top), "radius at mid-length")
    ax.plot([middle, middle], [-0.9, top], color="0.35", linewidth=0.7, linestyle=":")
    ax.annotate("", (middle + 1.8, 1.4), (middle, 1.4), arrowprops={"arrowstyle": "->", "linewidth": 0.9})
    ax.text(middle + 0.15, 1.65, "x of a profile", fontsize="small")
    for edge in (start, start + length):
        ax.plot([edge, edge], [0, -1.0], color="0.35", linewidth=0.7)
    draw_dimension(ax, (start, -0.75), (start + length, -0.75), "roller's length")
    draw_dimension(ax, (0, -0.75), (start, -0.75), "e")
    draw_dimension(ax, (0, -1.65), (body, -1.65), "body's length")
    ax.annotate(
        "fillet\n(corner radius)",
        (start + length - 0.3 * fillet, float(crown.drop(np.array([length / 2 - 0.3 * fillet]), length)[0])),
        (start + length + 0.5, 1.6),
        fontsize="small",
        va="center",
        arrowprops={"arrowstyle": "->", "linewidth": 0.9},
    )
    ax.text(-0.15, -1.2, "end I,\nx = 0 of a case", ha="right", fontsize="small")
    ax.text(body + 0.15, -1.2, "end II", fontsize="small")
    ax.set_xlim(-2.4, 14.4)
    ax.set_ylim(-2.2, 4.0)
    ax.set_aspect("equal")
    ax.set_axis_off()


def draw_position(ax: Axes, distance: float, text: str) -> None:
    """Left end of a roller over the left end of a body."""
    ax.fill_between([0, 4], -1.6, 0, facecolor=STEEL, edgecolor="none")
    ax.plot([0, 0, 4], [-1.6, 0, 0], color="black", linewidth=1.2)
    x = distance + np.concatenate([[0.0], 0.35 * (1 - np.cos(np.linspace(0, np.pi / 2, 60)))])
    outline = np.concatenate([[1.5], 0.35 * (1 - np.sin(np.linspace(0, np.pi / 2, 60)))])
    x, outline = np.append(x, 4.0), np.append(outline, 0.0)
    ax.fill_between(x, outline, 1.5, facecolor=ROLLER, edgecolor="none")
    ax.plot(x, outline, color="black", linewidth=1.2)
    if distance:
        ax.plot([distance, distance], [0.0, -0.6], color="0.35", linewidth=0.7)
        ax.annotate("", (0, -0.5), (distance, -0.5), arrowprops={"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0})
    ax.set_title(text, fontsize="medium")
    ax.set_xlim(-1.2, 3.2)
    ax.set_ylim(-1.6, 1.7)
    ax.set_aspect("equal")
    ax.set_axis_off()


def main() -> None:
    """Sketch of what drop, length, fillet and e are."""
    figure = pyplot.figure(figsize=(8.0, 5.4), layout="constrained")
    axes = figure.subplot_mosaic([["all"] * 3, ["inside", "flush", "over"]], height_ratios=[1.7, 1.0])
    draw_conventions(axes["all"])
    draw_position(axes["inside"], 0.9, "e > 0: inside")
    draw_position(axes["flush"], 0.0, "e = 0: flush")
    draw_position(axes["over"], -0.7, "e < 0: overhanging")
    figure.savefig("profile_conventions.png", dpi=200)


if __name__ == "__main__":
    main()
