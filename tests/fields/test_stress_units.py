"""Lengths and moduli in other units: equal fields for all bodies, cells and tractions."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    FiniteLengthSpace,
    HalfSpace,
    Material,
    QuarterSpace,
    displacement_field,
    equivalent_loads,
    stress_field,
    surface_displacement,
)
from contactstudy.bodies.models import Body

EDGES = {"uniform": np.linspace(0.0, 3.0, 6), "graded": np.array([0.0, 0.1, 0.4, 1.1, 2.6, 3.0])}


def make_body(kind: str, length: float, modulus: float) -> Body:
    material = Material(modulus, 0.3)
    if kind == "finite":
        return FiniteLengthSpace(length=3.0 * length, material=material)
    return (HalfSpace if kind == "half" else QuarterSpace)(material=material)


def compute_scaled_fields(kind: str, cells: str, length: float, modulus: float) -> list[np.ndarray]:
    """Stresses over the modulus, displacements over the length, equivalent loads over the modulus."""
    x, y = 0.5 * (EDGES[cells][1:] + EDGES[cells][:-1]), np.linspace(-1.0, 1.0, 7)
    pressure = 1e-3 * modulus * np.sqrt(np.maximum(0.7 - y**2, 0)) * (1 + 0.3 * x[:, None])
    coordinates = {"x": length * x, "y": length * y, "x_width": ("x", length * np.diff(EDGES[cells]))}
    load = xr.DataArray(pressure, coordinates, ("x", "y"))
    scaled_body = make_body(kind, length, modulus)
    arguments = {"friction": 0.2, "x": length * np.array([0.0, 0.5, 2.9]), "y": length * np.array([-0.3, 0.4])}
    stress = stress_field(scaled_body, load, **arguments, z=[0.02 * length, 0.7 * length], traction_x=0.1 * load)
    displacement = displacement_field(scaled_body, load, **arguments, z=[0.0, 0.7 * length])
    top_displacement = surface_displacement(scaled_body, load, 0.2)
    computed = [stress[name].values / modulus for name in stress.data_vars]
    computed += [displacement[name].values / length for name in displacement.data_vars]
    computed += [
        (top_displacement if isinstance(top_displacement, xr.DataArray) else top_displacement.to_dataarray()).values
        / length
    ]
    if kind != "half":
        loads = equivalent_loads(scaled_body, load, 0.2)
        computed += [loads[name].values / modulus for name in loads.data_vars if loads[name].attrs.get("units") == "Pa"]
    return computed


@pytest.mark.parametrize(
    ("kind", "cells"),
    [("half", "graded"), ("quarter", "graded"), pytest.param("finite", "uniform", marks=pytest.mark.slow)],
)
def test_fields_scale_with_units(kind: str, cells: str) -> None:
    expected, computed = (
        compute_scaled_fields(kind, cells, 1e-3, 2e11),
        compute_scaled_fields(kind, cells, 2.0**-12 * 1e-3, 2.0**-24 * 2e11),
    )
    assert len(expected) > 8
    for unit_field, scaled_field in zip(expected, computed, strict=True):
        scale = np.abs(
            unit_field[np.isfinite(unit_field)]
        ).max()  # displacements of mirrored rows are differences of large numbers
        np.testing.assert_allclose(scaled_field, unit_field, rtol=0, atol=1e-7 * scale)
