"""Shear yield stress for shakedown, and residual stress after five passes, near the free end."""

import numpy as np
from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
body = cs.FiniteLengthSpace(length=10e-3, material=steel)
crown = cs.profiles.Lundberg.for_pressure(2.8e9, radius=5e-3, modulus=steel.plane_strain_modulus)
roller = cs.Roller(radius=5e-3, length=10e-3, profile=crown)
case = cs.Case(body=body, roller=roller, max_pressure=2.8e9, friction=0.05)
a = case.hertz_half_width
end = a * (np.geomspace(1.0, 40.0, 24) - 1.0)
x = np.concatenate([end, [5e-3], 10e-3 - end[::-1]])
result = cs.solve(case, x=x, y=a * np.linspace(-3, 3, 49), z=a * np.linspace(0.0, 1.6, 17))
field = cs.fatigue.shakedown(result)
plastic = cs.plasticity.ElasticPlastic(yield_stress=1.4e9, kinematic_hardening=10e9)
residual = cs.plasticity.residual_stress(result, body, plastic, passes=5).isel(pass_number=-1)

figure, axes = pyplot.subplots(2, 1, figsize=(5.2, 4.6), sharex=True, layout="constrained")
panels = {"k for shakedown (MPa)": field["shakedown_stress"], "residual yy (MPa)": residual["sigma_yy"]}
for ax, (name, values) in zip(axes, panels.items(), strict=True):
    values = 1e-6 * values.transpose("z", ...)
    contours = ax.contourf(1e3 * values["x_field"], 1e6 * values["z"], values, levels=12, cmap=cs.plots.COLORS)
    figure.colorbar(contours, ax=ax, label=name)
    ax.set(ylabel="depth (µm)")
    ax.invert_yaxis()
axes[1].set(xlabel="distance from the free end (mm)", xlim=(0, 2))
figure.savefig("passes.png", dpi=200)
