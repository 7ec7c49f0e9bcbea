"""Limit on the threads of the linear algebra."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from threading import Lock

from threadpoolctl import ThreadpoolController

_LOCK, _LIMIT = Lock(), ExitStack()
_entry_count = 0
_controller = cache(ThreadpoolController)  # the search for the loaded libraries takes a millisecond


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep BLAS on one thread: for many small products, waiting for a second thread costs more than it saves."""
    # All threads of the process share the limit: the first entry sets it, the last exit restores the threads.
    global _entry_count
    with _LOCK:
        if not _entry_count:
            _LIMIT.enter_context(_controller().limit(limits=1, user_api="blas"))
        _entry_count += 1
    try:
        yield
    finally:
        with _LOCK:
            _entry_count -= 1
            if not _entry_count:
                _LIMIT.close()
