"""Effect of the length over the radius."""

import contactstudy as cs

if __name__ == "__main__":
    cs.run_study(cs.Study.from_toml("studies/gamma.toml"), "results/gamma")
    figure = cs.plots.study_figures(cs.open_study("results/gamma", cells="original"))["study"]
    figure.savefig("study_gamma.png", dpi=150)
