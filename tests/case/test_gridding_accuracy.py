"""Defaults of study parameters against those of `solve`."""

from __future__ import annotations

import inspect

import pytest

from contactstudy import solve
from contactstudy.case.gridding import ACCURACY
from contactstudy.study.parameters import PARAMETERS


@pytest.mark.parametrize("name", ["tolerance", "stresses"])
def test_parameter_default_equals_default_of_solve(name: str) -> None:
    assert PARAMETERS[name].default == inspect.signature(solve).parameters[name].default


def test_documented_accuracy_is_default() -> None:
    assert inspect.signature(solve).parameters["accuracy"].default is None
    assert f"default {ACCURACY:g}" in (solve.__doc__ or "")
