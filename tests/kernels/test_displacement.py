"""Displacements of the mirrored half-space in any unit and, on graded cells, wherever its mirrors stand."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid, Material
from contactstudy.checks import FloatArray
from contactstudy.kernels.displacement import half_space_displacement
from contactstudy.kernels.load import Load

EDGES = {"uniform": np.linspace(0.0, 3.0, 9), "graded": np.array([0.0, 0.2, 0.5, 1.0, 1.6, 2.3, 3.0])}


def displaced(
    load: Load, edges: FloatArray, *, place: float = 0.0, unit: float = 1.0, smooth: bool = True
) -> FloatArray:
    grid = Grid.between(unit * (edges + place), (-unit, unit), 8)
    pressure = np.sqrt(np.maximum(1 - (grid.y / unit / 0.8) ** 2, 0.0)) * (1 + 0.3 * (grid.x[:, None] / unit - place))
    extent = (unit * place, unit * (place + 3.0))
    x, y, z = unit * (np.array([0.0, 0.7, 2.2]) + place), unit * np.array([-0.1, 0.4]), unit * np.array([0.05, 0.6])
    return half_space_displacement(
        load, pressure, Material(1.0, 0.3), grid, x, y, z, extent=extent, reference=30.0 * unit, smooth=smooth
    )


@pytest.mark.parametrize("name", EDGES)
@pytest.mark.parametrize("load", Load)
@pytest.mark.parametrize("smooth", [True, False])
def test_neither_unit_nor_place_decides_anything(load: Load, name: str, *, smooth: bool) -> None:
    if name == "graded" and not smooth:
        return
    plain = displaced(load, EDGES[name], smooth=smooth)
    # Uniform cells of a body with ends begin at 0.
    for place, unit in ((0.0, 2.0**-17), *(() if name == "uniform" else ((8.0, 1.0), (-32.0, 1.0)))):
        other = displaced(load, EDGES[name], place=place, unit=unit, smooth=smooth)
        assert other / unit == pytest.approx(plain, abs=1e-7 * np.abs(plain).max())
