"""Temperature rise of the body near the free end under a roller that rolls and slides."""

from matplotlib import pyplot

import contactstudy as cs

steel = cs.Material(young=210e9, poisson=0.3)
case = cs.Case(
    body=cs.FiniteLengthSpace(length=12e-3, material=steel),
    roller=cs.Roller(radius=5e-3, length=10e-3, profile=cs.profiles.Cylinder(fillet_radius=0.1e-3)),
    max_pressure=1.5e9,
    friction=0.05,
    motion=cs.Sliding(body_speed=-10.0, roller_speed=-9.0),
)
metal = cs.heat.ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
result = cs.solve(case, accuracy=0.003, stresses=False)
temperatures = cs.heat.flash_temperature(case, result, body=metal, roller=metal)

figure, ax = pyplot.subplots(figsize=(5.2, 3.0), layout="constrained")
cs.plots.plot_temperature_map(temperatures, ax=ax)
ax.set_xlim(16, 21)
figure.savefig("flash_temperature.png", dpi=200)
