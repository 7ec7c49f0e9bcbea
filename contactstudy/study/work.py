"""What a worker does: solve one case, write its file, hand back a small record."""

from __future__ import annotations

import contextlib
import subprocess
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contactstudy.analysis.provenance import RUN_ATTRIBUTE, attribute
from contactstudy.analysis.summary import summarize
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import named
from contactstudy.case.gridding import first_that_holds
from contactstudy.errors import ContactStudyError
from contactstudy.study import own_profiles
from contactstudy.study.errors import StoreError
from contactstudy.study.folder import Folder
from contactstudy.study.setup import Setup, build_setup
from contactstudy.study.store import Header, write_case
from contactstudy.versions import versions

Solver = Callable[..., xr.Dataset]
"""What solves a case: called as :func:`contactstudy.solve`."""


@dataclass(frozen=True)
class Job:
    """One case to solve: all that a worker needs to know.

    Parameters
    ----------
    id, name : str
        Identity, and swept parameters in words.
    parameters : dict
        Checked parameters without defaults.
    folder : str
        The study's folder, which every worker can reach.
    level : str
        What to keep.
    operator : str
        Equal for jobs that share the solver's preparation.
    cost : float
        Expected effort.
    study : str
        Name of the study, for the file.
    own_profiles : mapping
        Pickles of the user's own profiles, by their content.
    """

    id: str
    name: str
    parameters: dict[str, Any]
    folder: str
    level: str
    operator: str = ""
    cost: float = 1.0
    study: str = ""
    own_profiles: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Record:
    """What became of a job: `status` is "ok" or "failed"; `error` and `message` say why it failed."""

    id: str
    status: str
    seconds: float
    path: str = ""
    error: str = ""
    message: str = ""
    scalars: dict[str, float] = field(default_factory=dict)
    run: dict[str, Any] = field(default_factory=dict)


@cache
def circumstances() -> dict[str, Any]:
    """Versions and commit with which this process solves cases, for the files."""
    found: dict[str, Any] = {**versions()}
    here = Path(__file__)
    try:
        # Only a checkout that tracks this very file is the package's own repository.
        tracked = ["git", "-C", str(here.parent), "ls-files", "--error-unmatch", here.name]
        subprocess.run(tracked, capture_output=True, check=True, timeout=10)
        commit = subprocess.run(
            ["git", "-C", str(here.parent), "describe", "--always", "--dirty", "--abbrev=40"],
            capture_output=True,
            check=True,
            timeout=10,
            text=True,
        )
        found["commit"] = commit.stdout.strip()
    except (OSError, subprocess.SubprocessError):
        pass
    return found


@contextlib.contextmanager
def single_threaded() -> Iterator[None]:
    """Keep linear algebra and transforms to one thread: the cores are shared out by cases.

    It also makes results the same in every process, because the order of sums does not depend on the threads.
    """
    import pyfftw
    from threadpoolctl import threadpool_limits

    previous, pyfftw.config.NUM_THREADS = pyfftw.config.NUM_THREADS, 1
    try:
        with threadpool_limits(limits=1):
            yield
    finally:
        pyfftw.config.NUM_THREADS = previous


def _solve_on(solver: Solver, setup: Setup, grid: Grid | None) -> xr.Dataset:
    """Solve a case on one of its grids."""
    return solver(setup.case, grid, **setup.options)


def differences(worker: Mapping[str, Any]) -> str:
    """Return in words how a worker's versions differ from those of this process; empty if they do not.

    Examples
    --------
    >>> differences(circumstances() | {"numpy": "0.1"}).startswith("numpy 0.1 instead of ")
    True
    """
    own = circumstances()
    return ", ".join(
        f"{name} {worker.get(name, 'unknown')} instead of {value}"
        for name, value in own.items()
        if worker.get(name) != value
    )


def perform(job: Job, solver: Solver | None = None) -> Record:
    """Solve a case, write its file and return the record.

    Parameters
    ----------
    job : Job
        The case.
    solver : callable, optional
        Called as :func:`contactstudy.solve`, which is the default.

    Returns
    -------
    Record
        With status "failed" if the case raised an error of the package, or asked for more memory than there is or for
        a solution that does not exist; other errors are errors of the program and pass through.

    Raises
    ------
    StoreError
        If the file cannot be written.
    """
    # Who only looks at a study, or plans one, does not wait for the solver to be imported.
    from contactstudy.fatigue.shakedown import shakedown_summary
    from contactstudy.solution import solve

    folder = Folder(job.folder)
    began = time.perf_counter()
    try:
        with single_threaded(), warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            own_profiles.receive(job.own_profiles)
            setup = build_setup(job.parameters)
            solve_on = partial(_solve_on, solver or solve, setup)
            dataset = first_that_holds(setup.grids, solve_on)
            scalars = summarize(dataset).assign(shakedown_summary(dataset).data_vars)
    except StoreError:
        raise
    except (ContactStudyError, MemoryError, np.linalg.LinAlgError) as error:
        return Record(job.id, "failed", time.perf_counter() - began, error=type(error).__name__, message=str(error))
    seconds = time.perf_counter() - began
    scalars["seconds"] = named("seconds", xr.DataArray(seconds))
    run = {
        **circumstances(),
        "study": job.study,
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "settings": {"tolerance": setup.options["tolerance"], "cells": tuple(dataset.sizes[axis] for axis in "xy")},
        "warnings": sorted({str(warning.message) for warning in caught}),
        "seconds": seconds,
        "stages": attribute(dataset, RUN_ATTRIBUTE).get("stages", {}),
        "level": job.level,
    }
    path = folder.case_path(job.id)
    scalar_values = {str(name): float(value) for name, value in scalars.data_vars.items()}
    write_case(path, dataset.assign(scalars.data_vars), job.level, Header(job.id, job.parameters, run, scalar_values))
    return Record(job.id, "ok", seconds, str(path), scalars=scalar_values, run=run)
