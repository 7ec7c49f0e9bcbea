"""Warnings that point to the caller's line, however deep in the package the reason is found."""

from __future__ import annotations

import sys
import warnings

BETWEEN = ("contactstudy", "contextlib", "dataclasses")
"""Modules whose frames may stand between the caller and the warning."""


def warn(message: str, category: type[Warning]) -> None:
    """Warn of something; the line that is shown is the last one outside of this package.

    Examples
    --------
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     warn("not converged", UserWarning)
    >>> "contactstudy" in caught[0].filename
    False
    """
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] in BETWEEN:
        level, frame = level + 1, frame.f_back
    warnings.warn(message, category, stacklevel=level)
