"""Numbers with a decimal point or, where it cannot be anything else, a decimal comma."""

from __future__ import annotations

import re

import numpy as np

from contactstudy.errors import InvalidInputError

NUMBER = re.compile(r"\s*[+-]?(?:(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?|nan|inf)\s*", re.ASCII | re.IGNORECASE)

THOUSANDS = re.compile(r"\s*[+-]?[1-9]\d{0,2},\d{3}\s*", re.ASCII)
"""A number that could have a comma between its thousands."""

LONGEST_QUOTE = 24


def quoted(text: str) -> str:
    """Return the beginning of what a file says: enough to find the place, not enough to give a foreign file away.

    Examples
    --------
    >>> quoted("0.1, 0.2")
    '0.1, 0.2'
    >>> quoted("a secret that stands in a file of somebody else")
    'a secret that stands ...'
    """
    text = text.strip()
    return text if len(text) <= LONGEST_QUOTE else f"{text[: LONGEST_QUOTE - 3]}..."


class Numbers:
    """The numbers of one file, which all have the same decimal mark.

    A comma is one only where it does not separate the columns, no number of the file has a point, and at least one
    number cannot have a comma between its thousands instead.

    Parameters
    ----------
    separator : str
        What stands between the columns.

    Examples
    --------
    >>> numbers = Numbers(";")
    >>> [numbers.read(number, "x", field) for number, field in enumerate(["0,5", "1,250", "1e3"], start=2)]
    [0.5, 1.25, 1000.0]
    >>> numbers.check()
    """

    def __init__(self, separator: str) -> None:
        self._may_be_comma = separator != ","
        self._with_point: tuple[str, str] | None = None
        self._with_comma: tuple[str, str] | None = None
        self._sure = False

    def read(self, line: int, name: str, field: str) -> float:
        """Return a field of a column as a number; an empty one is NaN."""
        # Python's own reading takes underscores and the digits of all scripts as well.
        if NUMBER.fullmatch(field):
            if self._with_point is None and "." in field:
                self._with_point = f"line {line}, {name}", field
            return float(field)
        if not field.strip():
            return np.nan
        if self._may_be_comma and "." not in field and NUMBER.fullmatch(pointed := field.replace(",", ".", 1)):
            self._with_comma = f"line {line}, {name}", field
            self._sure = self._sure or not THOUSANDS.fullmatch(field)
            return float(pointed)
        allowed = "a number with a decimal point" + (" or comma" if self._may_be_comma else "")
        raise InvalidInputError(f"line {line}, {name}", quoted(field), allowed)

    def check(self) -> None:
        """Raise if numbers with commas could mean something else."""
        if self._with_comma is None:
            return
        place, field = self._with_comma
        if self._with_point is not None:
            other = f"{self._with_point[0]} is {quoted(self._with_point[1])!r}"
            raise InvalidInputError(place, quoted(field), "a number with the decimal mark of all others", other)
        if not self._sure:
            hint = "here it may be a decimal comma or one between thousands: write decimal points"
            raise InvalidInputError(place, quoted(field), "a number of one meaning", hint)
