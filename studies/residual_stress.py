"""Residual stress that a roller leaves at a free end and in the middle when it is loaded above the shakedown limit.

Usage: ``python studies/residual_stress.py [--out FOLDER]``; about a minute. Writes ``residual_stress.nc`` and
``residual_stress.png`` and prints a table.

A slightly crowned roller that ends with the body rolls over it again and again. Its load is 15 % above Melan's limit
with residual stress along rolling. The material hardens a little. Stresses and depths are over k and a.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import contactstudy as cs
from contactstudy.fatigue import shakedown_limit
from contactstudy.passes import ElasticPlastic, rolled_in
from contactstudy.plots.style import line_styles

SHOWN = {"sigma_yy": "along rolling", "sigma_xx": "along the axis"}
"""Residual stresses of the figure."""

NEAR_END = 2.0
"""Distance from the free end, over a, within which its largest flow is looked for."""


@dataclass(frozen=True)
class Task:
    """What rolls over what: SI units, positions over the half-width a."""

    material: cs.Material = field(default_factory=lambda: cs.Material(210e9, 0.3))
    radius: float = 5e-3
    length: float = 1e-3
    max_pressure: float = 2.0e9
    friction: float = 0.1
    delta: float = 0.6
    overload: float = 1.15
    kinematic_hardening: float = 5e9
    passes: int = 6
    cells_x: int = 28
    cells_z: int = 18
    depth: float = 1.8
    window: float = 2.5
    positions_y: int = 61

    @property
    def case(self) -> cs.Case:
        """The contact, flush at both ends."""
        crown = cs.profiles.Lundberg.for_pressure(
            self.max_pressure, radius=self.radius, modulus=self.material.plane_strain_modulus, delta=self.delta
        )
        return cs.Case(
            body=cs.FiniteLengthSpace(length=self.length, material=self.material),
            roller=cs.Roller(radius=self.radius, length=self.length, profile=crown),
            max_pressure=self.max_pressure,
            friction=self.friction,
            end_distance=0.0,
        )

    @property
    def points(self) -> dict[str, np.ndarray]:
        """Positions of the stresses: middles of cells that are narrow at the ends and near the top."""
        a = self.case.hertz_half_width
        along = 0.5 * self.length * (1 - np.cos(np.linspace(0, np.pi, self.cells_x + 1)))
        down = self.depth * a * np.linspace(0, 1, self.cells_z + 1)
        return {
            "x": 0.5 * (along[1:] + along[:-1]),
            "y": self.window * a * np.linspace(-1, 1, self.positions_y),
            "z": 0.5 * (down[1:] + down[:-1]),
        }


def rolled(task: Task) -> xr.Dataset:
    """Return what the passes leave: stresses over k, positions over a, strains."""
    case = task.case
    stress = cs.solve(case, **task.points)
    limit = shakedown_limit(stress)
    shear_yield = task.max_pressure / (task.overload * float(limit["shakedown_limit"]))
    plastic = ElasticPlastic(yield_stress=np.sqrt(3) * shear_yield, kinematic_hardening=task.kinematic_hardening)
    left = rolled_in(stress, case.body, plastic, passes=task.passes)
    a = case.hertz_half_width
    found = left[list(SHOWN)] / shear_yield
    for name, words in SHOWN.items():
        found[name].attrs = {"units": "1", "long_name": f"residual stress {words} over k"}
    strain = left["equivalent_plastic_strain"]
    found["plastic_strain"] = strain.assign_attrs(units="1", long_name="accumulated equivalent plastic strain")
    along = next(str(dim) for dim in strain.dims if str(dim).startswith("x"))
    found = found.rename({along: "x"}).assign_coords(x=task.points["x"] / a, z=task.points["z"] / a)
    for axis in "xz":
        found[axis].attrs = {"units": "1", "long_name": f"{axis} over the half-width"}
    found["shear_yield_stress"] = xr.DataArray(shear_yield, attrs={"units": "Pa"})
    found["shakedown_limit"] = limit["shakedown_limit"].reset_coords(drop=True)
    found.attrs = {"Conventions": "CF-1.11", "title": "residual stress at a free end and in the middle"}
    return found


def places(found: xr.Dataset) -> dict[str, xr.Dataset]:
    """Depths on the free end, where most flows near it, and in the middle."""
    flown = found["plastic_strain"].isel(pass_number=-1).max("z")
    near = int(flown.where(flown["x"] < NEAR_END).argmax("x"))
    return {
        "on the free end": found.isel(x=0),
        f"{float(found['x'][near]):.1f} a inside": found.isel(x=near),
        "in the middle": found.isel(x=found.sizes["x"] // 2),
    }


def flow(one: xr.Dataset) -> xr.DataArray:
    """Largest equivalent plastic strain that each pass adds."""
    strain = one["plastic_strain"]
    return xr.concat([strain.isel(pass_number=[0]), strain.diff("pass_number")], "pass_number").max("z")


def draw(found: xr.Dataset) -> plt.Figure:
    """Residual stresses over the depth at the three places and over the section, and the flow of each pass."""
    figure, axes = plt.subplots(2, 2, figsize=(10.0, 7.6), layout="constrained")
    shown = places(found)
    for ax, (name, words) in zip(axes[0], SHOWN.items(), strict=True):
        for (place, one), style in zip(shown.items(), line_styles(len(shown)), strict=True):
            ax.plot(one[name].isel(pass_number=-1), one["z"], label=place, **style)
        ax.axvline(0, color="grey", linewidth=0.8)
        ax.set(xlabel=f"residual stress {words} over $k$", ylabel="$z/a$")
        ax.invert_yaxis()
    axes[0, 0].legend(frameon=False, fontsize="small")
    section = found["sigma_yy"].isel(pass_number=-1).transpose("z", "x")
    bound = np.ceil(20 * float(abs(section).max())) / 20
    levels = np.linspace(-bound, bound, 22)
    filled = axes[1, 0].contourf(found["x"], found["z"], section, levels=levels, cmap="RdBu_r")
    label = "residual stress along rolling over $k$"
    figure.colorbar(filled, ax=axes[1, 0], label=label, ticks=np.linspace(-bound, bound, 7))
    axes[1, 0].set(xlabel="distance from the free end, $x/a$", ylabel="$z/a$")
    axes[1, 0].invert_yaxis()
    for (place, one), style in zip(shown.items(), line_styles(len(shown)), strict=True):
        each = flow(one)
        axes[1, 1].semilogy(each["pass_number"], each.where(each > 0), marker="o", label=place, **style)
    axes[1, 1].set(xlabel="pass", ylabel="largest plastic strain that it adds")
    return figure


def table(found: xr.Dataset) -> str:
    """Markdown: extremes of the residual stresses at both places, and the flow of the first and the last pass."""
    heads = [f"{words}, lowest and highest over k" for words in SHOWN.values()]
    lines = [f"| place | {' | '.join(heads)} | strain, first pass | strain, last pass |", "|---" * 5 + "|"]
    for place, one in places(found).items():
        last = one.isel(pass_number=-1)
        cells = [f"{float(last[name].min()):.2f} to {float(last[name].max()):.2f}" for name in SHOWN]
        each = flow(one)
        cells += [f"{float(each[number]):.1e}" for number in (0, -1)]
        lines.append(f"| {place} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Roll, draw, write."""
    parser = argparse.ArgumentParser(description="Residual stress at a free end and in the middle.")
    parser.add_argument("--out", type=Path, default=Path("results/residual_stress"))
    options = parser.parse_args()
    found = rolled(Task())
    options.out.mkdir(parents=True, exist_ok=True)
    found.to_netcdf(options.out / "residual_stress.nc")
    draw(found).savefig(options.out / "residual_stress.png", dpi=100)
    print(f"shakedown limit p0/k = {float(found['shakedown_limit']):.2f}")
    print(f"k = {float(found['shear_yield_stress']) / 1e6:.0f} MPa\n")
    print(table(found))


if __name__ == "__main__":
    main()
