"""The common cells of a study's cases."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from contactstudy import open_study
from contactstudy.analysis import load_between, single_case
from contactstudy.arrays.grid import centres_of
from contactstudy.study import run_study
from contactstudy.study.common_cells import (
    END_WIDTH,
    MIN_WIDTH,
    Resampling,
    centre_cells,
    common_columns,
    common_rows,
    end_cells,
    resample,
    split_cells,
)
from tests.small_study import BASE, small_study


def make_resampling(source, borders, fill):
    return Resampling(source=source, axis=centres_of(borders), borders=borders, fill=fill)


@st.composite
def draw_edges(draw):
    """Random edges of cells; the first edge is 0."""
    widths = draw(st.lists(st.floats(0.01, 2.0), min_size=1, max_size=12))
    return np.concatenate([[0.0], np.cumsum(widths)])


@given(st.lists(draw_edges(), min_size=1, max_size=5))
def test_common_columns_resolve_all_cases(cases):
    common_edges = common_columns(cases)
    assert common_edges[0] == 0.0
    assert common_edges[-1] == max(case_edges[-1] for case_edges in cases)
    min_width = min(float(np.diff(case_edges).min()) for case_edges in cases)
    assert np.diff(common_edges).min() >= MIN_WIDTH * min_width * (1 - 1e-12)


@given(st.lists(draw_edges(), min_size=1, max_size=4), st.integers(0, 2**32 - 1))
def test_averaging_keeps_load(cases, seed):
    common_edges = common_columns(cases)
    for case_edges in cases:
        values = np.random.default_rng(seed).uniform(0.0, 1.0, case_edges.size - 1)
        averages = resample("pressure", values, [make_resampling(case_edges, common_edges, 0.0)])
        assert averages @ np.diff(common_edges) == pytest.approx(values @ np.diff(case_edges), rel=1e-9)


@given(draw_edges(), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_interpolation_keeps_straight_lines(case_edges, slope, offset):
    centres = 0.5 * (case_edges[1:] + case_edges[:-1])
    common_points = np.linspace(case_edges[0], case_edges[-1], 30)
    interpolated_gap = resample("gap", offset + slope * centres, [make_resampling(case_edges, common_points, np.nan)])
    positions = 0.5 * (common_points[1:] + common_points[:-1])
    np.testing.assert_allclose(
        interpolated_gap, offset + slope * np.clip(positions, centres[0], centres[-1]), atol=1e-12
    )


def test_values_beyond_cells_are_nan_or_zero():
    common_edges = np.array([0.0, 1.0, 2.0, 3.0])
    case_edges = np.array([0.0, 1.0, 2.0])
    along_x, along_y = make_resampling(case_edges, common_edges, np.nan), make_resampling(case_edges, common_edges, 0.0)
    pressure = resample("pressure", np.ones((2, 2)), [along_x, along_y])
    np.testing.assert_array_equal(pressure[:2], [[1, 1, 0], [1, 1, 0]])
    assert np.isnan(pressure[2]).all()
    gap = resample("gap", np.ones((2, 2)), [along_x, along_y])
    assert np.isnan(gap[:, 2]).all()


def test_infinite_gap_keeps_position():
    case_edges = np.array([0.0, 1.0, 2.0, 3.0])
    gap = resample("initial_gap", np.array([1.0, np.inf, np.inf]), [make_resampling(case_edges, case_edges, np.nan)])
    np.testing.assert_array_equal(gap, [1.0, np.inf, np.inf])


def test_rows_are_uniform_over_the_widest_window():
    rows = common_rows([np.linspace(-2.0, 2.0, 9), np.linspace(-1.0, 1.0, 11)])
    np.testing.assert_allclose(np.diff(rows), 0.2)
    assert rows[[0, -1]].tolist() == [-2.0, 2.0]


def test_refined_columns_share_common_axis(tmp_path):
    base = {
        "young": 210e9,
        "poisson": 0.3,
        "radius": 5e-3,
        "roller_length": 0.3e-3,
        "model": "mirror",
        "stresses": False,
        "profile": {"kind": "cylinder", "fillet_radius": 5e-5},
        "friction": 0.1,
        "accuracy": 0.1,
    }
    sweep = {"max_pressure": [1.0e9, 1.5e9], "e_over_a": [0.0, 2.0]}
    study = small_study(base=base, sweep=sweep, level="surface")
    assert run_study(study, tmp_path, workers=0, progress=False).counts == {"ok": 4}
    common_dataset, original_dataset = open_study(tmp_path), open_study(tmp_path, cells="original")
    assert common_dataset["pressure"].dims == ("max_pressure", "e_over_a", "x_over_a", "y_over_a")
    assert original_dataset["pressure"].dims == ("max_pressure", "e_over_a", "x_index", "y_over_a")
    assert "averaged" in common_dataset["pressure"].attrs["comment"]
    for p0 in (1.0e9, 1.5e9):
        for end_distance in (0.0, 2.0):
            common_case, original_case = (
                study_dataset.sel(max_pressure=p0, e_over_a=end_distance)
                for study_dataset in (common_dataset, original_dataset)
            )
            # Common cells preserve the total load and, with a fine axis, the load on the last half-width.
            total_load = load_between(common_case, -np.inf, np.inf)
            assert float(total_load) == pytest.approx(float(original_case["normal_load"]), rel=1e-6)
            half_width = float(original_case["hertz_half_width"])
            last_load = load_between(original_case, end_distance * half_width, (end_distance + 1) * half_width)
            assert float(last_load) == pytest.approx(float(original_case["end_load_first"]), rel=1e-6, abs=1e-9)
            case_result = single_case(original_case)
            assert case_result["pressure"].dims == ("x", "y")
            assert case_result["x_width"].dims == ("x",)
            assert float(case_result["pressure"].max()) >= float(common_case["pressure"].max())
    # All parameters of a bearing engineer are present, swept or not.
    assert common_dataset["gamma"].dims == ("max_pressure", "e_over_a")
    np.testing.assert_allclose(
        common_dataset["gamma"],
        (0.3e-3 + 2 * common_dataset["e_over_a"] * common_dataset["hertz_half_width"]).T / 5e-3,
        rtol=1e-12,
    )
    assert float(common_dataset["friction"]) == 0.1
    assert common_dataset["profile"].item().startswith("cylinder")


@given(draw_edges(), st.lists(st.floats(0.0, 3.0), min_size=1, max_size=6, unique=True))
@example(np.array([0.0, 1.29, 1.71]), [1.5, 1.625])  # two points in one cell, one at its centre
@example(np.array([0.0, 1.0]), [0.23, 0.69])  # the first cell begins at the end but for rounding
def test_stress_points_are_centres_of_cells(source, points):
    points = np.unique(np.round(points, 3))
    cells = centre_cells(source, points)
    assert np.diff(cells).min() > 0
    assert cells[[0, -1]].tolist() == source[[0, -1]].tolist()
    for point in points[(points > source[0]) & (points < source[-1])]:
        assert np.abs(centres_of(cells) - point).min() < 1e-9


def test_cells_have_edges_between_stress_points():
    cells = split_cells(np.array([0.0, 1.0, 3.0]), np.array([0.0, 0.5, 2.0]))
    assert cells.tolist() == [0.0, 0.25, 1.0, 3.0]


def test_common_edges_combine_edges_of_two_cases():
    first_edges, second_edges = np.array([0.0, 1.0, 2.0, 4.0]), np.array([0.0, 0.9, 4.0, 5.0])
    assert common_columns([first_edges, second_edges]).tolist() == [0.0, 0.9, 2.0, 4.0, 5.0]


def test_end_cells_have_one_width():
    case_edges, points = [np.array([0.0, 1.0, 4.0]), np.array([-1.0, 0.0, 5.0])], [np.array([0.0, 2.0, 4.0])]
    width = END_WIDTH * 6.0
    assert end_cells(case_edges, points).tolist() == [[0.0, width], [4.0, 4.0 - width]]


@given(st.lists(st.tuples(draw_edges(), st.floats(-3.0, 3.0)), min_size=1, max_size=5))
def test_ends_of_all_cases_have_cells(shifted_edges):
    cases = [case_edges + shift for case_edges, shift in shifted_edges]
    ends = end_cells(cases, cases)
    common_edges = common_columns([*cases, *np.sort(ends, axis=1)])
    width = float(np.abs(ends[:, 1] - ends[:, 0]).max())
    assert np.diff(common_edges).min() >= MIN_WIDTH * width * (1 - 1e-4)
    for case_edges in cases:
        for end in case_edges[[0, -1]]:
            assert np.abs(centres_of(common_edges) - end).min() <= 2 * width


@pytest.mark.slow
@pytest.mark.parametrize("has_stated_points", [False, True])
def test_stresses_on_the_ends_of_every_case(tmp_path, has_stated_points):
    base = {name: value for name, value in BASE.items() if name not in ("field_x_over_a", "cells_x", "cells_y")}
    base["accuracy"] = 0.1
    length = base["roller_length"] / 6.5e-5
    cases = [
        {"body": "half-space", "e_over_a": 0.0, "field_x_over_a": [1.0, 2.0]},
        {"body": "finite-length", "e_over_a": 0.0, "field_x_over_a": [0.0, 1.0, length]},
        {"body": "finite-length", "e_over_a": 0.4, "field_x_over_a": [0.0, 1.0, length + 0.8]},
    ]
    if not has_stated_points:
        cases = [{name: case[name] for name in ("body", "e_over_a")} for case in cases]
    study = small_study(base=base, sweep={}, cases=cases)
    assert run_study(study, tmp_path, workers=0, progress=False).counts == {"ok": 3}
    common_dataset, original_dataset = open_study(tmp_path), open_study(tmp_path, cells="original")
    for case_index in np.argwhere(original_dataset["status"].values == "ok").tolist():
        selection = dict(zip(original_dataset["status"].dims, case_index, strict=True))
        common_case, original_case = (dataset.isel(selection) for dataset in (common_dataset, original_dataset))
        points = original_case["x_field"].dropna("x_field_index") / original_case["hertz_half_width"]
        for index in (0, -1):
            common_stress = common_case["von_mises"].sel(x_over_a=points.values[index], method="nearest")
            assert float(common_stress["x_over_a"]) == pytest.approx(points.values[index], abs=1e-12)
            expected = original_case["von_mises"].isel(x_field_index=slice(points.size))[index]
            np.testing.assert_allclose(common_stress, expected, rtol=1e-12)
        # The end of a body is an edge of the common cells, so that resampling keeps the pressure at the end.
        if original_case["body"] == "finite-length":
            assert common_case["von_mises"].sel(x_over_a=0.0).notnull().all()
            line_loads = [
                case["pressure"].sum("y") * float(case["y"].diff("y")[0])
                for case in map(single_case, (common_case, original_case))
            ]
            for index in (0, -1):
                np.testing.assert_allclose(*(loads[index] for loads in line_loads), rtol=1e-9)
