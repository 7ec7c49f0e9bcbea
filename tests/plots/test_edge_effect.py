import pytest

from contactstudy import plots
from contactstudy.errors import InvalidInputError
from tests.stand_in_solver import FAILS


def test_study_figure(opened):
    figure = plots.plot_edge_effect(opened)
    figure.canvas.draw()
    titles = [ax.get_title() for ax in figure.get_axes()]
    assert [title for title in titles if title] == ["$e/a$ = 0", "$e/a$ = 1", "$e/a$ = 2"]
    labels = [text.get_text() for text in figure.get_axes()[0].get_legend().get_texts()]
    assert len(labels) == 4
    assert labels[-1].startswith("half-space")


def test_legend_fits_narrow_column(opened):
    figure = plots.plot_edge_effect(opened)
    (text, *_) = figure.get_axes()[0].get_legend().get_texts()
    assert text.get_fontsize() * 360 / (72 * figure.get_figwidth()) > 7


def test_no_text_is_clipped(opened, assert_nothing_clipped):
    assert_nothing_clipped(plots.plot_edge_effect(opened))


def test_study_figure_without_stresses_and_without_comparison(opened):
    surfaces = opened.drop_vars([name for name in opened.data_vars if "z" in str(opened[name].dims)])
    figure = plots.plot_edge_effect(surfaces.sel(body="finite-length"), selection={"friction": 0.1}, most=2)
    assert len(figure.get_axes()) == 1
    assert len(figure.get_axes()[0].get_legend().get_texts()) == 2


def test_study_without_pressures_raises(opened):
    with pytest.raises(InvalidInputError, match="finished cases"):
        plots.plot_edge_effect(opened, selection={"friction": FAILS})
    with pytest.raises(InvalidInputError, match="finished cases"):
        plots.plot_edge_effect(opened[["status"]])
    with pytest.raises(InvalidInputError, match="e_over_a"):
        plots.plot_edge_effect(opened.isel(e_over_a=0))
