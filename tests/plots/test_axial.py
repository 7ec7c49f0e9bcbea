import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

from contactstudy import analysis, plots
from contactstudy.errors import InvalidInputError


def test_axial_pressure_is_drawn_over_p0_and_a(study_case):
    line = plots.plot_axial_pressure(study_case, label="a").lines[0]
    assert line.get_xdata() == pytest.approx(
        (study_case["x"] / study_case["hertz_half_width"]).dropna("x_over_a").values
    )
    assert 1.0 < np.max(line.get_ydata()) < 1.2


def test_si_figure_has_mm_and_mpa(case_result):
    ax = plots.plot_axial_pressure(case_result, si=True)
    line = ax.lines[0]
    assert line.get_xdata() == pytest.approx(1e3 * case_result["x"].values)
    assert line.get_ydata() == pytest.approx(1e-6 * case_result["pressure"].max("y").values)
    assert "mm" in ax.get_xlabel()
    assert "MPa" in ax.get_ylabel()


def test_result_without_scales_requires_si(case_result):
    pressure_only = case_result[["pressure"]]
    with pytest.raises(InvalidInputError, match="si=True"):
        plots.plot_axial_pressure(pressure_only)
    assert plots.plot_axial_pressure(pressure_only, si=True).lines


@pytest.mark.parametrize("draw", [plots.plot_axial_pressure])
def test_axial_pressure_uses_given_axes(study_case, draw):
    ax = pyplot.figure().add_subplot()
    assert draw(study_case, ax) is ax


@pytest.mark.parametrize("draw", [plots.plot_axial_pressure])
def test_invalid_result_raises(study_dataset, study_case, draw):
    with pytest.raises(InvalidInputError, match="single case"):
        draw(study_dataset)
    with pytest.raises(InvalidInputError, match="level"):
        draw(study_case.drop_vars("pressure"))


def test_comparison_labels_each_line(case_result, strip_result, assert_nothing_clipped):
    ax = plots.plot_comparison({"ends": case_result, "Hertz": strip_result(1e-4, 1e9)})
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["ends", "Hertz"]
    assert ax.lines[1].get_ydata().max() == pytest.approx(1.0, abs=1e-3)
    assert_nothing_clipped(ax.figure)


def test_lines_differ_by_colour_and_dashes(strip_result):
    ax = plots.plot_comparison({str(index): strip_result() for index in range(6)})
    styles = {(line.get_color() if isinstance(line.get_color(), str) else tuple(line.get_color())) for line in ax.lines}
    assert len(styles) == 6
    assert len({str(line._dash_pattern) for line in ax.lines}) == 6
    luminances = [np.dot(line.get_color()[:3], [0.299, 0.587, 0.114]) for line in ax.lines]
    assert np.all(np.diff(luminances) > 0)


def test_comparison_of_stress_is_centred_at_mid_length(case_result):
    ax = plots.plot_comparison({"case": case_result}, "tresca", centred=True, si=True)
    assert ax.lines[0].get_xdata().mean() == pytest.approx(0, abs=1e-6)
    maximum = analysis.largest_sample(case_result, "tresca")["largest_tresca"]
    assert ax.lines[0].get_ydata().max() == pytest.approx(1e-6 * float(maximum))
    assert "mid-length" in ax.get_xlabel()


def test_stress_over_depth_equals_line_contact(strip_result, assert_nothing_clipped):
    ax = plots.plot_depth(strip_result(2e-4, 1e9), ["von_mises", "maximum_shear"])
    assert [line.get_xdata().max() for line in ax.lines] == pytest.approx([0.5575, 0.3], abs=2e-3)
    low, high = ax.get_ylim()
    assert low > high
    assert ax.get_title() == "below $x/a$ = 3, $y/a$ = 0"
    assert_nothing_clipped(ax.figure)


def test_comparison_and_depth_use_given_axes(case_result):
    ax = pyplot.figure().add_subplot()
    assert plots.plot_comparison({"case": case_result}, ax=ax) is ax
    assert plots.plot_depth(case_result, ax=ax, x=0.2e-3, si=True) is ax
    assert ax.get_title() == "below $x$ = 0.2 mm, $y$ = 0 mm"


def test_invalid_comparison_raises(case_result, study_dataset):
    for call, message in (
        (lambda: plots.plot_comparison({}), "at least one"),
        (lambda: plots.plot_comparison([case_result]), "mapping"),
        (lambda: plots.plot_comparison({"study": study_dataset}), "single case"),
        (lambda: plots.plot_comparison({"case": case_result}, "trescas"), "did you mean"),
        (lambda: plots.plot_depth(case_result, []), "at least one"),
        (lambda: plots.plot_depth(case_result, x=1.0), "within the result"),
        (lambda: plots.plot_depth(study_dataset), "single case"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()


@pytest.fixture
def wear_result():
    depth = xr.DataArray([[0.0, 0.0, 0.0], [0.0, 2e-6, 1e-6]], dims=("distance", "x"))
    load = xr.DataArray([[0.0, 3e5, 1e5], [0.0, 2e5, 2e5]], dims=("distance", "x"))
    return xr.Dataset({"wear_depth": depth, "line_load": load}, {"distance": [0.0, 10.0], "x": [0.5e-3, 1e-3, 1.5e-3]})


def test_wear_depth_axis_points_down(wear_result):
    ax = plots.plot_wear(wear_result)
    assert ax.yaxis_inverted()
    assert ax.lines[1].get_ydata()[1:] == pytest.approx([2.0, 1.0])
    assert np.isnan(ax.lines[1].get_ydata()[0])
    load_axes = plots.plot_wear(wear_result, variable="line_load")
    assert load_axes.lines[0].get_ydata()[1] == pytest.approx(300.0)
    assert not load_axes.yaxis_inverted()


def test_wear_lines_have_distance_labels(wear_result, assert_nothing_clipped):
    ax = plots.plot_wear(wear_result)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["0 m", "10 m"]
    wear_axes = plots.plot_wear(wear_result.assign_coords(distance=[1e4 / 3, 2e4]))
    assert [text.get_text() for text in wear_axes.get_legend().get_texts()] == ["3333 m", "20000 m"]
    assert len({line.get_linestyle() for line in ax.lines}) == 2
    assert_nothing_clipped(ax.figure)


def test_invalid_wear_raises(wear_result):
    with pytest.raises(InvalidInputError, match="variable"):
        plots.plot_wear(wear_result, variable="heat")
    with pytest.raises(InvalidInputError, match="wear_depth"):
        plots.plot_wear(wear_result.drop_vars("wear_depth"))
