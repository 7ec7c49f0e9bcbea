"""Pressure along the axis and von Mises stress for several distances e of the roller's end from the free end."""

import contactstudy as cs

if __name__ == "__main__":
    cs.run_study(cs.Study.from_toml("studies/edge_effect.toml"), "results/edge_effect")
    figure = cs.plots.plot_edge_effect(cs.open_study("results/edge_effect", cells="original"))
    figure.savefig("edge_effect.png", dpi=150)
