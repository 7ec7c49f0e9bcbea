"""Which worker solves which case next: cases that share an operator stay together, in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from contactstudy.study.work import Job


class Dispatcher:
    """Hands out jobs, one at a time, to workers that ask.

    A worker keeps to one group of jobs with the same operator until it is done; then it takes the most expensive
    group that nobody has, and when there is none it takes over the later half of the largest one.

    Parameters
    ----------
    jobs : iterable of Job
        All jobs.

    Examples
    --------
    >>> jobs = [Job(str(i), "", {}, "", "summary", operator="ab"[i % 2]) for i in range(4)]
    >>> dispatcher = Dispatcher(jobs)
    >>> [dispatcher.next_job(worker).id for worker in ("one", "two", "one", "two")]
    ['0', '1', '2', '3']
    """

    def __init__(self, jobs: Iterable[Job]) -> None:
        groups: dict[str, deque[Job]] = {}
        for job in jobs:
            groups.setdefault(job.operator, deque()).append(job)
        self._free = sorted(groups.values(), key=self._cost, reverse=True)
        self._taken: dict[str, deque[Job]] = {}

    @staticmethod
    def _cost(group: deque[Job]) -> float:
        return sum(job.cost for job in group)

    @property
    def waiting(self) -> int:
        """Jobs not yet handed out."""
        return sum(map(len, self._free)) + sum(map(len, self._taken.values()))

    @property
    def owners(self) -> set[str]:
        """Workers that have a group."""
        return set(self._taken)

    def next_job(self, worker: str) -> Job | None:
        """Return the next job for `worker`, or None if all are handed out."""
        own = self._taken.get(worker)
        if not own:
            own = self._take()
            if own is None:
                return None
            self._taken[worker] = own
        return own.popleft()

    def _take(self) -> deque[Job] | None:
        if self._free:
            return self._free.pop(0)
        largest = max(self._taken.values(), key=self._cost, default=None)
        if not largest:
            return None
        return deque(reversed([largest.pop() for _ in range((len(largest) + 1) // 2)]))

    def forget(self, worker: str) -> None:
        """Give back the jobs that a lost worker had not begun."""
        group = self._taken.pop(worker, None)
        if group:
            self._free.insert(0, group)
