import numpy as np
import pytest
from matplotlib import pyplot

from contactstudy import plots
from contactstudy.errors import InvalidInputError


def test_axial_pressure_is_over_p0_and_a(one):
    line = plots.plot_axial_pressure(one, label="a").lines[0]
    assert line.get_xdata() == pytest.approx((one["x"] / one["hertz_half_width"]).dropna("x_over_a").values)
    assert 1.0 < np.max(line.get_ydata()) < 1.2


def test_si_is_mm_and_mpa(solved):
    ax = plots.plot_axial_pressure(solved, si=True)
    line = ax.lines[0]
    assert line.get_xdata() == pytest.approx(1e3 * solved["x"].values)
    assert line.get_ydata() == pytest.approx(1e-6 * solved["pressure"].max("y").values)
    assert "mm" in ax.get_xlabel()
    assert "MPa" in ax.get_ylabel()


def test_map_shows_every_cell(solved, assert_nothing_clipped):
    ax = plots.plot_pressure_map(solved)
    drawn = ax.collections[0].get_array()
    assert np.asarray(drawn).max() == pytest.approx(float(solved["pressure"].max()) / 1.5e9)
    assert np.asarray(drawn).size == solved["pressure"].size
    assert "x/a" in ax.get_xlabel()
    assert "y/a" in ax.get_ylabel()
    assert_nothing_clipped(ax.figure)


def test_without_hertz_scales_si_is_left(solved):
    bare = solved[["pressure"]]
    with pytest.raises(InvalidInputError, match="si=True"):
        plots.plot_axial_pressure(bare)
    assert plots.plot_axial_pressure(bare, si=True).lines


@pytest.mark.parametrize("draw", [plots.plot_axial_pressure, plots.plot_pressure_map])
def test_given_axes_are_used(one, draw):
    ax = pyplot.figure().add_subplot()
    assert draw(one, ax) is ax


@pytest.mark.parametrize("draw", [plots.plot_axial_pressure, plots.plot_pressure_map])
def test_bad_input(opened, one, draw):
    with pytest.raises(InvalidInputError, match="single case"):
        draw(opened)
    with pytest.raises(InvalidInputError, match="level"):
        draw(one.drop_vars("pressure"))
