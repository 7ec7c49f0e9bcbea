import numpy as np
import pytest
import xarray as xr

from contactstudy import plots
from contactstudy.errors import InvalidInputError


@pytest.fixture
def worn():
    depth = xr.DataArray([[0.0, 0.0, 0.0], [0.0, 2e-6, 1e-6]], dims=("distance", "x"))
    load = xr.DataArray([[0.0, 3e5, 1e5], [0.0, 2e5, 2e5]], dims=("distance", "x"))
    return xr.Dataset({"wear_depth": depth, "line_load": load}, {"distance": [0.0, 10.0], "x": [0.5e-3, 1e-3, 1.5e-3]})


def test_depth_points_down_and_loads_are_in_newton_per_millimetre(worn):
    ax = plots.plot_wear(worn)
    assert ax.yaxis_inverted()
    assert ax.lines[1].get_ydata()[1:] == pytest.approx([2.0, 1.0])
    assert np.isnan(ax.lines[1].get_ydata()[0])
    loads = plots.plot_wear(worn, variable="line_load")
    assert loads.lines[0].get_ydata()[1] == pytest.approx(300.0)
    assert not loads.yaxis_inverted()


def test_lines_differ_and_are_named_by_the_distance(worn, assert_nothing_clipped):
    ax = plots.plot_wear(worn)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["0 m", "10 m"]
    long = plots.plot_wear(worn.assign_coords(distance=[1e4 / 3, 2e4]))
    assert [text.get_text() for text in long.get_legend().get_texts()] == ["3333 m", "20000 m"]
    assert len({line.get_linestyle() for line in ax.lines}) == 2
    assert_nothing_clipped(ax.figure)


def test_bad_input(worn):
    with pytest.raises(InvalidInputError, match="variable"):
        plots.plot_wear(worn, variable="luck")
    with pytest.raises(InvalidInputError, match="wear_depth"):
        plots.plot_wear(worn.drop_vars("wear_depth"))
