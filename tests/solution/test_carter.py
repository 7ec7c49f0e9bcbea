"""Largest von Mises stress of equal rolling cylinders, against the closed stresses of Carter's traction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import contactstudy as cs
from benchmarks import rolling_stress
from benchmarks.rolling_stress import LENGTH, RADIUS, STEEL, compare_with_carter, compare_with_finer_rows
from contactstudy.arrays.grid import Points
from contactstudy.checks import FloatArray
from contactstudy.fields.stress import stresses_at
from contactstudy.fields.stress_maximum import StressMaximum, find_stress_maximum, place_search
from contactstudy.solution import contact_on_cells


@pytest.mark.parametrize(
    ("friction", "force_fraction"),
    [(0.3, 0.25), *(pytest.param(*parameters, marks=pytest.mark.slow) for parameters in [(0.5, 0.8), (1.0, 0.5)])],
)
def test_stress_maximum_at_stick_slip_border(friction: float, force_fraction: float) -> None:
    result = check_stress_maximum(friction, force_fraction, max_error=0.03)
    assert abs(float(result.peak_von_mises_x) - LENGTH / 2) < 0.1 * LENGTH


@pytest.mark.parametrize(
    ("friction", "force_fraction", "max_error"),
    [(1.0, 0.95, 0.08), (0.7, 0.93, 0.08), (0.3, 0.14, 0.08), (0.5, 0.05, 0.15)],
)
def test_stress_maximum_at_border_near_rim_is_accurate(
    friction: float, force_fraction: float, max_error: float
) -> None:
    """The cusp lies at most two cells inside the rim; its stress is between samples or in a zone narrower than a
    cell."""
    check_stress_maximum(friction, force_fraction, max_error)


def check_stress_maximum(friction: float, force_fraction: float, max_error: float) -> xr.Dataset:
    """Check the largest stress and its error, over the closed stress at most `max_error`; return the result."""
    comparison = compare_with_carter(friction, force_fraction)
    assert abs(comparison.change) < comparison.error < max_error
    return comparison.result


def test_stress_maximum_below_rigid_roller_equals_finer_rows() -> None:
    """Under unlike bodies the pressure strains the sticking cells; cells four times finer along y are the reference."""
    roller = cs.Roller(radius=RADIUS, length=0.3e-3, profile=cs.profiles.Ellipsoid(crown_radius=20e-3), ends="none")
    case = cs.Case(body=cs.HalfSpace(material=STEEL), roller=roller, max_pressure=1e9, friction=0.4)
    creepage = 0.86 * 0.4 * case.hertz_half_width / RADIUS
    case = replace(case, motion=cs.Rolling(longitudinal_creepage=creepage))
    comparison = compare_with_finer_rows(case, accuracy=0.1)
    assert comparison is not None
    assert abs(comparison.change) < 0.01


def test_stress_maximum_in_narrow_slip_strip_equals_finer_cells() -> None:
    """On 6 columns the border is at most two cells off the rim along x and y; the reference is on finer cells."""
    profile = cs.profiles.Ellipsoid(crown_radius=1.5e-3)
    roller = cs.Roller(radius=RADIUS, length=0.2e-3, profile=profile, material=STEEL, ends="none")
    case = cs.Case(body=cs.HalfSpace(material=STEEL), roller=roller, max_pressure=1e9, friction=1.0)
    half_width = case.hertz_half_width
    creepages = {"longitudinal_creepage": -0.02, "lateral_creepage": 0.07}
    motion = cs.Rolling(**{name: value * half_width / RADIUS for name, value in creepages.items()})
    x_range = (0.1e-3 - 0.81 * half_width, 0.1e-3 + 0.81 * half_width)
    y_range = (-1.66 * half_width, 1.66 * half_width)
    coarse_maximum, fine_maximum = (
        find_stress_maximum_on_cells(
            replace(case, motion=motion),
            cs.Grid(x_range=x_range, y_range=y_range, cells_x=cells_x, cells_y=cells_y),
        )
        for cells_x, cells_y in ((8, 32), (32, 96))
    )
    assert coarse_maximum.position[2] == 0.0
    assert abs(coarse_maximum.value - fine_maximum.value) < coarse_maximum.error < 0.1 * fine_maximum.value


def find_stress_maximum_on_cells(case: cs.Case, grid: cs.Grid) -> StressMaximum:
    """Largest von Mises stress on given cells with its error, which results on given cells do not have."""
    solution = contact_on_cells(case, grid, None, 1e-6)
    loads, pressure = solution.tractions.loads, solution.contact.pressure

    def compute_stress(points: Points) -> FloatArray:
        return stresses_at(case.body, loads, grid, [points], pressure)[0]

    search = place_search(case.body, loads, grid, case.roller.material)
    return find_stress_maximum(search, [compute_stress(points) for points in search.samples], compute_stress)


def test_command_compares_with_carter(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(rolling_stress, "FRICTIONS", (0.3,))
    monkeypatch.setattr(rolling_stress, "FORCE_FRACTIONS", (0.8,))
    assert rolling_stress.main(["--carter"]) == 0
    assert "1 cases, 1 stated errors hold" in capsys.readouterr().out


@pytest.mark.slow
def test_command_compares_random_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert rolling_stress.main(["--first", "6", "--cases", "1"]) == 0
    assert "1 cases, 1 stated errors hold" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("body", "creepage"),
    [
        (cs.HalfSpace(material=STEEL), {"longitudinal_creepage": 0.15}),
        (cs.HalfSpace(material=STEEL), {"longitudinal_creepage": 0.3, "lateral_creepage": 0.2, "spin": 0.4}),
        (cs.FiniteLengthSpace(length=0.6e-3, material=STEEL), {"lateral_creepage": 0.5}),
    ],
)
def test_coulomb_law_holds_inside_cells(body: cs.Body, creepage: dict[str, float]) -> None:
    """Largest traction on the top over its bound, at positions inside the cells, away from the rim."""
    profile = cs.profiles.Ellipsoid(crown_radius=20e-3)
    roller = cs.Roller(radius=RADIUS, length=0.6e-3, profile=profile, material=STEEL, ends="none")
    case = cs.Case(body=body, roller=roller, max_pressure=1e9, friction=0.3)
    half_width = case.hertz_half_width
    scales = {name: 0.3 * half_width / RADIUS / (half_width if name == "spin" else 1.0) for name in creepage}
    motion = cs.Rolling(**{name: value * scales[name] for name, value in creepage.items()})
    contact = cs.solve(replace(case, motion=motion), stresses=False)
    stress = cs.stress_field(
        body,
        contact.pressure,
        traction_x=contact.traction_x,
        traction_y=contact.traction_y,
        x=np.linspace(0.25e-3, 0.35e-3, 5),
        y=half_width * np.linspace(-0.8, 0.8, 161),
        z=[0.0],
        inside_cells=contact.pressure,
    )
    pressure = -stress.sigma_zz
    ratio = np.hypot(stress.tau_xz, stress.tau_yz) / (0.3 * pressure)
    assert float(ratio.where(pressure > 0.3 * pressure.max()).max()) < 1.005
