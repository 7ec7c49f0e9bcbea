"""Singular ends in figures: marks instead of unbounded values."""

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, HalfSpace, Material, Roller, plots, solve
from contactstudy.plots.style import singular_ends


@pytest.fixture(scope="module")
def sharp_result():
    body = HalfSpace(material=Material(210e9, 0.3))
    case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9, end_distance=0.2e-3)
    return solve(case, stresses=False, accuracy=0.05)


def test_singular_ends_lie_at_roller_ends(sharp_result):
    np.testing.assert_allclose(singular_ends(sharp_result), [0.2e-3, 1.2e-3], rtol=1e-9)


def test_singular_end_is_marked(sharp_result):
    ax = plots.plot_axial_pressure(sharp_result)
    line, marks = ax.lines
    half_width, p0 = float(sharp_result["hertz_half_width"]), float(sharp_result["hertz_max_pressure"])
    np.testing.assert_allclose(marks.get_xdata(), np.array([0.2e-3, 1.2e-3]) / half_width)
    # The narrowest columns carry much higher pressures than the figure.
    assert np.nanmax(line.get_ydata()) < 0.5 * float(sharp_result["pressure"].max()) / p0


def test_mark_beyond_axes_keeps_limits(sharp_result):
    ax = plots.plot_axial_pressure(sharp_result)
    marks = ax.lines[-1]
    first_end, last_end = marks.get_xdata()
    ax.set_xlim(0.5 * (first_end + last_end), 1.1 * last_end)
    ax.figure.canvas.draw()
    assert ax.get_tightbbox().x0 > ax.transData.transform((first_end, 0.0))[0]
    assert marks.get_clip_on()


def test_map_colours_exclude_singular_end(sharp_result):
    mesh, *_ = plots.plot_pressure_map(sharp_result).collections
    assert mesh.get_clim()[1] < 0.5 * float(sharp_result["pressure"].max() / sharp_result["hertz_max_pressure"])


def create_study(values):
    peaks = xr.DataArray(values, dims=("e_over_a", "friction"), coords={"e_over_a": [0.0, 1.0], "friction": [0.0, 0.1]})
    return xr.Dataset({"peak_pressure": peaks.assign_attrs(units="Pa")})


def test_study_line_marks_singular_cases(assert_nothing_clipped):
    figure = plots.plot_study_lines(create_study([[1e9, 1.1e9], [np.inf, 1.2e9]]), x="e_over_a", hue="friction")
    first_line, marks, _ = figure.axes[0].lines
    assert np.isnan(first_line.get_ydata()[1])
    assert list(marks.get_xdata()) == [1.0]
    assert figure.axes[0].get_ylim()[1] == pytest.approx(1.08 * 1.2)
    assert any("singular" in text.get_text() for legend in figure.legends for text in legend.get_texts())
    assert_nothing_clipped(figure)


def test_regular_cases_have_no_mark():
    figure = plots.plot_study_lines(create_study([[1e9, 1.1e9], [1.3e9, 1.2e9]]), x="e_over_a", hue="friction")
    assert len(figure.axes[0].lines) == 2
    assert not any("singular" in text.get_text() for legend in figure.legends for text in legend.get_texts())


def test_study_map_labels_unbounded_values():
    ax = plots.plot_study_map(create_study([[1e9, 1.1e9], [np.inf, 1.2e9]]), "peak_pressure")
    assert [text.get_text() for text in ax.texts].count("\N{INFINITY}") == 1


def test_maximum_at_border_has_open_marker(lines_of):
    dataset = create_study([[1e9, 1.1e9], [1.3e9, 1.2e9]]).rename(peak_pressure="peak_von_mises")
    dataset["peak_von_mises_error"] = dataset["peak_von_mises"] * [[0.01, np.inf], [0.01, 0.01]]
    figure = plots.plot_study_lines(dataset, ["peak_von_mises"], x="e_over_a", hue="friction")
    _, line, marks = lines_of(figure.axes[0])
    assert np.isfinite(marks.get_ydata()).tolist() == [True, False]
    assert line.get_ydata()[0] == marks.get_ydata()[0] == pytest.approx(1.1)
    assert any("error not estimated" in text.get_text() for legend in figure.legends for text in legend.get_texts())


def test_stress_colours_exclude_singular_end():
    """Positions close to the end have unbounded stresses, which would occupy all colours."""
    body = HalfSpace(material=Material(210e9, 0.3))
    case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9, end_distance=0.2e-3)
    half_width = case.hertz_half_width
    x = np.sort(np.concatenate([0.2e-3 + half_width * np.geomspace(1e-4, 1.0, 12), [0.1e-3, 0.7e-3]]))
    result = solve(case, accuracy=0.05, x=x, y=[-1e-6, 0.0, 1e-6], z=half_width * np.array([0.0, 0.2, 0.8]))
    ax = plots.plot_stress_plane(result)
    (contours,) = [
        collection
        for collection in ax.collections
        if collection.get_array() is not None and collection.get_cmap().name != "white"
    ][:1]
    assert contours.norm.vmax < 0.5 * float(result["von_mises"].max()) / 1.5e9
    assert "unbounded at the singular end" in ax.figure.axes[-1].get_ylabel().replace("\n", " ")
