"""A study for the page: pressures, profiles by name, and two frictions, one of which fails."""

from __future__ import annotations

import socket
from importlib.util import find_spec
from pathlib import Path

import pytest

from contactstudy.study import run_study
from tests.small_study import BASE, small_study
from tests.stand_in_solver import FAILS, solve_fake

needs_panel = pytest.mark.skipif(find_spec("panel") is None, reason="the extra `explore` is not installed")

SWEEP = {
    "max_pressure": [1.0e9, 1.25e9, 1.5e9],
    "friction": [0.0, FAILS],
    "profile": ["cylinder", {"kind": "cylinder", "fillet_radius": 1e-4, "name": "rounded"}],
}


def find_free_port() -> int:
    """Port without a server."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("looked-at")
    base = {name: value for name, value in BASE.items() if name != "max_pressure"} | {"e_over_a": 1.0}
    base["field_y_over_a"] = [-1.0, 0.0, 1.0]
    run_study(small_study(base=base, sweep=SWEEP), folder, workers=0, solver=solve_fake, progress=False)
    return folder
