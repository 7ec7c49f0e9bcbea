"""Figures of profiles."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib import pyplot

from contactstudy import InvalidInputError
from contactstudy.plots import plot_profile, plot_profiles
from contactstudy.profiles import Cylinder, FullCrown, Lundberg


def test_profile_figure_has_drop_downwards():
    ax = plot_profile(FullCrown(1.25), 10e-3, color="black")
    x, drop = ax.lines[0].get_data()
    assert (x[0], x[-1]) == (-5.0, 5.0)
    np.testing.assert_allclose(drop, 0.4 * x**2, rtol=1e-4)
    assert ax.yaxis_inverted()
    assert "mm" in ax.get_xlabel()
    assert "µm" in ax.get_ylabel()


def test_profile_figure_keeps_inverted_given_axes():
    ax = pyplot.figure().add_subplot()
    for _ in range(2):
        assert plot_profile(Cylinder(), 10e-3, ax=ax) is ax
    assert ax.yaxis_inverted()


def test_profile_plot_omits_infinite_ends():
    ax = plot_profile(Lundberg(1e-7) + Cylinder(1e-3), 10e-3, deepest=5e-6)
    assert np.isnan(ax.lines[0].get_ydata()[[0, -1]]).all()
    assert ax.get_ylim()[0] == pytest.approx(5.0)


def test_profile_comparison_has_distinct_colours_and_fits():
    ax = plot_profiles({"sharp": Cylinder(), "crowned": FullCrown(1.0)}, 10e-3)
    ax.figure.canvas.draw()
    frame, box = ax.figure.bbox, ax.get_tightbbox()
    assert box.x0 >= frame.x0
    assert box.y0 >= frame.y0
    assert box.x1 <= frame.x1
    assert box.y1 <= frame.y1
    styles = {(line.get_color() if isinstance(line.get_color(), str) else tuple(line.get_color())) for line in ax.lines}
    assert len(styles) == 2


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda: plot_profile("crown", 1.0), "profile = 'crown'"),
        (lambda: plot_profile(Cylinder(), -1.0), "length = -1.0"),
        (lambda: plot_profile(Cylinder(1.0), 1.0), "fillet_radius = 1.0"),
        (lambda: plot_profile(Cylinder(), 1.0, deepest=0.0), "deepest = 0.0"),
        (lambda: plot_profiles({}, 1.0), "at least one"),
        (lambda: plot_profiles([Cylinder()], 1.0), "a mapping"),
    ],
)
def test_invalid_argument_raises(draw, message):
    with pytest.raises(InvalidInputError, match=message):
        draw()
