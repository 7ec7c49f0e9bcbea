"""Draw how wrong the half-space and the quick fixes for free ends are, from the study regime_map.toml.

Usage, after ``contactstudy run studies/regime_map.toml``: ``python studies/regime_map.py [FOLDER]``, default
``results/regime_map``. Writes ``errors.nc`` and ``regime_map.png`` into the folder.

The half-space's largest pressure is 37 to 86 % too high under a flush end, more for longer rollers, still 12 to 39 %
at e = 2 a (3 % on the shortest body), and within 5 % at 8 a only. The mirrored load comes within 2 % at flush ends
and errs by up to 9 % around e = a; Guilbault's factor is within 1 % flush and 5 % elsewhere. Stresses of either are
up to 13 % too low in short bodies (8 a), where they leave the ends loaded. A single pair of mirrored loads with two
separate vertical half-spaces, the published scheme, is within 0.7 % in pressure and 1.7 % in stress everywhere. A
quarter space takes too much load to its other end, which it believes to go on, and so errs by up to 17 % at the free
one.

The half-space's peaks are a cell or two wide and not converged: 32 cells per width give 40 to 73 %, not 37 to 86 %.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import xarray as xr

import contactstudy as cs

MODELS = {
    "half-space": {"body": "half-space", "model": "exact"},
    "mirrored load": {"body": "finite-length", "model": "mirror"},
    "with Guilbault's factor": {"body": "finite-length", "model": "mirror-factor"},
    "single mirror": {"body": "finite-length", "model": "single-mirror"},
    "quarter space": {"body": "quarter-space", "model": "exact"},
}
"""Words of the study for each model, by its title."""

RADIUS = 5e-3
"""Of the study's roller, metres."""

QUANTITIES = {"peak_pressure": "largest pressure", "peak_von_mises": "largest von Mises stress"}


def peaks(study: xr.Dataset) -> xr.Dataset:
    """Largest pressure and von Mises stress between the end and the middle, by e/a, gamma, friction and model."""
    pressure = cs.analysis.axial_pressure(study)
    along = cs.analysis.dimension_along(pressure, "x")
    middle = 0.5 * study["gamma"] * RADIUS / study["hertz_half_width"]
    near = study["x_over_a"] <= middle
    result = xr.Dataset({"peak_pressure": pressure.where(near).max(along), "peak_von_mises": study["peak_von_mises"]})
    return result.compute()


def errors(found: xr.Dataset) -> xr.Dataset:
    """Error of each model against the exact ends, in percent."""
    exact = pick(found, {"body": "finite-length", "model": "exact"})
    parts = [100 * (pick(found, words) / exact - 1) for words in MODELS.values()]
    result = xr.concat(parts, xr.DataArray(list(MODELS), dims="approximation", name="approximation"))
    for name, meaning in QUANTITIES.items():
        result[name].attrs = {"units": "percent", "long_name": f"error of the {meaning}"}
    result.attrs = {"Conventions": "CF-1.11", "title": "errors of approximations for free ends"}
    return result


def pick(found: xr.Dataset, words: dict[str, str]) -> xr.Dataset:
    """Return the cases of one body and model."""
    place = next(
        i
        for i, pair in enumerate(zip(found["body"].values, found["model"].values, strict=True))
        if pair == (words["body"], words["model"])
    )
    return found.isel(body_and_model=place, drop=True).reset_coords(drop=True)


def draw(error: xr.Dataset) -> plt.Figure:
    """One map over e/a and gamma for each model and quantity, without friction."""
    figure, axes = plt.subplots(
        len(QUANTITIES), len(MODELS), figsize=(4.2 * len(MODELS), 3.2 * len(QUANTITIES)), layout="constrained"
    )
    for row, (name, meaning) in zip(axes, QUANTITIES.items(), strict=True):
        for ax, model in zip(row, MODELS, strict=True):
            array = error[name].sel(approximation=model, friction=0.0).round()
            cs.plots.plot_study_map(error, array, "e_over_a", "gamma", ax, label=f"error of the {meaning} (%)")
            ax.set_title(model, fontsize="medium")
    return figure


def main(folder: Path) -> None:
    """Evaluate and draw the study in `folder`."""
    error = errors(peaks(cs.open_study(folder)))
    error.to_netcdf(folder / "errors.nc")
    figure = draw(error)
    figure.savefig(folder / "regime_map.png", dpi=80)
    print(f"wrote {folder / 'errors.nc'} and {folder / 'regime_map.png'}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/regime_map"))
