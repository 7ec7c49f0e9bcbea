"""Times and sizes of a run, in one place."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class RunSettings:
    """Times and sizes of a run; results depend on none of them."""

    task_seconds: float = 10.0  # duration of a task: longer ones need fewer messages, shorter ones balance better
    save_seconds: float = 15.0  # time between batches of a worker, at most lost if the worker is killed
    compact_seconds: float = 20.0  # time after which a run joins small batches again
    poll_seconds: float = 0.5  # time between two checks for new and lost workers
    start_seconds: float = 60.0  # longest wait for a scheduler's answer, or the start of a worker
    # time without a usable worker after which the user is informed; if all workers are excluded, the run ends
    announce_seconds: float = 10.0
    close_seconds: float = 2.0  # longest wait for the end of a connection
    share_seconds: float = 10.0  # longest wait of a share for another share that starts simultaneously
    buffer_bytes: int = 2**26  # size in memory at which a worker writes a batch
    batch_bytes: int = 2**27  # batches of this size, or of batch_cases, are not joined further
    batch_cases: int = 2**13
    small_bytes: int = 2**24  # smaller batches are joined at the end of a run
    # number of batches of similar size that a run joins: the number of files grows like the logarithm of the cases
    fan_in: int = 8
    pieces_per_share: int = 8  # least pieces of each share, so that all shares have cheap and expensive cases
    checked_groups: int = 4000  # largest number of groups that a plan checks; of more groups it checks an even sample


RUN = RunSettings()  # Settings of every run
