"""Load over the approach, and moment over the tilt, of a roller of 10 mm; circles are solved contacts."""

import numpy as np
from matplotlib import pyplot

import contactstudy as cs
from contactstudy.plots.style import line_styles

steel = cs.Material(young=210e9, poisson=0.3)
crown = cs.profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=steel.plane_strain_modulus)
case = cs.Case(
    body=cs.FiniteLengthSpace(length=10.5e-3, material=steel),
    roller=cs.Roller(radius=5e-3, length=10e-3, profile=crown),
    load=1500.0,
)
tilts, approaches = 1e-3 * np.linspace(-0.5, 0.5, 5), 1e-6 * np.geomspace(1.5, 8.0, 5)
law = cs.bearing.contact_law(case, tilts=tilts, approaches=approaches)

figure, (load_axes, moment_axes) = pyplot.subplots(2, 1, figsize=(5.2, 5.4), layout="constrained")
untilted = law.at(1e-6 * np.linspace(1.5, 8.0, 40))
load_axes.plot(1e6 * untilted.approach, 1e-3 * untilted.normal_load, color="black")
solved = 1e-3 * law.table.normal_load.sel(tilt=0)
load_axes.plot(1e6 * law.table.approach, solved, "o", color="black", fillstyle="none")
load_axes.set(xlabel="approach (µm)", ylabel="load without tilt (kN)")
tilted = law.at(1e-6 * np.array([2.0, 4.0, 8.0]), 1e-3 * np.linspace(-0.5, 0.5, 41))
for approach, style in zip(tilted.approach.values, line_styles(3), strict=True):
    moment_axes.plot(1e3 * tilted.tilt, tilted.moment.sel(approach=approach), label=f"{1e6 * approach:.0f} µm", **style)
moment_axes.legend(frameon=False, title="approach")
moment_axes.set(xlabel="tilt (mrad)", ylabel="moment (N m)")
figure.savefig("contact_law.png", dpi=200)
