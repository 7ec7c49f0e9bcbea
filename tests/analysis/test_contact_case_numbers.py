import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from contactstudy.analysis.contact import case_numbers, stress_summary
from contactstudy.errors import InvalidInputError


def contact_of(values, hertz_max_pressure=2.0):
    values = np.asarray(values, dtype=float)
    cells = {"x": 0.5 + np.arange(values.shape[0]), "y": np.arange(values.shape[1]) - (values.shape[1] - 1) / 2}
    return xr.Dataset({"pressure": (("x", "y"), values), "hertz_max_pressure": hertz_max_pressure}, coords=cells)


PRESSURE_VALUES = [[0, 0, 0], [0, 1, 0], [2, 3, 2], [0, 4, 1], [0, 0, 0]]


def test_summary_contains_peak_position():
    result = case_numbers(contact_of(PRESSURE_VALUES))
    assert [result[name] for name in ("peak_pressure", "peak_pressure_x", "peak_pressure_y")] == [4, 3.5, 0]


def test_values_at_cells_are_marked_not_estimated():
    numbers = case_numbers(contact_of(PRESSURE_VALUES))
    names = ("peak_pressure_x", "peak_pressure_y", "contact_width", "end_pressure_over_p0", "end_pressure_over_p0_last")
    assert {numbers[name].attrs["error_kind"] for name in names} == {"not estimated"}


def test_end_pressures_belong_to_outermost_loaded_columns():
    result = case_numbers(contact_of(PRESSURE_VALUES))
    assert (result["end_pressure_over_p0_first"], result["end_pressure_over_p0_last"]) == (0.5, 2.0)
    assert result["end_pressure_over_p0"] == 1.25


def test_contact_length_and_width_count_cells():
    result = case_numbers(contact_of(PRESSURE_VALUES))
    assert (result["contact_length"], result["contact_width"]) == (3, 3)


def test_case_without_contact_has_zero_length_and_nan_pressure():
    result = case_numbers(contact_of(np.zeros((3, 2))))
    assert np.isnan(result["end_pressure_over_p0"])
    assert result["contact_length"] == 0


@given(st.floats(0.1, 1e9))
def test_pressure_ratio_does_not_depend_on_unit(scale):
    numbers, scaled_numbers = (
        case_numbers(contact_of(PRESSURE_VALUES)),
        case_numbers(contact_of(np.multiply(PRESSURE_VALUES, scale), 2 * scale)),
    )
    assert scaled_numbers["end_pressure_over_p0"] == pytest.approx(float(numbers["end_pressure_over_p0"]))


def test_stress_summary_contains_largest_sample():
    stress = xr.DataArray(
        np.arange(8.0).reshape(2, 2, 2),
        dims=("x_field", "y_field", "z"),
        coords={"x_field": [1, 2], "y_field": [3, 4], "z": [5, 6]},
    )
    result = stress_summary(xr.Dataset({"von_mises": stress}))
    assert {name: float(value) for name, value in result.items()} == {
        "largest_von_mises": 7,
        "largest_von_mises_x": 2,
        "largest_von_mises_y": 4,
        "largest_von_mises_z": 6,
    }


def test_nan_field_has_no_peak():
    with pytest.raises(InvalidInputError, match="nan"):
        stress_summary(xr.Dataset({"von_mises": ("x", [np.nan])}))


def test_stress_summary_without_stresses_is_empty():
    assert not stress_summary(contact_of(PRESSURE_VALUES))
    assert "largest_von_mises" not in case_numbers(contact_of(PRESSURE_VALUES))


def test_case_numbers_contain_result_scalars():
    result = case_numbers(contact_of(PRESSURE_VALUES).assign(iterations=7))
    assert result["iterations"] == 7
    assert result["end_pressure_over_p0"].attrs["units"] == "1"
