"""Pressure along a straight roller, one that is held at 0.5 mrad, and one under an off-centre load."""

from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
crown = cs.profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=steel.plane_strain_modulus)
roller = cs.Roller(radius=5e-3, length=10e-3, profile=crown)
body = cs.FiniteLengthSpace(length=10e-3, material=steel)
cases = {
    "straight": cs.Case(body=body, roller=roller, load=1500.0),
    "0.5 mrad": cs.Case(body=body, roller=roller, load=1500.0, tilt=0.5e-3),
    "load 0.3 mm off-centre": cs.Case(body=body, roller=roller, load=1500.0, load_position=5.3e-3),
}
curves = {name: cs.solve(case, stresses=False) for name, case in cases.items()}

figure, ax = pyplot.subplots(figsize=(5.2, 3.0), layout="constrained")
cs.plots.plot_comparison(curves, "pressure", ax=ax, si=True)
figure.savefig("tilt.png", dpi=200)
