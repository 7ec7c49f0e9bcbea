"""Draw the errors of the half-space and of approximate models of free ends, from the study regime_map.toml.

Usage, after ``contactstudy run studies/regime_map.toml``: ``python studies/regime_map.py [FOLDER] [--finer]``, default
``results/regime_map``. Writes ``errors.nc``, ``limits.csv`` and a figure for each crown into the folder, and prints
the distances beyond which the errors stay small. With ``--finer`` it solves some cases again to a
quarter of the accuracy and prints the change of the errors.

The errors depend on the ratio of e to the body's length: with free ends a quarter of the length away, the
half-space errs by 2.6 % from L = 32 a on and by 8 % at 4 a, for every crown; at half that distance by 9 to 33 %. A
single pair of mirrored loads with two separate vertical half-spaces, the published scheme, errs by at most 1 % in
pressure, 1.2 % in load and 4.3 % in stress.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.colors import BoundaryNorm

import contactstudy as cs

MODELS = {
    "half-space": {"body": "half-space", "model": "exact"},
    "mirrored load": {"body": "finite-length", "model": "mirror"},
    "with Guilbault's factor": {"body": "finite-length", "model": "mirror-factor"},
    "single mirror": {"body": "finite-length", "model": "single-mirror"},
    "quarter space": {"body": "quarter-space", "model": "exact"},
}
"""Parameters of the study that select each model, by the model's title."""

QUANTITIES = {
    "peak_pressure_first": "largest pressure",
    "peak_von_mises": "von Mises stress",
    "end_load_first": "load on the last $a$",
}
"""Compared quantities; pressure and load of the half at end I, because a quarter space has one end."""

LIMITS = (5.0, 1.0)
"""Limits of the errors, in percent."""


def select_quantities(study: xr.Dataset) -> xr.Dataset:
    """Largest pressure between the end and the middle, largest stress, and the load within a of the roller's end."""
    radius = json.loads(study.attrs["contactstudy_study"])["base"]["radius"]
    length = (study["gamma"] * radius / study["hertz_half_width"].max()).round(3)
    return study[list(QUANTITIES)].assign_coords(length_over_a=length)


def describe_stated_errors(study: xr.Dataset) -> str:
    """Largest stated error of each quantity, in words."""
    parts = []
    for name in QUANTITIES:
        finite = np.isfinite(study[name]) & (study[name] > 0)
        share = (study[f"{name}_error"] / study[name]).where(finite)
        parts.append(f"{QUANTITIES[name].replace('$', '')}: {100 * float(share.max()):.2f} %")
    return f"largest stated error of the {', of the '.join(parts)}"


def compute_errors(values: xr.Dataset) -> xr.Dataset:
    """Error of each model against the exact ends, in percent; infinite where only the model's pressure is singular."""
    exact = select_model(values, {"body": "finite-length", "model": "exact"})
    approximations = [100 * (select_model(values, selection) / exact - 1) for selection in MODELS.values()]
    result = xr.concat(approximations, xr.DataArray(list(MODELS), dims="approximation", name="approximation"))
    # The largest stress of a quarter space may lie where the other body ends.
    comparable = result["approximation"] != "quarter space"
    result["peak_von_mises"] = result["peak_von_mises"].where(comparable)
    for name, meaning in QUANTITIES.items():
        result[name].attrs = {"units": "percent", "long_name": f"error of the {meaning.replace('$', '')}"}
    result.attrs = {"Conventions": "CF-1.11", "title": "errors of approximations for free ends"}
    return result.assign_coords(length_over_a=values["length_over_a"])


def select_model(values: xr.Dataset, selection: dict[str, str]) -> xr.Dataset:
    """Return the cases of one body and model."""
    number = next(
        i
        for i, pair in enumerate(zip(values["body"].values, values["model"].values, strict=True))
        if pair == (selection["body"], selection["model"])
    )
    return values.isel(body_and_model=number, drop=True).reset_coords(drop=True)


def find_limits(error: xr.Dataset) -> xr.Dataset:
    """Smallest e/a of the study beyond which the errors stay below each limit; NaN without such a distance."""
    magnitude = abs(error)
    distances = error["e_over_a"]
    beyond_maxima = [magnitude.sel(e_over_a=slice(e, None)).max("e_over_a") for e in distances.values]
    largest = xr.concat(beyond_maxima, distances)
    return xr.concat(
        [distances.where(largest < limit).min("e_over_a") for limit in LIMITS],
        xr.DataArray(list(LIMITS), dims="below", name="below", attrs={"units": "percent"}),
    )


def format_table(error: xr.Dataset) -> str:
    """Markdown: e/a beyond which errors stay below 5 and 1 % for every crown and friction."""
    largest = abs(error).max(["profile", "friction"])
    max_distance = largest["e_over_a"].where(largest["end_load_first"].notnull()).max(["e_over_a", "approximation"])
    lengths = [f"L = {length:g} a" for length in error["length_over_a"].values]
    lines = [f"| model | quantity | {' | '.join(lengths)} |", "|---" * (2 + len(lengths)) + "|"]
    for model in MODELS:
        for name, meaning in QUANTITIES.items():
            if largest[name].sel(approximation=model).isnull().all():
                continue
            values = find_limits(largest)[name].sel(approximation=model).transpose("gamma", "below").values
            cells = [
                " / ".join(f"{e:g}" if np.isfinite(e) else f"> {last:g}" for e in pair)
                for pair, last in zip(values, max_distance.values, strict=True)
            ]
            lines.append(f"| {model} | {meaning.replace('$', '')} | {' | '.join(cells)} |")
    return "\n".join(lines)


def draw(error: xr.Dataset, profile: str) -> plt.Figure:
    """Errors over e/a and length of each model and quantity for one crown, without friction; lines at the limits."""
    figure, axes = plt.subplots(
        len(MODELS), len(QUANTITIES), figsize=(8.0, 10.6), sharex=True, sharey=True, layout="constrained"
    )
    bands = [0.0, 1.0, 5.0, 20.0, 1000.0]
    colours = plt.get_cmap("viridis_r", len(bands) - 1)
    for row, model in zip(axes, MODELS, strict=True):
        for ax, name in zip(row, QUANTITIES, strict=True):
            panel = error[name].sel(approximation=model, friction=0.0, profile=profile).transpose("gamma", "e_over_a")
            magnitude = np.ma.masked_where(np.isnan(panel.values), np.minimum(abs(panel.values), 0.99 * bands[-1]))
            mesh = ax.pcolormesh(magnitude, cmap=colours, norm=BoundaryNorm(bands, colours.N))
            # Lines that follow the cells' borders: the values repeated on a much finer grid.
            fine_image = np.repeat(np.repeat(magnitude, 40, axis=0), 40, axis=1)
            y, x = ((np.arange(size) + 0.5) / 40 for size in fine_image.shape)
            ax.contour(x, y, fine_image, levels=sorted(LIMITS), colors="black", linestyles=["--", "-"], linewidths=1.6)
            for (i, j), value in np.ndenumerate(panel.values):
                if not np.isnan(value):
                    colour = "white" if abs(value) > 5 else "black"
                    text = f"{value:+.0f}" if abs(value) >= 9.95 else f"{value:+.1f}"
                    text = "\N{INFINITY}" if np.isinf(value) else text
                    ax.text(j + 0.5, i + 0.5, text, ha="center", va="center", color=colour, fontsize=7)
            ax.patch.set(facecolor="white", edgecolor="0.8", hatch="///")
    for ax, meaning in zip(axes[0], QUANTITIES.values(), strict=True):
        ax.set_title(meaning, fontsize="medium")
    for ax, model in zip(axes[:, 0], MODELS, strict=True):
        ax.set_ylabel(f"{model}\n$L_f/a$")
        ax.set_yticks(np.arange(error.sizes["gamma"]) + 0.5, [f"{v:g}" for v in error["length_over_a"].values])
    for ax in axes[-1]:
        ax.set_xlabel("$e/a$")
        ax.set_xticks(np.arange(error.sizes["e_over_a"]) + 0.5, [f"{v:g}" for v in error["e_over_a"].values])
    bar = figure.colorbar(mesh, ax=axes, ticks=bands[1:-1], location="bottom", shrink=0.6, pad=0.01)
    bar.set_label("size of the error (%); lines: solid 5 %, dashed 1 %")
    figure.suptitle(f"{profile}: error against exact free ends (%)")
    return figure


def refine_study(study: cs.Study) -> cs.Study:
    """Return some of the study's cases, without friction, solved to a quarter of the accuracy."""
    sweep = {**study.sweep, "e_over_a": [0.0, 2.0, 8.0], "friction": [0.0], "gamma": [0.026, 0.104, 0.832]}
    base = {**study.base, "accuracy": study.base["accuracy"] / 4}
    return replace(study, name=f"{study.name}_finer", base=base, sweep=sweep)


def main() -> None:
    """Evaluate and draw the study, or check its cells."""
    parser = argparse.ArgumentParser(description="Errors of the half-space and of approximate models of free ends.")
    parser.add_argument("folder", type=Path, nargs="?", default=Path("results/regime_map"))
    parser.add_argument("--finer", action="store_true", help="solve some cases more accurately and compare")
    options = parser.parse_args()
    folder: Path = options.folder
    study = cs.open_study(folder)
    error = compute_errors(select_quantities(study))
    if options.finer:
        cs.run_study(refine_study(cs.Study.from_toml(Path(__file__).with_suffix(".toml"))), folder / "finer", workers=2)
        change = abs(compute_errors(select_quantities(cs.open_study(folder / "finer"))) - error)
        for model in MODELS:
            max_change = change.where(np.isfinite(change)).sel(approximation=model).max()
            print(f"{model}: errors change by at most", *(f"{float(max_change[n]):.2f} % ({n})" for n in QUANTITIES))
        return
    error.to_netcdf(folder / "errors.nc")
    find_limits(error).to_dataframe().to_csv(folder / "limits.csv")
    for profile in map(str, error["profile"].values):
        draw(error, profile).savefig(folder / f"{profile.replace(' ', '_')}.png", dpi=110)
    print(format_table(error))
    print(f"\n{describe_stated_errors(study)}")
    print(f"\nwrote errors.nc, limits.csv and a figure for each crown in {folder}")


if __name__ == "__main__":
    main()
