"""Edge factors of tables computed by hand and of studies."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, analysis


def make_axial_contact(values: list[float]) -> xr.Dataset:
    cells = {"x": np.arange(len(values)) + 0.5, "y": [0.0]}
    return xr.Dataset({"pressure": (("x", "y"), np.array(values)[:, None]), "hertz_half_width": 1.0}, coords=cells)


def test_end_over_middle_equals_ratio_by_hand() -> None:
    result = analysis.edge_factors(make_axial_contact([0, 5, 6, 2, 2, 2, 2, 3, 4, 0]))
    assert float(result["end_over_middle_first"]) == 3.0
    assert float(result["end_over_middle_last"]) == 2.0


def test_end_over_middle_includes_cells_within_reach() -> None:
    result = analysis.edge_factors(make_axial_contact([5, 6, 8, 2, 2, 2, 2]), reach=2.0)
    assert float(result["end_over_middle_first"]) == 4.0


def test_over_reference_equals_ratio_by_hand() -> None:
    result = analysis.edge_factors(make_axial_contact([2, 1, 1, 1, 3]), reference=make_axial_contact([4, 2, 2, 2, 4]))
    values = [float(result[f"over_reference_{name}"]) for name in ("first", "last", "middle", "peak")]
    assert values == [0.5, 0.75, 0.5, 0.75]


def test_edge_factors_of_uniform_contact_are_one(strip_result) -> None:
    result = strip_result(2e-4, 1e9)
    for variable in ("pressure", "von_mises", "tresca", "orthogonal_shear_amplitude"):
        edge_factors = analysis.edge_factors(result, variable, result)
        assert np.allclose(edge_factors.to_array(), 1.0), variable


def test_end_over_middle_of_field_near_end_is_nan(strip_result) -> None:
    result = strip_result().isel(x_field=slice(0, 3))
    edge_factors = analysis.edge_factors(result, "von_mises", result)
    assert np.isnan(float(edge_factors["end_over_middle_first"]))
    assert float(edge_factors["over_reference_first"]) == 1.0


def test_edge_factors_of_filleted_roller_exceed_one(case_result: xr.Dataset) -> None:
    edge_factors = analysis.edge_factors(case_result)
    assert float(edge_factors["end_over_middle_first"]) > 1.2
    assert float(edge_factors["end_over_middle_first"]) == pytest.approx(
        float(edge_factors["end_over_middle_last"]), rel=1e-6
    )


def test_edge_factor_over_reference_has_dimensions_of_study(study_dataset: xr.Dataset) -> None:
    half_space = study_dataset.sel(body="half-space").isel(e_over_a=0)
    edge_factors = analysis.edge_factors(study_dataset.sel(body="finite-length"), "pressure", half_space)
    assert edge_factors["over_reference_peak"].sizes == {"e_over_a": 3, "friction": 2}
    assert float(edge_factors["over_reference_first"].sel(e_over_a=0, friction=0.1)) == pytest.approx(1.0, rel=0.05)


def test_invalid_argument_raises(strip_result) -> None:
    with pytest.raises(InvalidInputError, match="reach"):
        analysis.edge_factors(strip_result(), reach=0.0)
    with pytest.raises(InvalidInputError, match="reference="):
        analysis.edge_factors(strip_result(), strip_result())
    with pytest.raises(InvalidInputError, match="not negative"):
        analysis.edge_factors(strip_result(), "hydrostatic")
    with pytest.raises(InvalidInputError, match="pressure is missing"):
        analysis.edge_factors(strip_result(), reference=xr.Dataset())
