"""Profiles of one roller, made for one load."""

from matplotlib import pyplot

import contactstudy as cs

design = {"radius": 5e-3, "modulus": 113.7e9}
profiles = {
    "Lundberg": cs.profiles.Lundberg.for_pressure(2e9, **design),
    "Johns-Gohar": cs.profiles.JohnsGohar.for_pressure(2e9, **design),
    "Fujiwara-Kawase, K1 = 2, K2 = 0.5": cs.profiles.FujiwaraKawase.for_pressure(
        2e9, edge_drop=14e-6, k1=2.0, k2=0.5, **design
    ),
    "ISO/TS 16281": cs.profiles.IsoCylindrical(diameter=10e-3),
    "full crown, 1.5 m": cs.profiles.FullCrown(crown_radius=1.5),
    "straight, arcs, dub-off": cs.profiles.PartialCrown(4e-3, 1.2, dub_length=0.8e-3, dub_radius=0.06),
}
figure, ax = pyplot.subplots(figsize=(5.2, 3.4), layout="constrained")
cs.plots.plot_profiles(profiles, 10e-3, ax=ax, deepest=15e-6)
figure.savefig("profiles.png", dpi=200)
