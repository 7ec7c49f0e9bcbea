"""Numbers of a study: of a sensible size, and to as many digits as count."""

from __future__ import annotations

from contactstudy import checks
from contactstudy.errors import InvalidInputError

# Significant digits of a number in a study: more would tell apart values that are the same.
DIGITS = 12

# As for every other number; 0 is one as well.
SMALLEST, LARGEST = 1 / checks.LARGEST, checks.LARGEST


def rounded(value: float) -> float:
    """Return `value` to :data:`DIGITS` significant digits, with one zero instead of two.

    Examples
    --------
    >>> rounded(0.1 + 0.2), rounded(-0.0)
    (0.3, 0.0)
    """
    return float(f"{value:.{DIGITS}g}") + 0.0


def number(name: str, value: object) -> float:
    """Return a number of a sensible size, rounded.

    Examples
    --------
    >>> number("friction", 0.1 + 0.2)
    0.3
    """
    found = checks.finite(name, value)
    if found and not SMALLEST <= abs(found) <= LARGEST:
        raise InvalidInputError(name, value, f"0, or of a size from {SMALLEST:g} to {LARGEST:g}", "units are SI")
    return rounded(found)
