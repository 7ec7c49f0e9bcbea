"""Positions of the search for the largest stress."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    Material,
    Roller,
    profiles,
    solve,
    stress_field,
)
from contactstudy.fields.loads import TopLoad, sliding
from contactstudy.fields.stress_maximum import RIM_CELLS, place_search
from contactstudy.kernels.load import Load
from contactstudy.verification import closed_forms

BODY = FiniteLengthSpace(length=10.0, material=Material(1.0, 0.3))


def test_symmetric_contact_searches_one_peak() -> None:
    grid = Grid(x_range=(0.0, 10.0), y_range=(-1.0, 1.0), cells_x=100, cells_y=20)
    end_peaks = np.exp(-(np.minimum(grid.x - 1, 9 - grid.x) ** 2))[:, None] * np.ones(20)
    end_peaks[:, [0, -1]] = 0.0
    unequal_peaks = np.where(grid.x[:, None] > 5, 0.9, 1.0) * end_peaks
    low_peak = np.where(grid.x[:, None] > 5, 0.3, 1.0) * end_peaks
    sample_counts = [
        len(place_search(BODY, sliding(peaks, 0.0), grid).samples) for peaks in (end_peaks, unequal_peaks, low_peak)
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


@pytest.mark.parametrize(
    ("cells_y", "window", "max_error"),
    [
        (36, 1.36, 0.023),
        (36, 1.385, 0.018),
        (72, 1.34, 0.012),
    ],  # error over p0, at the positions of the edge with the largest error
)
def test_stress_at_last_cell_under_sliding_line_is_accurate(cells_y: int, window: float, max_error: float) -> None:
    """The von Mises stress at the centre of this cell, which the search includes, is within 0.8 percent."""
    body, radius, half_width, friction = HalfSpace(material=Material(210e9, 0.3)), 5e-3, 50e-6, 0.3
    modulus, length = body.material.plane_strain_modulus, 100 * half_width
    case = Case(
        body=body,
        roller=Roller(radius=radius, length=length, profile=profiles.Cylinder(), ends="none"),
        max_pressure=0.5 * half_width / radius * modulus,
    )
    y_range = (-window * half_width, window * half_width)
    cells = Grid(x_range=(-0.25 * length, 1.25 * length), y_range=y_range, cells_x=60, cells_y=cells_y)
    section_pressure = solve(case, cells, stresses=False).pressure.values[30]
    load = section_pressure.sum() * cells.dy
    half_width = np.sqrt(4 * load * radius / (np.pi * modulus))
    max_pressure = 2 * load / (np.pi * half_width)
    strip_x = np.linspace(0.0, 2000 * half_width, 81)[1::2]
    strip_pressure = xr.DataArray(np.tile(section_pressure, (40, 1)), {"x": strip_x, "y": cells.y}, ("x", "y"))
    loaded_y = cells.y[section_pressure > 0]
    for y in (loaded_y[1], loaded_y[-2]):
        inner_edge = y - np.sign(y) * 0.5 * cells.dy
        positions = np.sort([inner_edge, y])
        stress = stress_field(
            body,
            strip_pressure,
            friction=friction,
            x=[1000 * half_width],
            y=positions,
            z=[0.0],
            inside_cells=strip_pressure,
        ).isel(x=0, z=0)
        expected = closed_forms.hertz_strip(positions, np.zeros(2), half_width, max_pressure, 0.3, friction=friction)
        for name in ("sigma_xx", "sigma_yy", "sigma_zz", "tau_yz"):
            assert stress[name].values == pytest.approx(expected[name], abs=max_error * max_pressure)
        is_centre = positions == y
        assert closed_forms.von_mises(stress)[is_centre] == pytest.approx(
            closed_forms.von_mises(expected)[is_centre], rel=8e-3
        )
