"""Running a study: from the plan to batches, on local processes or on a cluster, resumable at any moment."""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

import numpy as np

from contactstudy import checks
from contactstudy.errors import InvalidInputError, StoreError, StudyFileError, Terminated
from contactstudy.study.batches import write_batch
from contactstudy.study.definition import Study
from contactstudy.study.engine import WAIT_SECONDS, Engine, TaskResults, Tasks, execute
from contactstudy.study.folder import UNDIVIDED, Folder, Share, States
from contactstudy.study.plan import Plan, PlannedCase
from contactstudy.study.settings import RUN
from contactstudy.study.worker import Outcome, Solver, Task, batch_of_case

if TYPE_CHECKING:
    from distributed import Client

LOGGER = logging.getLogger(__name__)
MAX_WARNINGS = 5  # Warnings of magnitudes that a run repeats; `plan` lists more
RERUN_STATUSES = ("failed", "stale", "skipped")  # States that can be solved anew


@dataclass(frozen=True)
class RunReport:
    """Result of a run.

    Parameters
    ----------
    folder : Path
        The study's folder.
    states : States
        State of every case of the study after the run.
    solved : int
        Cases solved now, failed ones included.
    remarks : tuple of str
        Messages on the run: damaged batches, workers that could not be used.
    """

    folder: Path
    states: States
    solved: int
    remarks: tuple[str, ...] = ()

    def __repr__(self) -> str:
        cases = f"{len(self.plan)} cases: {self.states.summary}; {self.solved} solved now"
        return f"RunReport({cases}; folder={str(self.folder)!r})"

    @property
    def plan(self) -> Plan:
        """The cases."""
        return self.states.plan

    @property
    def counts(self) -> dict[str, int]:
        """Number of cases of each status."""
        return self.states.counts

    @property
    def unconverged_cases(self) -> list[PlannedCase]:
        """Cases whose contact iteration did not reach its tolerance."""
        return [self.plan[index] for index in np.flatnonzero(self.states.numbers("converged") == 0.0).tolist()]

    @property
    def failures(self) -> list[tuple[PlannedCase, str]]:
        """Failed cases, each with its reason."""
        return [(self.plan[index], self.states.reasons[index]) for index in self.states.indices("failed")]

    @property
    def files(self) -> list[Path]:
        """Batches of the study."""
        return self.states.results.paths


def format_duration(seconds: float) -> str:
    """Duration of a forecast in words."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.1f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class Progress:
    """Bar, if `visible`, and log of one run; the log file grows from run to run."""

    def __init__(self, path: Path, *, visible: bool = True) -> None:
        self._shows_bar = visible and sys.stderr.isatty() and not os.environ.get("CI")
        self._shows_messages = visible
        self._bar: Any = None
        self._count = self._total = 0
        self._start_time = time.monotonic()
        self.remarks: list[str] = []
        flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
        with checks.convert_os_errors(f"write {path}"):
            self._file = os.fdopen(os.open(path, flags, 0o666), "a", encoding="utf-8", buffering=1)

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *error: object) -> None:
        """Close bar and log."""
        if self._bar is not None:
            self._bar.close()
        with contextlib.suppress(OSError):  # a full disk is reported already
            self._file.close()

    def log(self, message: str) -> None:
        """Write a line to the log file and to the logger of the package."""
        LOGGER.info(message)
        now = datetime.now(UTC).isoformat(timespec="seconds")
        # A failed log must not stop the run; writing a batch reports a full disk.
        with contextlib.suppress(OSError):
            self._file.write(f"{now} {message}\n")

    def notify(self, message: str) -> None:
        """Write a line to the log and, if progress is visible, to the screen; safe in a handler of signals."""
        self.log(message)
        if self._shows_messages:
            with contextlib.suppress(OSError, ValueError):
                os.write(sys.stderr.fileno(), f"contactstudy: {message}\n".encode())

    def remark(self, message: str) -> None:
        """Notify the user of a message that the report of the run repeats; equal messages appear once."""
        if message not in self.remarks:
            self.remarks.append(message)
            self.notify(message)

    def begin(self, cases: int, total: int) -> None:
        """Log the number of cases to solve."""
        self._total, self._start_time = cases, time.monotonic()
        self.log(f"process {os.getpid()}: {cases} of {total} cases to solve")
        if self._shows_bar and cases:
            from tqdm import tqdm

            self._bar = tqdm(
                total=cases,
                unit="case",
                dynamic_ncols=True,
                bar_format="{percentage:3.0f}%|{bar}| {n_fmt}/{total_fmt} cases [{elapsed}{postfix}]",
            )

    def record(self, outcome: Outcome) -> None:
        """Count one case; log a failure with its reason."""
        self._count += 1
        if outcome.status != "ok":
            self.log(f"{outcome.status} {outcome.case.id[:16]} {outcome.case.name}: {outcome.message}")
            if self._bar is not None:
                self._bar.write(f"{outcome.status}: {outcome.case.name}: {outcome.message}", file=sys.stderr)

    def show(self) -> None:
        """Log and show the number of finished cases and the time left at the present speed."""
        remaining_seconds = (time.monotonic() - self._start_time) * (self._total - self._count) / max(self._count, 1)
        forecast = f"about {format_duration(remaining_seconds)} left" if self._count < self._total else "all done"
        self.log(f"{self._count}/{self._total} cases, {forecast}")
        if self._bar is not None:
            self._bar.set_postfix_str(forecast, refresh=False)
            self._bar.update(self._count - self._bar.n)


@contextlib.contextmanager
def _interruptible(notify: Callable[[str], None]) -> Iterator[None]:
    """End the block at the first Ctrl-C, SIGTERM or SIGHUP, so that no workers and unfinished files remain."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    signals = [signal.SIGINT, signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]
    # A process under nohup continues to ignore SIGHUP.
    handlers = {number: handler for number in signals if (handler := signal.getsignal(number)) != signal.SIG_IGN}

    def handle(signal_number: int, frame: FrameType | None) -> None:
        for handled_number in handlers:
            signal.signal(handled_number, signal.SIG_IGN)
        notify("interrupted: ending the workers ...")
        if signal_number == signal.SIGINT:
            raise KeyboardInterrupt
        interrupt = Terminated(f"ended by {signal.Signals(signal_number).name}")
        interrupt.signal_number = signal_number
        raise interrupt

    for signal_number in handlers:
        signal.signal(signal_number, handle)
    try:
        yield
    finally:
        for signal_number, handler in handlers.items():
            signal.signal(signal_number, handler)


def run_study(
    study: Study,
    folder: str | Path | None = None,
    *,
    workers: int | None = None,
    scheduler: str | Client | None = None,
    share: tuple[int, int] | None = None,
    wait: float = WAIT_SECONDS,
    progress: bool = True,
    again: tuple[str, ...] = (),
    sample: int | None = None,
    solver: Solver | None = None,
) -> RunReport:
    """Solve every case of a study that is not solved yet.

    A run may be interrupted in any way and called again: finished cases are not solved twice, except films. Films that
    differ only in speed are solved together, and another speed may change them within their stated errors. A script
    needs the guard ``if __name__ == "__main__":``, because the worker processes import the script.

    Parameters
    ----------
    study : Study
        The study.
    folder : str or Path, optional
        Folder of its files; default ``results/<name>``. A folder contains a single study.
    workers : int, optional
        Number of local processes; default one per core. 0 solves in this process, without dask.
    scheduler : str or distributed.Client, optional
        Address ``tcp://...`` of a dask scheduler to use instead, or a client of it; its workers must see `folder`.
    share : (int, int), optional
        ``(3, 40)`` solves the third of forty independent parts of the study, into the same folder: for job arrays.
    wait : float
        Time to wait for a worker of `scheduler` while there is none, seconds; infinity waits for ever.
    progress : bool
        Whether to show a bar on a terminal; ``run.log`` in the folder is written in any case.
    again : tuple of {"failed", "stale", "skipped"}
        States of cases to solve anew.
    sample : int, optional
        Solve so many cases only, evenly spaced, films with their group: from these, `plan` estimates time and bytes.
    solver : callable, optional
        Called instead of :func:`contactstudy.solve`, with the same arguments.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind.
    StudyFileError
        If all cases are impossible, or the scheduler does not answer or lacks usable workers.
    LockedError
        If another process runs the study, or this share of it, in the folder.
    StoreError
        If a file or folder cannot be written.
    KeyboardInterrupt
        After Ctrl-C, SIGTERM or SIGHUP, when workers have ended; the message contains the number of finished cases.

    Examples
    --------
    >>> import tempfile
    >>> study = Study(
    ...     name="small",
    ...     base={"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.2e-3, "max_pressure": 1.5e9,
    ...           "body": "half-space", "cells_x": 4, "cells_y": 8, "stresses": False},
    ...     sweep={"e_over_a": [0, 1]},
    ... )
    >>> run_study(study, tempfile.mkdtemp(), workers=0, progress=False).counts
    {'ok': 2}
    """
    # A worker process imports a script without a guard, and would run the script's study.
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(1)
    checks.instance("study", study, Study, "a Study, as from Study.from_toml(path)")
    engine = Engine(workers=workers, scheduler=scheduler, wait=wait, solver=solver)
    run_share = _check_share(share)
    plan = study.plan()
    if not plan.unique:
        reason = plan.reason(plan.skipped[0]) if plan.skipped else "every combination is excluded"
        raise StudyFileError(f"study {study.name!r} has no case that can be solved: {reason}")
    results_folder = Folder(folder if folder is not None else Path("results") / study.name, run_share)
    results_folder.create()
    with (
        results_folder.locked(),
        Progress(results_folder.path / f"{run_share.name}.log", visible=progress) as log,
        _interruptible(log.notify),
    ):
        try:
            results_folder.clean()
            results_folder.write_study(study)
            for message in (*plan.unknown[:MAX_WARNINGS], *plan.doubts[:MAX_WARNINGS]):
                log.remark(message if message in plan.unknown else f"doubtful magnitude in SI units: {message}")
            results, messages = results_folder.verified_results()
            for message in messages:
                log.remark(message)
            groups = _groups_to_solve(States(plan, results), again, run_share, sample)
            lock = results_folder.path / f"{run_share.name}.lock"
            task = Task(
                cases=(),
                folder=str(results_folder.batches),
                lock=(str(lock), lock.read_text(encoding="utf-8")),
                prefix=run_share.prefix,
                level=plan.level,
                study=plan.name,
                run=1 + max((int(batch.cases["run"].max()) for batch in results.batches), default=0),
            )
            del results
            solved = sum(map(len, groups))
            log.begin(solved, total=len(plan.unique))
            tasks = Tasks(plan, groups, task)
            _collect_outcomes(execute(tasks, engine, log.remark), task, results_folder, log)
        except KeyboardInterrupt as interrupt:
            counts = results_folder.states(plan).counts
            finished = counts.get("ok", 0) + counts.get("stale", 0)
            message = f"interrupted: {finished} of {len(plan.unique)} cases are kept in {results_folder.path}"
            message += "; run again to go on"
            log.log(message)
            # The message replaces the traceback, which would show an arbitrary line of the solver.
            interrupt.args = (message,)
            raise interrupt.with_traceback(None) from None
        except BaseException as error:
            log.log(f"stopped: {type(error).__name__}: {error}")
            raise
        report = RunReport(results_folder.path, results_folder.states(plan), solved, tuple(log.remarks))
        log.log(f"done: {report.states.summary}")
    return report


def _check_share(share: tuple[int, int] | None) -> Share:
    """Share of a run."""
    if share is None:
        return UNDIVIDED
    numbers = share if isinstance(share, tuple) and all(type(entry) is int for entry in share) else ()
    if len(numbers) != 2 or not 1 <= numbers[0] <= numbers[1]:
        allowed = "two numbers, such as (3, 40) for the third of forty shares, the first from 1 to the second"
        raise InvalidInputError("share", share, allowed)
    return Share(*numbers)


def _groups_to_solve(states: States, again: tuple[str, ...], share: Share, sample: int | None) -> list[list[int]]:
    """Cases to solve, group by group, ordered by their operator."""
    for status in again:
        checks.known_name("again", status, RERUN_STATUSES)
    plan = states.plan
    unique = selected = np.array(plan.unique, dtype=np.int64)
    if sample is not None:
        count = min(checks.count("sample", sample), len(unique))
        selected = unique[np.linspace(0, len(unique) - 1, count).astype(np.int64)]
    unsolved = set(states.indices("missing", *again)) | {
        index for index in states.indices("stale") if not states.usable[index]
    }
    unsolved &= set(selected.tolist())
    cases_of_group: dict[tuple[int, int], list[int]] = {}
    for index in unique.tolist():
        cases_of_group.setdefault((int(plan.operators[index]), int(plan.groups[index])), []).append(index)

    groups = [cases_of_group[key] for key in sorted(cases_of_group)]
    if share.count > 1:
        # A piece contains consecutive groups; every share receives several pieces.
        size = max(1, len(groups) // (RUN.pieces_per_share * share.count))
        groups = [group for index, group in enumerate(groups) if index // size % share.count == share.number - 1]
    unsolved_groups = []
    for group in groups:
        if "entrainment_speed" in plan.values(group[0]):
            # A film starts from the film of the next lower speed: solve all cases of a group or none.
            films = sorted(group, key=lambda index: abs(plan.values(index)["entrainment_speed"]))
            unsolved_groups.append([] if unsolved.isdisjoint(group) else films)
        else:
            unsolved_groups.append([index for index in group if index in unsolved])
    return [group for group in unsolved_groups if group]


def _collect_outcomes(results: TaskResults, template: Task, results_folder: Folder, log: Progress) -> None:
    """Record the outcomes, and join small batches during the run and at the end."""
    last_compaction = time.monotonic()
    try:
        with contextlib.closing(results):
            for outcomes in results:
                for outcome in outcomes:
                    log.record(outcome)
                    if not outcome.stored:
                        batch = batch_of_case(template, outcome.case, outcome.status, outcome.message)
                        write_batch(Path(template.folder), f"{template.prefix}{outcome.case.id[:12]}", batch)
                log.show()
                if time.monotonic() - last_compaction > RUN.compact_seconds:
                    _compact(results_folder, log)
                    last_compaction = time.monotonic()
    finally:
        results_folder.clean()
    _compact(results_folder, log, at_end=True)


def _compact(results_folder: Folder, log: Progress, *, at_end: bool = False) -> None:
    """Join small batches; a full disk leaves them as they are."""
    try:
        results_folder.compact(at_end=at_end)
    except StoreError as error:
        log.log(f"batches are not joined: {error}")


def rerun_study(folder: str | Path, **options: Any) -> RunReport:
    """Solve the failed, skipped and stale cases of a folder's study anew, and the missing ones.

    Parameters
    ----------
    folder : str or Path
        The study's folder.
    **options
        `workers`, `scheduler`, `wait`, `progress` and `solver`, as for :func:`run_study`.
    """
    return run_study(Folder(folder).read_study(), folder, again=RERUN_STATUSES, **options)
