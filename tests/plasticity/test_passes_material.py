"""Elastic-plastic materials: yield stress over depth, hardness, invalid input."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError
from contactstudy.plasticity import ElasticPlastic


def test_yield_stress_is_interpolated_and_constant_beyond_depths() -> None:
    yield_stress = xr.DataArray([4.0, 2.0], {"z": [1.0, 2.0]}, "z")
    assert ElasticPlastic(yield_stress=yield_stress).yield_stress_at(np.array([0.0, 1.5, 9.0])).tolist() == [
        4.0,
        3.0,
        2.0,
    ]
    assert ElasticPlastic(yield_stress=yield_stress).shear_yield_stress == pytest.approx(2 / np.sqrt(3))


def test_hardness_is_three_times_the_yield_stress() -> None:
    hardness = xr.DataArray([700.0], {"z": [0.0]}, "z")
    steel = ElasticPlastic.from_hardness(hardness, kinematic_hardening=5e9)
    assert steel.yield_stress_at(np.zeros(1))[0] == pytest.approx(700 * 9.80665e6 / 3)
    assert steel.kinematic_hardening == 5e9


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"yield_stress": -1.0}, "yield_stress"),
        ({"yield_stress": float("nan")}, "yield_stress"),
        ({"yield_stress": xr.DataArray([1.0, -1.0], {"z": [0.0, 1.0]}, "z")}, "yield_stress"),
        ({"yield_stress": xr.DataArray([1.0, 1.0], {"z": [1.0, 0.0]}, "z")}, "increasing"),
        ({"yield_stress": xr.DataArray([1.0], {"x": [0.0]}, "x")}, "depths"),
        ({"kinematic_hardening": -1.0}, "kinematic_hardening"),
        ({"isotropic_hardening": float("inf")}, "isotropic_hardening"),
    ],
)
def test_invalid_argument_raises(change, message) -> None:
    with pytest.raises(InvalidInputError, match=message):
        ElasticPlastic(**({"yield_stress": 1.0} | change))
