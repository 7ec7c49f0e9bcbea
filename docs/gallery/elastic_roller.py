"""Pressure under an elastic roller with free ends, and under a half-space of the same shape."""

from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
crown = cs.profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=steel.plane_strain_modulus / 2)
body = cs.FiniteLengthSpace(length=10.5e-3, material=steel)
curves = {}
for name, ends in {"roller with free ends": "free", "roller as a half-space": "none"}.items():
    roller = cs.Roller(radius=5e-3, length=10e-3, profile=crown, material=steel, ends=ends)
    curves[name] = cs.solve(cs.Case(body=body, roller=roller, load=3060.0), stresses=False)

figure, ax = pyplot.subplots(figsize=(5.2, 3.0), layout="constrained")
cs.plots.plot_comparison(curves, "pressure", ax=ax, si=True)
ax.set(xlim=(0, 2))
figure.savefig("elastic_roller.png", dpi=200)
