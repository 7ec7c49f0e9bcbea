import re

import numpy as np
import pytest

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    InvalidInputError,
    Material,
    Roller,
    choose_grid,
    profiles,
    solve,
)
from contactstudy.analysis.discretisation import discretisation_error, extrapolated

STEEL = Material(210e9, 0.3)
HALF_WIDTH = 65e-6
BODY = FiniteLengthSpace(length=8 * HALF_WIDTH, material=STEEL)
PRESSURE = 1.5e9
LUNDBERG = profiles.Lundberg.for_pressure(PRESSURE, radius=5e-3, modulus=STEEL.plane_strain_modulus)


def case_of(length: float, profile: profiles.Profile) -> Case:
    return Case(body=BODY, roller=Roller(radius=5e-3, length=length, profile=profile), max_pressure=PRESSURE)


def solved(case: Case, cells: int):
    window = 2 * case.hertz_half_width
    return solve(case, Grid((0.0, BODY.length), (-window, window), cells, cells), stresses=False)


@pytest.mark.parametrize(
    "case",
    [case_of(8 * HALF_WIDTH, profiles.Cylinder()), case_of(7 * HALF_WIDTH, LUNDBERG)],
    ids=["flush cylinder", "Lundberg"],
)
def test_estimates_bound_the_difference_from_a_much_finer_grid(case):
    coarse, fine, finest = (solved(case, cells) for cells in (32, 64, 192))
    estimate, reference = discretisation_error(fine, coarse), discretisation_error(finest, fine)
    for name in ("peak_pressure", "end_pressure_first", "end_pressure_last", "half_width_middle"):
        difference = abs(float(estimate[name]) - float(reference[name]))
        assert difference <= float(estimate[f"{name}_error"]), name
        assert float(estimate[f"{name}_error"]) <= 0.06 * max(float(reference[name]), 1.0)


def test_symmetric_contacts_have_equal_ends():
    case = case_of(8 * HALF_WIDTH, profiles.Cylinder())
    result = discretisation_error(solved(case, 32), solved(case, 16))
    assert float(result.end_pressure_first) == pytest.approx(float(result.end_pressure_last), rel=1e-6)


def test_a_sharp_end_has_no_limit_and_says_so():
    case = case_of(5 * HALF_WIDTH, profiles.Cylinder())
    result = discretisation_error(solved(case, 64), solved(case, 32))
    for name in ("peak_pressure_error", "end_pressure_first_error", "end_pressure_last_error"):
        assert np.isinf(float(result[name]))
        assert "ends sharply" in result[name].attrs["comment"]
        assert "leave the grid out" in result[name].attrs["comment"]
    assert np.isfinite(float(result.half_width_middle_error))


def test_a_profile_that_ends_the_contact_has_no_end_pressure():
    case = case_of(7 * HALF_WIDTH, LUNDBERG)
    result = discretisation_error(solved(case, 64), solved(case, 32))
    assert float(result.end_pressure_first) == float(result.end_pressure_first_error) == 0.0


def test_the_fine_grid_must_be_finer():
    contact = solved(case_of(8 * HALF_WIDTH, profiles.Cylinder()), 16)
    with pytest.raises(InvalidInputError, match="coarse"):
        discretisation_error(contact, contact)


def test_richardson_removes_the_leading_error():
    for order, ratio in ((1, 2.0), (2, 2.0), (1.5, 3.0)):
        coarse, fine = (7.0 + 0.3 * step**order for step in (ratio, 1.0))
        assert extrapolated(coarse, fine, order, ratio) == pytest.approx(7.0, abs=1e-13)


@pytest.mark.parametrize("arguments", [(np.nan, 1, 1, 2), (1, 1, 0, 2), (1, 1, 1, 1)])
def test_richardson_refuses_what_says_nothing(arguments):
    with pytest.raises(InvalidInputError):
        extrapolated(*arguments)


def test_a_peak_away_from_a_sharp_end_has_a_limit():
    crowned = case_of(4 * HALF_WIDTH, profiles.FullCrown(0.015))
    result = discretisation_error(solved(crowned, 64), solved(crowned, 32))
    assert float(result.end_pressure_first) > 0
    assert np.isinf(float(result.end_pressure_first_error))
    assert float(result.peak_pressure_error) < 0.02 * float(result.peak_pressure)


@pytest.mark.parametrize("case", [case_of(5 * HALF_WIDTH, profiles.Cylinder()), case_of(8 * HALF_WIDTH, LUNDBERG)])
def test_no_end_pressure_is_above_the_peak(case):
    result = discretisation_error(solved(case, 64), solved(case, 32))
    ends = [float(result[f"end_pressure_{end}"]) for end in ("first", "last")]
    assert float(result.peak_pressure) >= max(ends)


@pytest.mark.parametrize("poisson", [-0.5, -0.2])
def test_a_peak_at_a_free_end_is_that_of_the_end(poisson):
    """A material that shrinks across when it is pressed is stiffer at its free end: the pressure rises to it."""
    body = FiniteLengthSpace(length=8 * HALF_WIDTH, material=Material(210e9, poisson))
    case = Case(body=body, roller=Roller(radius=5e-3, length=8 * HALF_WIDTH), max_pressure=PRESSURE)
    coarse, fine, finest = (solved(case, cells) for cells in (24, 48, 96))
    estimate, reference = discretisation_error(fine, coarse), discretisation_error(finest, fine)
    for found in (estimate, reference):
        assert float(found.peak_pressure) == float(max(found.end_pressure_first, found.end_pressure_last))
    difference = abs(float(estimate.peak_pressure) - float(reference.peak_pressure))
    assert difference <= float(estimate.peak_pressure_error) <= 0.1 * float(reference.peak_pressure)


def test_cells_that_are_too_coarse_are_told_what_to_try():
    steep = case_of(8 * HALF_WIDTH, profiles.Cylinder(fillet_radius=0.05e-3))
    grid = choose_grid(steep, cells_x=4, cells_y=8)
    result = solve(steep, grid, error_estimate=True, stresses=False)
    comment = result.peak_pressure_error.attrs["comment"]
    assert np.isinf(float(result.peak_pressure_error))
    assert comment.startswith(f"no limit in sight on {grid.shape[0]} x {grid.shape[1]} cells: leave the grid out")
    numbers = re.search(r"choose_grid\(case, cells_x=([\d.]+), cells_y=([\d.]+)\)", comment)
    finer = choose_grid(steep, cells_x=float(numbers[1]), cells_y=float(numbers[2]))
    assert finer.shape == pytest.approx([2 * count for count in grid.shape], rel=0.1)
    foreign = [each.drop_vars("hertz_half_width") for each in (solved(steep, 32), solved(steep, 16))]
    assert "take twice as many" in discretisation_error(*foreign).peak_pressure_error.attrs["comment"]
