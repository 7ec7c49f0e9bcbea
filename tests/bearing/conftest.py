"""Contact law shared by the tests of bearings."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Case, HalfSpace, Material, Roller, profiles
from contactstudy.bearing import ContactLaw, contact_law

STEEL = Material(210e9, 0.3)


@pytest.fixture(scope="session")
def short_case() -> Case:
    """A crowned roller on a half-space."""
    roller = Roller(radius=5e-3, length=0.5e-3, profile=profiles.Lundberg(0.2e-6))
    return Case(body=HalfSpace(material=STEEL), roller=roller, load=70.0)


@pytest.fixture(scope="session")
def short_law(short_case: Case) -> ContactLaw:
    return contact_law(short_case, 1e-3 * np.linspace(-1.5, 1.5, 5), 1e-6 * np.geomspace(1.0, 3.0, 5), accuracy=0.1)
