"""Reference profiles of ISO/TS 16281."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError
from contactstudy.profiles import IsoCylindrical, IsoTapered, Lundberg

DIAMETER = 10e-3


def test_short_roller_as_printed() -> None:
    """Millimetres, as in the standard, and a logarithm of the other base."""
    length, x = 12.0, np.linspace(-5.9, 5.9, 31)
    expected = 0.00035 * 10.0 * np.log10(1 / (1 - (2 * x / length) ** 2)) * np.log(10)
    np.testing.assert_allclose(1e3 * IsoCylindrical(DIAMETER).drop(1e-3 * x, 12e-3), expected, rtol=1e-12)


def test_long_roller_as_printed() -> None:
    length = 40.0
    x = np.linspace(-19.9, 19.9, 81)
    inside = np.abs(x) - (length - 25.0) / 2
    expected = np.where(inside > 0, 0.0005 * 10 * np.log(1 / (1 - (inside / 12.5) ** 2)), 0.0)
    np.testing.assert_allclose(1e3 * IsoCylindrical(DIAMETER).drop(1e-3 * x, 40e-3), expected, rtol=1e-9, atol=1e-18)


def test_tapered_is_nine_sevenths_of_the_short_profile() -> None:
    x = np.linspace(-5e-3, 5e-3, 21)[1:-1]
    ratio = IsoTapered(DIAMETER).drop(x, 10e-3)[:9] / IsoCylindrical(DIAMETER).drop(x, 10e-3)[:9]
    np.testing.assert_allclose(ratio, 9 / 7)


@given(st.floats(-0.999, 0.999))
def test_both_branches_meet_in_shape_but_not_in_size(place: float) -> None:
    """At length = 2.5 D the straight middle vanishes; the standard's amplitudes 0.00035 and 0.0005 stay different."""
    length = 2.5 * DIAMETER
    x = np.array([place * length / 2])
    profile = IsoCylindrical(DIAMETER)
    below, above = profile.drop(x, length), profile.drop(x, length * (1 + 1e-13))
    np.testing.assert_allclose(above, below * 0.0005 / 0.00035, rtol=1e-8, atol=1e-16)


def test_short_profile_is_lundbergs_for_3000_megapascals() -> None:
    """Two bodies of steel with the 207 GPa and 0.3 of the standard."""
    modulus = 207e9 / (2 * (1 - 0.3**2))
    design = Lundberg.for_pressure(3000e6, radius=DIAMETER / 2, modulus=modulus)
    x = np.array([3e-3, 4.5e-3])
    np.testing.assert_allclose(IsoCylindrical(DIAMETER).drop(x, 10e-3), design.drop(x, 10e-3), rtol=1e-2)


def test_ends_are_out_of_reach() -> None:
    for profile in (IsoCylindrical(DIAMETER), IsoTapered(DIAMETER)):
        for length in (10e-3, 40e-3):
            assert np.isinf(profile.drop(np.array([-length / 2, length / 2]), length)).all()


@pytest.mark.parametrize("kind", [IsoCylindrical, IsoTapered])
@pytest.mark.parametrize("diameter", [0.0, -1e-3, np.nan, "thick", True])
def test_bad_diameters_are_named(kind, diameter) -> None:
    with pytest.raises(InvalidInputError, match="diameter = "):
        kind(diameter)
