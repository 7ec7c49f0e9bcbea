"""A result and the case that it was solved for: told apart by their values, whatever prescribes the load."""

from __future__ import annotations

from dataclasses import replace

import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, HalfSpace, InvalidInputError, Material, Roller, profiles
from contactstudy.analysis import solved_case
from contactstudy.analysis.provenance import check_solved_for, with_provenance

STEEL = Material(210e9, 0.3)
CASE = Case(
    body=FiniteLengthSpace(length=0.6e-3, material=STEEL),
    roller=Roller(radius=5e-3, length=0.4e-3, profile=profiles.Lundberg(2e-7)),
    max_pressure=1.5e9,
    friction=0.05,
)


@pytest.fixture
def result() -> xr.Dataset:
    return with_provenance(xr.Dataset(), CASE, {}, {})


@pytest.mark.parametrize(
    "given",
    [
        CASE,
        CASE.body,
        replace(CASE, end_distance=0.1e-3),
        replace(CASE, max_pressure=None, load=CASE.normal_load),
    ],
)
def test_the_same_case_in_other_words_is_taken(result: xr.Dataset, given) -> None:
    check_solved_for(result, given)
    check_solved_for(xr.Dataset(), given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (replace(CASE, friction=0.1), r"solved with friction = 0.05.*of the case that is given, friction = 0.1"),
        (replace(CASE, max_pressure=1.4e9), r"max_pressure = 1.5e\+09.*max_pressure = 1.4e\+09"),
        (replace(CASE, end_distance=0.0), r"end_distance = 0.0001.*end_distance = 0"),
        (replace(CASE, roller=replace(CASE.roller, radius=6e-3)), r"roller.radius = 0.005.*roller.radius = 0.006"),
        (
            replace(CASE, roller=replace(CASE.roller, profile=profiles.Lundberg(3e-7))),
            r"roller.profile.amplitude = 2e-07.*roller.profile.amplitude = 3e-07",
        ),
        (FiniteLengthSpace(length=0.5e-3, material=STEEL), r"body.length = 0.0006.*of the body that is given"),
        (HalfSpace(material=STEEL), r"body.kind = FiniteLengthSpace.*body.kind = HalfSpace"),
    ],
)
def test_another_case_is_refused_by_what_differs(result: xr.Dataset, given, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        check_solved_for(result, given)


def test_parts_alone_may_have_to_agree(result: xr.Dataset) -> None:
    check_solved_for(result, replace(CASE, friction=0.1, max_pressure=1e9), only=("body", "roller"))


def test_a_case_of_an_opened_study_says_where_it_stands(opened: xr.Dataset) -> None:
    one = opened.isel(e_over_a=0, friction=0, body=0)
    with pytest.raises(InvalidInputError, match=rf"under cases, says it.*{one.case_id.item()[:8]}"):
        solved_case(one)
    with pytest.raises(InvalidInputError, match=r"as case_id does$"):
        solved_case(opened)
