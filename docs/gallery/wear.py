"""Worn depth and load per length along a roller with rounded ends, from new to worn in."""

from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
case = cs.Case(
    body=cs.FiniteLengthSpace(length=12e-3, material=steel),
    roller=cs.Roller(radius=5e-3, length=10e-3, profile=cs.profiles.Cylinder(fillet_radius=0.1e-3)),
    max_pressure=1.5e9,
    friction=0.05,
)
worn = cs.wear.wear_in(case, 1e-17, distance=[0.0, 500.0, 2e3, 1e4])

figure, axes = pyplot.subplots(2, 1, figsize=(5.2, 5.4), sharex=True, layout="constrained")
cs.plots.plot_wear(worn, axes[0])
cs.plots.plot_wear(worn, axes[1], variable="line_load")
axes[0].set_xlabel("")
axes[1].set_xlim(1, 3)
figure.savefig("wear.png", dpi=200)
