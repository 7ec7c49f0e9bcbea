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
def flush(request: pytest.FixtureRequest) -> xr.Dataset:
    body = BODIES[request.param]
    position = {} if request.param == "flush" else {"end_distance": 0.0}
    return solve(Case(body=body, roller=ROLLER, max_pressure=1.5e9, **position), accuracy=0.1, stresses=False)


def end_values(selected: xr.Dataset) -> list[float]:
    return [float(value) for value in analysis.edge_pressure(selected).values()]


@pytest.mark.parametrize("with_attributes", [True, False])
def test_ends_of_halves(flush: xr.Dataset, with_attributes: bool) -> None:
    contact = flush if with_attributes else flush.drop_attrs(deep=False)
    mid_column = flush.sizes["x"] // 2
    first, last = end_values(contact)
    assert first > 0
    assert last > 0
    assert end_values(contact.isel(x=slice(None, mid_column))) == pytest.approx([first, np.nan], nan_ok=True)
    # The end of a body with loaded columns only is unknown if the result contains no case.
    reaches = bool((flush["pressure"].isel(x=-1) > 0).any())
    expected = last if with_attributes or not reaches else np.nan
    assert end_values(contact.isel(x=slice(mid_column, None))) == pytest.approx([np.nan, expected], nan_ok=True)
    assert np.isnan(end_values(contact.isel(x=slice(mid_column - 5, mid_column + 5)))).all()


def test_missing_cells(flush: xr.Dataset) -> None:
    sparse_result = flush.isel(x=slice(None, None, 2))
    assert not np.isnan(end_values(sparse_result)).any()


def test_pressures_in_megapascals(flush: xr.Dataset) -> None:
    metric = flush.assign(pressure=(1e-6 * flush["pressure"]).assign_attrs(units="MPa"))
    assert end_values(metric) == pytest.approx(end_values(flush))
    converted = analysis.contact_results(metric)
    for name, value in analysis.contact_results(flush).items():
        assert float(converted[name]) == pytest.approx(float(value)), name


def test_part_of_a_contact_has_the_peaks_of_its_cells(flush: xr.Dataset) -> None:
    """The refined peak has an error; at a singular end the peak, the edge pressure and the factor are infinite."""
    results = analysis.contact_results(flush)
    assert float(results["peak_pressure"]) == float(flush["peak_pressure"])
    np.testing.assert_array_equal(results["peak_pressure_error"], flush["peak_pressure_error"])
    mid_column = flush.sizes["x"] // 2
    subset = flush.isel(x=slice(mid_column - 5, mid_column + 5))
    assert float(analysis.contact_results(subset)["peak_pressure"]) == float(subset["pressure"].max())
    singular = np.isinf(float(flush["end_pressure_last"]))
    assert np.isinf(float(results["edge_pressure_last"])) == singular
    assert np.isinf(float(analysis.edge_factors(flush)["end_over_middle_last"])) == singular
    assert results["edge_pressure_first"].attrs["error_kind"] == "not estimated"
    assert analysis.largest_sample(flush, "pressure")["largest_pressure"].attrs["error_kind"] == "not estimated"
