"""Reference life against Lundberg and Palmgren's theory without laminae."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, InvalidInputError, Material, Roller, profiles
from contactstudy.bearing import reference_life, roller_ratings

ROLLER = Roller(radius=5e-3, length=0.5e-3, profile=profiles.Cylinder())
CASE = Case(body=FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3)), roller=ROLLER, load=70.0)
LOADS = (20.0, 70.0, 45.0)
RATINGS = (900.0, 1400.0)


@pytest.fixture(scope="module")
def flush_roller_life() -> xr.Dataset:
    """Life of a straight roller, flush with free ends: the loads of the slices are equal."""
    return reference_life(CASE, CASE, RATINGS, accuracy=0.05)


@pytest.fixture(scope="module")
def roller_lives() -> xr.Dataset:
    cases = [replace(CASE, load=load) for load in LOADS]
    return reference_life(cases, cases, RATINGS, rollers=7, accuracy=0.05)


def test_life_of_uniform_slices_equals_formula(flush_roller_life: xr.Dataset) -> None:
    slices = flush_roller_life.sel(model="slices")
    lives = [(rating / 70.0) ** 4 for rating in RATINGS]
    bearing_life = sum(life ** (-9 / 8) for life in lives) ** (-8 / 9)
    np.testing.assert_allclose(slices["raceway_life"], 1e6 * np.array(lives), rtol=1e-9)
    assert float(slices["reference_life"]) == pytest.approx(1e6 * bearing_life, rel=1e-9)


def test_life_of_flush_roller_depends_on_model(flush_roller_life: xr.Dataset) -> None:
    life = flush_roller_life["reference_life"]
    assert float(life.sel(model="free ends")) == pytest.approx(float(life.sel(model="slices")), rel=0.25)
    assert float(life.sel(model="half-space")) == 0  # its pressure is singular at the sharp ends
    assert float(life.sel(model="slices with riser")) < 0.7 * float(life.sel(model="slices"))
    assert (
        0
        < float(flush_roller_life["reference_life_error"].sel(model="free ends"))
        < 0.3 * float(life.sel(model="free ends"))
    )


VARIABLES = ("reference_life", "raceway_life", "lamina_equivalent_load", "stress_riser")


def test_error_of_slice_models_is_nan(flush_roller_life: xr.Dataset) -> None:
    for name in VARIABLES:
        error = flush_roller_life[f"{name}_error"]
        assert np.isnan(error.sel(model=["slices", "slices with riser"])).all(), name
        assert not np.isnan(error.sel(model=["half-space", "free ends"])).any(), name
        assert error.attrs["units"] == flush_roller_life[name].attrs["units"]
    end_slices = flush_roller_life.sel(model="half-space").isel(slice=[0, -1])
    assert np.isinf(end_slices["lamina_equivalent_load"]).all()
    assert np.isinf(end_slices["lamina_equivalent_load_error"]).all()


@pytest.mark.slow
def test_errors_cover_difference_from_finer_columns() -> None:
    crown = replace(ROLLER, length=1e-3, profile=profiles.FullCrown(crown_radius=0.04))
    body = FiniteLengthSpace(length=1.2e-3, material=Material(210e9, 0.3))
    tilted_case = Case(body=body, roller=replace(crown, profile=profiles.Lundberg(0.4e-6)), load=200.0, tilt=1e-3)
    crowned_case = Case(body=body, roller=crown, load=120.0)
    coarse_life, fine_life = (
        reference_life(crowned_case, tilted_case, RATINGS, accuracy=accuracy).sel(model=["half-space", "free ends"])
        for accuracy in (0.01, 0.004)
    )
    for name in VARIABLES:
        difference = abs(coarse_life[name] - fine_life[name])
        assert (difference <= coarse_life[f"{name}_error"]).where(np.isfinite(difference), other=True).all(), name
    assert (coarse_life["reference_life_error"] < 0.15 * coarse_life["reference_life"]).all()


def test_raceway_life_uses_power_means_over_rollers(roller_lives: xr.Dataset) -> None:
    loads = np.array(LOADS)
    turning_mean = ((loads**4).sum() / 7) ** (1 / 4)
    standing_mean = ((loads**4.5).sum() / 7) ** (1 / 4.5)
    lives = 1e6 * np.array([(RATINGS[0] / turning_mean) ** 4, (RATINGS[1] / standing_mean) ** 4])
    np.testing.assert_allclose(roller_lives["raceway_life"].sel(model="slices"), lives, rtol=1e-9)
    assert roller_lives.sizes["roller"] == 3
    assert roller_lives.attrs["turning"] == "inner"


def test_turning_outer_raceway_lives_longer(roller_lives: xr.Dataset) -> None:
    cases = [replace(CASE, load=load) for load in LOADS]
    outer_turning = reference_life(cases, cases, RATINGS, rollers=7, accuracy=0.05, turning="outer")
    is_longer = outer_turning["raceway_life"] > roller_lives["raceway_life"]
    assert is_longer.sel(model="slices").values.tolist() == [False, True]


def load_integrals() -> tuple[float, float, float]:
    """Mean load, and power means of the turning and the standing raceway, over the largest load of a half-loaded
    bearing."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 20001)
    # In a line contact the load grows with the approach to the power 10/9; the theory of 1952 has 1.1.
    load_distribution = np.cos(angles) ** 1.1
    integrals = [
        np.trapezoid(values, angles) / (2 * np.pi)
        for values in (load_distribution * np.cos(angles), load_distribution**4, load_distribution**4.5)
    ]
    return integrals[0], integrals[1] ** (1 / 4), integrals[2] ** (1 / 4.5)


def test_roller_ratings_agree_with_the_bearing_rating() -> None:
    """With half of the rollers loaded the life under C is a million revolutions without the factor 0.83."""
    mean_load, turning_mean, standing_mean = load_integrals()
    assert mean_load / turning_mean == pytest.approx(0.378, abs=0.002)
    assert mean_load / standing_mean == pytest.approx(0.364, abs=0.002)
    rating, count = 50e3, 14
    inner_rating, outer_rating = roller_ratings(rating, count, 0.18)
    max_load = rating / (count * mean_load)
    life = ((turning_mean * max_load / inner_rating) ** 4.5 + (standing_mean * max_load / outer_rating) ** 4.5) ** (
        -8 / 9
    )
    assert life == pytest.approx(0.83**-4, rel=0.02)


def test_ratings_of_two_rows_exceed_single_row() -> None:
    single_rating, double_rating = roller_ratings(50e3, 14, 0.18), roller_ratings(50e3, 14, 0.18, rows=2)
    np.testing.assert_allclose(np.array(single_rating) / double_rating, 2 ** (7 / 9))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: reference_life([], CASE, RATINGS), "inner = "),
        (lambda: reference_life(CASE, [CASE, CASE], RATINGS), "outer = 2: must be as many rollers"),
        (lambda: reference_life(CASE, CASE, (1.0,)), "ratings"),
        (lambda: reference_life(CASE, CASE, (1.0, -1.0)), "ratings"),
        (lambda: reference_life([CASE, CASE], [CASE, CASE], RATINGS, rollers=1), "rollers = 1"),
        (lambda: reference_life(CASE, CASE, RATINGS, turning="shaft"), "turning"),
        (lambda: roller_ratings(50e3, 14, 1.2), "gamma = 1.2: must be below 1"),
        (lambda: roller_ratings(-1.0, 14, 0.2), "dynamic_rating"),
    ],
)
def test_invalid_argument_raises(call, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        call()
