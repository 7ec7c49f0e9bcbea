"""The constants of materials against the factors of their sources."""

from pathlib import Path

import numpy as np
import pytest

from contactstudy import Material, materials
from contactstudy.bodies.material import contact_modulus

ROOT = Path(__file__).parents[2]


def test_elasticity_factors_equal_gear_standard() -> None:
    """The elasticity factor is the root of E* over pi, in N and mm; the standard states four digits."""
    for second_material, factor in ((materials.GEAR_STEEL, 189.8), (materials.DUCTILE_IRON, 181.4)):
        modulus = 1e-6 * contact_modulus(materials.GEAR_STEEL, second_material)
        assert np.sqrt(modulus / np.pi) == pytest.approx(factor, abs=0.05)


def test_contact_factors_equal_bearing_handbook() -> None:
    """Half-width over the root of ``Q / (l sum of curvatures)``, and semi-axes over the cube root of ``Q / sum of
    curvatures``."""
    modulus = 1e-6 * contact_modulus(materials.BEARING_STEEL, materials.BEARING_STEEL)
    assert np.sqrt(4 / (np.pi * modulus)) == pytest.approx(3.35e-3, abs=0.005e-3)
    assert (3 / (2 * modulus)) ** (1 / 3) == pytest.approx(0.0236, abs=0.00005)


def test_structural_steel_has_the_standard_shear_modulus() -> None:
    assert 1e-6 * materials.STRUCTURAL_STEEL.shear_modulus == pytest.approx(80770, abs=5)


def test_reference_contains_the_sources_of_materials() -> None:
    names = {name for name in materials.__all__ if isinstance(getattr(materials, name), Material)}
    assert set(materials.SOURCES) == names
    for source in materials.SOURCES.values():
        assert any(word in source for word in ("ISO 6336", "EN 1993", "edition"))
    assert "<!-- made: materials -->" in (ROOT / "docs" / "reference" / "materials.md").read_text()
