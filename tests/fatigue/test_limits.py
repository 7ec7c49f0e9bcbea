"""Constants of the criteria: every one of them is on the limit in bending and in torsion."""

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
def test_both_limits_are_on_the_limit(cycle, wave, criterion, ratio: float, bending: float) -> None:
    limits = FatigueLimits(bending=bending, torsion=ratio * bending)
    bent, twisted = cycle(sigma_yy=limits.bending * wave), cycle(tau_xz=limits.torsion * wave)
    for history, share in ((bent, 1.0), (twisted, 1.0), (0.5 * twisted, 0.5)):
        assert float(criterion(history, limits)["utilisation"]) == pytest.approx(share, rel=1e-6)


def test_crossland_of_von_mises_limits() -> None:
    assert FatigueLimits(bending=1.0, torsion=1 / np.sqrt(3)).crossland_slope == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("bending", "torsion", "message"),
    [(0.0, 1.0, "bending"), (1.0, -1.0, "torsion"), (1.0, 0.4, "half"), (1.0, 1.0, "half"), (np.nan, 1.0, "bending")],
)
def test_impossible_limits(bending: float, torsion: float, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        FatigueLimits(bending=bending, torsion=torsion)


def test_crossland_refuses_a_brittle_ratio(cycle, wave) -> None:
    with pytest.raises(InvalidInputError, match="for Crossland"):
        fatigue.crossland(cycle(tau_yz=wave), FatigueLimits(bending=1.0, torsion=0.55))
