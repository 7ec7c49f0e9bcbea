"""Cut ends of a roller as long as its body."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, Material, QuarterSpace, Roller, analysis, solve

STEEL = Material(210e9, 0.3)
ROLLER = Roller(radius=5e-3, length=0.3e-3)
BODIES = {
    "flush": FiniteLengthSpace(length=0.3e-3, material=STEEL),
    "quarter": QuarterSpace(material=STEEL),
}


@pytest.fixture(scope="module", params=BODIES)
def flush_result(request: pytest.FixtureRequest) -> xr.Dataset:
    body = BODIES[request.param]
    end_argument = {} if request.param == "flush" else {"end_distance": 0.0}
    return solve(Case(body=body, roller=ROLLER, max_pressure=1.5e9, **end_argument), accuracy=0.1, stresses=False)


def compute_end_values(selected_result: xr.Dataset) -> list[float]:
    return [float(value) for value in analysis.edge_pressure(selected_result).values()]


@pytest.mark.parametrize("has_attributes", [True, False])
def test_edge_pressure_of_half_contact_has_one_end(flush_result: xr.Dataset, has_attributes: bool) -> None:
    contact = flush_result if has_attributes else flush_result.drop_attrs(deep=False)
    mid_column = flush_result.sizes["x"] // 2
    first_pressure, last_pressure = compute_end_values(contact)
    assert first_pressure > 0
    assert last_pressure > 0
    assert compute_end_values(contact.isel(x=slice(None, mid_column))) == pytest.approx(
        [first_pressure, np.nan], nan_ok=True
    )
    # The end of a body with loaded columns only is unknown if the result contains no case.
    is_end_loaded = bool((flush_result["pressure"].isel(x=-1) > 0).any())
    expected = last_pressure if has_attributes or not is_end_loaded else np.nan
    assert compute_end_values(contact.isel(x=slice(mid_column, None))) == pytest.approx([np.nan, expected], nan_ok=True)
    assert np.isnan(compute_end_values(contact.isel(x=slice(mid_column - 5, mid_column + 5)))).all()


def test_edge_pressure_of_every_other_cell_is_known(flush_result: xr.Dataset) -> None:
    sparse_result = flush_result.isel(x=slice(None, None, 2))
    assert not np.isnan(compute_end_values(sparse_result)).any()


def test_contact_results_in_megapascals_are_equal(flush_result: xr.Dataset) -> None:
    result_in_mpa = flush_result.assign(pressure=(1e-6 * flush_result["pressure"]).assign_attrs(units="MPa"))
    assert compute_end_values(result_in_mpa) == pytest.approx(compute_end_values(flush_result))
    converted_result = analysis.contact_results(result_in_mpa)
    for name, value in analysis.contact_results(flush_result).items():
        assert float(converted_result[name]) == pytest.approx(float(value)), name


def test_peak_of_cut_contact_equals_largest_cell_pressure(flush_result: xr.Dataset) -> None:
    """The refined peak has an error; at a singular end the peak, the edge pressure and the factor are infinite."""
    results = analysis.contact_results(flush_result)
    assert float(results["peak_pressure"]) == float(flush_result["peak_pressure"])
    np.testing.assert_array_equal(results["peak_pressure_error"], flush_result["peak_pressure_error"])
    mid_column = flush_result.sizes["x"] // 2
    subset = flush_result.isel(x=slice(mid_column - 5, mid_column + 5))
    assert float(analysis.contact_results(subset)["peak_pressure"]) == float(subset["pressure"].max())
    is_singular = np.isinf(float(flush_result["end_pressure_last"]))
    assert np.isinf(float(results["edge_pressure_last"])) == is_singular
    assert np.isinf(float(analysis.edge_factors(flush_result)["end_over_middle_last"])) == is_singular
    assert results["edge_pressure_first"].attrs["error_kind"] == "not estimated"
    assert analysis.largest_sample(flush_result, "pressure")["largest_pressure"].attrs["error_kind"] == "not estimated"
