"""Numbers of a study: limited size, twelve significant digits."""

from __future__ import annotations

from contactstudy import checks
from contactstudy.errors import InvalidInputError

# Significant digits of a number in a study, beyond rounding.
DIGITS = 12

SMALLEST, LARGEST = 1 / checks.LARGEST, checks.LARGEST


def rounded(value: float) -> float:
    """Return `value` to twelve significant digits, with one zero instead of two."""
    return float(f"{value:.{DIGITS}g}") + 0.0


def number(name: str, value: object) -> float:
    """Return a finite number of limited size, rounded."""
    finite = checks.finite(name, value)
    if finite and not SMALLEST <= abs(finite) <= LARGEST:
        raise InvalidInputError(name, value, f"0, or of a size from {SMALLEST:g} to {LARGEST:g}", "units are SI")
    return rounded(finite)
