"""Slices: loads, pressures, stresses and errors."""

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
    analysis,
    profiles,
    solve,
)
from contactstudy.analysis.roller_slices import Columns, border_load_errors, find_maxima, power_means
from contactstudy.arrays.variables import ERROR_KIND, ESTIMATED, NOT_ESTIMATED
from contactstudy.study import Study, open_study, run_study
from tests.split_columns import split_columns


@pytest.mark.parametrize("count", [1, 5, 16])
def test_loads_of_slices_sum_to_resultant(strip_result, count: int) -> None:
    result = strip_result()
    table = analysis.slices(result, count)
    assert float(table["normal_load"].sum()) == pytest.approx(float(analysis.contact_results(result)["resultant"]))
    assert table["normal_load"].values == pytest.approx(float(table["normal_load"].mean()))
    assert float(table["width"].sum()) == pytest.approx(4.0)
    assert float(table["position"].mean()) == pytest.approx(3.0)


def test_slices_of_line_contact_equal_johnson(strip_result) -> None:
    table = analysis.slices(strip_result(), 4).to_dataframe()
    assert table.index.tolist() == [1, 2, 3, 4]
    assert table["axial_pressure"].to_numpy() == pytest.approx(1, abs=1e-3)
    assert table["half_width"].to_numpy() == pytest.approx(1, abs=1e-9)
    assert table["largest_von_mises"].to_numpy() == pytest.approx(0.5575, abs=1e-3)
    assert table["largest_orthogonal_shear_amplitude_z"].to_numpy() == pytest.approx(0.5, abs=0.03)


def test_slices_without_stress_points_have_no_stress(strip_result) -> None:
    table = analysis.slices(strip_result().isel(x_field=[0]), 4)
    assert table["largest_von_mises"].isnull().values.tolist() == [False, True, True, True]


def test_slices_of_surface_contain_no_stress(study_dataset: xr.Dataset) -> None:
    study_case = study_dataset.sel(e_over_a=1, friction=0.1, body="finite-length")
    surface = study_case.drop_vars([name for name in study_case.data_vars if "z_over_a" in study_case[name].dims])
    table = analysis.slices(surface, 5)
    assert "largest_von_mises" not in table
    assert float(table["normal_load"].sum()) == pytest.approx(float(analysis.contact_results(study_case)["resultant"]))


def test_slices_of_symmetric_contact_are_symmetric(case_result: xr.Dataset) -> None:
    table = analysis.slices(case_result, 6)
    for name in ("normal_load", "axial_pressure", "half_width"):
        assert np.allclose(table[name], table[name][::-1], rtol=1e-5)


def test_invalid_slice_count_or_study_raises(strip_result, study_dataset: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="number of cells, 16"):
        analysis.slices(strip_result(), 17)
    with pytest.raises(InvalidInputError, match="count"):
        analysis.slices(strip_result(), 0)
    with pytest.raises(InvalidInputError, match="single case"):
        analysis.slices(study_dataset)


def test_slices_keep_order_at_single_depth(case_result: xr.Dataset) -> None:
    table = analysis.slices(case_result, 4)
    reversed_slices = analysis.slices(case_result.isel(x=slice(None, None, -1)), 4)
    assert reversed_slices["normal_load"].values == pytest.approx(table["normal_load"].values)
    assert "largest_maximum_shear" not in analysis.slices(case_result.isel(z=1), 4)


STEEL = Material(210e9, 0.3)
DESIGN = profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=STEEL.plane_strain_modulus)


def make_case(profile: profiles.Profile, length: float, body_length: float | None, **parameters: float) -> Case:
    """A roller of 5 mm radius on a body of a length, or on a half-space."""
    is_half_space = body_length is None
    body = HalfSpace(material=STEEL) if is_half_space else FiniteLengthSpace(length=body_length, material=STEEL)
    return Case(body=body, roller=Roller(radius=5e-3, length=length, profile=profile), max_pressure=1.5e9, **parameters)


CASES = {
    "crowned": make_case(profiles.FullCrown(crown_radius=0.06), 1.6e-3, 2e-3),
    "crowned, tilted": make_case(profiles.FullCrown(crown_radius=0.1), 1e-3, 1.4e-3, tilt=1e-3),
    "straight, flush with free ends": make_case(profiles.Cylinder(), 1e-3, 1e-3),
    "straight, flush and tilted": make_case(profiles.Cylinder(), 1e-3, 1e-3, tilt=1e-3),
    "logarithmic, on a half-space": make_case(DESIGN, 1e-3, None),
    "logarithmic, lifted at one end by its tilt": make_case(DESIGN, 1e-3, 1.2e-3, tilt=6e-3),
    "rounded edges": make_case(profiles.Cylinder(fillet_radius=0.05e-3), 1.2e-3, 1.6e-3),
    "sharp end inside the face": make_case(profiles.Cylinder(), 1e-3, 1.2e-3, end_distance=0.0),
}


DEFAULT_KINDS = ("crowned",)
"""Kinds of the default tier."""


@pytest.mark.parametrize(
    "case_name",
    [pytest.param(case_name, marks=() if case_name in DEFAULT_KINDS else pytest.mark.slow) for case_name in CASES],
)
def test_errors_cover_difference_from_finer_columns(case_name: str) -> None:
    coarse_result = solve(CASES[case_name], stresses=False, accuracy=0.02)
    fine_result = solve(CASES[case_name], split_columns(coarse_result, 4), stresses=False)
    for count in (3, 12, 30):
        table, finer_table = analysis.slices(coarse_result, count), analysis.slices(fine_result, count)
        for name in ("axial_pressure", "normal_load"):
            is_finite = np.isfinite(finer_table[name])
            differences = abs(table[name] - finer_table[name]).where(is_finite, 0.0)
            assert (differences <= table[f"{name}_error"]).all(), (count, name)
            typical_errors = float(
                (table[f"{name}_error"] / finer_table[name].where(is_finite).max()).where(is_finite).median()
            )
            assert typical_errors < 0.1, (count, name)


def test_errors_of_symmetric_slices_are_symmetric() -> None:
    """A border between an unloaded slice and the contact has the same uncertainty on both sides."""
    result = solve(make_case(profiles.FullCrown(crown_radius=0.1), 1e-3, 1.4e-3), stresses=False, accuracy=0.03)
    table = analysis.slices(result, 25)
    for name in ("axial_pressure", "axial_pressure_error", "normal_load", "normal_load_error"):
        values = table[name].values
        assert values == pytest.approx(values[::-1], rel=1e-6, abs=1e-9 * values.max())
    pressures, errors = find_maxima(
        Columns(
            np.stack([np.arange(6.0), np.arange(6.0) + 1], axis=-1), np.arange(6) + 0.5, np.array([0, 0, 0, 5, 5, 5])
        ),
        np.array([0.0, 2.7, 6.0]),
    )
    assert pressures[0] == pytest.approx(np.sqrt(0.2 * 25))
    assert errors[0] == 5.0


def test_end_slices_have_peak_of_fillet_or_infinity() -> None:
    rounded_result = solve(CASES["rounded edges"], stresses=False, accuracy=0.03)
    maximum = analysis.slices(rounded_result, 10)["axial_pressure"]
    for end, index in (("first", 0), ("last", -1)):
        peak, error = (float(rounded_result[f"peak_pressure_{end}{kind}"]) for kind in ("", "_error"))
        assert float(maximum[index]) == pytest.approx(peak, abs=error)
    sharp_table = analysis.slices(solve(CASES["sharp end inside the face"], stresses=False, accuracy=0.1), 10)
    for name in ("axial_pressure", "axial_pressure_error"):
        assert np.isinf(sharp_table[name]).values.tolist() == [False] * 9 + [True]
    assert np.isfinite(sharp_table["normal_load_error"]).all()


def test_errors_of_study_case_exist_on_original_cells(tmp_path) -> None:
    base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.5e-3, "e_over_a": 1.0, "stresses": False}
    base["accuracy"] = 0.05
    edge = {"name": "rounded", "kind": "cylinder", "fillet_radius": 0.05e-3}
    study = Study(name="small", base=base | {"profile": edge}, sweep={"max_pressure": [1.2e9, 1.5e9]})
    run_study(study, tmp_path, workers=0, progress=False)
    original_cells, common_cells = (
        open_study(tmp_path, cells=cells).sel(max_pressure=1.5e9) for cells in ("original", "common")
    )
    table = analysis.slices(original_cells, 6)
    assert float(table["axial_pressure"][0]) == pytest.approx(
        float(original_cells["peak_pressure_first"]), abs=float(original_cells["peak_pressure_first_error"])
    )
    assert np.isfinite(table["axial_pressure_error"]).all()
    assert np.isnan(analysis.slices(common_cells, 6)["axial_pressure_error"]).all()


def test_slices_of_cut_results_have_no_error_estimate(case_result: xr.Dataset) -> None:
    refined_result = solve(CASES["straight, flush with free ends"], stresses=False, accuracy=0.05)
    results = {
        "given cells": case_result,
        "cut": refined_result.sel(x=slice(0.5e-3, None)),
        "half": refined_result.sel(y=slice(0, None)),
    }
    for description, result in results.items():
        table = analysis.slices(result, 4)
        for name in ("axial_pressure", "normal_load"):
            assert np.isnan(table[f"{name}_error"]).all(), description
            assert table[name].attrs[ERROR_KIND] == NOT_ESTIMATED, description
            assert table[f"{name}_error"].attrs[ERROR_KIND] == NOT_ESTIMATED, description
    for name, array in analysis.slices(case_result, 4).data_vars.items():
        if name not in ("position", "width"):
            assert array.attrs[ERROR_KIND] == NOT_ESTIMATED, name
    refined_slices = analysis.slices(refined_result, 4)
    assert all(refined_slices[name].attrs[ERROR_KIND] == ESTIMATED for name in ("axial_pressure", "normal_load"))


def test_maxima_and_means_between_borders_equal_values_by_hand() -> None:
    edges, borders = np.array([[0.0, 1], [1, 2], [2, 3], [3, 4]]), np.array([0.0, 2.0, 4.0])
    pressure = Columns(edges, edges.mean(axis=1), np.array([1.0, 1, 2, 2]))
    maximum, error = find_maxima(pressure, borders)
    np.testing.assert_allclose((maximum, error), ([np.sqrt(2.5), 2.0], [0.5, 0.5]))
    np.testing.assert_allclose(border_load_errors(pressure, borders), [0.25, 0.25])
    means = power_means(Columns(edges, edges.mean(axis=1), np.array([1.0, 1, 1, 3])), borders, 1.0)
    np.testing.assert_allclose(means, ([1.0, 2.125], [0.0, 0.625]), atol=1e-12)
