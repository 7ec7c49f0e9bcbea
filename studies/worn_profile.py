"""A roller with sharp ends worn in, against the best crown.

Usage: ``python studies/worn_profile.py [--out FOLDER]``; about one minute. Writes ``worn_profile.nc`` (the wear),
``worn_profile_judged.nc`` and ``worn_profile.png`` and prints a table.

A rigid cylinder that ends half a width from the free ends slides under one load until its load per length is uniform.
Its profiles after little wear, more wear and wear-in are then pressed under other loads, at and beside mid-length.
Lundberg's profile with the factor that ``best_profile.py`` finds is pressed as well.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import contactstudy as cs
from contactstudy.plots.style import line_styles
from contactstudy.wear import wear_in, worn_profile

MIN_END_DISTANCE = 0.05
"""Least distance from the roller's end, over the half-width, of compared pressures; the ends are singular."""

WINDOW, CELLS_Y = 2.6, 64
"""Half-width of the window over the Hertz half-width, and its cells: sharp ends widen a contact."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """Roller, wear and loads: SI units."""

    material: cs.Material = field(default_factory=lambda: cs.Material(210e9, 0.3))
    radius: float = 5e-3
    length: float = 10e-3
    end_distance: float = 33e-6
    design_pressure: float = 1.5e9
    coefficient: float = 1e-17
    mean_depths: tuple[float, ...] = (0.1e-6, 1e-6, 10e-6)
    pressures: tuple[float, ...] = (1.0e9, 1.5e9, 2.0e9)
    offsets: tuple[float, ...] = (0.0, 0.5e-3)
    """Distances of the load from mid-length."""
    best_delta: float = 0.81

    @property
    def crown(self) -> cs.profiles.Lundberg:
        """The best crown."""
        modulus = self.material.plane_strain_modulus
        return cs.profiles.Lundberg.for_pressure(
            self.design_pressure, radius=self.radius, modulus=modulus, delta=self.best_delta
        )

    def case(
        self, profile: cs.profiles.Profile | None = None, pressure: float | None = None, offset: float = 0.0
    ) -> cs.Case:
        """One profile and load; without a profile the sharp cylinder."""
        body = cs.FiniteLengthSpace(length=self.length + 2 * self.end_distance, material=self.material)
        shape = cs.profiles.Cylinder() if profile is None else profile
        return cs.Case(
            body=body,
            roller=cs.Roller(radius=self.radius, length=self.length, profile=shape),
            max_pressure=self.design_pressure if pressure is None else pressure,
            end_distance=self.end_distance,
            load_position=self.end_distance + self.length / 2 + offset,
        )


def wear_roller(task: Task) -> xr.Dataset:
    """Wear at the design load, with results at some mean depths."""
    case = task.case()
    area = 2 * np.pi * task.radius * task.length
    distances = [0.0, *(area * depth / (task.coefficient * case.normal_load) for depth in task.mean_depths)]
    return wear_in(case, task.coefficient, distance=distances)


def collect_profiles(task: Task, worn: xr.Dataset) -> dict[str, cs.profiles.Profile]:
    """Return the compared profiles by name."""
    names = ["sharp", *(f"worn by {1e6 * depth:g} µm" for depth in task.mean_depths)]
    case = task.case()
    worn_profiles: dict[str, cs.profiles.Profile] = {
        name: worn_profile(case, worn, float(distance))
        for name, distance in zip(names, worn["distance"].values, strict=True)
    }
    return worn_profiles | {"best crown": task.crown}


def press_profiles(task: Task, worn: xr.Dataset) -> xr.Dataset:
    """Load per length and largest pressure of every profile under every load, on the cells of the wear."""
    edges = np.append(worn["x_bounds"].values[:, 0], worn["x_bounds"].values[-1, 1])
    compared_profiles = collect_profiles(task, worn)
    results = []
    for profile in compared_profiles.values():
        load_results = []
        for pressure in task.pressures:
            half_window = WINDOW * task.case(pressure=pressure).hertz_half_width
            grid = cs.Grid.from_edges(edges, (-half_window, half_window), CELLS_Y)
            load_results.append(
                xr.concat(
                    [_press_profile(task.case(profile, pressure, offset), grid) for offset in task.offsets],
                    xr.Variable("offset", list(task.offsets), {"units": "m"}),
                )
            )
        results.append(xr.concat(load_results, xr.Variable("max_pressure", list(task.pressures), {"units": "Pa"})))
    result = xr.concat(results, xr.Variable("profile", list(compared_profiles)))
    result.attrs = {"Conventions": "CF-1.11", "title": "a worn-in roller against the best crown"}
    return result


def _press_profile(case: cs.Case, grid: cs.Grid) -> xr.Dataset:
    """Load per length over the mean one, and pressure over p0 beside the ends and between them."""
    result = cs.solve(case, grid, stresses=False)
    line_load = cs.analysis.line_load(result) * case.contact_length / case.normal_load
    start, stop = case.contact_range
    is_compared = np.minimum(result["x"] - start, stop - result["x"]) >= MIN_END_DISTANCE * case.hertz_half_width
    max_pressure = result["pressure"].max("y").where(is_compared).max() / case.max_pressure
    return xr.Dataset(
        {
            "relative_load": line_load.assign_attrs(units="1", long_name="load per length over the mean"),
            "largest_pressure": max_pressure.assign_attrs(units="1", long_name="largest pressure over p0 off the ends"),
        }
    )


def draw(task: Task, worn: xr.Dataset, pressures: xr.Dataset) -> plt.Figure:
    """Profiles, and the load per length near an end at the load of the wear and at a higher load."""
    figure, axes = plt.subplots(3, 1, figsize=(5.4, 8.4), layout="constrained")
    compared_profiles = collect_profiles(task, worn)
    x = 0.5 * task.length * np.linspace(-1, 1, 2001)[1:-1]
    styles = line_styles(len(compared_profiles))
    drops = {name: 1e6 * profile.drop(x, task.length) for name, profile in compared_profiles.items()}
    for (name, drop), style in zip(drops.items(), styles, strict=True):
        axes[0].plot(1e3 * x, drop - drop[x.size // 2], label=name, **style)
    min_drop = min((drop - drop[x.size // 2]).min() for drop in drops.values())
    axes[0].set(xlabel="distance from mid-length (mm)", ylabel="drop below mid-length (µm)", ylim=(0.8, 1.1 * min_drop))
    axes[0].legend(frameon=False, fontsize="small", loc="lower center")
    for ax, pressure in zip(axes[1:], task.pressures[-2:], strict=True):
        for name, style in zip(compared_profiles, styles, strict=True):
            line = pressures["relative_load"].sel(profile=name, max_pressure=pressure, offset=task.offsets[0])
            distance = (line["x"].values - task.end_distance) / task.case().hertz_half_width
            is_near = (distance > MIN_END_DISTANCE) & (distance < 8)
            ax.plot(distance[is_near], line.values[is_near], **style)
        ax.set(xlabel="distance from the end over $a$ at 1.5 GPa", ylabel="load per length over the mean")
        ax.set(title=f"$p_0$ = {pressure / 1e9:g} GPa", ylim=(0.0, 2.0), xscale="log")
    return figure


def format_table(pressures: xr.Dataset) -> str:
    """Markdown: largest pressure off the ends, by load and its position."""
    loads = [(float(load), float(offset)) for offset in pressures["offset"] for load in pressures["max_pressure"]]
    headings = [f"{load / 1e9:g} GPa{f', {1e3 * offset:+g} mm' if offset else ''}" for load, offset in loads]
    lines = [f"| profile | {' | '.join(headings)} |", "|---" * (len(headings) + 1) + "|"]
    for name in pressures["profile"].values:
        cells = [
            f"{float(pressures['largest_pressure'].sel(profile=name, max_pressure=load, offset=offset)):.2f}"
            for load, offset in loads
        ]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Wear, press, draw, write."""
    parser = argparse.ArgumentParser(description="A roller with sharp ends worn in, against the best crown.")
    parser.add_argument("--out", type=Path, default=Path("results/worn_profile"))
    options = parser.parse_args()
    task = Task()
    worn = wear_roller(task)
    pressures = press_profiles(task, worn)
    options.out.mkdir(parents=True, exist_ok=True)
    worn.to_netcdf(options.out / "worn_profile.nc")
    pressures.to_netcdf(options.out / "worn_profile_judged.nc")
    draw(task, worn, pressures).savefig(options.out / "worn_profile.png", dpi=200)
    print(format_table(pressures))


if __name__ == "__main__":
    main()
