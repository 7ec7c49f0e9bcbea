"""Effect of the distance from the free end."""

import contactstudy as cs

if __name__ == "__main__":
    cs.run_study(cs.Study.from_toml("studies/end_distance.toml"), "results/end_distance")
    figure = cs.plots.study_figures(cs.open_study("results/end_distance", cells="original"))["study"]
    figure.savefig("study_end_distance.png", dpi=150)
