"""Running a study: from the plan to files, on local processes or on a cluster, resumable at any moment."""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from contactstudy import checks
from contactstudy.errors import Terminated
from contactstudy.study.definition import Study
from contactstudy.study.errors import StoreError, StudyFileError
from contactstudy.study.executor import WAIT_SECONDS, execute
from contactstudy.study.folder import Entry, Folder
from contactstudy.study.guard import refuse_in_a_worker
from contactstudy.study.lock import locked
from contactstudy.study.own_profiles import pickles_of
from contactstudy.study.plan import Plan, PlannedCase
from contactstudy.study.progress import Progress
from contactstudy.study.work import Job, Record, Solver, differences

SAVE_SECONDS = 5.0

# Questions on magnitudes that a run repeats; `plan` shows more.
MOST_DOUBTS = 5


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
    remarks : tuple of str
        What the reader should know of this run: workers with other versions, workers that could not be used.
    """

    folder: Path
    plan: Plan
    entries: list[Entry]
    solved: int
    remarks: tuple[str, ...] = ()

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
def _interruptible(say: Callable[[str], None]) -> Iterator[None]:
    """Let the first Ctrl-C or SIGTERM end the block, and no further one break off the tidying up after it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def handler(number: int, frame: FrameType | None) -> None:
        for each in (signal.SIGINT, signal.SIGTERM):
            signal.signal(each, signal.SIG_IGN)
        say("interrupted: ending the workers ...")
        raise Terminated("ended by SIGTERM") if number == signal.SIGTERM else KeyboardInterrupt

    previous = {number: signal.signal(number, handler) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, former in previous.items():
            signal.signal(number, former)


def _todo(plan: Plan, folder: Folder, again: tuple[str, ...], log: Callable[[str], None]) -> list[Job]:
    """Jobs for the cases that are not done; damaged files are moved out of the way first."""
    for path, problem in folder.foreign_files():
        log(f"{problem}; moved to {folder.set_aside(path)}")
    jobs = []
    for case in plan.unique:
        entry, _ = folder.state(case.id, plan.level)
        if entry.status == "missing" or (entry.status == "stale" and not entry.usable) or entry.status in again:
            place, own = str(folder.path), pickles_of(case.parameters)
            jobs.append(
                Job(case.id, case.name, case.parameters, place, plan.level, case.operator, case.cost, plan.name, own)
            )
    return jobs


def _interrupted(place: Folder, plan: Plan) -> str:
    """Say what an interrupted run leaves, and how it goes on."""
    kept = sum(place.case_path(case.id).exists() for case in plan.unique)
    return f"interrupted: {kept} of {len(plan.unique)} cases are kept in {place.path}; run again to go on"


def run_study(
    study: Study,
    folder: str | Path | None = None,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    wait: float = WAIT_SECONDS,
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
    wait : float
        How long to wait for a worker of `scheduler` while there is none, seconds; infinity waits for ever.
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
    InvalidInputError
        If an argument is of the wrong kind.
    StudyFileError
        If no case of the study can be solved, or the scheduler does not answer or has no worker that can be used.
    LockedError
        If another process runs a study in the folder.
    StoreError
        If the disk or a permission is in the way.
    KeyboardInterrupt
        After Ctrl-C or SIGTERM, when workers have ended and the lock is released; it says how many cases are kept.

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
    refuse_in_a_worker()
    checks.instance("study", study, Study, "a Study, as from Study.from_toml(path)")
    plan = study.plan()
    if not plan.unique:
        reason = plan.skipped[0].reason if plan.skipped else "every combination is excluded"
        raise StudyFileError(f"study {study.name!r} has no case that can be solved: {reason}")
    place = Folder(folder if folder is not None else Path("results") / study.name)
    place.create()
    with (
        Progress(place.path / "run.log", shown=progress) as log,
        _interruptible(log.tell),
        locked(place.path) as took_over,
    ):
        if took_over:
            log.say(took_over)
        try:
            place.clean()
            place.write_study(study)
            for unknown in plan.unknown[:MOST_DOUBTS]:
                log.remark(unknown)
            for doubt in plan.doubts[:MOST_DOUBTS]:
                log.remark(f"doubtful, for units are SI: {doubt}")
            jobs = _todo(plan, place, again, log.say)
            log.begin(jobs, total=len(plan.unique))
            records = execute(jobs, workers=workers, scheduler=scheduler, wait=wait, solver=solver, say=log.remark)
            _finish(records, place, jobs, log)
        except KeyboardInterrupt as interrupt:
            words = _interrupted(place, plan)
            log.say(words)
            # A fresh one: the reader needs to know what is kept, not where the solver was.
            raise (Terminated if isinstance(interrupt, Terminated) else KeyboardInterrupt)(words) from None
        report = RunReport(place.path, plan, place.entries(plan), len(jobs), tuple(log.remarks))
        log.say(f"done: {', '.join(f'{count} {status}' for status, count in report.counts.items())}")
    return report


def _finish(records: Generator[Record, None, None], place: Folder, jobs: list[Job], log: Progress) -> None:
    """Take in the records, and leave the folder tidy however that ends."""
    try:
        _collect(records, place, jobs, log)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        log.say(f"stopped: {type(error).__name__}: {error}")
        raise
    finally:
        # The manifest is a cache: a disk that cannot take it must not hide why the run ended.
        with contextlib.suppress(StoreError):
            place.clean()
            place.save_manifest()


def _collect(records: Generator[Record, None, None], place: Folder, jobs: list[Job], log: Progress) -> None:
    """Take in the records as they come."""
    by_id = {job.id: job for job in jobs}
    saved = time.monotonic()
    with contextlib.closing(records):
        for record in records:
            job = by_id[record.id]
            if record.status == "ok":
                place.failure_path(record.id).unlink(missing_ok=True)
                place.remember(place.case_path(record.id), record.id, record.run, record.scalars)
                if other := differences(record.run):
                    log.remark(f"a worker solves with other versions than this process has: {other}")
            else:
                place.write_failure(record.id, job.parameters, record.error, record.message)
            log.finished(job, record)
            if time.monotonic() - saved > SAVE_SECONDS:
                place.save_manifest()
                saved = time.monotonic()


def rerun_study(
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    wait: float = WAIT_SECONDS,
    progress: bool = True,
    solver: Solver | None = None,
) -> RunReport:
    """Solve the failed and the stale cases of a folder's study anew, and the missing ones.

    Parameters
    ----------
    folder : str or Path
        The study's folder.
    workers, scheduler, wait, progress, solver
        As for :func:`run_study`.

    Returns
    -------
    RunReport
    """
    return run_study(
        Folder(folder).read_study(),
        folder,
        workers=workers,
        scheduler=scheduler,
        wait=wait,
        progress=progress,
        again=("failed", "stale"),
        solver=solver,
    )
