"""Threads: one for BLAS, as many as there are processors for the package's own loops."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from typing import TypeVar

from threadpoolctl import threadpool_limits

Item = TypeVar("Item")
Result = TypeVar("Result")


def one_blas_thread() -> AbstractContextManager[object]:
    """Keep BLAS on one thread: the products here are many and small, and waiting for a second thread costs more."""
    limit: AbstractContextManager[object] = threadpool_limits(1, user_api="blas")
    return limit


def thread_count() -> int:
    """Threads for the package's own loops: ``OMP_NUM_THREADS`` if set, else the processors at hand."""
    asked = os.environ.get("OMP_NUM_THREADS", "")
    return int(asked) if asked.isdigit() and int(asked) > 0 else len(os.sched_getaffinity(0))


def in_threads(function: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """Apply `function` to `items`, in threads if there are several; results come in the order of the items.

    The order makes sums over the results the same to the last bit, however many threads there are.

    Examples
    --------
    >>> list(in_threads(abs, [-1, 2, -3]))
    [1, 2, 3]
    """
    threads = thread_count()
    if threads == 1:
        yield from map(function, items)
        return
    with ThreadPoolExecutor(threads) as pool:
        yield from pool.map(function, items)
