"""Film at the ends over load, profile and end distance, and profiles with the thickest film or the lowest pressure.

python studies/film_profiles.py
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

import contactstudy as cs
from contactstudy.plots.style import line_styles

MODELS = {"flush": 0.0, "free end 2 a away": 2.0, "half-space": None}
"""Distances of the free ends over a; None: half-space."""

FULL_FILM = 3.0
"""Film ratio lambda above which the surfaces do not touch."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """Cases: one roller and oil; loads and crowns vary."""

    length: float = 1e-3
    radius: float = 5e-3
    speed: float = 2.0
    pressures: tuple[float, ...] = (0.8e9, 1.2e9, 1.6e9)
    crowns: tuple[float, ...] = (0.25, 0.5, 1.0, 1.5, 2.5, 5.0, 8.0, 12.0, 20.0)
    """Drops over those of Lundberg's profile for each pressure."""
    accuracy: float = 0.1

    @property
    def material(self) -> cs.Material:
        """Steel."""
        return cs.Material(210e9, 0.3)

    def case(self, pressure: float, crown: float, model: str) -> cs.Case:
        """Return a rigid crowned roller in the middle of a steel body."""
        modulus, distance = self.material.plane_strain_modulus, MODELS[model]
        profile = cs.profiles.Lundberg.for_pressure(pressure, radius=self.radius, modulus=modulus)
        profile = cs.profiles.Lundberg(amplitude=crown * profile.amplitude, delta=profile.delta)
        roller = cs.Roller(radius=self.radius, length=self.length, profile=profile)
        body: cs.HalfSpace | cs.FiniteLengthSpace = cs.HalfSpace(material=self.material)
        end_distance = None
        if distance is not None:
            end_distance = distance * 2 * self.radius * pressure / modulus
            body = cs.FiniteLengthSpace(length=self.length + 2 * end_distance, material=self.material)
        oil = cs.Lubricant.preset("heavy machine oil", 100.0)
        motion = cs.Sliding(body_speed=self.speed, roller_speed=self.speed)
        return cs.Case(
            body=body, roller=roller, end_distance=end_distance, max_pressure=pressure, lubricant=oil, motion=motion
        )


def solve_all(task: Task) -> xr.Dataset:
    """Films and dry peak pressures over model, load and crown."""
    rows = []
    for model in MODELS:
        for pressure in task.pressures:
            for crown in task.crowns:
                case = task.case(pressure, crown, model)
                try:
                    film = cs.solve_film(case, accuracy=task.accuracy)
                except cs.FilmError:  # no film at the ends
                    film = xr.Dataset()
                dry_contact = cs.solve(case, accuracy=0.05, stresses=False)
                values = {
                    name: float(film.get(name, np.nan))
                    for key in ("end_film_ratio", "least_film", "least_film_middle")
                    for name in (key, f"{key}_error")
                }
                if film:
                    # Slices beyond the contact carry no load and have no film.
                    values["slice_ratio"] = float(film["slice_film"].min() / film["slice_film"].median())
                peak = {name: float(dry_contact[name]) / pressure for name in ("peak_pressure", "peak_pressure_error")}
                coordinates = {"model": model, "max_pressure": pressure, "crown": crown}
                rows.append(xr.Dataset(values | peak, coordinates).expand_dims([*coordinates]))
    return xr.combine_by_coords(rows, combine_attrs="drop").sel(model=[*MODELS])


def choose_crowns(films: xr.Dataset) -> xr.Dataset:
    """Crowns with the thickest least film and with the lowest peak pressure, and the film that the latter loses."""
    film_crown = films["least_film"].fillna(0.0).idxmax("crown")
    pressure_crown = films["peak_pressure"].idxmin("crown")
    film_case, pressure_case = (films.sel(crown=crown).drop_vars("crown") for crown in (film_crown, pressure_crown))
    film_share = pressure_case["least_film"] / film_case["least_film"]
    return xr.Dataset(
        {
            "crown_film": film_crown,
            "crown_pressure": pressure_crown,
            "film_loss": 1 - film_share,
            "film_loss_error": (pressure_case["least_film_error"] + film_share * film_case["least_film_error"])
            / film_case["least_film"],
            "pressure_gain": film_case["peak_pressure"] / pressure_case["peak_pressure"] - 1,
        }
    )


def format_table(films: xr.Dataset) -> str:
    """Film ratios for the crown of each design pressure, middle film ratios of full films, and the two best crowns."""
    choice = choose_crowns(films)
    lines = [
        "| p0, GPa | ends | least over middle film | slices | middle lambda of a full film | crown: film, pressure "
        "| film lost | pressure gained |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for pressure in films["max_pressure"].values:
        for model in films["model"].values:
            case, choices = (data.sel(max_pressure=pressure, model=model) for data in (films, choice))
            design = case.sel(crown=1.0)
            ratio = float(design["end_film_ratio"])
            lines.append(
                f"| {1e-9 * pressure:g} | {model} | {ratio:.3f} ± {float(design['end_film_ratio_error']):.3f} "
                f"| {float(design['slice_ratio']):.2f} | {FULL_FILM / ratio:.1f} "
                f"| {float(choices['crown_film']):g}, {float(choices['crown_pressure']):g} "
                f"| {100 * float(choices['film_loss']):.1f} ± {100 * float(choices['film_loss_error']):.1f} % "
                f"| {100 * float(choices['pressure_gain']):.1f} % |"
            )
    return "\n".join(lines)


def draw(films: xr.Dataset) -> Figure:
    """Film ratio at the ends and peak pressure over the crown."""
    figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.8), layout="constrained")
    pressure = films["max_pressure"].values[films.sizes["max_pressure"] // 2]
    for model, style in zip(films["model"].values, line_styles(films.sizes["model"]), strict=True):
        case = films.sel(max_pressure=pressure, model=model)
        axes[0].errorbar(case["crown"], case["end_film_ratio"], case["end_film_ratio_error"], label=model, **style)
        axes[1].errorbar(case["crown"], case["peak_pressure"], case["peak_pressure_error"], **style)
    axes[0].set_ylabel("least film over that of the middle")
    axes[1].set_ylabel("dry peak pressure over $p_0$")
    for ax in axes:
        ax.set_xscale("log")
        ax.set_xlabel(f"drop over Lundberg's, $p_0$ = {1e-9 * pressure:g} GPa")
        ax.grid(color="0.9", linewidth=0.6)
    axes[0].legend(frameon=False, fontsize="small")
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Solve, print the table and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("results/film_profiles"))
    folder = parser.parse_args(arguments).out
    warnings.simplefilter("ignore", cs.MagnitudeWarning)
    films = solve_all(Task())
    folder.mkdir(parents=True, exist_ok=True)
    films.to_netcdf(folder / "films.nc")
    print(format_table(films))
    draw(films).savefig(folder / "film_profiles.png", dpi=150)


if __name__ == "__main__":
    main()
