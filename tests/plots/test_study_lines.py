import numpy as np
import pytest
import xarray as xr

from contactstudy import plots
from contactstudy.errors import InvalidInputError


def test_study_figure_has_panels_of_variables_and_lines_of_bodies(study_dataset, assert_nothing_clipped, lines_of):
    figure = plots.plot_study_lines(study_dataset, x="e_over_a", hue="body", selection={"friction": 0.1})
    assert len(figure.axes) == 3
    assert all(len(lines_of(ax)) == 2 for ax in figure.axes)
    expected = study_dataset["peak_von_mises"].sel(friction=0.1, body="finite-length").values / 1e9
    np.testing.assert_allclose(figure.axes[1].lines[0].get_ydata(), expected)
    assert all("(" in ax.get_ylabel() for ax in figure.axes)
    assert_nothing_clipped(figure)


def test_names_are_tick_labels(study_dataset):
    figure = plots.plot_study_lines(study_dataset, ["peak_pressure"], x="body", selection={"friction": 0.1})
    assert [tick.get_text() for tick in figure.axes[0].get_xticklabels()] == ["finite-length", "half-space"]


def test_study_figures_depend_on_variables(study_dataset):
    assert list(plots.study_figures(study_dataset)) == ["edge_effect", "study"]
    assert list(plots.study_figures(study_dataset[["status", "peak_pressure"]].isel(e_over_a=[0]))) == ["study"]
    assert plots.study_figures(study_dataset[["status"]]) == {}


@pytest.mark.parametrize("arguments", [{"x": "gamma"}, {"x": "e_over_a", "hue": "gamma"}])
def test_parameters_must_be_swept(study_dataset, arguments):
    with pytest.raises(InvalidInputError, match="swept"):
        plots.plot_study_lines(study_dataset, **arguments)


def test_missing_quantity_raises(study_dataset):
    with pytest.raises(InvalidInputError, match="no_such_thing"):
        plots.plot_study_lines(study_dataset, ["no_such_thing"], x="e_over_a")


def test_lines_show_first_solved_cases(study_dataset):
    study_with_failed_cases_first = study_dataset.isel(friction=[1, 0])
    figure = plots.plot_study_lines(study_with_failed_cases_first, x="e_over_a", hue="body")
    assert figure.get_suptitle() == "friction = 0.1, one of 2 values"
    assert np.isfinite(figure.axes[0].lines[0].get_ydata()).all()
    assert list(plots.study_figures(study_with_failed_cases_first)) == ["edge_effect", "study"]
    figure_of_failed_cases = plots.plot_study_lines(study_dataset.isel(friction=[1]), x="e_over_a", hue="body")
    assert not np.isfinite(figure_of_failed_cases.axes[0].lines[0].get_ydata()).any()


def test_title_contains_fixed_parameters(study_dataset):
    load = xr.DataArray([200.0, 300.0], dims="load", attrs={"units": "N"})
    study_with_loads = study_dataset.isel(friction=0, drop=True).expand_dims(load=load)
    study_with_loads["load"].attrs["units"] = "N"
    assert (
        plots.plot_study_lines(study_with_loads, x="e_over_a", hue="body").get_suptitle()
        == "load = 200 N, one of 2 values"
    )


def test_legend_contains_unit(study_dataset):
    study_over_pressure = study_dataset.sel(friction=0.1, body="finite-length").expand_dims(max_pressure=[1e9, 2e9])
    study_over_pressure["max_pressure"].attrs["units"] = "Pa"
    legend, *_ = plots.plot_study_lines(study_over_pressure, x="e_over_a", hue="max_pressure").legends
    assert "GPa" in legend.get_title().get_text()
    assert [text.get_text() for text in legend.get_texts()] == ["1", "2"]


def test_zipped_parameters_share_label(study_dataset):
    selection = study_dataset.sel(friction=0.1).isel(e_over_a=[0])
    zipped_study = selection.rename(body="body_and_model").assign_coords(
        body=("body_and_model", ["finite-length", "half-space"]), model=("body_and_model", ["mirror", "exact"])
    )
    zipped_study["body_and_model"] = [0, 1]
    legend, *_ = plots.plot_study_lines(zipped_study, x="e_over_a", hue="body_and_model").legends
    assert legend.get_title().get_text() == "body and model"
    assert [text.get_text() for text in legend.get_texts()] == ["finite-length, mirror", "half-space, exact"]


def test_finite_errors_are_drawn_as_bars() -> None:
    distances = {"e_over_a": [0.0, 1.0, 2.0]}
    peaks = xr.DataArray([1e9, 2e9, 3e9], distances, "e_over_a", attrs={"units": "Pa"})
    errors = peaks.copy(data=[1e8, np.inf, 2e8])
    figure = plots.plot_study_lines(xr.Dataset({"peak_pressure": peaks, "peak_pressure_error": errors}), x="e_over_a")
    (bars,) = figure.axes[0].collections
    bar_ends = [
        segment[:, 1].tolist() for segment in bars.get_segments() if len(segment) and np.isfinite(segment).all()
    ]
    assert bar_ends == [pytest.approx([0.9, 1.1]), pytest.approx([2.8, 3.2])]
    study_without_errors = plots.plot_study_lines(xr.Dataset({"peak_pressure": peaks}), x="e_over_a")
    assert not study_without_errors.axes[0].collections


def test_values_without_errors_have_open_markers(lines_of) -> None:
    distances = {"e_over_a": [0.0, 1.0]}
    peaks = xr.DataArray([1e9, 2e9], distances, "e_over_a", attrs={"units": "Pa"})
    data_with_errors = {"peak_von_mises": peaks, "peak_von_mises_error": 0.1 * peaks, "peak_von_mises_z": 1e-14 * peaks}
    names = ["peak_von_mises", "peak_von_mises_z", "normal_load"]
    figure = plots.plot_study_lines(xr.Dataset(data_with_errors | {"normal_load": peaks}), names, x="e_over_a")
    marker_colors = [line.get_markerfacecolor() for ax in figure.axes for line in lines_of(ax)]
    assert [isinstance(face, str) and face == "white" for face in marker_colors] == [False, True, False]
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["error not estimated"]


def test_figures_follow_selection(study_dataset) -> None:
    (title_of_default, _), (title_of_selection, _) = (
        [figure.get_suptitle() for figure in plots.study_figures(study_dataset, selection=selection).values()]
        for selection in ({}, {"friction": "0.10"})
    )
    assert "friction = 0.1, one of 2 values" in title_of_default
    assert "friction = 0.1" in title_of_selection
    assert "of 2" not in title_of_selection
    assert (
        plots.study_figures(study_dataset, selection={"body": "half-space"})["study"].get_suptitle()
        == "body = half-space"
    )
    with pytest.raises(InvalidInputError, match="swept parameter: e_over_a"):
        plots.study_figures(study_dataset, selection={"speed": 1.0})
    with pytest.raises(InvalidInputError, match="one of"):
        plots.study_figures(study_dataset, selection={"friction": 0.7})


def make_creepage_study() -> xr.Dataset:
    """Forces over a creepage and a distance."""
    swept = {"longitudinal_creepage": [0.0, 1e-3, 2e-3], "e_over_a": [0.0, 2.0]}
    force = xr.DataArray([[0.0, 0.0], [0.05, 0.06], [0.09, np.nan]], coords=swept, dims=tuple(swept))
    return xr.Dataset({"force_y": force, "force_x": force, "normal_load": xr.ones_like(force)}, {"friction": 0.1})


def test_traction_curve_is_over_full_sliding(assert_nothing_clipped) -> None:
    ax = plots.plot_traction_curve(make_creepage_study(), "e_over_a")
    first_line, second_line, full_sliding = ax.lines
    assert first_line.get_ydata() == pytest.approx([0.0, 0.5, 0.9])
    assert second_line.get_ydata() == pytest.approx([0.0, 0.6])
    assert list(full_sliding.get_ydata()) == [1.0, 1.0]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["0", "2"]
    assert_nothing_clipped(ax.figure)
    assert len(plots.plot_traction_curve(make_creepage_study(), selection={"e_over_a": 2.0}).lines) == 2


def test_invalid_traction_curve_raises() -> None:
    with pytest.raises(InvalidInputError, match="selection"):
        plots.plot_traction_curve(make_creepage_study())
    with pytest.raises(InvalidInputError, match="hue = 'friction'"):
        plots.plot_traction_curve(make_creepage_study(), "friction")
    with pytest.raises(InvalidInputError, match="over lateral_creepage"):
        plots.plot_traction_curve(make_creepage_study(), creepage="lateral_creepage")
    with pytest.raises(InvalidInputError, match="creepage = 'spin'"):
        plots.plot_traction_curve(make_creepage_study(), creepage="spin")
