"""Worst pressure over the amplitude of Lundberg's profile, with errors; grey: equivalent designs."""

import xarray as xr
from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
body = cs.FiniteLengthSpace(length=10.5e-3, material=steel)
roller = cs.Roller(radius=5e-3, length=10e-3)
cases = [cs.Case(body=body, roller=roller, max_pressure=p0, tilt=0.5e-3) for p0 in (1.2e9, 1.8e9)]


def scale_pressure(result: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Largest pressure over p0, and its error."""
    p0 = result.hertz_max_pressure
    return result.peak_pressure / p0, result.peak_pressure_error / p0


design = cs.design.best_profile(
    cases,
    cs.profiles.Lundberg,
    bounds={"amplitude": (0.5e-6, 10e-6)},
    measure=scale_pressure,
    accuracy=0.02,
    evaluations=14,
)

figure, ax = pyplot.subplots(figsize=(5.2, 3.0), layout="constrained")
designs = design.sortby(design.design[:, 0])
x, errors = 1e6 * designs.design[:, 0], designs.design_measure_error
ax.errorbar(x, designs.design_measure, errors, fmt="o-", color="black", capsize=3, markersize=4)
ax.axvspan(1e6 * float(design.flat_from[0]), 1e6 * float(design.flat_to[0]), color="0.9")
ax.set(xscale="log", xlabel="amplitude of Lundberg's profile (µm)", ylabel="worst pressure over $p_0$")
ax.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
ax.minorticks_off()
figure.savefig("best_profile.png", dpi=200)
