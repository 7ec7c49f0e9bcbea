"""One run per folder: a lock file that says who holds it."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import stat
import uuid
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from types import ModuleType

from contactstudy.study.errors import LockedError, StoreError
from contactstudy.study.process import birth, boot, system

LOCK_NAME = "run.lock"

fcntl: ModuleType | None
try:
    import fcntl
except ImportError:  # not on Windows, where only the tiny moment of a take-over goes unguarded
    fcntl = None


def _is_dead(holder: dict[str, object]) -> bool:
    """Whether the holder of a lock surely does not run any more."""
    pid = holder.get("process")
    if type(pid) is not int or holder.get("host") != socket.gethostname():
        return False
    if holder.get("system", system()) != system():
        return False
    if holder.get("boot", boot()) != boot():
        return True
    born = birth(pid)
    return born is None or holder.get("birth", born) != born


@contextlib.contextmanager
def _guard(folder: Path) -> Iterator[None]:
    """Hold the folder itself for the moment in which a lock is looked at and taken."""
    if fcntl is None:
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def read_lock(folder: Path) -> dict[str, object] | None:
    """Who holds the folder's lock: process, host and time; None if nobody does."""
    path = folder / LOCK_NAME
    try:
        # A pipe or a device of that name would never end.
        content = json.loads(path.read_text(encoding="utf-8")) if stat.S_ISREG(path.stat().st_mode) else None
    except FileNotFoundError:
        return None
    except (OSError, ValueError, RecursionError):
        content = None
    return content if isinstance(content, dict) else {"process": "unknown", "host": "unknown", "time": "unknown"}


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[str]:
    """Hold the lock of `folder`; yields a message if a dead run's lock was taken over, else an empty text.

    Raises
    ------
    LockedError
        If another live process, or one on another host, holds it.
    StoreError
        If the folder cannot be written.
    """
    path = folder / LOCK_NAME
    token = uuid.uuid4().hex
    now = datetime.now(UTC).isoformat(timespec="seconds")
    mine = {
        "process": os.getpid(),
        "host": socket.gethostname(),
        "system": system(),
        "time": now,
        "token": token,
        "boot": boot(),
        "birth": birth(os.getpid()),
    }
    message = ""
    try:
        with _guard(folder):
            holder = read_lock(folder)
            if holder is not None:
                who = f"process {holder.get('process')} on {holder.get('host')} since {holder.get('time')}"
                if not _is_dead(holder):
                    raise LockedError(f"{folder} is in use by {who}; if that run is surely gone, delete {path}")
                message = f"took over the lock of a dead run: {who}"
                path.unlink()
            part = folder / f"{LOCK_NAME}.{token}"
            part.write_text(json.dumps(mine), encoding="utf-8")
            os.replace(part, path)
    except OSError as error:
        raise StoreError(f"cannot write {path}: {error.strerror or error}") from error
    try:
        yield message
    finally:
        with contextlib.suppress(OSError), _guard(folder):
            holder = read_lock(folder)
            if holder is not None and holder.get("token") == token:
                path.unlink()
