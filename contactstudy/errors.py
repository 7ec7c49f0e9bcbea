"""Exceptions and warnings of the package.

Every error that a user can cause derives from :class:`ContactStudyError`, so one ``except`` clause of a script
separates a bad case from a programming error.
"""

from __future__ import annotations

from typing import Any


class ContactStudyError(Exception):
    """Base class of all errors raised by contactstudy."""


class FilmError(ContactStudyError):
    """No film separates the surfaces, or the film's iteration does not converge."""


class InvalidInputError(ContactStudyError, ValueError):
    """A parameter has a value that the calculation does not allow.

    Parameters
    ----------
    parameter : str
        Name of the parameter as the caller wrote it.
    value : object
        The value that was given.
    allowed : str
        Allowed values, as the end of the sentence "must be ...".
    hint : str, optional
        Advice.

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
        message = f"{parameter} = {_format_value(value)}: must be {allowed}"
        super().__init__(f"{message}; {hint}" if hint else message)

    def __reduce__(self) -> tuple[type, tuple[str, object, str, str]]:
        """Pickle through the constructor: errors cross process borders in a study."""
        return type(self), (self.parameter, self.value, self.allowed, self.hint)


def _format_value(value: Any) -> str:
    """Return the text of a value on one short line; for an array, type and shape, without computing a lazy array."""
    try:
        shape, dtype = getattr(value, "shape", None), getattr(value, "dtype", None)
        if isinstance(value, type):  # a class has the attributes of its instances
            text = repr(value)
        elif hasattr(value, "data_vars"):
            text = f"{type(value).__name__} of {len(value.data_vars)} variables"
        elif dtype is None or not isinstance(shape, tuple):
            text = " ".join(line.strip() for line in repr(value).splitlines())
        elif getattr(value, "chunks", None) is not None:
            text = f"lazy {type(value).__name__} of {f'shape {shape} and ' if shape else ''}type {dtype}"
        elif shape:
            text = f"{type(value).__name__} of shape {shape} and type {dtype}"
        else:
            unit = getattr(value, "attrs", {}).get("units")
            text = repr(value.item()) + (f" {unit}" if isinstance(unit, str) else "")
    except (ValueError, RecursionError):  # a whole number of thousands of digits, or deeply nested tables
        text = f"a {type(value).__name__} that is too large to show"
    return text if len(text) <= 120 else text[:117] + "..."


class StudyFileError(ContactStudyError):
    """A study file cannot be read, or no case of the study can be solved."""


class StoreError(ContactStudyError):
    """A result cannot be written or read: a full disk, a missing permission, a damaged file; ends a run."""


class LockedError(ContactStudyError):
    """Another process is running a study in the same folder."""


class WindowError(ContactStudyError):
    """The contact reaches the edge of the window in y, so the window is too narrow for the load."""


class Terminated(KeyboardInterrupt):
    """SIGTERM or SIGHUP ended a run; the cleanup is the same as after Ctrl-C."""

    signal_number = 15


class ConvergenceWarning(UserWarning):
    """The contact iteration stopped before its tolerance; ``converged`` is False in the result."""


class MagnitudeWarning(UserWarning):
    """A value lies outside its usual range, which suggests a wrong unit; the calculation uses the value unchanged."""


class TemperatureWarning(UserWarning):
    """The temperature of a contact exceeds the given limit."""


class BoundWarning(UserWarning):
    """The optimum equals a bound of the search range."""
