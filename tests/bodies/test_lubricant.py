import numpy as np
import pytest

from contactstudy import InvalidInputError, Lubricant
from contactstudy.bodies.lubricant import OILS, walther


def test_density_slope_equals_the_derivative():
    oil = Lubricant(viscosity=0.02, pressure_viscosity=2e-8)
    pressures = np.array([1e6, 1e8, 1e9])
    difference_quotient = (oil.density_ratio(pressures * 1.0001) - oil.density_ratio(pressures * 0.9999)) / (
        2e-4 * pressures
    )
    assert oil.density_ratio_slope(pressures) == pytest.approx(difference_quotient, rel=1e-5)


def test_roelands_viscosity_approaches_barus_at_low_pressure():
    oil = Lubricant(viscosity=0.02, pressure_viscosity=2e-8)
    assert float(oil.log_viscosity(1e3)) == pytest.approx(2e-8 * 1e3, rel=1e-5)
    assert float(oil.log_viscosity(1e9)) < 2e-8 * 1e9


@pytest.mark.parametrize(("law", "pressure"), [("barus", 0.5e9), ("roelands", 2.0976e9)])
def test_viscosity_law_has_pressure_limit(law, pressure):
    """Barus' law to 0.5 GPa, Roelands' to solidification."""
    oil = Lubricant(viscosity=0.02, pressure_viscosity=2e-8, viscosity_law=law)
    assert oil.law_holds(np.array([0.99, 1.01]) * pressure).tolist() == [True, False]


def test_walther_interpolates_two_viscosities():
    points = {40: 100.0, 100: 11.0}
    assert walther(points, 40.0)[0] == pytest.approx(100.0)
    step = 1e-3
    temperature_coefficient = np.log(walther(points, 70.0 - step)[0] / walther(points, 70.0 + step)[0]) / (2 * step)
    assert walther(points, 70.0)[1] == pytest.approx(temperature_coefficient, rel=1e-6)


@pytest.mark.parametrize("name", OILS)
def test_presets_equal_tabulated_viscosities(name):
    for column, temperature in enumerate((30.0, 60.0, 100.0)):
        oil = Lubricant.preset(name, temperature)
        assert oil.viscosity == pytest.approx(OILS[name][0][column])
    step = 0.01
    temperature_coefficient = (
        np.log(Lubricant.preset(name, 60 - step).viscosity / Lubricant.preset(name, 60 + step).viscosity) / 0.02
    )
    assert Lubricant.preset(name, 60.0).temperature_viscosity == pytest.approx(temperature_coefficient, rel=1e-4)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"viscosity": 0.0}, "viscosity"),
        ({"pressure_viscosity": -1e-8}, "pressure_viscosity"),
        ({"viscosity_law": "reynolds"}, "viscosity_law"),
        ({"viscosity": 1e-5}, "viscosity"),
        ({"density": -1.0}, "density"),
    ],
)
def test_invalid_lubricant_raises(parameters, message):
    with pytest.raises(InvalidInputError, match=message):
        Lubricant(**({"viscosity": 0.02, "pressure_viscosity": 2e-8} | parameters))


def test_invalid_temperature_or_viscosities_raise():
    with pytest.raises(InvalidInputError, match="temperature"):
        Lubricant.preset("spindle oil", 20.0)
    with pytest.raises(InvalidInputError, match="viscosities"):
        walther({40: 10.0, 100: 20.0}, 70.0)
