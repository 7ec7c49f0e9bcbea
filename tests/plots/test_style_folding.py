"""Long names and labels fit into their figure."""

import numpy as np
import pytest
import xarray as xr

from contactstudy import plots, profiles
from contactstudy.plots.style import fold_text

LONG_NAME = "outer ring raceway with an unusually long name, after grinding and superfinishing, batch 12"


def list_legends(figure):
    return [*figure.legends, *(ax.get_legend() for ax in figure.axes if ax.get_legend())]


@pytest.fixture
def assert_figure_fits(assert_nothing_clipped):
    def check_artists_and_legends(figure):
        assert_nothing_clipped(figure)
        frame = figure.bbox
        for legend in list_legends(figure):
            box = legend.get_window_extent()
            assert box.x0 >= frame.x0 - 1
            assert box.y0 >= frame.y0 - 1
            assert box.x1 <= frame.x1 + 1
            assert box.y1 <= frame.y1 + 1

    return check_artists_and_legends


def make_approach_study():
    steps = {"approach": [1e-6, 2e-6], "profile": [LONG_NAME, f"{LONG_NAME}, 2"]}
    values = xr.DataArray([[1e9, 2e9], [3e9, 4e9]], steps, ("approach", "profile"), attrs={"units": "Pa"})
    study = xr.Dataset(dict.fromkeys(("peak_pressure", "peak_von_mises", "end_pressure_first"), values))
    meaning = "how far the roller is pressed down at its mid-length, from first touch without tilt"
    study["approach"].attrs = {"long_name": meaning, "units": "m"}
    return study


def test_parameters_of_long_meaning_fit(assert_figure_fits):
    study = make_approach_study()
    assert_figure_fits(plots.plot_study_lines(study, x="approach", selection={"profile": LONG_NAME}))
    assert_figure_fits(plots.plot_study_lines(study, x="profile", hue="approach"))
    assert_figure_fits(plots.plot_study_lines(study, ["peak_pressure"], x="approach", hue="profile"))
    assert_figure_fits(plots.plot_study_map(study, "peak_pressure", x="approach", y="profile").figure)
    assert_figure_fits(plots.plot_study_map(study, "peak_pressure", x="profile", y="approach").figure)


def test_results_and_profiles_of_long_names_fit(study_case, study_dataset, assert_figure_fits):
    assert_figure_fits(plots.plot_comparison({LONG_NAME: study_case, f"{LONG_NAME}, 2": study_case}).figure)
    assert_figure_fits(
        plots.plot_profiles({LONG_NAME: profiles.FullCrown(1.0), "b": profiles.FullCrown(2.0)}, 10e-3).figure
    )
    assert_figure_fits(plots.plot_edge_effect(study_dataset.assign_coords(profile=LONG_NAME)))
    creepages = {"longitudinal_creepage": [0.0, 1e-3], "profile": [LONG_NAME, f"{LONG_NAME}, 2"]}
    force = xr.DataArray([[0.0, 0.0], [0.06, 0.05]], creepages, ("longitudinal_creepage", "profile"))
    study = xr.Dataset({"force_y": force, "normal_load": xr.ones_like(force)}, {"friction": 0.1})
    assert_figure_fits(plots.plot_traction_curve(study, "profile").figure)


def test_folded_text_keeps_formulas():
    assert fold_text(r"stress along the axis, $\sigma_x\ \mathrm{(MPa)}$ in $y = 0$", 22).split("\n") == [
        "stress along the axis,",
        r"$\sigma_x\ \mathrm{(MPa)}$ in $y = 0$",
    ]
    assert fold_text("x" * 30, 20) == "x" * 20 + "\n" + "x" * 10
    assert fold_text(r"\$1 roller at \$2", 10) == "\\$1 roller\nat \\$2"
    assert np.all([len(line) <= 40 for line in fold_text(LONG_NAME, 40).split("\n")])


def test_folded_text_breaks_between_values_clauses_or_words():
    values = "profile = edge radius 0.05 mm, one of 2 values; friction = 0, one of 2 values; body = finite-length"
    assert fold_text(values, 40).split("\n") == [
        "profile = edge radius 0.05 mm,",
        "one of 2 values;",
        "friction = 0, one of 2 values;",
        "body = finite-length",
    ]
    assert fold_text("friction = 0; body = finite-length", 20) == "friction = 0;\nbody = finite-length"
    assert fold_text("Pressure near a free end: friction = 0", 30) == "Pressure near a free end:\nfriction = 0"
    assert fold_text("distance of the roller's end from the free end, $e/a$", 40).split("\n") == [
        "distance of the roller's end from the",
        "free end, $e/a$",
    ]
