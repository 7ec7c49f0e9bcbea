"""FASTSIM against the linear theory on an ellipse and published numbers."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import InvalidInputError, Rolling
from contactstudy.contact.rolling.fastsim import creep_coefficients, strip_tractions
from contactstudy.verification.tribology import material, rolling_ellipse

STEEL = material(82e9, 0.28)


@pytest.mark.parametrize(
    "motion", [Rolling(longitudinal_creepage=1e-6, model="fastsim"), Rolling(lateral_creepage=1e-6, model="fastsim")]
)
def test_small_creepages_match_kalker_forces(motion: Rolling) -> None:
    half_width_y, half_width_x = 6e-3, 4e-3
    computed = rolling_ellipse(half_width_x, half_width_y, 80e3, STEEL, 0.3, motion, (44, 50))
    c11, c22, _ = creep_coefficients(half_width_y / half_width_x, 0.28)
    is_lateral = bool(motion.lateral_creepage)
    force = float(computed["force_x" if is_lateral else "force_y"])
    assert force == pytest.approx(82e9 * half_width_y * half_width_x * (c22 if is_lateral else c11) * 1e-6, rel=0.02)


def test_fastsim_matches_published_spin_case() -> None:
    """The published force is 0.602 of full sliding with an elliptic bound (the program CONTACT's FASTSIM)."""
    motion = Rolling(lateral_creepage=-6.25e-4, spin=-0.625, model="fastsim")
    computed = rolling_ellipse(4e-3, 8e-3, 82e3, STEEL, 0.3, motion, (44, 50))
    assert float(computed["force_x"]) / (0.3 * 82e3) == pytest.approx(0.602, abs=0.012)
    bound = 0.3 * computed["pressure"]
    traction_size = np.hypot(computed["traction_x"], computed["traction_y"])
    assert float((traction_size - bound).max()) < 1e-9 * float(bound.max())
    is_slipping = (computed["pressure"] > 0) & ~computed["stick"].astype(bool)
    assert float(np.abs(traction_size - bound).where(is_slipping, 0.0).max()) < 1e-9 * float(bound.max())


def test_creep_coefficients_are_interpolated_and_extrapolated() -> None:
    assert creep_coefficients(0.3, 0.5) == pytest.approx([4.80, 2.81, 0.889])
    assert (np.diff([creep_coefficients(ratio, 0.3) for ratio in (0.5, 0.75, 1.1, 3.0)], axis=0) > 0).all()
    assert creep_coefficients(0.05, 0.3)[:2] == pytest.approx([np.pi**2 / 2.8, np.pi**2 / 4])
    assert creep_coefficients(50.0, 0.25) == pytest.approx([11.7, 12.8, 14.6])


@pytest.mark.parametrize(("poisson", "tabulated_coefficient"), [(0.0, 0.334), (0.25, 0.473), (0.5, 0.731)])
def test_narrow_contact_follows_kalker_spin_asymptote(poisson: float, tabulated_coefficient: float) -> None:
    # Kalker's own form has Lambda = ln(16 / g**2).
    for ratio in (0.03, 0.0999):
        half_logarithm = 0.5 * np.log(16 / ratio**2)
        expected = np.pi * ratio**0.5 / 3 * (1 + poisson * (half_logarithm + np.log(4) - 5)) / (1 - poisson)
        assert creep_coefficients(ratio, poisson)[2] == pytest.approx(expected)
    assert expected == pytest.approx(tabulated_coefficient, rel=0.07)


def test_strip_traction_grows_to_bound() -> None:
    """Material enters at the last cell; the traction grows over half a cell, then over one cell per step."""
    bound = np.array([[0.0, 2.2, 2.2, 2.2, 2.2, 0.0], [0.0, 0.3, 0.3, 0.3, 0.3, 0.0]])
    growth = np.stack([np.full(bound.shape, 1.2), np.full(bound.shape, -1.6)])
    traction, slip = strip_tractions(bound, growth, 0.5)
    traction_sizes, slip_sizes = np.hypot(*traction), np.hypot(*slip)
    assert traction_sizes[0] == pytest.approx([0, 2.2, 2.2, 1.5, 0.5, 0])
    assert slip_sizes[0] == pytest.approx([0, 2.0, 0.6, 0, 0, 0])
    assert traction_sizes[1] == pytest.approx([0, 0.3, 0.3, 0.3, 0.3, 0])
    assert slip_sizes[1] == pytest.approx([0, 2.0, 2.0, 2.0, 0.8, 0])
    assert traction[0] == pytest.approx(0.6 * traction_sizes)
    assert traction[1] == pytest.approx(-0.8 * traction_sizes)
    assert slip[1] == pytest.approx(-0.8 * slip_sizes)


def test_fastsim_accepts_creepages_only() -> None:
    with pytest.raises(InvalidInputError, match=r"model = 'fastsim'.*takes forces"):
        Rolling(force_y=1.0, model="fastsim")
    with pytest.raises(InvalidInputError, match="did you mean 'fastsim'"):
        Rolling(model="fastsims")
