"""Ctrl-C in a long calculation: the reader needs to know which call it ended, not where the solver was."""

from __future__ import annotations

from types import TracebackType


class BriefInterrupt:
    """Context in which an interrupt ends with the trace of the caller alone.

    It is a context and not a decorator: that would stand in the trace of every other error, and between a warning and
    the line it is about.

    Examples
    --------
    >>> def solver():
    ...     raise KeyboardInterrupt
    >>> try:
    ...     with BriefInterrupt():
    ...         solver()
    ... except KeyboardInterrupt as interrupt:
    ...     print(interrupt.__traceback__)  # nothing of `solver`
    None
    """

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Forget where in the calculation it was, and what was being handled there."""
        if isinstance(error, KeyboardInterrupt):
            error.__traceback__ = error.__context__ = None
