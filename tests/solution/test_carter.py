"""Largest von Mises stress of equal rolling cylinders, against the closed stresses of Carter's traction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import contactstudy as cs
from contactstudy.checks import FloatArray

POISSON, RADIUS, LENGTH, PRESSURE = 0.28, 5e-3, 3e-3, 5e8
STEEL = cs.Material(young=210e9, poisson=POISSON)


def elliptic_line(y: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stresses (yy, zz, yz) under the pressure, and under the traction along +y, ``sqrt(1 - y**2)``.

    K. L. Johnson, Contact Mechanics (1985), 4.49 and 7.8.
    """
    difference = 1 - y**2 + z**2
    root = np.sqrt(difference**2 + 4 * y**2 * z**2)
    m = np.sqrt(np.maximum(root + difference, 0) / 2)
    n = np.sign(y) * np.sqrt(np.maximum(root - difference, 0) / 2)
    squares = np.maximum(m**2 + n**2, 1e-300)
    yy, zz = 2 * z - m * (1 + (z**2 + n**2) / squares), -m * (1 - (z**2 + n**2) / squares)
    yz = -n * (m**2 - z**2) / squares
    return np.array([yy, zz, yz]), np.array([n * (2 - (z**2 - m**2) / squares) - 2 * y, yz, yy])


def largest_under_carter(friction: float, stick: float) -> float:
    """Largest von Mises stress over the largest pressure, in plane strain."""
    y = np.append(np.linspace(-1.1, 1.1, 441), 1 - 2 * stick)
    y, z = (axis.ravel() for axis in np.meshgrid(y, np.linspace(0.0, 1.0, 51)))
    pressure, sliding = elliptic_line(y, z)
    sticking = elliptic_line((y - 1 + stick) / stick, z / stick)[1]
    yy, zz, yz = pressure + friction * (sliding - stick * sticking)
    xx = POISSON * (yy + zz)
    squares = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * yz**2
    return float(np.sqrt(squares.max()))


@pytest.mark.parametrize(
    ("friction", "force_fraction"),
    [(0.3, 0.25), *(pytest.param(*pair, marks=pytest.mark.slow) for pair in [(0.5, 0.8), (1.0, 0.5)])],
)
def test_stress_maximum_at_stick_slip_border(friction: float, force_fraction: float) -> None:
    result = check_stress_maximum(friction, force_fraction, max_error=0.03)
    assert abs(float(result.peak_von_mises_x) - LENGTH / 2) < 0.1 * LENGTH


@pytest.mark.parametrize(
    ("friction", "force_fraction", "max_error"),
    [(1.0, 0.95, 0.08), (0.7, 0.93, 0.08), (0.3, 0.14, 0.08), (0.5, 0.05, 0.15)],
)
def test_stress_maximum_at_border_near_rim(friction: float, force_fraction: float, max_error: float) -> None:
    """The cusp lies at most two cells inside the rim; its stress is between samples, or hidden in a narrow zone."""
    check_stress_maximum(friction, force_fraction, max_error)


def check_stress_maximum(friction: float, force_fraction: float, max_error: float) -> xr.Dataset:
    """Check the largest stress and its error, over the closed stress at most `max_error`; return the result."""
    profile = cs.profiles.Lundberg.for_pressure(
        PRESSURE, radius=RADIUS, modulus=STEEL.plane_strain_modulus / 2, delta=2
    )
    roller = cs.Roller(radius=RADIUS, length=LENGTH, profile=profile, material=STEEL, ends="none")
    case = cs.Case(body=cs.HalfSpace(material=STEEL), roller=roller, max_pressure=PRESSURE, friction=friction)
    creepage = friction * case.hertz_half_width / RADIUS * (1 - force_fraction)
    result = cs.solve(replace(case, motion=cs.Rolling(longitudinal_creepage=creepage)), y=[0.0], z=[0.0])
    middle_column = result.isel(x=int(abs(result.x.values - LENGTH / 2).argmin()))
    largest, step = float(result.peak_pressure), float(result.y[1] - result.y[0])
    half_width = 2 * step * float(middle_column.pressure.sum()) / (np.pi * largest)
    stick = 1 - creepage * RADIUS / (friction * half_width)
    expected = largest * largest_under_carter(friction, stick)
    assert abs(float(result.peak_von_mises) - expected) < float(result.peak_von_mises_error)
    assert float(result.peak_von_mises_error) < max_error * expected
    return result


def test_stress_maximum_at_border_below_rigid_roller() -> None:
    """Under unlike bodies the pressure strains the sticking cells; cells four times finer along y are the reference."""
    roller = cs.Roller(radius=RADIUS, length=0.3e-3, profile=cs.profiles.Ellipsoid(crown_radius=20e-3), ends="none")
    case = cs.Case(body=cs.HalfSpace(material=STEEL), roller=roller, max_pressure=1e9, friction=0.4)
    creepage = 0.86 * 0.4 * case.hertz_half_width / RADIUS
    case = replace(case, motion=cs.Rolling(longitudinal_creepage=creepage))
    result = cs.solve(case, accuracy=0.1, y=[0.0], z=[0.0])
    edges = np.append(result.x_bounds.values[:, 0], result.x_bounds.values[-1, 1])
    half_step = 0.5 * float(result.y[1] - result.y[0])
    window = (float(result.y[0]) - half_step, float(result.y[-1]) + half_step)
    reference = cs.solve(case, cs.Grid.between(edges, window, 4 * result.sizes["y"]), y=[0.0], z=[0.0])
    assert float(result.peak_von_mises) == pytest.approx(float(reference.peak_von_mises), rel=0.01)


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
