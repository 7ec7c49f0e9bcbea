"""Positions of the search for the largest stress."""

from __future__ import annotations

import numpy as np

from contactstudy import FiniteLengthSpace, Grid, Material
from contactstudy.fields.loads import TopLoad, sliding
from contactstudy.fields.stress_maximum import RIM_CELLS, place_search
from contactstudy.kernels.load import Load

BODY = FiniteLengthSpace(length=10.0, material=Material(1.0, 0.3))


def test_symmetric_contact_searches_one_peak() -> None:
    grid = Grid(x_range=(0.0, 10.0), y_range=(-1.0, 1.0), cells_x=100, cells_y=20)
    end_peaks = np.exp(-(np.minimum(grid.x - 1, 9 - grid.x) ** 2))[:, None] * np.ones(20)
    end_peaks[:, [0, -1]] = 0.0
    unequal_peaks = np.where(grid.x[:, None] > 5, 0.9, 1.0) * end_peaks
    low_peak = np.where(grid.x[:, None] > 5, 0.3, 1.0) * end_peaks
    sample_counts = [
        len(place_search(BODY, sliding(variant, 0.0), grid).samples) for variant in (end_peaks, unequal_peaks, low_peak)
    ]
    assert sample_counts == [2, 3, 2]
    for points in place_search(BODY, sliding(unequal_peaks, 0.0), grid).samples:
        assert points.x.min() >= 0.0
        assert points.x.max() <= 10.0


def test_search_on_top_excludes_rim() -> None:
    grid = Grid(x_range=(0.0, 10.0), y_range=(-1.0, 1.0), cells_x=100, cells_y=20)
    pressure = np.ones((100, 20))
    pressure[:, [0, -1]] = 0.0
    pressure[70:] = 0.0
    search = place_search(BODY, sliding(pressure, 0.0), grid)
    # The body ends with the cells: its end has no rim.
    assert search.inside_rim[: 70 - RIM_CELLS, 1 + RIM_CELLS : 19 - RIM_CELLS].all()
    assert search.inside_rim.sum() == (70 - RIM_CELLS) * (18 - 2 * RIM_CELLS)
    for points in search.samples:
        assert points.z[0] == 0.0
        assert search.inside_rim_at(points).any()
        assert set(points.x) <= set(grid.x)
        assert set(points.y) <= set(grid.y)


def test_search_without_pressure_is_empty() -> None:
    grid = Grid(x_range=(0.0, 1.0), y_range=(-1.0, 1.0), cells_x=10, cells_y=10)
    assert not place_search(BODY, sliding(np.zeros((10, 10)), 0.0), grid).samples


def test_axial_traction_is_symmetric_if_reversed() -> None:
    grid = Grid(x_range=(0.0, 10.0), y_range=(-1.0, 1.0), cells_x=100, cells_y=20)
    pressure = np.ones((100, 20))
    pressure[:, [0, -1]] = 0.0
    normal = TopLoad(pressure)
    for traction, is_symmetric in ((pressure, False), (pressure * np.sign(grid.x - 5.0)[:, None], True)):
        loads = {Load.NORMAL: normal, Load.ALONG_X: TopLoad(traction)}
        last_x = max(points.x.max() for points in place_search(BODY, loads, grid).samples)
        assert (last_x < 9.5) == is_symmetric
