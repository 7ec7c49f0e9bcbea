"""Multiaxial criteria: analytic cycles, invariances, Hertz' line contact."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from contactstudy import InvalidInputError, fatigue
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, STRESSES
from contactstudy.fatigue import FatigueLimits
from contactstudy.fatigue.criteria import _compute_damage, _find_worst_planes, _rotate_frames

LIMITS = FatigueLimits(bending=1.0, torsion=0.65)
CRITERIA = [fatigue.dang_van, fatigue.crossland, fatigue.findley]


@pytest.mark.parametrize("criterion", CRITERIA)
def test_criteria_at_points_have_no_estimated_error(cycle, wave, criterion) -> None:
    result = criterion(cycle(tau_yz=wave), LIMITS)
    assert all(array.attrs[ERROR_KIND] == NOT_ESTIMATED for array in result.values())


@pytest.mark.parametrize("criterion", CRITERIA)
def test_hydrostatic_pressure_gives_zero_utilisation(cycle, criterion) -> None:
    pressure_history = -np.sin(np.linspace(0, np.pi, 21))
    result = criterion(cycle(sigma_xx=pressure_history, sigma_yy=pressure_history, sigma_zz=pressure_history), LIMITS)
    assert float(result["utilisation"]) == pytest.approx(0, abs=1e-9)


def test_hydrostatic_tension_is_weighted_by_the_slope(cycle, wave) -> None:
    tension_wave = cycle(sigma_xx=wave, sigma_yy=wave, sigma_zz=wave)
    assert float(fatigue.dang_van(tension_wave, LIMITS)["dang_van"]) == pytest.approx(LIMITS.dang_van_slope)
    assert float(fatigue.crossland(tension_wave, LIMITS)["crossland"]) == pytest.approx(LIMITS.crossland_slope)
    assert float(fatigue.findley(tension_wave, LIMITS)["findley"]) == pytest.approx(LIMITS.findley_slope)


def test_mean_shear_does_not_change_dang_van_and_crossland(cycle) -> None:
    """The mean of a shear has no influence on Dang Van and Crossland."""
    pulsating_shear = cycle(tau_yz=np.sin(np.linspace(0, np.pi, 21)) ** 2)
    assert float(fatigue.dang_van(pulsating_shear, LIMITS)["dang_van"]) == pytest.approx(0.5)
    assert float(fatigue.crossland(pulsating_shear, LIMITS)["crossland"]) == pytest.approx(0.5)


def test_mean_shear_increases_findley(cycle) -> None:
    """On the plane at angle t to the shear plane the amplitude is cos(2t)/2, the largest normal stress sin(2t)."""
    pulsating_shear = cycle(tau_yz=np.sin(np.linspace(0, np.pi, 21)) ** 2)
    expected = np.sqrt(0.25 + LIMITS.findley_slope**2)
    assert float(fatigue.findley(pulsating_shear, LIMITS)["findley"]) == pytest.approx(expected, rel=1e-6)


def test_rotating_shear_has_constant_amplitude(cycle) -> None:
    """The deviator describes a circle: Crossland's amplitude is the radius, Dang Van's shear is constant."""
    angle = 2 * np.pi * np.arange(60) / 60
    rotating_shear = cycle(tau_xz=np.cos(angle), tau_yz=np.sin(angle))
    assert float(fatigue.crossland(rotating_shear, LIMITS)["crossland"]) == pytest.approx(1.0, rel=1e-6)
    assert float(fatigue.dang_van(rotating_shear, LIMITS)["dang_van"]) == pytest.approx(1.0, rel=1e-6)


def test_findley_plane_of_push_pull_equals_closed_form(cycle, wave) -> None:
    """The plane at angle t has the shear sin(2t)/2 and the normal stress (1 + cos(2t))/2, worst at tan(2t) = 1/k."""
    result = fatigue.findley(cycle(sigma_xx=wave), LIMITS)
    slope = LIMITS.findley_slope
    angle = 0.5 * np.arctan2(1, slope)
    assert abs(float(result["findley_plane"].sel(axis="x"))) == pytest.approx(np.cos(angle), abs=1e-4)
    assert float(result["findley"]) == pytest.approx(0.5 * (slope + np.sqrt(1 + slope**2)), rel=1e-9)
    assert float(result["findley_shear"]) == pytest.approx(0.5 * np.sin(2 * angle), abs=1e-4)


histories = arrays(float, (1, 9, 6), elements=st.floats(-1, 1).map(lambda value: round(value, 3)))


@settings(max_examples=10)
@given(history=histories)
def test_findley_plane_has_largest_damage(history: np.ndarray) -> None:
    # For smooth histories of a passage the search is exact to 1e-9; random histories have many local maxima.
    result = _find_worst_planes(history, 0.3)["damage"]
    rotations = np.linalg.qr(np.random.default_rng(2).normal(size=(4000, 3, 3)))[0]
    random_damage, _, _ = _compute_damage(history, rotations[None, :, :2], 0.3)
    assert result[0] >= random_damage.max() * (1 - 2e-2)


def test_refinement_rotates_about_all_axes() -> None:
    frame = np.array([[[0.0, 0, 1], [1.0, 0, 0]]])
    rotated_frame = _rotate_frames(frame, np.array([0.1]))[0]
    assert len({tuple(np.round(stress.ravel(), 6)) for stress in rotated_frame}) == 15
    assert np.allclose(rotated_frame[0], frame[0])
    assert np.allclose(np.einsum("kij,klj->kil", rotated_frame, rotated_frame), np.eye(2))


@settings(max_examples=10)
@given(history=histories, angle=st.floats(0, 6))
def test_criteria_do_not_depend_on_axes(history: np.ndarray, angle: float) -> None:
    xx, yy, zz, xy, xz, yz = np.moveaxis(history[0], -1, 0)
    tensor = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), -1, 0)
    rotation = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, 0.6, -0.8], [0, 0.8, 0.6]]
    )
    rotated_frame = rotation @ tensor @ rotation.T
    indices = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    datasets = [
        xr.Dataset(
            {name: ("y", stress[:, i, j]) for name, (i, j) in zip(STRESSES, indices, strict=True)}, {"y": range(9)}
        )
        for stress in (tensor, rotated_frame)
    ]
    for criterion, tolerance in ((fatigue.dang_van, 1e-7), (fatigue.crossland, 1e-7), (fatigue.findley, 2e-2)):
        original_value, rotated_value = (float(criterion(stress, LIMITS)[criterion.__name__]) for stress in datasets)
        assert rotated_value == pytest.approx(original_value, rel=tolerance, abs=1e-9), criterion.__name__


def test_crossland_of_line_contact_is_shear_amplitude(strip_result) -> None:
    """Without hydrostatic tension Crossland's sum is the amplitude of the root of J2."""
    result = fatigue.crossland(strip_result(window=12.0), LIMITS).isel(x_field=0)
    assert float(result["crossland_hydrostatic"].max()) < 1e-3
    # The orthogonal shear alone, +-0.25 p0 at 0.5 a, has the amplitude 0.25 p0; at the points it is a little less.
    shear = result["crossland_shear"].sel(z=0.5, method="nearest")
    assert 0.247 < float(shear) < 0.30
    # The pressure reduces Dang Van's sum below the shear.
    dang_van = fatigue.dang_van(strip_result(window=12.0), LIMITS).isel(x_field=0)["dang_van"].max()
    assert 0 < float(dang_van) < float(result["crossland_shear"].max())


def test_criteria_scale_with_load(strip_result) -> None:
    unit_result, scaled_result = (
        result.isel(x_field=[0], z=[5, 9]) for result in (strip_result(), strip_result(3e-4, 2e9))
    )
    for criterion in CRITERIA:
        name = criterion.__name__
        unit_value = criterion(unit_result, LIMITS)[name]
        scaled_value = criterion(scaled_result, LIMITS)[name]
        assert np.allclose(scaled_value / 2e9, unit_value, rtol=1e-6, atol=1e-9)


def test_criteria_of_solved_case_are_symmetric(case_result: xr.Dataset) -> None:
    limits = FatigueLimits(bending=700e6, torsion=450e6)
    for criterion in CRITERIA:
        result = criterion(case_result.isel(x_field=[0, 12], z=[0, 3]), limits)
        assert result["utilisation"].dims == ("x_field", "z")
        assert np.isfinite(result["utilisation"]).all()
        # The roller is symmetric.
        assert np.allclose(result["utilisation"], result["utilisation"][::-1], atol=1e-3)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_padded_lazy_study_equals_single_cases(criterion, case_result: xr.Dataset) -> None:
    """Two cases of different length as dask arrays equal the single cases."""
    case_result = case_result.isel(x_field=[0, 3], z=[2, 3])
    shorter_case = case_result.isel(y_field=slice(2, 15))
    case_stresses = [case_stress[list(STRESSES)].reset_coords(drop=True) for case_stress in (case_result, shorter_case)]
    padded_stresses = xr.concat(case_stresses, "case", join="outer").chunk(case=1)
    limits = FatigueLimits(bending=700e6, torsion=450e6)
    name = criterion.__name__
    padded_result = criterion(padded_stresses, limits)[name]
    assert padded_result.chunks is not None
    for case_index, case_stress in enumerate(case_stresses):
        single_result = criterion(case_stress, limits)[name]
        assert np.allclose(padded_result.isel(case=case_index), single_result, rtol=1e-9)


def test_single_position_along_y_is_rejected(study_dataset: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="at least 3"):
        fatigue.crossland(study_dataset, LIMITS)


def test_window_remainder_decreases_with_the_window(strip_result) -> None:
    near_remainder, far_remainder = (
        float(fatigue.window_remainder(strip_result(window=window)).max()) for window in (1.5, 12.0)
    )
    assert far_remainder < 0.2 < near_remainder <= 1
    full_passage = strip_result()
    assert float(fatigue.window_remainder(full_passage.where(abs(full_passage.y_field) < 3, 0.0)).max()) == 0.0


@pytest.mark.parametrize("criterion", CRITERIA)
def test_invalid_argument_raises(criterion, cycle, wave) -> None:
    shear_cycle = cycle(tau_yz=wave)
    with pytest.raises(InvalidInputError, match="limits"):
        criterion(shear_cycle, 300e6)
    with pytest.raises(InvalidInputError, match="sigma_xx is missing"):
        criterion(shear_cycle.drop_vars("sigma_xx"), LIMITS)
    with pytest.raises(InvalidInputError, match="exactly one dimension along y"):
        criterion(shear_cycle.isel(y=0), LIMITS)
    with pytest.raises(InvalidInputError, match="at least 3"):
        criterion(shear_cycle.isel(y=[0, 1]), LIMITS)
