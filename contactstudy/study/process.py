"""Processes of this host: whether one runs, and which of all that ever had its number it is.

Times of day are of no use for that, because the clock may be set while a study runs. Linux counts ticks since it
booted, and gives every boot an identity.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import socket
from pathlib import Path

BOOT = Path("/proc/sys/kernel/random/boot_id")
MACHINE = Path("/etc/machine-id")
NAMESPACE = Path("/proc/self/ns/pid")
STATE, STARTED = 0, 19
"""Places in ``/proc/<pid>/stat`` after the command's name."""


def boot() -> str:
    """Identity of the running system since it was started; empty where the system gives none."""
    try:
        return BOOT.read_text(encoding="ascii").strip()
    except OSError:
        return ""


def birth(pid: int) -> str | None:
    """When a process began, as this system counts; None if it does not run, a zombie being dead.

    Examples
    --------
    >>> birth(os.getpid()) == birth(os.getpid()), birth(2**30)
    (True, None)
    """
    if not BOOT.exists():
        return _birth_elsewhere(pid)
    try:
        after_name = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
    except OSError:
        return None
    return None if after_name[STATE] in "ZX" else f"{after_name[STARTED]} ticks"


def _birth_elsewhere(pid: int) -> str | None:
    """When a process began on a system that is no Linux."""
    import psutil

    with contextlib.suppress(psutil.Error, OverflowError, ValueError):
        process = psutil.Process(pid)
        if process.status() != psutil.STATUS_ZOMBIE:
            return f"{process.create_time():.0f} s"
    return None


def alive(pid: int) -> bool:
    """Whether a process with this number runs on this host."""
    return birth(pid) is not None


@functools.cache
def system() -> str:
    """Name of this host, with a digest of its machine and of what gives processes their numbers.

    Only processes of one system can tell whether another one runs: two machines, or two containers of one machine, may
    have the same name.
    """
    parts = []
    with contextlib.suppress(OSError):
        parts.append(MACHINE.read_text(encoding="ascii", errors="replace").strip())
    with contextlib.suppress(OSError):
        parts.append(os.readlink(NAMESPACE))
    return f"{socket.gethostname()}-{hashlib.sha256(' '.join(parts).encode()).hexdigest()[:8]}"


def process_name() -> str:
    """System and process, as in the names of unfinished files."""
    return f"{system()}-{os.getpid()}"
