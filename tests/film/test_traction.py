from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import contactstudy as cs
from contactstudy.film import film_traction
from contactstudy.film.traction import shear_stress, thermal_reduction
from tests.film.test_solve import HALF_WIDTH, make_film_case

OIL = cs.Lubricant(viscosity=0.03, pressure_viscosity=2e-8, conductivity=0.14, temperature_viscosity=0.04)


@pytest.fixture
def film_result():
    """A film of one thickness under a uniform pressure."""
    case = replace(make_film_case(16 * HALF_WIDTH), lubricant=OIL)
    x, y = (np.arange(16) + 0.5) * HALF_WIDTH, (np.arange(8) - 3.5) * 0.25 * HALF_WIDTH
    pressure = np.full((16, 8), 1e8)
    load = 1e8 * 16 * 2 * HALF_WIDTH**2
    fields = {"pressure": (("x", "y"), pressure), "film_thickness": (("x", "y"), np.full((16, 8), 1e-6))}
    return case, xr.Dataset(fields | {"entrainment_speed": 2.0, "normal_load": load}, coords={"x": x, "y": y})


def test_newtonian_traction_equals_closed_form(film_result):
    case, result = film_result
    curve = film_traction(case, result, [-0.02, 0.0, 0.02])
    expected = float(OIL.viscosity_at(1e8)) * 0.02 * 2.0 / 1e-6 / 1e8
    assert curve.traction_coefficient.values == pytest.approx([-expected, 0.0, expected])
    assert float(curve.rolling_force) == 0.0
    area = 16 * 2 * HALF_WIDTH**2
    assert float(curve.power_loss[2]) == pytest.approx(expected * 1e8 * area * 0.04)
    assert float(curve.thermal_reduction[1]) < 1


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_heat_of_the_fluid_equals_traction_times_sliding_speed(film_result, direction):
    case, result = film_result
    motion = cs.Sliding(body_speed=direction * 1.9, roller_speed=direction * 2.1)
    sliding_case = replace(case, motion=motion)
    result = result.assign(entrainment_speed=direction * 2.0)
    curve = film_traction(sliding_case, result, [0.1]).isel(slide_roll_ratio=0)
    steel = cs.heat.ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    flash_result = cs.heat.flash_temperature(
        sliding_case, result.assign(traction_y=curve.traction_y), body=steel, roller=steel
    )
    traction_force = float(curve.traction_coefficient) * float(result.normal_load)
    assert float(flash_result.friction_power) == pytest.approx(0.2 * traction_force, rel=1e-9)
    assert float(flash_result.friction_power) == pytest.approx(float(curve.power_loss), rel=1e-9)


def test_eyring_and_limiting_shear_bound_traction():
    rates = np.geomspace(1.0, 1e9, 50)
    eyring_stress = shear_stress(OIL.replaced(eyring_stress=5e6), np.full(50, 5e8), rates)
    assert (np.diff(eyring_stress) > 0).all()
    assert (eyring_stress <= shear_stress(OIL, np.full(50, 5e8), rates) * (1 + 1e-12)).all()
    limited_stress = shear_stress(OIL.replaced(limiting_shear=0.05), np.full(50, 5e8), rates)
    assert limited_stress.max() == pytest.approx(0.05 * 5e8)


def test_thermal_reduction_equals_published_value():
    assert thermal_reduction(3e-3, 0.0, 1.0) == 1.0
    assert thermal_reduction(5e-3, 1.0, 0.1) == pytest.approx(0.728, abs=5e-4)
    assert thermal_reduction(3e-3, 1.0, 1.0) < thermal_reduction(3e-3, 1.0, 0.0) < thermal_reduction(3e-3, 0.1, 0.0) < 1


def test_invalid_argument_raises(film_result):
    case, result = film_result
    with pytest.raises(cs.InvalidInputError, match="lubricant"):
        film_traction(replace(case, lubricant=None), result, [0.0, 0.1])
    with pytest.raises(cs.InvalidInputError, match="film_thickness"):
        film_traction(case, result[["pressure"]], [0.0, 0.1])
