"""Exceptions and warnings of the package.

Every error that a user can cause derives from :class:`ContactStudyError`, so a script can tell a bad case from a
programming mistake with one ``except`` clause.
"""

from __future__ import annotations

from typing import Any


class ContactStudyError(Exception):
    """Base class of all errors raised by contactstudy."""


class InvalidInputError(ContactStudyError, ValueError):
    """A parameter has a value that the calculation does not allow.

    Parameters
    ----------
    parameter : str
        Name of the parameter as the caller wrote it.
    value : object
        The value that was given.
    allowed : str
        What is allowed, as the end of the sentence "must be ...".
    hint : str, optional
        What to do about it.

    Examples
    --------
    >>> raise InvalidInputError("length", -1.0, "a positive finite number (metres)")
    Traceback (most recent call last):
    contactstudy.errors.InvalidInputError: length = -1.0: must be a positive finite number (metres)
    """

    def __init__(self, parameter: str, value: object, allowed: str, hint: str = "") -> None:
        self.parameter = parameter
        self.value = value
        self.allowed = allowed
        self.hint = hint
        message = f"{parameter} = {_shown(value)}: must be {allowed}"
        super().__init__(f"{message}; {hint}" if hint else message)

    def __reduce__(self) -> tuple[type, tuple[str, object, str, str]]:
        """Pickle through the constructor: errors cross process borders in a study."""
        return type(self), (self.parameter, self.value, self.allowed, self.hint)


def _shown(value: Any) -> str:
    """Return a value on one short line: of an array its kind and shape, of one without dimensions the number.

    A lazy array is not computed for it.
    """
    try:
        shape, dtype = getattr(value, "shape", None), getattr(value, "dtype", None)
        if isinstance(value, type):  # its attributes are those of its instances
            shown = repr(value)
        elif hasattr(value, "data_vars"):
            shown = f"{type(value).__name__} of {len(value.data_vars)} variables"
        elif dtype is None or not isinstance(shape, tuple):
            shown = " ".join(line.strip() for line in repr(value).splitlines())
        elif getattr(value, "chunks", None) is not None:
            shown = f"lazy {type(value).__name__} of {f'shape {shape} and ' if shape else ''}type {dtype}"
        elif shape:
            shown = f"{type(value).__name__} of shape {shape} and type {dtype}"
        else:
            unit = getattr(value, "attrs", {}).get("units")
            shown = repr(value.item()) + (f" {unit}" if isinstance(unit, str) else "")
    except (ValueError, RecursionError):  # a whole number of thousands of digits, tables within tables
        shown = f"a {type(value).__name__} that is too large to show"
    return shown if len(shown) <= 120 else shown[:117] + "..."


class WindowError(ContactStudyError):
    """The contact reaches the edge of the window in y, so the window is too narrow for the load."""


class Terminated(KeyboardInterrupt):
    """A run was asked to end by SIGTERM; everything that Ctrl-C does happens as well."""


class ConvergenceWarning(UserWarning):
    """The contact iteration stopped before its tolerance; the result says ``converged = False``."""


class MagnitudeWarning(UserWarning):
    """A value is of a size that is mostly a mistake in the unit; it is taken as it is."""


class TemperatureWarning(UserWarning):
    """The temperature of a contact passes the limit that was given."""


class BoundWarning(UserWarning):
    """A best value lies at the bound of where it was sought."""
