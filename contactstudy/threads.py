"""Limit on the threads of the linear algebra."""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import cache

from threadpoolctl import ThreadpoolController


@cache
def _controller() -> ThreadpoolController:
    """Find the loaded libraries, which takes a millisecond, once."""
    return ThreadpoolController()


def one_blas_thread() -> AbstractContextManager[object]:
    """Keep BLAS on one thread: for many small products, waiting for a second thread costs more than it saves."""
    limit: AbstractContextManager[object] = _controller().limit(limits=1, user_api="blas")
    return limit
