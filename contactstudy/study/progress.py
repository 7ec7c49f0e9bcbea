"""Progress of a run: a bar for the terminal, a log for everybody else."""

from __future__ import annotations

import contextlib
import logging
import os
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from contactstudy.study.errors import StoreError
from contactstudy.study.work import Job, Record

LOGGER = logging.getLogger(__name__)


def duration(seconds: float) -> str:
    """Seconds in words, as exact as a forecast deserves.

    Examples
    --------
    >>> duration(7.4), duration(200), duration(9000)
    ('7 s', '3.3 min', '2.5 h')
    """
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.1f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class Progress:
    """Bar and log of one run.

    The time left is the expected effort of the cases to come at the speed of those done, so cheap cases first do not
    promise an early end.

    Parameters
    ----------
    path : Path
        Log file; new lines go to its end.
    shown : bool
        Whether to show a bar; it is never shown where no one watches: without a terminal, or in CI.
    """

    def __init__(self, path: Path, *, shown: bool = True) -> None:
        self._shown = shown and sys.stderr.isatty() and not os.environ.get("CI")
        self._path = path
        self._bar: Any = None
        self._left = self._all = 0.0
        self._count = self._total = 0
        self._began = time.monotonic()
        self._file: IO[str] | None = None
        self._wanted = shown
        self.remarks: list[str] = []

    def __enter__(self) -> Progress:
        """Open the log."""
        try:
            self._file = open(self._path, "a", encoding="utf-8", buffering=1)
        except OSError as error:
            raise StoreError(f"cannot write {self._path}: {error.strerror or error}") from error
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close bar and log."""
        if self._bar is not None:
            self._bar.close()
        if self._file is not None:
            with contextlib.suppress(OSError):  # a full disk has been reported already
                self._file.close()

    def say(self, message: str) -> None:
        """Write a line to the log file, and hand it to the logger of the package."""
        LOGGER.info(message)
        if self._file is not None:
            now = datetime.now(UTC).isoformat(timespec="seconds")
            # A log that cannot grow must not stop the run; a full disk shows when a case is written.
            with contextlib.suppress(OSError):
                self._file.write(f"{now} {message}\n")

    def tell(self, message: str) -> None:
        """Write a line to the log and, if progress is wanted, to the screen at once, even from a handler of signals."""
        self.say(message)
        if self._wanted:
            with contextlib.suppress(OSError, ValueError):
                os.write(sys.stderr.fileno(), f"contactstudy: {message}\n".encode())

    def remark(self, message: str) -> None:
        """Tell what the reader should still know when the run has ended; the same thing once only."""
        if message not in self.remarks:
            self.remarks.append(message)
            self.tell(message)

    def begin(self, jobs: list[Job], total: int) -> None:
        """Say what is to be done."""
        self._left = self._all = sum(job.cost for job in jobs)
        self._total, self._began = len(jobs), time.monotonic()
        self.say(f"process {os.getpid()}: {len(jobs)} of {total} cases to solve")
        if self._shown and jobs:
            from tqdm import tqdm

            self._bar = tqdm(
                total=len(jobs),
                unit="case",
                dynamic_ncols=True,
                bar_format="{percentage:3.0f}%|{bar}| {n_fmt}/{total_fmt} cases [{elapsed}{postfix}]",
            )

    def finished(self, job: Job, record: Record) -> None:
        """Count one case."""
        self._count += 1
        self._left -= job.cost
        done = self._all - self._left
        remaining = (time.monotonic() - self._began) * self._left / done if done > 0 else 0.0
        left = f"about {duration(remaining)} left" if self._count < self._total else "all done"
        detail = f": {record.error}: {record.message}" if record.error else ""
        self.say(
            f"{self._count}/{self._total} {record.status} {job.id[:16]} {job.name} "
            f"{record.seconds:.2f} s, {left}{detail}"
        )
        if self._bar is not None:
            self._bar.set_postfix_str(left, refresh=False)
            self._bar.update()
            if record.status != "ok":
                self._bar.write(f"failed: {job.name}{detail}", file=sys.stderr)
