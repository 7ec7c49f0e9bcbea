"""Atlas of logarithmic rollers against solved cases."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import contactstudy as cs

STEEL = cs.Material(210e9, 0.3)
RADIUS, PRESSURE = 8e-3, 1.3e9
HALF_WIDTH = 2 * PRESSURE * RADIUS / STEEL.plane_strain_modulus
LENGTH, DISTANCE, CROWN = 45 * HALF_WIDTH, 0.8 * HALF_WIDTH, 0.2 * HALF_WIDTH**2 / RADIUS


def solved(load_factor: float, **options: object) -> xr.Dataset:
    """Roller at a multiple of the load of the Hertz pressure."""
    case = cs.Case(
        body=cs.FiniteLengthSpace(length=LENGTH + 2 * DISTANCE, material=STEEL),
        roller=cs.Roller(radius=RADIUS, length=LENGTH, profile=cs.profiles.Lundberg(CROWN)),
        end_distance=DISTANCE,
        max_pressure=PRESSURE * np.sqrt(load_factor),
    )
    return cs.solve(case, **options)


def roller() -> xr.Dataset:
    return cs.atlas(LENGTH / HALF_WIDTH, DISTANCE / HALF_WIDTH, CROWN * RADIUS / HALF_WIDTH**2)


def test_pressure_stress_and_approach_of_another_roller_lie_within_the_stated_errors() -> None:
    contact, result = solved(1.0, x=[0.0], y=[0.0], z=[0.0]), roller()
    mean = contact["normal_load"] * HALF_WIDTH / LENGTH
    expected = {
        "peak_pressure_ratio": contact["peak_pressure"] / PRESSURE,
        "peak_von_mises_ratio": contact["peak_von_mises"] / PRESSURE,
        "approach_ratio": contact["approach"] * RADIUS / HALF_WIDTH**2,
        "end_load_ratio": contact["end_load_first"] / mean,
    }
    for name, value in expected.items():
        assert abs(float(result[name] - value)) <= float(result[f"{name}_error"]), name


def test_stiffness_is_the_slope_of_solved_loads() -> None:
    low, high = solved(0.95, stresses=False), solved(1.05, stresses=False)
    slope = (high["normal_load"] - low["normal_load"]) / (high["approach"] - low["approach"])
    result = roller()
    error = float(result["stiffness_ratio"] - slope / (STEEL.plane_strain_modulus * LENGTH))
    assert abs(error) <= float(result["stiffness_ratio_error"])


def test_arrays_are_broadcast() -> None:
    crown = xr.DataArray([0.1, 0.2, 0.4], dims="crown")
    result = cs.atlas(100, xr.DataArray([0.0, 1.0], dims="e"), crown)
    assert set(result["stiffness_ratio"].dims) == {"e", "crown"}
    assert cs.atlas([50, 100], 0.0, 0.2)["peak_pressure_ratio"].dims == ("point",)
    assert cs.atlas(50, 0.0, 0.2)["peak_pressure_ratio"].dims == ()


@pytest.mark.parametrize(
    ("name", "value"), [("length_over_a", 10.0), ("e_over_a", -0.1), ("crown", np.nan), ("crown", "high")]
)
def test_values_outside_the_table_raise(name: str, value: object) -> None:
    groups = {"length_over_a": 100.0, "e_over_a": 1.0, "crown": 0.2} | {name: value}
    with pytest.raises(cs.InvalidInputError, match=name):
        cs.atlas(**groups)
