"""Pressure along a roller with rounded corners, as steps over its columns of cells."""

import numpy as np
from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
body = cs.FiniteLengthSpace(length=10e-3, material=steel)
roller = cs.Roller(radius=5e-3, length=10e-3, profile=cs.profiles.Cylinder(fillet_radius=0.1e-3))
result = cs.solve(cs.Case(body=body, roller=roller, max_pressure=1.5e9), stresses=False)

edges = np.append(result["x_bounds"][:, 0], result["x_bounds"][-1, 1])
figure, axes = pyplot.subplots(1, 2, figsize=(5.2, 2.6), sharey=True, layout="constrained")
for ax, stop, title in zip(axes, (10.0, 0.15), ("the roller", "its end"), strict=True):
    ax.stairs(1e-9 * result["pressure"].max("y"), 1e3 * edges, baseline=None, color="black")
    ax.set(xlabel="x (mm)", xlim=(0, stop), title=title)
axes[0].set_ylabel("pressure (GPa)")
figure.savefig("columns.png", dpi=200)
