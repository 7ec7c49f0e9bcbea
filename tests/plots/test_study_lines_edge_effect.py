import pytest

from contactstudy import plots
from contactstudy.errors import InvalidInputError
from tests.stand_in_solver import FAILS


def test_edge_effect_figure_has_panel_of_each_distance(study_dataset):
    figure = plots.plot_edge_effect(study_dataset)
    figure.canvas.draw()
    titles = [ax.get_title() for ax in figure.get_axes()]
    assert [title for title in titles if title] == ["$e/a$ = 0", "$e/a$ = 1", "$e/a$ = 2"]
    labels = [text.get_text() for text in figure.get_axes()[0].get_legend().get_texts()]
    assert len(labels) == 4
    assert labels[-1].startswith("half-space")


def test_middle_colour_is_quarter_of_largest_stress(study_dataset):
    figure = plots.plot_edge_effect(study_dataset)
    panels = [ax.collections[0] for ax in figure.get_axes() if ax.get_title()]
    assert [float(panel.norm(0.25 * panel.levels[-1])) for panel in panels] == pytest.approx([0.5] * 3)


def test_legend_fits_narrow_column(study_dataset):
    figure = plots.plot_edge_effect(study_dataset)
    (text, *_) = figure.get_axes()[0].get_legend().get_texts()
    assert text.get_fontsize() * 360 / (72 * figure.get_figwidth()) > 7


def test_edge_effect_figure_fits(study_dataset, assert_nothing_clipped):
    assert_nothing_clipped(plots.plot_edge_effect(study_dataset))


def test_edge_effect_figure_without_stresses_has_one_panel(study_dataset):
    surfaces = study_dataset.drop_vars(
        [name for name in study_dataset.data_vars if "z" in str(study_dataset[name].dims)]
    )
    figure = plots.plot_edge_effect(surfaces.sel(body="finite-length"), selection={"friction": 0.1}, most=2)
    assert len(figure.get_axes()) == 1
    assert len(figure.get_axes()[0].get_legend().get_texts()) == 2


def test_study_without_pressures_raises(study_dataset):
    with pytest.raises(InvalidInputError, match="finished cases"):
        plots.plot_edge_effect(study_dataset, selection={"friction": FAILS})
    with pytest.raises(InvalidInputError, match="finished cases"):
        plots.plot_edge_effect(study_dataset[["status"]])
    with pytest.raises(InvalidInputError, match="e_over_a"):
        plots.plot_edge_effect(study_dataset.isel(e_over_a=0))
