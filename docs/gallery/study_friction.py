"""Effect of friction."""

import contactstudy as cs

if __name__ == "__main__":
    cs.run_study(cs.Study.from_toml("studies/friction.toml"), "results/friction")
    figure = cs.plots.study_figures(cs.open_study("results/friction", cells="original"))["study"]
    figure.savefig("study_friction.png", dpi=150)
