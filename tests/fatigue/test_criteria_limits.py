"""Limits and constants of the criteria."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contactstudy import InvalidInputError, fatigue
from contactstudy.fatigue import FatigueLimits


@settings(max_examples=10)
@given(ratio=st.floats(0.58, 0.95), bending=st.floats(1e8, 1e9))
@pytest.mark.parametrize("criterion", [fatigue.dang_van, fatigue.crossland, fatigue.findley])
def test_limits_have_utilisation_one(cycle, wave, criterion, ratio: float, bending: float) -> None:
    limits = FatigueLimits(bending=bending, torsion=ratio * bending)
    bending_cycle, torsion_cycle = cycle(sigma_yy=limits.bending * wave), cycle(tau_xz=limits.torsion * wave)
    for history, utilisation in ((bending_cycle, 1.0), (torsion_cycle, 1.0), (0.5 * torsion_cycle, 0.5)):
        assert float(criterion(history, limits)["utilisation"]) == pytest.approx(utilisation, rel=1e-6)


def test_crossland_slope_of_von_mises_limits() -> None:
    assert FatigueLimits(bending=1.0, torsion=1 / np.sqrt(3)).crossland_slope == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("bending", "torsion", "message"),
    [(0.0, 1.0, "bending"), (1.0, -1.0, "torsion"), (1.0, 0.4, "half"), (1.0, 1.0, "half"), (np.nan, 1.0, "bending")],
)
def test_impossible_limits_are_rejected(bending: float, torsion: float, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        FatigueLimits(bending=bending, torsion=torsion)


def test_crossland_rejects_a_brittle_ratio(cycle, wave) -> None:
    with pytest.raises(InvalidInputError, match="for Crossland"):
        fatigue.crossland(cycle(tau_yz=wave), FatigueLimits(bending=1.0, torsion=0.55))
