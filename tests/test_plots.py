import matplotlib

matplotlib.use("Agg")

import numpy as np
import pytest
from matplotlib import pyplot

from contactstudy import plots
from contactstudy.errors import InvalidInputError
from tests.study.fakes import FAILS


@pytest.fixture
def results(opened):
    return opened


@pytest.fixture
def one(results):
    return results.sel(e_over_a=1, friction=0.1, body="finite-length")


@pytest.fixture(autouse=True)
def _closed_figures():
    yield
    pyplot.close("all")


def test_axial_pressure_is_over_p0_and_a(one):
    line = plots.plot_axial_pressure(one, label="a").lines[0]
    size = int(np.isfinite(one["x"]).sum())
    np.testing.assert_allclose(line.get_xdata()[:size], (one["x"] / one["hertz_half_width"])[:size])
    assert 1.0 < np.nanmax(line.get_ydata()) < 1.2


def test_pressure_map_says_what_it_shows(one):
    ax = plots.plot_pressure_map(one)
    assert "x/a" in ax.get_xlabel()
    assert "y/a" in ax.get_ylabel()


def test_stress_plane_has_depth_downwards(one):
    ax = plots.plot_stress_plane(one, "sigma_xx")
    low, high = ax.get_ylim()
    assert low > high


def test_given_axes_are_used(one):
    ax = pyplot.figure().add_subplot()
    assert plots.plot_axial_pressure(one, ax) is ax
    assert plots.plot_stress_plane(one, ax=ax) is ax


def test_study_figure(results):
    figure = plots.plot_edge_effect(results)
    figure.canvas.draw()
    titles = [ax.get_title() for ax in figure.get_axes()]
    assert [title for title in titles if title] == ["$e/a$ = 0", "$e/a$ = 1", "$e/a$ = 2"]
    labels = [text.get_text() for text in figure.get_axes()[0].get_legend().get_texts()]
    assert len(labels) == 4
    assert labels[-1].startswith("half-space")


def test_no_text_is_clipped(results):
    figure = plots.plot_edge_effect(results)
    figure.canvas.draw()
    frame = figure.bbox
    for ax in figure.get_axes():
        if ax.get_visible():
            box = ax.get_tightbbox()
            assert box.x0 >= frame.x0 - 1
            assert box.y0 >= frame.y0 - 1
            assert box.x1 <= frame.x1 + 1
            assert box.y1 <= frame.y1 + 1


def test_study_figure_without_stresses_and_without_comparison(results):
    surfaces = results.drop_vars([name for name in results.data_vars if "z" in str(results[name].dims)])
    figure = plots.plot_edge_effect(surfaces.sel(body="finite-length"), selection={"friction": 0.1}, most=2)
    assert len(figure.get_axes()) == 1
    assert len(figure.get_axes()[0].get_legend().get_texts()) == 2


def test_colours_keep_their_order_in_grey():
    colours = matplotlib.colormaps[plots.COLORS](np.linspace(0, 1, 20))[:, :3]
    assert np.all(np.diff(colours @ [0.299, 0.587, 0.114]) > 0)


@pytest.mark.parametrize("draw", [plots.plot_axial_pressure, plots.plot_pressure_map, plots.plot_stress_plane])
def test_more_than_one_case(results, draw):
    with pytest.raises(InvalidInputError, match="single case"):
        draw(results)


@pytest.mark.parametrize("draw", [plots.plot_axial_pressure, plots.plot_pressure_map, plots.plot_stress_plane])
def test_missing_variable(one, draw):
    with pytest.raises(InvalidInputError, match="level"):
        draw(one.drop_vars(["pressure", "von_mises"]))


def test_nothing_to_draw(results):
    with pytest.raises(InvalidInputError, match="finished cases"):
        plots.plot_edge_effect(results, selection={"friction": FAILS})
    with pytest.raises(InvalidInputError, match="e_over_a"):
        plots.plot_edge_effect(results.isel(e_over_a=0))
