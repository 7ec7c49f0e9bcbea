"""Measures and largest samples: the textbook extremes of Hertz' line contact, and studies."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis
from tests.stand_in_solver import FAILS


@pytest.mark.parametrize(
    ("variable", "value", "depth"),
    # The values are from Johnson, Contact Mechanics, section 4.2; von Mises stress for Poisson's ratio 0.3.
    [
        ("von_mises", 0.5575, 0.70),
        ("tresca", 0.600, 0.786),
        ("maximum_shear", 0.300, 0.786),
        ("orthogonal_shear_amplitude", 0.25, 0.5),
        ("orthogonal_shear_range", 0.5, 0.5),
    ],
)
def test_largest_samples_of_line_contact_equal_johnson(strip_result, variable: str, value: float, depth: float) -> None:
    half_width, peak_pressure = 2e-4, 1e9
    result = analysis.largest_sample(strip_result(half_width, peak_pressure), variable, along="x")
    assert result[f"largest_{variable}"].dims == ("x_field",)
    assert result[f"largest_{variable}"].values / peak_pressure == pytest.approx(value, abs=1e-3)
    assert result[f"largest_{variable}_z"].values / half_width == pytest.approx(depth, abs=0.03)
    overall_sample = analysis.largest_sample(strip_result(half_width, peak_pressure), variable)
    assert float(overall_sample[f"largest_{variable}"]) == float(result[f"largest_{variable}"].max())
    assert overall_sample[f"largest_{variable}_x"].attrs["units"] == "m"


def test_friction_shifts_the_largest_von_mises(strip_result) -> None:
    result = analysis.largest_sample(strip_result(friction=0.2))
    # The traction acts along +y on the body; the table is of the line contact with f = 0.2.
    assert float(result["largest_von_mises"]) == pytest.approx(0.590, abs=2e-3)
    assert float(result["largest_von_mises_y"]) == pytest.approx(0.55, abs=0.05)


def test_study_results_equal_case_results(study_dataset: xr.Dataset) -> None:
    for variable in ("von_mises", "pressure", "tresca", "hydrostatic"):
        study_samples = analysis.largest_sample(study_dataset, variable)
        for e_over_a in (0.0, 2.0):
            selected_case = {"e_over_a": e_over_a, "friction": 0.1, "body": "finite-length"}
            case_sample = analysis.largest_sample(analysis.single_case(study_dataset.sel(selected_case)), variable)
            for name, value in case_sample.items():
                assert float(study_samples[name].sel(selected_case)) == pytest.approx(float(value), rel=1e-6), name
        assert study_samples.sel(friction=FAILS).to_array().isnull().all()


def test_section_samples_of_study_equal_case_samples(study_dataset: xr.Dataset) -> None:
    study_samples = analysis.largest_sample(study_dataset, along="x")
    selected_case = {"e_over_a": 1.0, "friction": 0.1, "body": "finite-length"}
    case_sample = analysis.largest_sample(analysis.single_case(study_dataset.sel(selected_case)), along="x")
    sections = study_samples["largest_von_mises"].sel(selected_case).dropna("x_over_a")
    assert np.array_equal(sections, case_sample["largest_von_mises"])


def test_unknown_measure_raises(strip_result) -> None:
    with pytest.raises(InvalidInputError, match="did you mean 'von_mises'"):
        analysis.largest_sample(strip_result(), "von_misses")
    with pytest.raises(InvalidInputError, match="tau_xy is missing"):
        analysis.largest_sample(strip_result().drop_vars("tau_xy"), "tresca")


def test_variable_without_axes_raises(strip_result) -> None:
    with pytest.raises(InvalidInputError, match="field along"):
        analysis.largest_sample(strip_result(), "hertz_half_width")
    with pytest.raises(InvalidInputError, match="field along x"):
        analysis.largest_sample(xr.Dataset({"a": ("z", [1.0])}, {"z": [0.0]}), "a", along="x")


def test_measure_of_failed_case_raises(study_dataset: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="nan everywhere"):
        analysis.measure(study_dataset.sel(friction=FAILS), "tresca")


def test_principal_stresses_are_ordered_and_sum_to_invariants(strip_result) -> None:
    result = strip_result(friction=0.2)
    principal_stresses = [analysis.measure(result, f"principal_stress_{rank}") for rank in (1, 2, 3)]
    assert (principal_stresses[0] >= principal_stresses[1]).all()
    assert (principal_stresses[1] >= principal_stresses[2]).all()
    np.testing.assert_allclose(
        principal_stresses[0] - principal_stresses[2], analysis.measure(result, "tresca"), rtol=1e-9, atol=1e-6
    )
    np.testing.assert_allclose(
        sum(principal_stresses) / 3, analysis.measure(result, "hydrostatic"), rtol=1e-9, atol=1e-6
    )
    assert principal_stresses[0].attrs == {"units": "Pa", "long_name": "largest principal stress"}
    assert float(analysis.largest_sample(result, "principal_stress_1")["largest_principal_stress_1"]) > 0
