"""Utilisation after Dang Van and Findley below a roller that ends with the body."""

import numpy as np
from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
crown = cs.profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=steel.plane_strain_modulus)
case = cs.Case(
    body=cs.FiniteLengthSpace(length=10e-3, material=steel),
    roller=cs.Roller(radius=5e-3, length=10e-3, profile=crown),
    max_pressure=1.5e9,
    friction=0.1,
)
a = case.hertz_half_width
x = a * np.geomspace(1.0, 16.0, 24) - a  # from the free end
result = cs.solve(case, x=x, y=a * np.linspace(-3, 3, 97), z=a * np.linspace(0.0, 1.5, 31))
limits = cs.fatigue.FatigueLimits(bending=700e6, torsion=450e6)
panels = {"Dang Van": cs.fatigue.dang_van(result, limits), "Findley": cs.fatigue.findley(result, limits)}

figure, axes = pyplot.subplots(2, 1, figsize=(5.2, 4.6), sharex=True, layout="constrained")
for ax, (name, criterion) in zip(axes, panels.items(), strict=True):
    values = criterion["utilisation"].transpose("z", ...)
    contours = ax.contourf(1e3 * values["x_field"], 1e6 * values["z"], values, levels=12, cmap=cs.plots.COLORS)
    figure.colorbar(contours, ax=ax, label=f"{name}, 1 is the limit")
    ax.set(ylabel="depth (µm)")
    ax.invert_yaxis()
axes[1].set(xlabel="distance from the free end (mm)")
figure.savefig("fatigue.png", dpi=200)
