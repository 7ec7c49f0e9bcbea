"""Edge factors of laminae against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    choose_grid,
    profiles,
    solve,
)
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED
from contactstudy.bearing import lamina_factors
from contactstudy.verification import closed_forms
from tests.split_columns import split_columns

STEEL = Material(210e9, 0.3)
DESIGN = profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=STEEL.plane_strain_modulus)


@pytest.fixture(scope="module")
def uniform_contact() -> xr.Dataset:
    """Lundberg's profile at its design load on a half-space: the pressure is uniform along the roller."""
    roller = Roller(radius=5e-3, length=4e-3, profile=DESIGN)
    case = Case(body=HalfSpace(material=STEEL), roller=roller, max_pressure=1.5e9)
    return solve(case, stresses=False, accuracy=0.02)


def test_uniform_pressure_gives_uniform_loads(uniform_contact: xr.Dataset) -> None:
    factors = lamina_factors(uniform_contact)
    load = float(uniform_contact.normal_load) / 4e-3
    np.testing.assert_allclose(factors.hertz_load_per_length[3:-3], load, rtol=0.03)
    np.testing.assert_allclose(
        factors.stress_riser * factors.load_per_length, factors.hertz_load_per_length, rtol=1e-12
    )
    assert float(factors.width.sum()) == pytest.approx(4e-3)
    assert float(factors.position[0]) == pytest.approx(4e-3 / 60)
    assert 0 < float(factors.stress_riser_error[10]) < 0.05


def test_slice_model_is_the_limit_of_long_rollers() -> None:
    """Independent slices are the limit of a straight roller that is long compared with its half-width.

    Sharp ends on a half-space unload the middle and flush free ends load it, less for longer rollers.
    """
    mid_risers: dict[str, list[float]] = {"half-space": [], "flush": []}
    for length in (0.5e-3, 8e-3):
        bodies = {"half-space": HalfSpace(material=STEEL), "flush": FiniteLengthSpace(length=length, material=STEEL)}
        for name, body in bodies.items():
            case = Case(body=body, roller=Roller(radius=5e-3, length=length), max_pressure=1.5e9)
            factors = lamina_factors(solve(case, stresses=False, accuracy=0.02), laminae=31)
            mid_risers[name].append(float(factors.stress_riser[15]))
    assert mid_risers["half-space"][0] < mid_risers["half-space"][1] < 1
    assert mid_risers["flush"][0] > mid_risers["flush"][1] > 1
    assert mid_risers["flush"][1] - mid_risers["half-space"][1] < 0.12


def test_risk_is_independent_of_laminae(uniform_contact: xr.Dataset) -> None:
    coarse_factors, fine_factors = (lamina_factors(uniform_contact, laminae=count) for count in (30, 90))
    risks = [
        float((factors.hertz_load_per_length**4.5 * factors.width).sum()) for factors in (coarse_factors, fine_factors)
    ]
    assert risks[0] == pytest.approx(risks[1], rel=1e-9)


def test_free_ends_lower_the_outermost_riser() -> None:
    roller = Roller(radius=5e-3, length=0.5e-3, profile=DESIGN)
    flush_body = FiniteLengthSpace(length=0.5e-3, material=STEEL)
    end_risers = [
        float(
            lamina_factors(solve(Case(body=body, roller=roller, load=70.0, tilt=2e-4), stresses=False)).stress_riser[-1]
        )
        for body in (HalfSpace(material=STEEL), flush_body)
    ]
    assert end_risers[1] < 0.8 * end_risers[0]


def test_riser_at_sharp_end_is_infinite_on_refined_columns_only() -> None:
    roller, body = Roller(radius=5e-3, length=0.5e-3), FiniteLengthSpace(length=0.7e-3, material=STEEL)
    case = Case(body=body, roller=roller, max_pressure=1.5e9)
    sharp_factors = lamina_factors(solve(case, stresses=False, accuracy=0.05))
    assert np.isinf(sharp_factors.stress_riser[[0, -1]]).all()
    assert np.isfinite(sharp_factors.stress_riser[1:-1]).all()
    uniform_factors = lamina_factors(solve(case, choose_grid(case), stresses=False))
    assert np.isfinite(uniform_factors.stress_riser).all()
    assert np.isnan(uniform_factors.stress_riser_error).all()
    assert uniform_factors.stress_riser_error.attrs[ERROR_KIND] == NOT_ESTIMATED
    assert uniform_factors.edge_factor.attrs["comment"] == "of independent slices"


@pytest.mark.parametrize(
    ("profile", "tilt"),
    [
        (profiles.FullCrown(crown_radius=0.02), 4e-3),
        pytest.param(profiles.Cylinder(fillet_radius=0.05e-3), 4e-4, marks=pytest.mark.slow),
        (profiles.Cylinder(), 5e-4),
    ],
)
def test_errors_cover_difference_from_finer_columns(profile: profiles.Profile, tilt: float) -> None:
    roller = Roller(radius=5e-3, length=0.8e-3, profile=profile)
    case = Case(body=HalfSpace(material=STEEL), roller=roller, max_pressure=1.5e9, tilt=tilt)
    coarse_result = solve(case, stresses=False, accuracy=0.01)
    fine_result = solve(case, split_columns(coarse_result, 4), stresses=False)
    for laminae in (4, 9, 30, 60):
        factors, fine_loads = (
            lamina_factors(result, laminae=laminae).hertz_load_per_length for result in (coarse_result, fine_result)
        )
        error = lamina_factors(coarse_result, laminae=laminae).hertz_load_per_length_error
        is_finite = np.isfinite(factors)
        assert (abs(factors - fine_loads) <= error)[is_finite].all()
        assert float(error[is_finite].median()) < 0.05 * float(fine_loads[is_finite].max())


@pytest.mark.parametrize("crown_radius", [0.01, 0.04])
def test_errors_cover_difference_from_hertz_ellipse(crown_radius: float) -> None:
    """The load per length equals p0 (1 - (x/b)**2)**0.5, and 0 beyond the contact, within a lamina."""
    roller = Roller(radius=5e-3, length=1e-3, profile=profiles.FullCrown(crown_radius))
    case = Case(body=HalfSpace(material=STEEL), roller=roller, max_pressure=0.6e9)
    result = solve(case, stresses=False)
    contact = closed_forms.hertz_ellipse(case.normal_load, crown_radius, roller.radius, case.modulus)
    positions = np.linspace(-0.5e-3, 0.5e-3, 400001)
    squared_pressure = contact.max_pressure**2 * np.clip(1 - (positions / contact.long) ** 2, 0.0, None)
    load_per_length = np.pi * roller.radius / case.modulus * squared_pressure
    for laminae in (5, 13):
        factors = lamina_factors(result, laminae=laminae)
        lamina_indices = np.clip(((positions + 0.5e-3) / 1e-3 * laminae).astype(int), 0, laminae - 1)
        power_means = (np.bincount(lamina_indices, load_per_length ** (9 / 2)) / np.bincount(lamina_indices)) ** (2 / 9)
        error = factors.hertz_load_per_length_error.values
        assert (np.abs(factors.hertz_load_per_length.values - power_means) <= error + 1e-3).all()
        assert np.median(error) < 0.1 * power_means.max()


def test_unloaded_laminae_have_no_riser() -> None:
    roller = Roller(radius=5e-3, length=2e-3, profile=profiles.FullCrown(crown_radius=0.3))
    case = Case(body=HalfSpace(material=STEEL), roller=roller, load=60.0)
    factors = lamina_factors(solve(case, stresses=False, accuracy=0.05))
    is_unloaded = factors.load_per_length == 0
    assert bool(is_unloaded.any())
    assert np.isnan(factors.stress_riser.where(is_unloaded, drop=True)).all()
    assert np.isfinite(factors.hertz_load_per_length).all()


def test_result_without_case_is_rejected(uniform_contact: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="contactstudy_inputs"):
        lamina_factors(uniform_contact.drop_attrs())
    with pytest.raises(InvalidInputError, match="laminae = 1"):
        lamina_factors(uniform_contact, laminae=1)
    with pytest.raises(InvalidInputError, match="pressure"):
        lamina_factors(uniform_contact.drop_vars("pressure"))
