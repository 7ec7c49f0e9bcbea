"""Equivalent loads on the top and on both faces under pressure and under traction along y."""

import numpy as np
from matplotlib import pyplot

import contactstudy as cs
from contactstudy.operators import Overlapping

length = 4.0
grid = cs.Grid(x_range=(0.0, length), y_range=(-2.0, 2.0), cells_x=64, cells_y=64)
depths = np.linspace(0.02, 3.0, 60)
body = cs.FiniteLengthSpace(length=length, material=cs.Material(young=1.0, poisson=0.3))
hertz = (np.sqrt(np.maximum(1 - grid.y**2, 0)) * np.ones(grid.shape)).ravel()

figure, axes = pyplot.subplots(3, 2, figsize=(5.4, 6.6), layout="constrained")
for column, load, name in zip(axes.T, ("pressure", "traction_y"), ("pressure", "traction along y"), strict=True):
    method = Overlapping(body=body, grid=grid, z=depths, load=load)
    excess = (method.P_h1 @ hertz).reshape(grid.shape) - (hertz.reshape(grid.shape) if load == "pressure" else 0.0)
    faces = [(operator @ hertz).reshape(grid.cells_y, -1) for operator in (method.P_v1, method.P_v2)]
    titles = (r"$P_{h1} - p$" if load == "pressure" else r"$P_{h1}$", r"$P_{v1}$", r"$P_{v2}$")
    panels = [(grid.x, grid.y, excess.T), *((grid.y, depths, face.T) for face in faces)]
    for axis, title, (along, down, values) in zip(column, titles, panels, strict=True):
        limit = np.abs(values).max()
        image = axis.pcolormesh(along, down, values, cmap="RdBu_r", vmin=-limit, vmax=limit, shading="gouraud")
        figure.colorbar(image, ax=axis, label="over $p_0$")
        axis.set_title(f"{title}, {name}", fontsize="medium")
        top = title.startswith("$P_{h")
        axis.set(xlabel="x / a" if top else "y / a", ylabel="y / a" if top else "z / a")
        if not top:
            axis.invert_yaxis()
figure.savefig("equivalent_loads.png", dpi=200)
