"""Residual stress that a roller leaves at a free end and in the middle when it is loaded above the shakedown limit.

Usage: ``python studies/residual_stress.py [--out FOLDER]``; about a minute. Writes ``residual_stress.nc`` and
``residual_stress.png`` and prints a table.

A slightly crowned roller with ends flush with the body's rolls over it many times. Its load is 15 % above Melan's limit
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
from contactstudy.plasticity import ElasticPlastic, residual_stress
from contactstudy.plots.style import line_styles

COMPONENTS = {"sigma_yy": "along rolling", "sigma_xx": "along the axis"}
"""Residual stresses of the figure."""

NEAR_END = 2.0
"""Largest distance from the free end, over a, of the largest flow near the end."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """Roller, body and passes: SI units, positions over the half-width a."""

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
        x_edges = 0.5 * self.length * (1 - np.cos(np.linspace(0, np.pi, self.cells_x + 1)))
        z_edges = self.depth * a * np.linspace(0, 1, self.cells_z + 1)
        return {
            "x": 0.5 * (x_edges[1:] + x_edges[:-1]),
            "y": self.window * a * np.linspace(-1, 1, self.positions_y),
            "z": 0.5 * (z_edges[1:] + z_edges[:-1]),
        }


def roll_passes(task: Task) -> xr.Dataset:
    """Residual stresses over k, positions over a, plastic strains."""
    case = task.case
    stress = cs.solve(case, **task.points)
    limit = shakedown_limit(stress)
    shear_yield = task.max_pressure / (task.overload * float(limit["shakedown_limit"]))
    plastic = ElasticPlastic(yield_stress=np.sqrt(3) * shear_yield, kinematic_hardening=task.kinematic_hardening)
    passes = residual_stress(stress, case.body, plastic, passes=task.passes)
    a = case.hertz_half_width
    residual = passes[list(COMPONENTS)] / shear_yield
    for name, direction in COMPONENTS.items():
        residual[name].attrs = {"units": "1", "long_name": f"residual stress {direction} over k"}
    strain = passes["equivalent_plastic_strain"]
    residual["plastic_strain"] = strain.assign_attrs(units="1", long_name="accumulated equivalent plastic strain")
    x_dim = next(str(dim) for dim in strain.dims if str(dim).startswith("x"))
    residual = residual.rename({x_dim: "x"}).assign_coords(x=task.points["x"] / a, z=task.points["z"] / a)
    for axis in "xz":
        residual[axis].attrs = {"units": "1", "long_name": f"{axis} over the half-width"}
    residual["shear_yield_stress"] = xr.DataArray(shear_yield, attrs={"units": "Pa"})
    residual["shakedown_limit"] = limit["shakedown_limit"].reset_coords(drop=True)
    residual.attrs = {"Conventions": "CF-1.11", "title": "residual stress at a free end and in the middle"}
    return residual


def select_depths(residual: xr.Dataset) -> dict[str, xr.Dataset]:
    """Depth profiles on the free end, at the largest flow near the end, and in the middle."""
    strain = residual["plastic_strain"].isel(pass_number=-1).max("z")
    flow_index = int(strain.where(strain["x"] < NEAR_END).argmax("x"))
    return {
        "on the free end": residual.isel(x=0),
        f"{float(residual['x'][flow_index]):.1f} a inside": residual.isel(x=flow_index),
        "in the middle": residual.isel(x=residual.sizes["x"] // 2),
    }


def compute_flow(profile: xr.Dataset) -> xr.DataArray:
    """Largest equivalent plastic strain that each pass adds."""
    strain = profile["plastic_strain"]
    return xr.concat([strain.isel(pass_number=[0]), strain.diff("pass_number")], "pass_number").max("z")


def draw(residual: xr.Dataset) -> plt.Figure:
    """Residual stresses over the depth at the three places and over the section, and the flow of each pass."""
    figure, axes = plt.subplots(2, 2, figsize=(8.0, 6.4), layout="constrained")
    profiles = select_depths(residual)
    for ax, (name, direction) in zip(axes[0], COMPONENTS.items(), strict=True):
        for (label, profile), style in zip(profiles.items(), line_styles(len(profiles)), strict=True):
            ax.plot(profile[name].isel(pass_number=-1), profile["z"], label=label, **style)
        ax.axvline(0, color="grey", linewidth=0.8)
        ax.set(xlabel=f"residual stress {direction} over $k$", ylabel="$z/a$")
        ax.invert_yaxis()
    axes[0, 0].legend(frameon=False, fontsize="small")
    section = residual["sigma_yy"].isel(pass_number=-1).transpose("z", "x")
    bound = np.ceil(20 * float(abs(section).max())) / 20
    levels = np.linspace(-bound, bound, 22)
    contours = axes[1, 0].contourf(residual["x"], residual["z"], section, levels=levels, cmap="RdBu_r")
    label = "residual stress along rolling over $k$"
    figure.colorbar(contours, ax=axes[1, 0], label=label, ticks=np.linspace(-bound, bound, 7))
    axes[1, 0].set(xlabel="distance from the free end, $x/a$", ylabel="$z/a$")
    axes[1, 0].invert_yaxis()
    for (label, profile), style in zip(profiles.items(), line_styles(len(profiles)), strict=True):
        increments = compute_flow(profile)
        axes[1, 1].semilogy(
            increments["pass_number"], increments.where(increments > 0), marker="o", label=label, **style
        )
    axes[1, 1].set(xlabel="pass", ylabel="largest plastic strain that it adds")
    return figure


def format_table(residual: xr.Dataset) -> str:
    """Markdown: extremes of the residual stresses at each place, and the flow of the first and the last pass."""
    headings = [f"{direction}, lowest and highest over k" for direction in COMPONENTS.values()]
    lines = [f"| place | {' | '.join(headings)} | strain, first pass | strain, last pass |", "|---" * 5 + "|"]
    for label, profile in select_depths(residual).items():
        last = profile.isel(pass_number=-1)
        cells = [f"{float(last[name].min()):.2f} to {float(last[name].max()):.2f}" for name in COMPONENTS]
        increments = compute_flow(profile)
        cells += [f"{float(increments[number]):.1e}" for number in (0, -1)]
        lines.append(f"| {label} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Roll, draw, write."""
    parser = argparse.ArgumentParser(description="Residual stress at a free end and in the middle.")
    parser.add_argument("--out", type=Path, default=Path("results/residual_stress"))
    options = parser.parse_args()
    residual = roll_passes(Task())
    options.out.mkdir(parents=True, exist_ok=True)
    residual.to_netcdf(options.out / "residual_stress.nc")
    draw(residual).savefig(options.out / "residual_stress.png", dpi=160)
    print(f"shakedown limit p0/k = {float(residual['shakedown_limit']):.2f}")
    print(f"k = {float(residual['shear_yield_stress']) / 1e6:.0f} MPa\n")
    print(format_table(residual))


if __name__ == "__main__":
    main()
