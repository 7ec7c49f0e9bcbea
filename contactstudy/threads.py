"""Control of the threads that the linear algebra starts on its own."""

from __future__ import annotations

from contextlib import AbstractContextManager

from threadpoolctl import threadpool_limits


def one_blas_thread() -> AbstractContextManager[object]:
    """Keep BLAS on one thread: the products here are many and small, and waiting for a second thread costs more."""
    limit: AbstractContextManager[object] = threadpool_limits(1, user_api="blas")
    return limit
