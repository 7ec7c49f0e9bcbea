"""Load at a prescribed approach and its error, against Hertz."""

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
    report,
    solve,
)
from contactstudy.analysis import solved_case
from contactstudy.case.case import MIN_HALF_WIDTH
from contactstudy.case.case import Case as AnyCase
from contactstudy.contact.refinement import refined_contact
from contactstudy.contact.refinement.refined_contact import (
    LOAD_EXCESS,
    SLICE_WIDTH,
    RefinedContact,
    _slice_load,
    contact_at_approach,
    refine_contact,
    search_load,
)

STEEL = Material(210e9, 0.3)
RADIUS, APPROACH = 5e-3, 2e-6
BALL = Case(
    body=HalfSpace(material=STEEL),
    roller=Roller(radius=RADIUS, length=0.8e-3, profile=profiles.FullCrown(crown_radius=RADIUS)),
    approach=APPROACH,
)
HERTZ_LOAD = 4 / 3 * STEEL.plane_strain_modulus * np.sqrt(RADIUS) * APPROACH**1.5  # Johnson (1985), eq. 4.23
SHORT_CASE = Case(
    body=FiniteLengthSpace(length=0.3e-3, material=STEEL),
    roller=Roller(radius=RADIUS, length=0.3e-3, profile=profiles.FullCrown(crown_radius=0.1)),
    approach=1.5e-6,
    tilt=5e-4,
    friction=0.2,
    coupled=True,
)


def test_ball_carries_hertz_load() -> None:
    result = solve(BALL, stresses=False)
    assert abs(float(result.normal_load) - HERTZ_LOAD) < float(result.normal_load_error) < 2e-3 * HERTZ_LOAD
    assert float(result.approach) == APPROACH
    assert bool(result.converged)
    peak = 2 * STEEL.plane_strain_modulus / np.pi * np.sqrt(APPROACH / RADIUS)  # Johnson (1985), eq. 4.24
    assert abs(float(result.peak_pressure) - peak) < float(result.peak_pressure_error)


@pytest.mark.slow
def test_approach_between_free_ends_reproduces_load() -> None:
    approach_result = solve(SHORT_CASE, stresses=False, accuracy=0.1)
    loaded_case = replace(SHORT_CASE, approach=None, load=float(approach_result.normal_load))
    load_result = solve(loaded_case, stresses=False, accuracy=0.1)
    assert float(approach_result.approach) == SHORT_CASE.approach
    assert float(load_result.approach) == pytest.approx(SHORT_CASE.approach, rel=1e-3)
    assert float(approach_result.peak_pressure) == pytest.approx(float(load_result.peak_pressure), rel=0.01)
    assert float(approach_result.hertz_half_width) == pytest.approx(loaded_case.hertz_half_width)
    assert "normal_load_error" not in load_result


def test_tractions_at_prescribed_approach() -> None:
    rolling_case = replace(BALL, friction=0.1, motion=Rolling(longitudinal_creepage=5e-4))
    result = solve(rolling_case, stresses=False, accuracy=0.1)
    assert float(result.approach) == APPROACH
    assert float(result.normal_load) == pytest.approx(HERTZ_LOAD, rel=5e-3)
    assert 0 < abs(float(result.force_y)) < 0.1 * float(result.normal_load)
    assert "normal_load_error" in result


def test_approach_on_given_cells_and_rough_surfaces() -> None:
    cells = Grid(x_range=(0.2e-3, 0.6e-3), y_range=(-0.2e-3, 0.2e-3), cells_x=64, cells_y=64)
    assert float(solve(BALL, cells, stresses=False).normal_load) == pytest.approx(HERTZ_LOAD, rel=0.02)
    flat_heights = xr.DataArray(np.zeros((2, 2)), dims=("x", "y"), coords={"x": [-1e-2, 1e-2], "y": [-1e-2, 1e-2]})
    untilted_case = replace(SHORT_CASE, body=HalfSpace(material=STEEL), tilt=0.0, coupled=False)
    untilted_result = solve(untilted_case, stresses=False, accuracy=0.1)
    assert float(solve(untilted_case, roughness=flat_heights, stresses=False).normal_load) == pytest.approx(
        float(untilted_result.normal_load), rel=0.02
    )


def test_load_search_converges_from_distant_initial_load() -> None:
    """The load of a steep crown is a hundredth of the sum over line contacts of its slices."""
    steep_case = replace(BALL, roller=replace(BALL.roller, radius=0.5, profile=profiles.FullCrown(crown_radius=1e-3)))
    computed = contact_at_approach(steep_case, 0.1, 1e-4)
    assert computed.contact.approach == APPROACH


def test_result_keeps_approach_and_requires_load() -> None:
    result = solve(BALL, stresses=False, accuracy=0.1)
    case = solved_case(result)
    assert case == BALL
    assert "approach = 2 µm" in repr(case)
    assert "approach" in report.case_table(case)._repr_html_()
    with pytest.raises(InvalidInputError, match="give load = normal_load of its result"):
        _ = BALL.hertz_half_width


CYLINDER = Case(
    body=FiniteLengthSpace(length=5e-3, material=STEEL),
    roller=Roller(radius=RADIUS, length=2e-3),
    end_distance=1.5e-3,
    approach=3e-6,
)


def test_slice_load_sums_hertz_line_contacts() -> None:
    """A slice at depth d carries ``pi E* b**2 / 4 R`` with b proportional to ``sqrt(2 R d)``: it is linear in d."""
    load_factor = np.pi / 2 * SLICE_WIDTH**2 * STEEL.plane_strain_modulus
    assert _slice_load(CYLINDER) == pytest.approx(load_factor * 3e-6 * 2e-3)
    start, stop = BALL.contact_range
    x = np.linspace(start, stop, 20001)
    depth = np.maximum(APPROACH - (RADIUS - np.sqrt(RADIUS**2 - (x - 0.5 * (start + stop)) ** 2)), 0.0)
    assert _slice_load(BALL) == pytest.approx(load_factor * depth.mean() * (stop - start), rel=0.01)
    # If no slice touches, the initial load is the least load of a case.
    tilted_case = replace(BALL, body=FiniteLengthSpace(length=2e-3, material=STEEL), end_distance=0.6e-3, tilt=4e-4)
    min_load = _slice_load(replace(tilted_case, approach=tilted_case.first_touch + 1e-11))
    assert replace(BALL, approach=None, load=min_load).hertz_half_width == pytest.approx(2 * MIN_HALF_WIDTH * RADIUS)


@pytest.mark.parametrize(("case", "max_loads"), [(BALL, 4), (replace(SHORT_CASE, friction=0.0, coupled=False), 5)])
def test_load_search_needs_few_loads(case: Case, max_loads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    attempts: list[float] = []

    def record_load(loaded_case: AnyCase, accuracy: float, tolerance: float) -> RefinedContact:
        attempts.append(loaded_case.normal_load)
        return refine_contact(loaded_case, accuracy, tolerance)

    monkeypatch.setattr(refined_contact, "refine_contact", record_load)
    contact_at_approach(case, 0.1, 1e-4)
    assert len(attempts) <= max_loads


def test_load_search_fits_power_of_depth(monkeypatch: pytest.MonkeyPatch) -> None:
    """The depth of the contact is a power of the load, as for a ball."""
    contact_at_load = refine_contact(replace(BALL, approach=None, load=HERTZ_LOAD), 0.1, 1e-4)
    attempts: list[float] = []

    def make_power_law_contact(loaded_case: AnyCase, accuracy: float, tolerance: float) -> RefinedContact:
        attempts.append(loaded_case.normal_load)
        first_touch = float(contact_at_load.contact.shape.gap.values.min())
        depth = (APPROACH - first_touch) * (loaded_case.normal_load / HERTZ_LOAD) ** (2 / 3)
        return replace(contact_at_load, contact=replace(contact_at_load.contact, approach=first_touch + depth))

    monkeypatch.setattr(refined_contact, "refine_contact", make_power_law_contact)
    search_load(BALL, APPROACH, 0.2 * HERTZ_LOAD, 0.1, 1e-4)
    load_factors = np.array(attempts) / HERTZ_LOAD
    assert load_factors[:2] == pytest.approx([0.2, 0.2 * LOAD_EXCESS * (0.2 ** (-2 / 3)) ** 1.2])
    assert load_factors[2:] == pytest.approx([LOAD_EXCESS])
    attempts.clear()
    search_load(BALL, APPROACH, 1.06 * HERTZ_LOAD, 0.1, 1e-4)
    assert len(attempts) == 1
