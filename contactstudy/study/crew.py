"""The workers of a scheduler: who is there, and who of them can solve cases of this study.

A worker that lacks the package, has another version of it, or sees another folder under the same path is left out
before it is given a case, with the reason. The checks are tasks of functions of the standard library, because a
function of this package could not be loaded where the package is missing.
"""

from __future__ import annotations

import operator
import pkgutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contactstudy.study.errors import StudyFileError
from contactstudy.study.lock import LOCK_NAME
from contactstudy.study.work import circumstances

if TYPE_CHECKING:
    from distributed import Client, Future

# After how long without a worker to say that this is why nothing happens.
SILENT_SECONDS = 10.0

INTRODUCTION = f"{__name__}:introduce"


def introduce(path: str) -> dict[str, Any]:
    """Say, on a worker, with which versions it solves and what it reads in the file `path`."""
    try:
        read = Path(path).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        read = f"{type(error).__name__}: {error}"
    return {"versions": circumstances(), "read": read}


class Crew:
    """Workers that can be given cases.

    Parameters
    ----------
    client : Client
        Of the scheduler.
    folder : str
        The study's folder, with the lock of this run, which every worker must see.
    wait : float
        How long to wait for a worker while there is none, seconds.
    say : callable
        Takes what the user should know.
    """

    def __init__(self, client: Client, folder: str, wait: float, say: Callable[[str], None]) -> None:
        self._client, self._wait, self._say = client, wait, say
        self._lock = Path(folder) / LOCK_NAME
        self._asked: dict[str, Future[Any]] = {}
        self._accepted: set[str] = set()
        self._refused: dict[str, str] = {}
        self._alone_since = time.monotonic()
        self._told = False

    def ready(self, busy: set[str]) -> set[str]:
        """Return the workers that may be given cases now, those included that are at work.

        Raises
        ------
        StudyFileError
            If all workers are unfit, or there has been none for too long.
        """
        present = set(self._client.nthreads())
        for gone in set(self._asked) - present:
            self._asked.pop(gone).release()
        for worker in present - self._accepted - set(self._refused) - set(self._asked):
            self._asked[worker] = self._ask(worker)
        for worker, answer in list(self._asked.items()):
            if answer.done():
                del self._asked[worker]
                self._judge(worker, answer)
        able = present & self._accepted
        if able or busy:
            self._alone_since, self._told = time.monotonic(), False
        else:
            self._be_patient(present)
        return able

    def _ask(self, worker: str) -> Future[Any]:
        """Have a worker import the package and introduce itself."""
        here = {"workers": [worker], "pure": False, "retries": 0}
        found = self._client.submit(pkgutil.resolve_name, INTRODUCTION, **here)
        return self._client.submit(operator.call, found, str(self._lock), **here)

    def _judge(self, worker: str, answer: Future[Any]) -> None:
        """Accept a worker or leave it out."""
        error = answer.exception() if answer.status == "error" else None
        if error is not None:
            reason = f"it cannot import this version of contactstudy ({type(error).__name__}: {error})"
        elif answer.status != "finished":
            return
        else:
            reason = self._unfit(answer.result())
        answer.release()
        if not reason:
            self._accepted.add(worker)
            return
        self._refused[worker] = reason
        self._say(f"worker {worker} is left out: {reason}")

    def _unfit(self, said: dict[str, Any]) -> str:
        """Return why a worker that introduced itself cannot be used; empty if it can."""
        own, other = circumstances()["contactstudy"], said["versions"].get("contactstudy")
        if other != own:
            return f"it has version {other} of contactstudy, not {own}"
        if said["read"] != self._lock.read_text(encoding="utf-8"):
            seen = said["read"][:200]
            return f"it does not see this run's lock at {self._lock}; the folder must be the same for all ({seen})"
        return ""

    def _be_patient(self, present: set[str]) -> None:
        """Say that there is nobody to solve anything, and give up in the end."""
        unfit = present & set(self._refused)
        if present and unfit == present:
            raise StudyFileError(f"none of the {len(unfit)} workers can be used: {self._refused[min(unfit)]}")
        waited = time.monotonic() - self._alone_since
        if waited > self._wait:
            what = "has answered" if present else "is connected to the dask scheduler"
            raise StudyFileError(
                f"no worker {what} after {waited:.0f} s: start workers, or wait longer (--wait SECONDS)"
            )
        if waited > SILENT_SECONDS and not self._told:
            self._told = True
            self._say(f"no worker yet; waiting for one up to {self._wait:g} s (--wait SECONDS)")
