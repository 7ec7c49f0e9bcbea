import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Grid, InvalidInputError, Material, Roller, profiles, solve
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
        assert "sharp" in result[name].attrs["comment"]
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
