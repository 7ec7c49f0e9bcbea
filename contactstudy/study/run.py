"""Running a study: from the plan to files, on local processes or on a cluster, resumable at any moment."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType

from contactstudy.study.definition import Study
from contactstudy.study.errors import StoreError, StudyFileError
from contactstudy.study.executor import execute
from contactstudy.study.folder import Entry, Folder
from contactstudy.study.lock import locked
from contactstudy.study.plan import Plan, PlannedCase
from contactstudy.study.progress import Progress
from contactstudy.study.work import Job, Record, Solver, circumstances

SAVE_SECONDS = 5.0


class Terminated(KeyboardInterrupt):
    """The process was asked to end by SIGTERM."""


@dataclass(frozen=True)
class RunReport:
    """What a run did.

    Parameters
    ----------
    folder : Path
        The study's folder.
    plan : Plan
        All cases.
    entries : list of Entry
        State of every case of the plan, in its order, after the run.
    solved : int
        Cases solved now, failed ones included.
    """

    folder: Path
    plan: Plan
    entries: list[Entry]
    solved: int

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {status}" for status, count in self.counts.items())
        return (
            f"RunReport({len(self.plan.cases)} cases: {counts}; {self.solved} solved now; folder={str(self.folder)!r})"
        )

    @property
    def counts(self) -> dict[str, int]:
        """Number of cases of each status."""
        return dict(Counter(entry.status for entry in self.entries))

    @property
    def not_converged(self) -> list[PlannedCase]:
        """Cases whose contact iteration did not reach its tolerance."""
        pairs = zip(self.plan.cases, self.entries, strict=True)
        return [case for case, entry in pairs if entry.scalars.get("converged", 1.0) == 0.0]

    @property
    def failures(self) -> list[tuple[PlannedCase, Entry]]:
        """Failed cases, each with its reason."""
        pairs = zip(self.plan.cases, self.entries, strict=True)
        return [(case, entry) for case, entry in pairs if entry.status == "failed"]

    @property
    def files(self) -> list[Path]:
        """The netCDF files of the study's cases."""
        return sorted({self.folder / entry.path for entry in self.entries if entry.path})


@contextlib.contextmanager
def _terminable() -> Iterator[None]:
    """Let SIGTERM end the block as Ctrl-C does; signals reach the main thread only."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def handler(number: int, frame: FrameType | None) -> None:
        raise Terminated("ended by SIGTERM")

    previous = signal.signal(signal.SIGTERM, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous)


def _todo(plan: Plan, folder: Folder, again: tuple[str, ...], log: Callable[[str], None]) -> list[Job]:
    """Jobs for the cases that are not done; damaged files are moved out of the way first."""
    for path, problem in folder.foreign_files():
        log(f"{problem}; moved to {folder.set_aside(path)}")
    jobs = []
    found = circumstances() | {"study": plan.name}
    for case in plan.unique:
        entry, _ = folder.state(case.id, plan.level)
        if entry.status == "missing" or (entry.status == "stale" and not entry.usable) or entry.status in again:
            jobs.append(
                Job(case.id, case.name, case.parameters, str(folder.path), plan.level, case.operator, case.cost, found)
            )
    return jobs


def run_study(
    study: Study,
    folder: str | Path | None = None,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: bool = True,
    again: tuple[str, ...] = (),
    solver: Solver | None = None,
) -> RunReport:
    """Solve every case of a study that is not solved yet.

    May be interrupted in any way and called again: what is finished is not solved twice. A script that calls this
    needs the guard ``if __name__ == "__main__":``, because the workers are processes that import it.

    Parameters
    ----------
    study : Study
        The study.
    folder : str or Path, optional
        Where its files are; default ``results/<name>``. It belongs to this study.
    workers : int, optional
        Number of local processes; default one per core. 0 solves in this process, without dask.
    scheduler : str, optional
        Address ``tcp://...`` of a dask scheduler to use instead; its workers must see `folder`.
    progress : bool
        Whether to show a bar on a terminal; ``run.log`` in the folder is written in any case.
    again : tuple of {"failed", "stale"}
        Also solve cases of these states anew.
    solver : callable, optional
        Called instead of :func:`contactstudy.solve`, with the same arguments.

    Returns
    -------
    RunReport

    Raises
    ------
    StudyFileError
        If no case of the study can be solved.
    LockedError
        If another process runs a study in the folder.
    StoreError
        If the disk or a permission is in the way.
    KeyboardInterrupt
        After Ctrl-C or SIGTERM, when workers have ended and the lock is released.

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
    plan = study.plan()
    if not plan.unique:
        reason = plan.skipped[0].reason if plan.skipped else "every combination is excluded"
        raise StudyFileError(f"study {study.name!r} has no case that can be solved: {reason}")
    place = Folder(folder if folder is not None else Path("results") / study.name)
    place.create()
    with locked(place.path) as took_over, _terminable(), Progress(place.path / "run.log", shown=progress) as log:
        if took_over:
            log.say(took_over)
        place.clean()
        place.write_study(study)
        jobs = _todo(plan, place, again, log.say)
        log.begin(jobs, total=len(plan.unique))
        try:
            _collect(execute(jobs, workers=workers, scheduler=scheduler, solver=solver), place, jobs, log)
        except KeyboardInterrupt:
            log.say("interrupted: finished cases are kept, run again to go on")
            raise
        except BaseException as error:
            log.say(f"stopped: {type(error).__name__}: {error}")
            raise
        finally:
            # The manifest is a cache: a disk that cannot take it must not hide why the run ended.
            with _uninterrupted(), contextlib.suppress(StoreError):
                place.clean()
                place.save_manifest()
        report = RunReport(place.path, plan, place.entries(plan), len(jobs))
        log.say(f"done: {', '.join(f'{count} {status}' for status, count in report.counts.items())}")
    return report


def _collect(records: Iterator[Record], place: Folder, jobs: list[Job], log: Progress) -> None:
    """Take in the records as they come."""
    import time

    by_id = {job.id: job for job in jobs}
    saved = time.monotonic()
    with contextlib.closing(records) as stream:  # type: ignore[type-var]
        for record in stream:
            job = by_id[record.id]
            if record.status == "ok":
                place.failure_path(record.id).unlink(missing_ok=True)
                place.remember(place.case_path(record.id), record.id, record.run, record.scalars)
            else:
                place.write_failure(record.id, job.parameters, record.error, record.message)
            log.finished(job, record)
            if time.monotonic() - saved > SAVE_SECONDS:
                place.save_manifest()
                saved = time.monotonic()


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Let no further Ctrl-C break off the cleaning."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)


def rerun_study(folder: str | Path, **options: object) -> RunReport:
    """Solve the failed and the stale cases of a folder's study anew, and the missing ones.

    Parameters
    ----------
    folder : str or Path
        The study's folder.
    **options
        As for :func:`run_study`.

    Returns
    -------
    RunReport
    """
    study = Folder(folder).read_study()
    return run_study(replace(study), folder, again=("failed", "stale"), **options)  # type: ignore[arg-type]
