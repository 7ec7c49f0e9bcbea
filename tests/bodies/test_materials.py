"""Materials have the constants from which their sources' factors follow."""

import numpy as np
import pytest

from contactstudy import materials
from contactstudy.bodies.material import contact_modulus


def test_factors_of_a_gear_standard_follow() -> None:
    """Elasticity factor: root of E* over pi, in N and mm; stated to four digits."""
    for other, stated in ((materials.GEAR_STEEL, 189.8), (materials.DUCTILE_IRON, 181.4)):
        modulus = 1e-6 * contact_modulus(materials.GEAR_STEEL, other)
        assert np.sqrt(modulus / np.pi) == pytest.approx(stated, abs=0.05)


def test_factors_of_a_bearing_handbook_follow() -> None:
    """Half-width of a line contact over the root of ``Q / (l sum of curvatures)``; semi-axes over a cube root."""
    modulus = 1e-6 * contact_modulus(materials.BEARING_STEEL, materials.BEARING_STEEL)
    assert np.sqrt(4 / (np.pi * modulus)) == pytest.approx(3.35e-3, abs=0.005e-3)
    assert (3 / (2 * modulus)) ** (1 / 3) == pytest.approx(0.0236, abs=0.00005)


def test_structural_steel_has_the_shear_modulus_of_its_standard() -> None:
    assert 1e-6 * materials.STRUCTURAL_STEEL.shear_modulus == pytest.approx(80770, abs=5)


def test_another_material_is_refused_with_those_there_are() -> None:
    with pytest.raises(AttributeError, match=r"no material .STEEL.; there are BEARING_STEEL, .* Material\(young"):
        vars(materials)["__getattr__"]("STEEL")
