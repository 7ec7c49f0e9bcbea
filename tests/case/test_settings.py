"""The settings that studies know are those of the solver."""

from __future__ import annotations

import inspect

from contactstudy import solve
from contactstudy.case.gridding import ACCURACY, solver_settings


def test_defaults_are_those_of_the_solver() -> None:
    own, solver = (inspect.signature(each).parameters for each in (solver_settings, solve))
    assert all(solver[name].default == entry.default for name, entry in own.items())
    assert solver["accuracy"].default is None
    assert f"default {ACCURACY:g}" in (solve.__doc__ or "")
