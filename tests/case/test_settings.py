"""The settings of studies equal those of the solver."""

from __future__ import annotations

import inspect

from contactstudy import solve
from contactstudy.case.gridding import ACCURACY, solver_settings


def test_defaults_equal_the_solver() -> None:
    settings, solver = (inspect.signature(function).parameters for function in (solver_settings, solve))
    assert all(solver[name].default == entry.default for name, entry in settings.items())
    assert solver["accuracy"].default is None
    assert f"default {ACCURACY:g}" in (solve.__doc__ or "")
