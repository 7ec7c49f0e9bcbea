"""Approach and tilt refer to a material line of each body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import (
    Case,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    choose_grid,
    displacement_field,
    profiles,
    solve,
)

STEEL = Material(210e9, 0.3)
YOUNG, POISSON, RADIUS = 210e9, 0.3, 5e-3


def make_long_case(length: float, depth: float | None = None) -> Case:
    body = FiniteLengthSpace(length=length, material=STEEL, reference_depth=depth)
    return Case(body=body, roller=Roller(radius=RADIUS, length=length), max_pressure=1e9)


def test_approach_at_mid_length_of_a_long_roller() -> None:
    depth = 5e-3
    case = make_long_case(100e-3, depth)
    result = solve(case, stresses=False, accuracy=0.05)
    line_load = float(result.pressure.sel(x=0.05, method="nearest").sum()) * float(result.y[1] - result.y[0])
    ratio = POISSON / (1 - POISSON)
    expected = (1 - POISSON**2) * line_load / (np.pi * YOUNG) * (2 * np.log(2 * depth / case.hertz_half_width) - ratio)
    assert float(result.approach) == pytest.approx(expected, rel=0.005)


def test_approach_grows_with_the_logarithm_of_the_depth_beyond_three_lengths() -> None:
    length = 4e-3
    shallow_result, deep_result = (
        solve(make_long_case(length, depth), stresses=False, accuracy=0.05) for depth in (3 * length, 6 * length)
    )
    slope = float(deep_result.approach - shallow_result.approach) / np.log(2)
    assert slope == pytest.approx(2 * float(shallow_result.normal_load) / length / (np.pi * YOUNG), rel=0.01)


CROWN = profiles.FullCrown(2.0)


def make_crowned_roller(**arguments: float) -> Case:
    body = FiniteLengthSpace(length=6e-3, material=STEEL, reference_depth=9e-3)
    roller = Roller(radius=6e-3, length=4e-3, profile=CROWN, material=STEEL, reference_depth=6e-3)
    return Case(body=body, roller=roller, end_distance=0.5e-3, **arguments)


def test_prescribed_tilt_equals_prescribed_position() -> None:
    case = make_crowned_roller(load=1500.0, tilt=5e-4)
    grid = choose_grid(case, cells_x=4, cells_y=8)
    balanced_result = solve(case, grid, stresses=False)
    position_result = solve(
        make_crowned_roller(load=1500.0, load_position=float(balanced_result.load_position)), grid, stresses=False
    )
    assert float(position_result.tilt) == pytest.approx(5e-4, rel=2e-3)
    assert float(position_result.pressure.max()) == pytest.approx(float(balanced_result.pressure.max()), rel=2e-3)
    tilted_result = solve(
        make_crowned_roller(approach=float(balanced_result.approach), tilt=5e-4), grid, stresses=False
    )
    # The approach of a tilted roller refers to its mid-length in both results.
    assert float(tilted_result.normal_load) == pytest.approx(1500.0, rel=3e-3)


def test_gap_is_initial_gap_and_displacement_less_the_approach() -> None:
    case = replace(make_crowned_roller(load=1500.0, tilt=5e-4), roller=Roller(radius=6e-3, length=4e-3, profile=CROWN))
    result = solve(case, stresses=False, accuracy=0.1)
    gap = result.initial_gap + result.displacement_z - result.approach
    np.testing.assert_allclose(gap.values, result.gap.values, atol=1e-12)


def test_reference_line_of_body_is_at_rest() -> None:
    case = make_crowned_roller(load=1500.0, tilt=5e-4)
    result = solve(case, stresses=False, accuracy=0.05)
    x = np.linspace(0.1e-3, 5.9e-3, 16)
    load_position = float(result.load_position)
    field = displacement_field(case.body, result.pressure, x=np.append(x, load_position), y=[0.0], z=[0.0, 9e-3]).u_z[
        :, 0
    ]
    slope = np.polynomial.polynomial.polyfit(x, field[:-1, 1], 1)[1]
    expected = float(field[-1, 0] - field[-1, 1])
    top_displacement = result.displacement_z.sel(y=0.0, method="nearest").interp(x=load_position)
    assert float(top_displacement) == pytest.approx(expected, rel=0.01)
    assert abs(slope) > 1e-6


def test_reference_depth_of_half_space_reduces_approach() -> None:
    roller = Roller(radius=RADIUS, length=4e-3, profile=CROWN)
    infinite_result, finite_result = (
        solve(
            Case(body=HalfSpace(material=STEEL, reference_depth=depth), roller=roller, load=500.0),
            stresses=False,
            accuracy=0.1,
        )
        for depth in (None, 10e-3)
    )
    assert float(finite_result.approach) < float(infinite_result.approach)
    with pytest.raises(InvalidInputError, match="reference_depth = -1"):
        HalfSpace(material=STEEL, reference_depth=-1.0)
    with pytest.raises(InvalidInputError, match=r"reference_depth = 0\.006"):
        Roller(radius=RADIUS, length=4e-3, reference_depth=6e-3)
