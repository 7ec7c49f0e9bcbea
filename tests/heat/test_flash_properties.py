import pytest

from contactstudy import InvalidInputError
from contactstudy.heat import ThermalProperties


def test_diffusivity_equals_conductivity_over_capacity():
    water = ThermalProperties(conductivity=0.6, density=1000.0, specific_heat=4186.0)
    assert water.diffusivity == pytest.approx(1.43e-7, rel=3e-3)


@pytest.mark.parametrize("name", ["conductivity", "density", "specific_heat"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), None])
def test_thermal_properties_are_positive(name, value):
    arguments = {"conductivity": 1.0, "density": 1.0, "specific_heat": 1.0} | {name: value}
    with pytest.raises(InvalidInputError, match=name):
        ThermalProperties(**arguments)
