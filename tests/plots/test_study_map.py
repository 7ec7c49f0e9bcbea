import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

from contactstudy import analysis, plots
from contactstudy.errors import InvalidInputError
from contactstudy.plots.study_map import describe_value
from tests.stand_in_solver import FAILS


def test_map_has_values_and_hatched_failures(study_dataset, assert_nothing_clipped):
    ax = plots.plot_study_map(study_dataset, "peak_von_mises", selection={"body": "finite-length"})
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["0", "1", "2"]
    assert [tick.get_text() for tick in ax.get_yticklabels()] == ["0.1", f"{FAILS:g}"]
    # Three cases have labels with their values in GPa, three failed cases are hatched.
    expected = study_dataset["peak_von_mises"].sel(friction=0.1, body="finite-length").values / 1e9
    assert [text.get_text() for text in ax.texts] == [f"{value:.3g}" for value in expected]
    assert sum(bool(collection.get_hatch()) for collection in ax.collections) == 3
    (legend_text,) = ax.get_legend().get_texts()
    assert legend_text.get_text() == "no value: 3 of 6 cases (3 failed)"
    assert_nothing_clipped(ax.figure)


def test_map_counts_missing_listed_cases(assert_nothing_clipped):
    listed_cases = xr.Dataset(
        {"peak_pressure": ("case", [1e9, 2e9, 3e9, np.nan]), "status": ("case", ["ok", "ok", "ok", "failed"])},
        coords={"e_over_a": ("case", [0.0, 0.0, 1.0, 2.0]), "friction": ("case", [0.0, 0.1, 0.1, 0.0])},
    )
    ax = plots.plot_study_map(listed_cases, "peak_pressure")
    assert ax.get_legend().get_texts()[0].get_text() == "no value: 3 of 6 cases (1 failed)"
    assert [text.get_text() for text in ax.texts] == ["1e+09", "2e+09", "3e+09"]
    assert_nothing_clipped(ax.figure)
    with pytest.raises(InvalidInputError, match=r"several have e_over_a = 0.0, friction = 0.0"):
        plots.plot_study_map(listed_cases.assign_coords(friction=("case", np.zeros(4))), "peak_pressure")


def test_complete_map_has_no_legend(study_dataset):
    complete_study = study_dataset.isel(friction=[0]).sel(body="finite-length")
    assert plots.plot_study_map(complete_study, "peak_von_mises").get_legend() is None


def test_map_has_engineering_unit(study_dataset):
    ax = plots.plot_study_map(study_dataset, "contact_length", selection={"body": "finite-length"})
    assert any("(mm)" in axes.get_ylabel() for axes in ax.figure.get_axes())


def test_map_axis_has_names_of_bodies(study_dataset):
    ax = plots.plot_study_map(study_dataset, "end_pressure_over_p0", y="body", selection={"friction": 0.1})
    assert [tick.get_text() for tick in ax.get_yticklabels()] == ["finite-length", "half-space"]


def test_map_of_computed_values_has_given_levels(study_dataset):
    factors = analysis.edge_factors(study_dataset.sel(body="finite-length"))["end_over_middle_first"]
    values = factors.copy(data=np.arange(6.0).reshape(3, 2))
    ax = plots.plot_study_map(study_dataset, values, levels=[1.5, 2.5], label="factor")
    assert not [text for text in ax.texts if text.get_text() not in ("1.5", "2.5")]
    assert ax.figure.get_axes()[1].get_ylabel() == "factor"


def test_map_uses_given_axes(study_dataset):
    ax = pyplot.figure().add_subplot()
    assert plots.plot_study_map(study_dataset, "end_pressure_over_p0", ax=ax, selection={"body": "finite-length"}) is ax


def test_invalid_argument_raises(study_dataset):
    one_body_study = study_dataset.sel(body="finite-length")
    for call, message in (
        (lambda: plots.plot_study_map(study_dataset, "end_pressure_over_p0"), "with a value of body"),
        (lambda: plots.plot_study_map(one_body_study, "status"), "a number of each case"),
        (lambda: plots.plot_study_map(one_body_study, "end_pressures"), "did you mean"),
        (lambda: plots.plot_study_map(one_body_study, "end_pressure_over_p0", y="gamma"), "two swept parameters"),
        (lambda: plots.plot_study_map(one_body_study, "end_pressure_over_p0", y="e_over_a"), "two swept parameters"),
        (
            lambda: plots.plot_study_map(study_dataset, "end_pressure_over_p0", selection={"body": "moon"}),
            "one of finite-length",
        ),
        (lambda: plots.plot_study_map(one_body_study, "end_pressure_over_p0", selection={"speed": 1}), "of nothing"),
        (lambda: plots.plot_study_map(one_body_study.isel(friction=[1]), "end_pressure_over_p0"), "at least one"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()


def test_description_of_value_has_symbol_and_unit() -> None:
    assert describe_value("max_pressure", 1e9, "Pa", 2) == "$p_0$ = 1 GPa, one of 2 values"
    assert describe_value("profile", "crowned", "") == "profile = crowned"
