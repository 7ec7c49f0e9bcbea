"""The stored references: complete, small, and in agreement with the cases that the package states."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError
from contactstudy.verification.load_cases import CONTACT_CASES, LOAD_CASES
from contactstudy.verification.stored import CONTACT_FILE, STRESS_FILE, data_file, load_contact, load_stress


@pytest.mark.parametrize("name", CONTACT_CASES)
def test_stored_contacts(name: str) -> None:
    """Load, sign, and symmetry; errors small where the pressure is smooth."""
    reference = load_contact(name)
    case, contact = reference.case, reference.contact
    stated = [contact.attrs[key] for key in ("length", "distance", "crown", "poisson")]
    assert stated == [case.length, case.distance, case.crown, case.poisson]
    pressure = contact["pressure"]
    assert float(pressure.min()) >= 0
    assert float(contact["line_load"].integrate("x")) == pytest.approx(case.load, rel=1e-6)
    assert np.abs(pressure.values - pressure.values[::-1]).max() < 1e-6
    inner = contact.sel(x=slice(case.start + 0.5, case.stop - 0.5), y=0)
    assert float(inner["pressure_error"].max()) < 6e-3
    assert float(inner["pressure_error"].median()) < 3e-3


@pytest.mark.parametrize("name", LOAD_CASES)
def test_stored_stresses_belong_to_the_cases(name: str) -> None:
    reference = load_stress(name)
    case, stated = reference.case, reference.stress.attrs
    assert [stated[key] for key in ("length", "poisson", "friction", "g")] == [
        case.length,
        case.poisson,
        case.friction,
        str(case.g),
    ]
    assert reference.median_error < reference.error < 5e-4


@pytest.mark.parametrize("load", [load_stress, load_contact])
def test_unknown_names_are_errors(load: Callable[[str], object]) -> None:
    with pytest.raises(InvalidInputError, match="nothing"):
        load("nothing")


@pytest.mark.parametrize("name", [STRESS_FILE, CONTACT_FILE])
def test_files_are_small_and_say_how_they_were_made(name: str) -> None:
    assert data_file(name).stat().st_size < 300_000
    stated = xr.load_dataset(data_file(name)).attrs
    assert "scikit-fem" in stated["software"]
    assert stated["regenerate"].startswith("python -m tests.finite_elements.generate")
