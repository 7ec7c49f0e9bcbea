"""The settings of studies equal those of the solver."""

from __future__ import annotations

import inspect

import pytest

from contactstudy import solve
from contactstudy.case.gridding import ACCURACY
from contactstudy.study.parameters import PARAMETERS


@pytest.mark.parametrize("name", ["tolerance", "stresses"])
def test_defaults_equal_the_solver(name: str) -> None:
    assert PARAMETERS[name].default == inspect.signature(solve).parameters[name].default


def test_documented_accuracy_is_default() -> None:
    assert inspect.signature(solve).parameters["accuracy"].default is None
    assert f"default {ACCURACY:g}" in (solve.__doc__ or "")
