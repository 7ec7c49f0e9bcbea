import numpy as np
import pytest

from contactstudy import plots
from contactstudy.errors import InvalidInputError


@pytest.fixture(scope="module")
def hot(solved):
    rise = 1e-8 * solved["pressure"].copy()
    return solved.assign(temperature_rise=rise, frictional_heat=solved["pressure"])


def test_map_shows_every_cell_and_the_hottest_one(hot, assert_nothing_clipped):
    ax = plots.plot_temperature_map(hot)
    assert np.asarray(ax.collections[0].get_array()).max() == pytest.approx(float(hot.temperature_rise.max()))
    hottest = hot.temperature_rise.where(hot.temperature_rise == hot.temperature_rise.max(), drop=True)
    assert ax.lines[0].get_xdata()[0] == pytest.approx(float(hottest.x[0] / hot.hertz_half_width))
    assert "x/a" in ax.get_xlabel()
    assert_nothing_clipped(ax.figure)


def test_a_surface_without_temperature_is_refused(hot):
    with pytest.raises(InvalidInputError, match="roller_temperature_rise"):
        plots.plot_temperature_map(hot, surface="roller")
    with pytest.raises(InvalidInputError, match="surface"):
        plots.plot_temperature_map(hot, surface="ball")
