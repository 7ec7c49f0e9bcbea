"""Effect of the profile."""

import contactstudy as cs

if __name__ == "__main__":
    cs.run_study(cs.Study.from_toml("studies/profiles.toml"), "results/profiles")
    figure = cs.plots.study_figures(cs.open_study("results/profiles", cells="original"))["study"]
    figure.savefig("study_profiles.png", dpi=150)
