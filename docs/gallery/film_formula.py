"""Moes' formula for the central film of a line contact against films with converged inlets."""

import numpy as np
from matplotlib import pyplot

from contactstudy.film.levels import moes_line
from contactstudy.film.line_contact import solve_line
from contactstudy.plots.style import line_styles

loads, lubricants = np.geomspace(5.0, 1000.0, 12), (2.0, 5.0, 10.0, 15.0)
figure, ax = pyplot.subplots(figsize=(5.2, 3.6), layout="constrained")
for lubricant, style in zip(lubricants, line_styles(len(lubricants)), strict=True):
    films = np.array([solve_line(load, lubricant, finest=0.1).central_film for load in loads])
    deviations = 100 * (moes_line(loads, lubricant) / films - 1)
    ax.semilogx(loads, deviations, label=f"L = {lubricant:g}", **style)
    print(f"L = {lubricant:g}: {deviations.min():.1f} to {deviations.max():.1f} %")
ax.axhspan(-4.0, 4.0, color="0.92", zorder=0)
ax.set_xlabel("load number, $M$")
ax.set_ylabel("formula less solution (%)")
ax.legend(frameon=False, ncols=2)
figure.savefig("film_formula.png", dpi=150)
