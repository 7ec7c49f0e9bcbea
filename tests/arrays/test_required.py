"""What a missing variable is reported as."""

from __future__ import annotations

import pytest
import xarray as xr

from contactstudy import InvalidInputError
from contactstudy.arrays.required import require


@pytest.mark.parametrize(
    ("missing", "hint"),
    [
        ("tau_yz", "tau_yz is missing; a study keeps it at level 'fields'"),
        ("pressure", "pressure is missing; a study keeps it at level 'surface'"),
        ("hertz_half_width", "hertz_half_width is missing"),
        ("luck", "luck is missing"),
    ],
)
def test_the_level_of_a_study_that_keeps_a_missing_variable_is_named(missing: str, hint: str) -> None:
    with pytest.raises(InvalidInputError) as caught:
        require(xr.Dataset({"gap": 0.0}), "gap", missing, argument="result")
    assert caught.value.hint == hint
    assert str(caught.value).startswith("result = ['gap']")


def test_a_case_that_failed_says_why() -> None:
    failed = xr.Dataset({"status": "failed", "message": "too narrow"})
    with pytest.raises(InvalidInputError, match=r"a failed case.*too narrow"):
        require(failed, "pressure")


def test_anything_else_is_no_dataset() -> None:
    with pytest.raises(InvalidInputError, match=r"list.*Dataset"):
        require([], argument="result")
