"""Work of one process: solve a task, group by group, and write the finished cases in batches."""

from __future__ import annotations

import contextlib
import json
import pickle
import socket
import subprocess
import time
import uuid
import warnings
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cache
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from contactstudy.analysis.contact import case_numbers
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import DERIVED
from contactstudy.case.gridding import solve_in_first_window
from contactstudy.errors import ContactStudyError, MagnitudeWarning, StoreError
from contactstudy.profiles import Profile
from contactstudy.study.batches import Batch, add_arrays, join_batches, write_batch
from contactstudy.study.case_setup import Setup, build_setup
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.plan import PlannedCase
from contactstudy.study.profile_tables import REGISTRY
from contactstudy.study.settings import RUN
from contactstudy.versions import versions

Solver = Callable[..., xr.Dataset]  # Callable with the arguments and the result of :func:`contactstudy.solve`
Record = tuple[str, str, str]  # Identity, status and message of a finished case


@dataclass(frozen=True, kw_only=True)
class Task:
    """Groups of cases that one worker solves in order."""

    cases: tuple[PlannedCase, ...]  # group by group
    folder: str  # folder of the batches, on a file system of all workers
    # path and text of the run's lock: a worker that reads another text has another file system
    lock: tuple[str, str] = ("", "")
    prefix: str = ""  # start of the names of the batches
    level: str = "summary"  # arrays to retain
    study: str = ""
    run: int = 0
    profiles: Mapping[str, Profile] = field(default_factory=dict)  # profiles of users' classes, by content


class Outcome(NamedTuple):
    """Outcome of one case: a status from `STATUSES`, and the reason of a failure."""

    case: PlannedCase
    status: str
    message: str = ""
    stored: bool = True  # whether the worker stored the case


@cache
def run_context() -> dict[str, Any]:
    """Versions and commit of this process."""
    context: dict[str, Any] = {**versions()}
    source = Path(__file__)
    git = ["git", "-C", str(source.parent)]
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        # The commit is the package's only if the checkout tracks this file.
        subprocess.run([*git, "ls-files", "--error-unmatch", source.name], capture_output=True, check=True, timeout=10)
        describe_command = [*git, "describe", "--always", "--dirty", "--abbrev=40"]
        commit = subprocess.run(describe_command, capture_output=True, check=True, timeout=10, text=True)
        context["commit"] = commit.stdout.strip()
    return context


@contextlib.contextmanager
def single_threaded() -> Iterator[None]:
    """Limit linear algebra and transforms to one thread, so that the order of sums is the same in every process."""
    import pyfftw
    from threadpoolctl import threadpool_limits

    previous_count, pyfftw.config.NUM_THREADS = pyfftw.config.NUM_THREADS, 1
    try:
        with threadpool_limits(limits=1):
            yield
    finally:
        pyfftw.config.NUM_THREADS = previous_count


def solve_compressed_task(task_and_solver: bytes) -> list[Record]:
    """Solve a compressed task: a scheduler stores 70 bytes per case, instead of 1500 for objects."""
    return solve_task(*pickle.loads(zlib.decompress(task_and_solver)))


def solve_task(task: Task, solver: Solver | None = None) -> list[Record]:
    """Solve the cases of a task, write them in batches, return their records; defects of the program are raised."""
    path, expected_lock = task.lock
    try:
        lock = Path(path).read_text(encoding="utf-8") if path else ""
    except (OSError, ValueError) as error:
        lock = f"{type(error).__name__}: {error}"
    if lock != expected_lock:
        host = socket.gethostname()
        raise StoreError(f"a worker on {host} reads {lock[:200]!r} at {path}, not this run's lock; share the folder")
    REGISTRY.update(task.profiles)
    unsaved_batches: list[Batch] = []
    records: list[Record] = []

    def write_unsaved() -> None:
        batches = sorted(unsaved_batches, key=attrgetter("structure"))
        unsaved_batches.clear()
        for _, group in groupby(batches, key=attrgetter("structure")):
            batch = join_batches(list(group))
            write_batch(Path(task.folder), f"{task.prefix}{uuid.uuid4().hex[:12]}", batch)
            records.extend(batch.cases[["status", "message"]].itertuples(name=None))

    last_save = time.monotonic()
    try:
        with single_threaded():
            for _, cases in groupby(task.cases, key=lambda case: case.group):
                for batch in _solve_group(task, list(cases), solver):
                    unsaved_batches.append(batch)
                    is_full = bool(batch.arrays) and sum(entry.nbytes for entry in unsaved_batches) > RUN.buffer_bytes
                    if is_full or time.monotonic() - last_save > RUN.save_seconds:
                        write_unsaved()
                        last_save = time.monotonic()
    except StoreError:
        raise
    except BaseException:
        write_unsaved()
        raise
    write_unsaved()
    return records


def _solve_group(task: Task, cases: list[PlannedCase], solver: Solver | None) -> Iterator[Batch]:
    """Solve the cases of a group; without stresses one solution serves all values of uncoupled friction."""
    shares_contact = solver is None and len(cases) > 1 and task.level == "summary"
    shared_batch: Batch | None = None
    film: xr.Dataset | None = None
    # Frictionless cases last: the stresses of pressure, which all cases share, are evaluated with those of traction.
    for case in sorted(cases, key=lambda case: case.parameters.get("friction", 0.0) == 0.0):
        start_time = time.perf_counter()
        try:
            setup = build_setup(case.parameters)
        except ContactStudyError as error:
            yield batch_of_case(task, case, "skipped", str(error))
            continue
        if shared_batch is None:
            batch, result = _solve_case(task, case, setup, solver, film)
            if setup.case.lubricant is not None:
                film = result
            elif shares_contact and result is not None and setup.grid is None and not setup.options["stresses"]:
                shared_batch = batch
        else:
            row = shared_batch.cases.set_axis([case.id]).assign(parameters=json.dumps(case.parameters))
            batch = replace(shared_batch, cases=row)
        batch.cases["seconds"] = time.perf_counter() - start_time
        yield batch


def batch_of_case(
    task: Task,
    case: PlannedCase,
    status: str,
    message: str = "",
    *,
    warnings_of_case: Iterable[str] = (),
    numbers: Mapping[Any, xr.Variable] | None = None,
) -> Batch:
    """Batch of one case with its numbers."""
    texts, numbers = sorted(set(warnings_of_case)), numbers or {}
    row = {
        "status": status,
        "run": task.run,
        "parameters": json.dumps(case.parameters),
        "message": message,
        "warnings": json.dumps(texts) if texts else "",
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        **{name: float(number) for name, number in numbers.items()},
    }
    return Batch(
        cases=pd.DataFrame(row, index=[case.id]),
        attributes={name: number.attrs for name, number in numbers.items()},
        run_context={**run_context(), "study": task.study, "level": task.level},
    )


def _solve_case(
    task: Task, case: PlannedCase, setup: Setup, solver: Solver | None, film: xr.Dataset | None
) -> tuple[Batch, xr.Dataset | None]:
    """Solve one case, starting from the film of another speed; the result of a failed case is None."""
    # Planning and opening a study need no solver.
    from contactstudy.fatigue.shakedown import shakedown_summary
    from contactstudy.film.solve import solve_film
    from contactstudy.solution import solve

    def solve_on(grid: Grid | None) -> xr.Dataset:
        if setup.case.lubricant is not None:
            return (solver or solve_film)(setup.case, start=film, **setup.options)
        return (solver or solve)(setup.case, grid, **setup.options)

    try:
        with warnings.catch_warnings(record=True) as caught_warnings:
            warnings.simplefilter("always")
            dataset = solve_in_first_window(setup.grids, solve_on)
            numbers = case_numbers(dataset) | dict(shakedown_summary(dataset).variables)
    except StoreError:
        raise
    except (ContactStudyError, MemoryError, np.linalg.LinAlgError) as error:
        return batch_of_case(task, case, "failed", f"{type(error).__name__}: {error}"), None
    except Exception as error:
        error.add_note(f"while solving the case {case.name} ({case.id[:16]})")
        raise
    e_over_a = setup.e_over_a
    if np.isnan(e_over_a):  # the half-width follows from the solution
        e_over_a = setup.case.roller_start / float(numbers["hertz_half_width"])
    for name, value in (("e_over_a", e_over_a), ("gamma", setup.gamma)):
        numbers[name] = xr.Variable((), float(value), PARAMETERS[name].attrs | {"comment": DERIVED})
    messages = (str(entry.message) for entry in caught_warnings if entry.category is not MagnitudeWarning)
    batch = batch_of_case(task, case, "ok", warnings_of_case=messages, numbers=numbers)
    return add_arrays(batch, dataset, task.level) if task.level != "summary" else batch, dataset
