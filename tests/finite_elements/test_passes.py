"""Finite elements of passes against closed forms and stored results."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.finite_elements.passes import YOUNG, PlasticStrip, Strip
from benchmarks.finite_elements.passes_file import PRODUCTION, solve_reference
from contactstudy.verification.problems import PASSES_CASES, PASSES_FILE, PassesCase, load_reference

COARSE_STRIP = Strip(length=12.0, depth=6.0, width=1.0, height=0.2, fine=2.2, step=0.25)


def test_line_contact_below_first_yield_has_no_plastic_strain() -> None:
    """First yield of a line contact is at p0 = 3.107 k."""
    strains, stresses, _ = PlasticStrip(
        PassesCase(shear_yield_stress=1 / 3.0, friction=0.0, passes=1), COARSE_STRIP
    ).roll_over()
    assert np.abs(strains).max() == 0
    assert np.abs(stresses).max() < 1e-12


def test_residual_stress_equals_stress_of_uniform_layers() -> None:
    """Far behind the contact the plastic strain is uniform along y; the stress follows from zero total strains xx and
    yy."""
    strip = PlasticStrip(PASSES_CASES["settling"], COARSE_STRIP)
    strains, stresses, strain_spread = strip.roll_over()
    xx, yy, zz, _ = YOUNG * strains[-1]
    poisson = strip.case.poisson
    assert xx + yy + zz == pytest.approx(0, abs=1e-9)
    max_stress = np.abs(stresses).max()
    assert stresses[:2] == pytest.approx(
        -np.array([xx + poisson * yy, yy + poisson * xx]) / (1 - poisson**2), abs=0.1 * max_stress
    )
    assert stresses[2:] == pytest.approx(0, abs=0.01 * max_stress)
    assert max_stress > 0.05
    assert YOUNG * strain_spread.max() < 0.1 * np.abs(YOUNG * strains).max()


def test_radial_return_tangent_equals_stress_derivative() -> None:
    """Some strains are below yield, others above."""
    strip = PlasticStrip(replace(PASSES_CASES["settling"], kinematic_hardening=0.02), COARSE_STRIP)
    rng = np.random.default_rng(2)
    total_strain, plastic = rng.normal(size=(2, 4, 40)) * np.array([4e-4, 1e-5])[:, None, None]
    elastic_stress = np.zeros((4, 40))
    stress, plastic_after, tangent = strip.return_stress(total_strain, plastic, elastic_stress)
    assert 0 < np.count_nonzero((plastic_after != plastic).any(axis=0)) < 40
    for component in range(4):
        change = np.zeros((4, 1))
        change[component] = 1e-9
        stress_forward, stress_backward = (
            strip.return_stress(total_strain + step_sign * change, plastic, elastic_stress)[0] for step_sign in (1, -1)
        )
        slope = (stress_forward - stress_backward) / 2e-9 / (2 if component == 3 else 1)
        assert slope == pytest.approx(tangent[:, component], abs=1e-4 * YOUNG)
    assert np.isfinite(stress).all()


@pytest.mark.slow
def test_passes_on_coarse_mesh_approximate_stored_passes() -> None:
    stored_passes = load_reference(PASSES_FILE, "flowing_sliding")
    result = solve_reference(PASSES_CASES["flowing_sliding"], replace(PRODUCTION, width=1.0, step=1 / 4))
    max_stress = float(np.abs(stored_passes["sigma_xx"]).max())
    assert np.abs(result["sigma_xx"].values - stored_passes["sigma_xx"].values).max() < 0.15 * max_stress
    shear, expected = (dataset["plastic_strain_yz_young"].sum("z").values for dataset in (result, stored_passes))
    # Flow accumulates over the passes, with the errors of a coarse mesh.
    assert shear == pytest.approx(expected, abs=0.3 * float(np.abs(expected).max()))
