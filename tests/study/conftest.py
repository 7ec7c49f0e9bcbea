"""Small studies of the tests of the study layer."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from contactstudy.study import Study
from contactstudy.study.batches import batch_paths, find_damage
from contactstudy.study.folder import Folder
from contactstudy.study.plan import PlannedCase
from tests.small_study import format_toml, small_study
from tests.stand_in_solver import HELD, give_tickets

ROOT = Path(__file__).parents[2]


def locate_tickets(folder: Path) -> Path:
    """Folder of the tickets of a run that writes to `folder`."""
    return folder.with_name(f"{folder.name}-tickets")


def start_run(
    study: Path, folder: Path, *options: str, tickets: int, prefix: Sequence[str] = ()
) -> subprocess.Popen[str]:
    """Start the command in a new process group; the stand-in solver solves `tickets` cases and then waits.

    `prefix` precedes the command, for example a command of a container.
    """
    initial_tickets = locate_tickets(folder)
    give_tickets(initial_tickets, tickets)
    command = [sys.executable, "-m", "tests.study.fake_run", "run", str(study), "--out", str(folder), "--no-figure"]
    return subprocess.Popen(
        [*prefix, *command, *options],
        cwd=ROOT,
        start_new_session=True,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=os.environ | {HELD: str(initial_tickets)},
    )


def count_finished(folder: Path) -> int:
    """Number of cases in the written batches of a folder."""
    return len(Folder(folder).results().cases)


def has_intact_batches(folder: Path) -> bool:
    """Whether every batch of a folder has its checksum."""
    return not any(find_damage(path) for path in batch_paths(folder / "batches"))


@pytest.fixture
def study() -> Study:
    return small_study()


@pytest.fixture
def study_file(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(format_toml(small_study()))
    return path


def make_planned_case(index, parameters=None):
    """A planned case outside a plan."""
    return PlannedCase(
        index=index,
        id=f"{index:064x}",
        parameters=parameters or {},
        name=f"case {index}",
        position=(index,),
        group=index,
    )
