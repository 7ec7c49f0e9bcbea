"""Contact results: tables computed by hand, Hertz' line contact, the cases of a study, a solved contact."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, analysis
from contactstudy.analysis.axial import contact_borders
from tests.stand_in_solver import FAILS


def contact_of(values: list[list[float]]) -> xr.Dataset:
    array = np.asarray(values, dtype=float)
    cells = {"x": 0.5 + np.arange(array.shape[0]), "y": np.arange(array.shape[1]) - (array.shape[1] - 1) / 2}
    return xr.Dataset({"pressure": (("x", "y"), array)}, coords=cells)


PRESSURE_VALUES = [[0, 0, 0], [0, 1, 0], [2, 3, 2], [0, 4, 1], [0, 0, 0]]


def test_axial_profiles_equal_manual_reduction() -> None:
    profiles = analysis.axial_profiles(contact_of(PRESSURE_VALUES))
    assert profiles["axial_pressure"].values.tolist() == [0, 1, 3, 4, 0]
    assert profiles["line_load"].values.tolist() == [0, 1, 7, 5, 0]
    assert profiles["half_width"].values.tolist() == [0, 0.5, 1.5, 1, 0]
    assert profiles["contact_middle"].values[1:4].tolist() == [0, 0, 0.5]


@pytest.mark.parametrize(
    ("start", "stop", "expected"),
    [(0, 5, 13), (-np.inf, np.inf, 13), (1, 2, 1), (1.5, 2.5, 4), (2.25, 2.75, 3.5), (4, 9, 0)],
)
def test_load_between_positions_equals_sum_of_cells(start: float, stop: float, expected: float) -> None:
    load = analysis.load_between(contact_of(PRESSURE_VALUES), start, stop)
    assert float(load) == pytest.approx(expected)
    assert load.attrs["units"] == "N"


@pytest.mark.parametrize(
    ("start", "stop", "message"),
    [
        (3, 2, r"start, stop = \(3, 2\): must be increasing"),
        (100.0, 300.0, r"must be a part of the cells"),
        ("0", 1.0, r"start = '0': must be a number"),
        ([0, 1], [1, 2], r"start = \[0, 1\]: must be a number"),
    ],
)
def test_invalid_interval_raises(start, stop, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        analysis.load_between(contact_of(PRESSURE_VALUES), start, stop)


def test_normalized_data_and_single_row_raise() -> None:
    normalized_result = analysis.normalized(
        contact_of(PRESSURE_VALUES).assign(hertz_half_width=2.0, hertz_max_pressure=4.0)
    )
    with pytest.raises(InvalidInputError, match=r"in SI.*analysis.normalized"):
        analysis.line_load(normalized_result)
    with pytest.raises(InvalidInputError, match="two positions along y or more"):
        analysis.line_load(contact_of(PRESSURE_VALUES).isel(y=[1]))
    with pytest.raises(InvalidInputError, match=r"variable = 5: must be a name"):
        analysis.largest_sample(contact_of(PRESSURE_VALUES), 5)  # type: ignore[arg-type]


def test_contact_results_equal_values_by_hand() -> None:
    result = analysis.contact_results(contact_of(PRESSURE_VALUES))
    expected = {
        "peak_pressure": 4,
        "peak_pressure_x": 3.5,
        "peak_pressure_y": 0,
        "edge_pressure_first": 1,
        "edge_pressure_last": 4,
        "contact_area": 6,
        "contact_length": 3,
        "contact_width": 3,
        "resultant": 13,
        "load_position": (1.5 + 7 * 2.5 + 5 * 3.5) / 13,
        "moment": 1 * -1 + 5 * 1,
    }
    assert {name: float(value) for name, value in result.items()} == pytest.approx(expected)
    assert all(value.attrs["units"] for value in result.values())


@given(about=st.floats(-10, 10))
def test_moment_depends_on_reference_point(about: float) -> None:
    result = analysis.contact_results(contact_of(PRESSURE_VALUES), about)
    assert float(result["moment"]) == pytest.approx(4 - 13 * (about - 2.5), abs=1e-9)


def test_contact_length_loss_of_half_contact_is_one(strip_result) -> None:
    result = strip_result()
    assert float(analysis.contact_results(result)["contact_length_loss"]) == pytest.approx(0, abs=1e-12)
    partial_contact = result.assign(pressure=result["pressure"].where(result["x"] > 2, 0.0))
    assert float(analysis.contact_results(partial_contact)["contact_length_loss"]) == pytest.approx(1)
    assert float(analysis.contact_results(partial_contact)["moment"]) > 0


@given(half_width=st.floats(0.4, 1.9), centre=st.floats(-0.3, 0.3))
def test_borders_of_hertz_pressure_equal_half_width(half_width: float, centre: float) -> None:
    positions = (np.arange(80) - 39.5) / 16
    pressure = np.sqrt(np.maximum(1 - ((positions - centre) / half_width) ** 2, 0))
    first_border, last_border = contact_borders(pressure, positions)
    # The analysis excludes the value of the outermost cell: the border may lie anywhere in this cell.
    assert float(last_border) == pytest.approx(centre + half_width, abs=1e-6)
    assert float(first_border) == pytest.approx(centre - half_width, abs=1e-6)


def test_line_contact_has_hertz_load_and_half_width(strip_result) -> None:
    result = strip_result(half_width=2e-4, max_pressure=1e9)
    profiles = analysis.axial_profiles(result)
    loaded_profiles = profiles.isel(x=np.flatnonzero(profiles["line_load"] > 0))
    assert loaded_profiles["half_width"].values == pytest.approx(2e-4, rel=1e-9)
    assert loaded_profiles["line_load"].values == pytest.approx(np.pi / 2 * 2e-4 * 1e9, rel=2e-3)
    assert profiles["unloaded_gap"].isnull().values.tolist() == (profiles["line_load"] == 0).values.tolist()


def test_solved_contact_is_balanced_and_has_hertz_half_width(case_result: xr.Dataset) -> None:
    result = analysis.contact_results(case_result)
    assert float(result["resultant"]) == pytest.approx(float(case_result["normal_load"]), rel=1e-9)
    assert abs(float(result["moment"])) < 1e-6 * float(case_result["normal_load"]) * 0.5e-3
    half_width = analysis.half_width(case_result)["half_width"].sel(x=0.26e-3, method="nearest")
    line_load = analysis.line_load(case_result).sel(x=0.26e-3, method="nearest")
    # The half-width is Hertz' half-width for the load of the section, to a fraction of a cell (a/12).
    hertz_half_width = float(case_result["hertz_half_width"]) * np.sqrt(
        float(line_load) / (np.pi / 2 * float(case_result["hertz_half_width"] * case_result["hertz_max_pressure"]))
    )
    assert float(half_width) == pytest.approx(hertz_half_width, rel=0.03)


def test_study_results_equal_case_results(study_dataset: xr.Dataset) -> None:
    study_results = analysis.contact_results(study_dataset)
    assert study_results["contact_area"].dims == ("e_over_a", "friction", "body")
    for e_over_a in (0.0, 2.0):
        selected_case = {"e_over_a": e_over_a, "friction": 0.1, "body": "finite-length"}
        case_result = analysis.contact_results(analysis.single_case(study_dataset.sel(selected_case)))
        for name, value in case_result.items():
            assert float(study_results[name].sel(selected_case)) == pytest.approx(float(value), rel=1e-12, abs=1e-15), (
                name
            )
        study_half_width = analysis.half_width(study_dataset.sel(selected_case))["half_width"].dropna("x_over_a")
        case_half_width = analysis.half_width(analysis.single_case(study_dataset.sel(selected_case)))["half_width"]
        assert np.array_equal(study_half_width.values, case_half_width.values)
    assert study_results.sel(friction=FAILS).to_array().isnull().all()


def test_load_between_in_study_equals_case_load(study_dataset: xr.Dataset) -> None:
    start = study_dataset["e_over_a"] * study_dataset["hertz_half_width"]
    stop = start + 2 * study_dataset["hertz_half_width"]
    study_loads = analysis.load_between(study_dataset, start, stop)
    assert study_loads.dims == ("e_over_a", "friction", "body")
    for e_over_a in (0.0, 2.0):
        selected_case = {"e_over_a": e_over_a, "friction": 0.1, "body": "finite-length"}
        selected_result = analysis.single_case(study_dataset.sel(selected_case))
        load = analysis.load_between(selected_result, float(start.sel(selected_case)), float(stop.sel(selected_case)))
        assert float(study_loads.sel(selected_case)) == pytest.approx(float(load), rel=1e-12)
    assert study_loads.sel(friction=FAILS).isnull().all()


def test_half_width_of_lazy_surface_is_lazy(study_dataset: xr.Dataset) -> None:
    assert analysis.axial_profiles(study_dataset.chunk())["half_width"].chunks is not None


def test_results_without_contact_are_zero_or_nan() -> None:
    result = analysis.contact_results(contact_of([[0, 0], [0, 0]]))
    assert float(result["contact_length"]) == float(result["contact_area"]) == 0
    assert np.isnan(float(result["edge_pressure_first"]))
    assert np.isnan(float(result["load_position"]))


@pytest.mark.parametrize(
    "function",
    [
        analysis.axial_pressure,
        analysis.line_load,
        analysis.half_width,
        analysis.axial_profiles,
        analysis.edge_pressure,
        analysis.contact_results,
        analysis.unloaded_gap,
        analysis.slices,
        analysis.edge_factors,
        lambda dataset: analysis.load_between(dataset, 0.0, 1.0),
    ],
)
def test_missing_variable_raises(function) -> None:
    with pytest.raises(InvalidInputError, match=r"(pressure|initial_gap) is missing"):
        function(xr.Dataset({"normal_load": 1.0}))
    with pytest.raises(InvalidInputError, match="Dataset"):
        function(np.zeros(3))


def test_moment_about_nan_raises() -> None:
    with pytest.raises(InvalidInputError, match="about"):
        analysis.contact_results(contact_of(PRESSURE_VALUES), np.nan)


@pytest.mark.parametrize(
    ("x_slice", "first", "last"),
    [
        (slice(None), 1.0, 4.0),
        (slice(2, None), np.nan, 4.0),
        (slice(0, 3), 1.0, np.nan),
        (slice(2, 3), np.nan, np.nan),
    ],
)
def test_edge_pressure_of_cut_end_is_nan(x_slice: slice, first: float, last: float) -> None:
    # A sufficient window has unloaded rows on either side along y.
    full_contact = (
        contact_of(PRESSURE_VALUES).pad(y=1, constant_values=0).assign_coords(y=np.arange(-2.0, 3.0), normal_load=13.0)
    )
    full_contact = full_contact.reset_coords("normal_load").assign(hertz_half_width=1.0)
    selected_contact = full_contact.isel(x=x_slice).assign_coords(x_width=1.0)
    end_pressures = analysis.edge_pressure(selected_contact)
    assert [float(end_pressures[f"edge_pressure_{end_name}"]) for end_name in ("first", "last")] == pytest.approx(
        [first, last], nan_ok=True
    )
    edge_factors = analysis.edge_factors(selected_contact)
    for end_name in ("first", "last"):
        assert np.isnan(float(edge_factors[f"end_over_middle_{end_name}"])) == (np.isnan(first) or np.isnan(last))
    half_result = analysis.edge_pressure(full_contact.sel(y=slice(0, None)))
    assert [float(pressure) for pressure in half_result.values()] == [1.0, 4.0]


def test_cut_solved_contact_has_no_contact_length(case_result: xr.Dataset) -> None:
    half_contact = case_result.sel(x=slice(0.26e-3, None))
    assert np.isnan(analysis.edge_pressure(half_contact)["edge_pressure_first"])
    full_pressure = analysis.edge_pressure(case_result)["edge_pressure_last"]
    assert float(analysis.edge_pressure(half_contact)["edge_pressure_last"]) == float(full_pressure)
    assert "contact_length" in case_result.contact.summary()
    assert "contact_length" not in half_contact.contact.summary()


def test_results_do_not_depend_on_order_of_positions(case_result: xr.Dataset) -> None:
    shuffled_result = case_result.isel(
        x=slice(None, None, -1), y=np.random.default_rng(1).permutation(case_result.sizes["y"])
    )
    xr.testing.assert_identical(analysis.edge_pressure(shuffled_result), analysis.edge_pressure(case_result))
    xr.testing.assert_identical(analysis.half_width(shuffled_result).sortby("x"), analysis.half_width(case_result))
