"""Stress riser of each lamina of a tilted roller on both raceways by three models; grey: stated errors."""

from matplotlib import pyplot

import contactstudy as cs
from contactstudy.plots.style import line_styles

steel = cs.Material(young=210e9, poisson=0.3)
crown = cs.profiles.Lundberg(amplitude=1.5e-6)


def create_case(relative_radius: float, width: float) -> cs.Case:
    """Return the roller on one raceway, as two elastic bodies of steel."""
    roller = cs.Roller(radius=relative_radius, length=10e-3, profile=crown, material=steel)
    return cs.Case(body=cs.FiniteLengthSpace(length=width, material=steel), roller=roller, load=3000.0, tilt=0.5e-3)


inner, outer = create_case(4e-3, width=10.5e-3), create_case(6e-3, width=12e-3)
life = cs.bearing.reference_life(inner, outer, cs.bearing.roller_ratings(dynamic_rating=30e3, rollers=14, gamma=0.2))

figure, axes = pyplot.subplots(1, 2, figsize=(5.2, 3.0), sharey=True, layout="constrained")
models = ("slices with riser", "half-space", "free ends")
for ax, raceway, name in zip(axes, ("inner", "outer"), ("$f_i$", "$f_e$"), strict=True):
    for model, style in zip(models, line_styles(3), strict=True):
        row = life.sel(model=model, raceway=raceway, roller=1)
        factor, error = row.stress_riser, row.stress_riser_error
        ax.plot(factor.slice, factor, label=model, **style)
        ax.fill_between(factor.slice, factor - error, factor + error, color="0.8")
    ax.set(xlabel="lamina", title=f"{raceway} raceway, {name}")
axes[0].set(ylabel="factor on the load")
figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
figure.savefig("lamina_factors.png", dpi=200)
