"""A prescribed approach takes the load that Hertz states, and the load that gives this approach, with its error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    Rolling,
    profiles,
    solve,
)
from contactstudy.analysis import solved_case
from contactstudy.contact.at_approach import settled_at_approach

STEEL = Material(210e9, 0.3)
RADIUS, APPROACH = 5e-3, 2e-6
BALL = Case(
    body=HalfSpace(material=STEEL),
    roller=Roller(radius=RADIUS, length=0.8e-3, profile=profiles.FullCrown(crown_radius=RADIUS)),
    approach=APPROACH,
)
HERTZ = 4 / 3 * STEEL.plane_strain_modulus * np.sqrt(RADIUS) * APPROACH**1.5  # Johnson (1985), 4.23
SHORT = Case(
    body=FiniteLengthSpace(length=0.3e-3, material=STEEL),
    roller=Roller(radius=RADIUS, length=0.3e-3, profile=profiles.FullCrown(crown_radius=0.1)),
    approach=1.5e-6,
    tilt=5e-4,
    friction=0.2,
    coupled=True,
)


def test_a_ball_carries_hertz_load() -> None:
    result = solve(BALL, stresses=False)
    assert abs(float(result.normal_load) - HERTZ) < float(result.normal_load_error) < 2e-3 * HERTZ
    assert float(result.approach) == APPROACH
    assert bool(result.converged)
    peak = 2 * STEEL.plane_strain_modulus / np.pi * np.sqrt(APPROACH / RADIUS)  # Johnson (1985), 4.24
    assert abs(float(result.peak_pressure) - peak) < float(result.peak_pressure_error)


def test_between_free_ends_it_is_the_approach_of_the_load() -> None:
    pressed = solve(SHORT, stresses=False, accuracy=0.1)
    loaded = replace(SHORT, approach=None, load=float(pressed.normal_load))
    other = solve(loaded, stresses=False, accuracy=0.1)
    assert float(pressed.approach) == SHORT.approach
    assert float(other.approach) == pytest.approx(SHORT.approach, rel=1e-3)
    assert float(pressed.peak_pressure) == pytest.approx(float(other.peak_pressure), rel=0.01)
    assert float(pressed.hertz_half_width) == pytest.approx(loaded.hertz_half_width)
    assert "normal_load_error" not in other


def test_tractions_are_found_at_the_approach() -> None:
    rolling = replace(BALL, friction=0.1, motion=Rolling(longitudinal_creepage=5e-4))
    result = solve(rolling, stresses=False, accuracy=0.1)
    assert float(result.approach) == APPROACH
    assert float(result.normal_load) == pytest.approx(HERTZ, rel=5e-3)
    assert 0 < abs(float(result.force_y)) < 0.1 * float(result.normal_load)
    assert "normal_load_error" in result


def test_given_cells_and_rough_surfaces_take_it_too() -> None:
    cells = Grid((0.2e-3, 0.6e-3), (-0.2e-3, 0.2e-3), 64, 64)
    assert float(solve(BALL, cells, stresses=False).normal_load) == pytest.approx(HERTZ, rel=0.02)
    flat = xr.DataArray(np.zeros((2, 2)), dims=("x", "y"), coords={"x": [-1e-2, 1e-2], "y": [-1e-2, 1e-2]})
    straight = replace(SHORT, body=HalfSpace(material=STEEL), tilt=0.0, coupled=False)
    smooth = solve(straight, stresses=False, accuracy=0.1)
    assert float(solve(straight, roughness=flat, stresses=False).normal_load) == pytest.approx(
        float(smooth.normal_load), rel=0.02
    )


def test_a_far_first_guess_is_corrected() -> None:
    """A steep crown carries a hundredth of what its slices as line contacts would."""
    steep = replace(BALL, roller=replace(BALL.roller, radius=0.5, profile=profiles.FullCrown(crown_radius=1e-3)))
    found = settled_at_approach(steep, 0.1, 1e-4)
    assert found.settled.contact.approach == APPROACH


def test_results_keep_what_was_asked_and_what_needs_a_load_says_so() -> None:
    result = solve(BALL, stresses=False, accuracy=0.1)
    case = solved_case(result)
    assert case == BALL
    assert "approach = 2 µm" in repr(case)
    assert "approach" in case._repr_html_()
    with pytest.raises(InvalidInputError, match="give load = normal_load of its result"):
        _ = BALL.hertz_half_width
