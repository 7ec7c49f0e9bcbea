"""Identities of the cases of studies/, which locate results on disk, and defaults of parameters."""

import hashlib
import inspect

import pytest

from contactstudy.case import choose_grid
from contactstudy.case.case import Case
from contactstudy.case.gridding import WINDOWS, create_widening_grids
from contactstudy.solution import solve
from contactstudy.study import Study
from contactstudy.study.case_setup import build_setup
from contactstudy.study.parameters import PARAMETERS, Parameter, keywords_of
from contactstudy.study.profile_tables import check_number
from tests.small_study import BASE
from tests.study.conftest import ROOT

STORED_IDENTITIES = {
    "edge_effect": (48, "afc89e0b3e7aff3b"),
    "end_distance": (27, "63cb95128676bb57"),
    "friction": (33, "96f92ee20a25bd8e"),
    "gamma": (18, "7cac20daa29f13d6"),
    "profiles": (48, "de4bef948587bafc"),
    "regime_map": (780, "4255edcab9c3fd43"),
}

DEFAULTS = {
    "body": "finite-length",
    "body_edge": {"kind": "cylinder"},
    "model": "exact",
    "friction": 0.0,
    "profile": {"kind": "cylinder"},
    "roller_body": "rigid",
    "tilt": 0.0,
    "coupled": False,
    "motion": "sliding",
    "rolling_model": "exact",
    "cells_x": 8.0,
    "cells_y": 16.0,
    "window": 2.0,
    "margin": 4.0,
    "tolerance": 1e-6,
    "stresses": True,
}


@pytest.mark.parametrize("name", STORED_IDENTITIES)
def test_identities_of_stored_studies_never_change(name):
    cases = Study.from_toml(ROOT / "studies" / f"{name}.toml").plan()
    digest = hashlib.sha256("\n".join(case.id for case in cases).encode()).hexdigest()
    assert (len(cases), digest[:16]) == STORED_IDENTITIES[name]


def test_defaults_match_stored_cases():
    """Defaults come from the signatures of Case, choose_grid and solve: a changed default needs a new SCHEMA."""
    assert {name: entry.default for name, entry in PARAMETERS.items() if entry.default is not None} == DEFAULTS


def test_new_table_entry_adds_parameter(monkeypatch):
    def call_parameter_consumer(case: Case, *, sharpness: float = 0.5) -> None: ...

    new_parameter = Parameter(
        name="sharpness", check=check_number, units="1", meaning="made up", consumer=call_parameter_consumer
    )
    monkeypatch.setitem(PARAMETERS, "sharpness", new_parameter)
    assert new_parameter.default == 0.5
    assert keywords_of(call_parameter_consumer, {"sharpness": 0.7, "friction": 0.1}) == {"sharpness": 0.7}


def test_study_uses_default_grid():
    setup = build_setup(BASE | {"e_over_a": 1.0, "cells_x": None, "cells_y": None})
    assert setup.grid == choose_grid(setup.case)
    assert list(setup.grids) == list(create_widening_grids(setup.case))
    assert len(list(setup.grids)) == len(WINDOWS)
    assert set(setup.options) == {"x", "y", "z", "stresses", "tolerance"}
    assert set(setup.options) <= set(inspect.signature(solve).parameters)


@pytest.mark.parametrize("changes", [{"window": 2.2}, {"margin": 3.0}])
def test_explicit_window_is_kept(changes):
    setup = build_setup(BASE | {"e_over_a": 1.0} | changes)
    assert list(setup.grids) == [setup.grid]
