"""Measured profiles in contact: ridges between columns, and the error from the spacing of the points."""

from __future__ import annotations

import numpy as np
import pytest

import contactstudy as cs
from contactstudy.profiles import Cylinder, FullCrown, Measured, Profile

STEEL = cs.Material(young=210e9, poisson=0.3)


def solve_peak(profile: Profile, length: float = 2e-3, accuracy: float = 0.01, **load: float) -> tuple[float, float]:
    case = cs.Case(
        body=cs.HalfSpace(material=STEEL), roller=cs.Roller(radius=5e-3, length=length, profile=profile), **load
    )
    result = cs.solve(case, stresses=False, accuracy=accuracy)
    return float(result.peak_pressure), float(result.peak_pressure_error)


@pytest.mark.parametrize("step", [10e-6, 7e-6])
def test_error_covers_edge_radius_of_few_points(step: float) -> None:
    """The corner begins on a sample of the profile, or between two samples."""
    formula = Cylinder(0.1e-3)
    x = np.linspace(-1e-3, 1e-3, round(2e-3 / step) + 1)
    exact_peak, _ = solve_peak(formula, max_pressure=1.5e9)
    measured_peak, error = solve_peak(Measured(x, formula.drop(x, 2e-3)), max_pressure=1.5e9)
    assert abs(measured_peak - exact_peak) < error


def test_crest_between_points_keeps_its_curvature() -> None:
    formula = FullCrown(50e-3, centre=7e-6)
    x = np.linspace(-1e-3, 1e-3, 41)
    exact_peak, _ = solve_peak(formula, load=5.0)
    measured_peak, error = solve_peak(Measured(x, formula.drop(x, 2e-3)), load=5.0)
    assert measured_peak == pytest.approx(exact_peak, rel=2e-3)
    assert error < 0.05 * exact_peak


@pytest.mark.parametrize("position", [0.231, pytest.param(0.487, marks=pytest.mark.slow)])
def test_ridge_is_resolved_at_any_position(position: float) -> None:
    """A burr of 0.4 um over ten points carries several times the pressure of the cylinder."""
    length = 4e-3
    x = np.linspace(-length / 2, length / 2, 801)
    burr = np.exp(-(((x + length / 2 - position * length) / 10e-6) ** 2))
    drop = 0.4e-6 * (1 - burr) + 0.5e-6 * (2 * x / length) ** 2
    profile = Measured(x, drop) + Cylinder(fillet_radius=0.03 * length)
    largest_pressure, _ = solve_peak(profile, length, 0.1, max_pressure=1e9)
    assert largest_pressure > 2.5e9


def test_points_of_ridge_between_samples_split_the_first_columns() -> None:
    """A ridge of 2 um between samples 15 um apart carries the largest pressure."""
    length, width, ridge_x = 60e-3, 1e-6, (0.1685 - 0.5) * 60e-3
    coarse_x = np.linspace(-length / 2, length / 2, 601)
    x = np.sort(
        np.concatenate([ridge_x + width * np.linspace(-3, 3, 25), coarse_x[np.abs(coarse_x - ridge_x) > 4 * width]])
    )
    drop = 0.3e-6 * (1 - np.exp(-(((x - ridge_x) / width) ** 2)))
    largest_pressure, _ = solve_peak(
        Measured(x, drop, largest_spike=1e-6) + Cylinder(0.03 * length), length, 0.1, max_pressure=1e9
    )
    assert largest_pressure > 20e9
