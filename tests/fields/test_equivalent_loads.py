"""Equivalent loads: conditions in real space, without the equation set."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    Material,
    QuarterSpace,
    Roller,
    equivalent_loads,
    profiles,
    solve,
)
from contactstudy.arrays.grid import Points
from contactstudy.kernels.field import half_space_field, stress_influence
from contactstudy.kernels.load import Load
from contactstudy.overlapping import problem
from contactstudy.overlapping.problem import POLES


def test_face_loads_reverse_end_stress_of_top_load(short_body: FiniteLengthSpace, strip_pressure) -> None:
    friction = 0.3
    pressure = strip_pressure(8.0, (96, 64))
    depths = np.array([0.2, 0.5, 1.0, 3.0])
    loads = equivalent_loads(short_body, pressure, friction, z=depths)
    grid = Grid.from_centres(pressure.x.values, pressure.y.values)
    y = grid.y[[10, 28, 33, 50]]

    def compute_end_stress(load: Load, cells: np.ndarray) -> np.ndarray:
        return half_space_field(
            cells, stress_influence(load, 0.3), grid, Points(np.array([0.0, 8.0]), y, depths), extent=(0.0, 8.0)
        )[0]

    end_stress = compute_end_stress(Load.NORMAL, loads["P_h1"].values) + friction * compute_end_stress(
        Load.ALONG_Y, pressure.values
    )
    # The load on the top is limited to the cells of the window.
    assert np.abs(end_stress[0] - loads["P_v1"].sel(y=y)).max() < 2e-2
    assert np.abs(end_stress[1] - loads["P_v2"].sel(y=y)).max() < 2e-2
    assert float(np.abs(loads["P_v1"]).max()) > 0.5


def test_quarter_space_has_one_face_load_and_half_space_none(half_space: HalfSpace, strip_pressure) -> None:
    pressure = strip_pressure(8.0, (32, 32))
    loads = equivalent_loads(QuarterSpace(material=half_space.material), pressure, z=[0.5])
    assert "P_v2" not in loads
    assert loads["P_h1"].attrs["long_name"].endswith("P_h1")
    loads = equivalent_loads(half_space, pressure)
    assert set(loads.data_vars) == {"P_h1"}
    np.testing.assert_array_equal(loads["P_h1"], pressure)


@pytest.mark.parametrize(
    ("kind", "distance"),
    [
        ("exact", 0.0),
        ("mirror", 0.0),
        pytest.param("single-mirror", 0.05e-3, marks=pytest.mark.slow),
        ("quarter", 0.0),
        ("half", 0.0),
    ],
)
def test_equivalent_loads_of_solved_pressure(kind: str, distance: float) -> None:
    steel = Material(206e9, 0.3)
    bodies = {"quarter": QuarterSpace(material=steel), "half": HalfSpace(material=steel)}
    body = bodies.get(kind) or FiniteLengthSpace(length=0.5e-3, material=steel, model=kind)
    roller = Roller(radius=6e-3, length=0.5e-3 - 2 * distance, profile=profiles.Lundberg(amplitude=0.2e-6))
    result = solve(Case(body=body, roller=roller, max_pressure=1.2e9), stresses=False, accuracy=0.1)
    has_end_correction = kind not in ("mirror", "half")
    for depths in ([0.0], [1e-5, 1e-4]):
        loads = equivalent_loads(body, result.pressure, 0.2, z=depths)
        assert ("P_v1" in loads) is has_end_correction
        assert all(np.isfinite(loads[name]).all() for name in loads.data_vars)
        exceeds_pressure = float(loads["P_h1"].max()) > float(result.pressure.max())
        assert exceeds_pressure is has_end_correction


def test_eccentric_loads_do_not_depend_on_pole_panel(
    short_body: FiniteLengthSpace, strip_pressure, monkeypatch
) -> None:
    pressure = strip_pressure(8.0, (16, 16)) * (1 + 0.5 * (strip_pressure(8.0, (16, 16)).x - 4.0))

    def compute_loads():
        return equivalent_loads(short_body, pressure, 0.3, z=[0.2, 1.0])

    baseline = compute_loads()
    assert baseline["P_h1"].attrs["reference_distance"] == 80.0
    monkeypatch.setitem(problem.POLE_PANEL_FACTOR, POLES, 0.1 * problem.POLE_PANEL_FACTOR[POLES])
    for name in ("P_h1", "P_v1", "P_v2"):
        assert float(np.abs(compute_loads()[name] - baseline[name]).max()) < 1e-4 * float(np.abs(baseline[name]).max())
