"""Shakedown limit of a crowned roller, from the study shakedown.toml.

Usage, after ``contactstudy run studies/shakedown.toml``: ``python studies/shakedown.py [FOLDER]``, default
``results/shakedown``. Writes ``shakedown_limits.csv`` and ``shakedown.png`` into the folder and prints a table.

Melan's bound with residual stress along rolling, over friction and the distance e of the roller's end from the free
end, for each crown; beside it the line contact between half-spaces, where residual stress along the axis is free as
well (K. L. Johnson, A shakedown limit in rolling contact, Proc. 4th US National Congress of Applied Mechanics (1962)
971-975).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import contactstudy as cs
from contactstudy.fatigue import shakedown_limit
from contactstudy.plots.style import line_styles
from contactstudy.verification.closed_forms import hertz_strip

LINE_CONTACT = {
    "first yield": ("first_yield_limit", False),
    "along rolling": ("shakedown_limit", False),
    "along rolling and axis (Johnson)": ("shakedown_limit", True),
}
"""Limits of the line contact by residual stress: name of the limit, and whether stress along the axis contributes."""

LEVELS = np.linspace(1.0, 3.4, 25)
"""Values of the map."""


def line_contact(frictions: np.ndarray, poisson: float) -> xr.Dataset:
    """Limits of Hertz' line contact by friction: a variable for each of LINE_CONTACT."""
    y, z = np.linspace(-4.0, 4.0, 161), np.linspace(0.0, 1.5, 61)
    limits_by_model: dict[str, list[float]] = {name: [] for name in LINE_CONTACT}
    for friction in frictions:
        stress = hertz_strip(y[:, None], z, 1.0, 1.0, poisson, friction=float(friction))
        fields = xr.Dataset({name: (("y", "z"), values) for name, values in stress.items()}, {"y": y, "z": z})
        fields["hertz_max_pressure"] = 1.0
        limits = {axial: shakedown_limit(fields, axial=axial) for axial in (False, True)}
        for name, (limit, axial) in LINE_CONTACT.items():
            limits_by_model[name].append(float(limits[axial][limit]))
    return xr.Dataset({name: ("friction", values) for name, values in limits_by_model.items()}, {"friction": frictions})


def stated_errors(study: xr.Dataset) -> xr.DataArray:
    """Relative stated error of the shakedown limit."""
    return (study["shakedown_limit_error"] / study["shakedown_limit"]).rename("error")


def draw(study: xr.Dataset, limits: xr.Dataset) -> plt.Figure:
    """Limits over friction and distance: a map, and lines with the line contact's limits, for each crown."""
    crowns = study["profile"].values
    figure, axes = plt.subplots(2, crowns.size, figsize=(8.0, 7.4), layout="constrained", squeeze=False)
    for crown, map_ax, line_ax in zip(crowns, *axes, strict=True):
        limit = study["shakedown_limit"].sel(profile=crown).transpose("e_over_a", "friction")
        friction, distance = limit["friction"].values, limit["e_over_a"].values
        contours = map_ax.contourf(friction, distance, limit.values, levels=LEVELS, cmap="viridis", extend="both")
        lines = map_ax.contour(friction, distance, limit.values, levels=LEVELS[2::2], colors="white", linewidths=0.8)
        map_ax.clabel(lines, fmt="%.1f", fontsize="small")
        map_ax.set(title=str(crown), xlabel="friction", ylabel="$e/a$")
        for value, style in zip(distance, line_styles(distance.size), strict=True):
            line_ax.plot(friction, limit.sel(e_over_a=value), label=f"$e$ = {value:g} $a$", **style)
        for name, dashes in zip(LINE_CONTACT, (":", "--", "-"), strict=True):
            line_ax.plot(
                limits["friction"], limits[name], color="black", linestyle=dashes, label=f"line contact, {name}"
            )
        line_ax.set(xlabel="friction", ylabel="$p_0/k$", ylim=(0.8, 4.1))
    figure.colorbar(contours, ax=axes[0], label="$p_0/k$ at shakedown")
    figure.legend(
        *axes[1, -1].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize="small", frameon=False
    )
    return figure


def format_table(study: xr.Dataset, line_limits: xr.Dataset) -> str:
    """Markdown: limits by crown and distance, and of the line contact, for every second friction."""
    frictions = study["friction"].values[::2]
    lines = [
        f"| crown | e / a | {' | '.join(f'f = {friction:g}' for friction in frictions)} |",
        "|---" * (2 + frictions.size) + "|",
    ]
    for crown in study["profile"].values:
        for distance in study["e_over_a"].values:
            row = study.sel(profile=crown, e_over_a=distance, friction=frictions)
            limits = zip(row["shakedown_limit"].values, row["shakedown_limit_error"].values, strict=True)
            cells = [
                f"{limit:.2f} ± {error:.2f}" if np.isfinite(error) else f"{limit:.2f}, rim" for limit, error in limits
            ]
            lines.append(f"| {crown} | {distance:g} | {' | '.join(cells)} |")
    for name in LINE_CONTACT:
        cells = [f"{value:.2f}" for value in line_limits[name].sel(friction=frictions).values]
        lines.append(f"| line contact, {name} | | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Draw the study and print its table."""
    parser = argparse.ArgumentParser(description="Shakedown limit between free ends.")
    parser.add_argument("folder", type=Path, nargs="?", default=Path("results/shakedown"))
    folder: Path = parser.parse_args().folder
    opened_study = cs.open_study(folder)
    study = opened_study[["shakedown_limit", "shakedown_limit_error", "first_yield_limit"]].load()
    poisson = json.loads(opened_study.attrs["contactstudy_study"])["base"]["poisson"]
    line_limits = line_contact(study["friction"].values, poisson)
    study.to_dataframe().to_csv(folder / "shakedown_limits.csv")
    draw(study, line_limits).savefig(folder / "shakedown.png", dpi=100)
    print(format_table(study, line_limits))
    errors = stated_errors(study).values
    finite_errors = errors[np.isfinite(errors)]
    unestimated = errors.size - finite_errors.size
    print(
        f"\nlargest stated error: {100 * finite_errors.max():.1f} %; without an error: {unestimated} of {errors.size}"
    )
    print(f"\nwrote shakedown_limits.csv and shakedown.png in {folder}")


if __name__ == "__main__":
    main()
