"""Progress of a run: a bar on a terminal, and a log."""

from __future__ import annotations

import contextlib
import logging
import os
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from contactstudy.checks import convert_os_errors
from contactstudy.study.worker import Outcome

LOGGER = logging.getLogger(__name__)


def format_duration(seconds: float) -> str:
    """Duration of a forecast in words."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.1f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class Progress:
    """Bar, if `visible`, and log of one run; the log file grows from run to run."""

    def __init__(self, path: Path, *, visible: bool = True) -> None:
        self._bar_shown = visible and sys.stderr.isatty() and not os.environ.get("CI")
        self._messages_shown = visible
        self._bar: Any = None
        self._count = self._total = 0
        self._began = time.monotonic()
        self.remarks: list[str] = []
        flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
        with convert_os_errors(f"write {path}"):
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
        if self._messages_shown:
            with contextlib.suppress(OSError, ValueError):
                os.write(sys.stderr.fileno(), f"contactstudy: {message}\n".encode())

    def remark(self, message: str) -> None:
        """Notify the user of a message that the report of the run repeats; equal messages appear once."""
        if message not in self.remarks:
            self.remarks.append(message)
            self.notify(message)

    def begin(self, cases: int, total: int) -> None:
        """Log the number of cases to solve."""
        self._total, self._began = cases, time.monotonic()
        self.log(f"process {os.getpid()}: {cases} of {total} cases to solve")
        if self._bar_shown and cases:
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
        remaining_seconds = (time.monotonic() - self._began) * (self._total - self._count) / max(self._count, 1)
        forecast = f"about {format_duration(remaining_seconds)} left" if self._count < self._total else "all done"
        self.log(f"{self._count}/{self._total} cases, {forecast}")
        if self._bar is not None:
            self._bar.set_postfix_str(forecast, refresh=False)
            self._bar.update(self._count - self._bar.n)
