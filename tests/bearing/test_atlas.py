"""Atlas of logarithmic rollers against solved cases."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import contactstudy as cs

RADIUS, PRESSURE = 8e-3, 1.3e9
GROUPS = {"length_over_a": 45.0, "e_over_a": 0.8, "crown": 0.2}
TILTED_GROUPS = GROUPS | {"tilt_ratio": 0.6, "poisson": 0.25}


def compute_material_and_scales(groups: dict[str, float]) -> tuple[cs.Material, float, float]:
    """Material, half-width and length of the roller."""
    material = cs.Material(210e9, groups.get("poisson", 0.3))
    half_width = 2 * PRESSURE * RADIUS / material.plane_strain_modulus
    return material, half_width, groups["length_over_a"] * half_width


def solve_groups(groups: dict[str, float], load_factor: float = 1.0, **options: object) -> xr.Dataset:
    """Roller at a multiple of the load of the Hertz pressure."""
    material, a, length = compute_material_and_scales(groups)
    distance = groups["e_over_a"] * a
    case = cs.Case(
        body=cs.FiniteLengthSpace(length=length + 2 * distance, material=material),
        roller=cs.Roller(radius=RADIUS, length=length, profile=cs.profiles.Lundberg(groups["crown"] * a**2 / RADIUS)),
        end_distance=distance,
        max_pressure=PRESSURE * np.sqrt(load_factor),
        tilt=2 * groups.get("tilt_ratio", 0.0) * a**2 / (length * RADIUS),
    )
    return cs.solve(case, **options)


@pytest.mark.slow
@pytest.mark.parametrize("groups", [GROUPS, TILTED_GROUPS], ids=["parallel", "tilted"])
def test_atlas_errors_cover_a_solved_roller(groups) -> None:
    contact, result = solve_groups(groups, x=[0.0], y=[0.0], z=[0.0]), cs.atlas(**groups)
    _, half_width, length = compute_material_and_scales(groups)
    mean_load = contact["normal_load"] * half_width / length
    expected = {
        "peak_pressure_ratio": contact["peak_pressure"] / PRESSURE,
        "peak_von_mises_ratio": contact["peak_von_mises"] / PRESSURE,
        "approach_ratio": contact["approach"] * RADIUS / half_width**2,
        "end_load_ratio": contact["end_load_last"] / mean_load,
    }
    for name, value in expected.items():
        assert abs(float(result[name] - value)) <= float(result[f"{name}_error"]), name


@pytest.mark.parametrize("groups", [GROUPS, TILTED_GROUPS], ids=["parallel", "tilted"])
def test_atlas_stiffness_equals_the_slope_of_loads(groups) -> None:
    low_load_result, high_load_result = (
        solve_groups(groups, 0.95, stresses=False),
        solve_groups(groups, 1.05, stresses=False),
    )
    slope = (high_load_result["normal_load"] - low_load_result["normal_load"]) / (
        high_load_result["approach"] - low_load_result["approach"]
    )
    (material, _, length), result = compute_material_and_scales(groups), cs.atlas(**groups)
    error = float(result["stiffness_ratio"] - slope / (material.plane_strain_modulus * length))
    assert abs(error) <= float(result["stiffness_ratio_error"])


def test_atlas_broadcasts_arrays() -> None:
    crown = xr.DataArray([0.1, 0.2, 0.4], dims="crown")
    result = cs.atlas(100, xr.DataArray([0.0, 1.0], dims="e"), crown)
    assert set(result["stiffness_ratio"].dims) == {"e", "crown"}
    assert cs.atlas([50, 100], 0.0, 0.2)["peak_pressure_ratio"].dims == ("point",)
    assert cs.atlas(50, 0.0, 0.2)["peak_pressure_ratio"].dims == ()


@pytest.mark.parametrize(
    ("name", "value"),
    [("length_over_a", 10.0), ("e_over_a", -0.1), ("crown", np.nan), ("crown", "high"), ("tilt_ratio", -0.1)],
)
def test_values_outside_the_table_raise(name: str, value: object) -> None:
    groups = {"length_over_a": 100.0, "e_over_a": 1.0, "crown": 0.2} | {name: value}
    with pytest.raises(cs.InvalidInputError, match=name):
        cs.atlas(**groups)
