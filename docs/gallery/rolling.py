"""Stick, slip and tractions near the free end of a roller that rolls with creepage."""

import numpy as np
from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
case = cs.Case(
    body=cs.FiniteLengthSpace(length=10e-3, material=steel),
    roller=cs.Roller(radius=5e-3, length=10e-3, material=steel),
    max_pressure=1.5e9,
    friction=0.1,
    motion=cs.Rolling(longitudinal_creepage=1e-3),
)
a = case.hertz_half_width
half_edges = np.cumsum([0.0, *np.minimum(0.05 * a * 1.05 ** np.arange(130), 1.5 * a)])  # narrow at the free end
half_edges *= 5e-3 / half_edges[-1]
grid = cs.Grid.from_edges([*half_edges, *(10e-3 - half_edges[-2::-1])], (-1.4 * a, 1.4 * a), 56)
result = cs.solve(case, grid, stresses=False)

figure, ax = pyplot.subplots(figsize=(5.2, 4.0), layout="constrained")
cs.plots.plot_stick_and_slip(result.sel(x=slice(0, 4 * a)), ax, arrows=18)
ax.set_xlim(-0.1, 3.0)
figure.savefig("rolling.png", dpi=200)
