"""Checks of single arguments, each raising :class:`~contactstudy.errors.InvalidInputError`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from numbers import Integral, Real
from typing import Any

import numpy as np
import numpy.typing as npt

from contactstudy.errors import InvalidInputError
from contactstudy.near_names import nearest
from contactstudy.unit_sizes import factor_to

Array = npt.NDArray[Any]
FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

REAL = "biufO"
"""Kinds of arrays whose values can be real numbers: not complex ones, dates or texts."""


def store(checked: object, **values: object) -> None:
    """Store checked values in the fields of a frozen dataclass, from its ``__post_init__``."""
    for name, value in values.items():
        object.__setattr__(checked, name, value)


LARGEST = 1e50
"""Largest number that is taken, and one over the smallest positive one: far beyond every quantity in SI units, and
small enough for products of a few to be numbers as well."""


def _float(value: Real) -> float:
    """Return a real number as a float; one beyond the range of floats is infinite."""
    try:
        return float(value)
    except OverflowError:
        return np.inf


SI_WORDS = {"": "1", "metres": "m", "radians": "rad"}
"""What messages call units, where that is not the unit itself."""


def scalar(name: str, value: Any, unit: str = "") -> Any:
    """Return the number in an array without dimensions, in SI if an attribute ``units`` says what it is in.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : object
        A 0-d array of numpy, or a DataArray such as a scalar of a result. All else is returned as it is.
    unit : str
        Unit in SI, as messages call it.

    Raises
    ------
    InvalidInputError
        If the array says a unit that is not known for this quantity.

    Examples
    --------
    >>> scalar("young", np.array(210e9), "Pa")
    210000000000.0
    """
    if isinstance(value, np.generic) or getattr(value, "ndim", None) != 0 or not hasattr(value, "item"):
        return value
    # By way of numpy: a lazy array has no item().
    number, said = np.asarray(value).item(), getattr(value, "attrs", {}).get("units")
    known = SI_WORDS.get(unit, unit.partition(",")[0])  # "m/s, of rolling" is in m/s
    if said is None or said == known or isinstance(number, bool) or not isinstance(number, Real):
        return number
    return factor_to(known, f"{name}.attrs['units']", said) * _float(number)


def finite(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float, or raise if it is not a finite real number."""
    return _within(name, value, unit, -LARGEST, f"a finite number{_suffix(unit)}")


def positive(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float, or raise if it is not a positive finite number."""
    return _within(name, value, unit, 1 / LARGEST, f"a positive finite number{_suffix(unit)}")


def not_negative(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float, or raise if it is not a finite number >= 0."""
    return _within(name, value, unit, 0.0, f"a finite number not below zero{_suffix(unit)}")


def _suffix(unit: str) -> str:
    """Return a unit in brackets, if there is one."""
    return f" ({unit})" if unit else ""


def _within(name: str, value: object, unit: str, least: float, allowed: str) -> float:
    """Return a real number from `least` to `LARGEST`, or raise."""
    number = scalar(name, value, unit)
    if not isinstance(number, bool) and isinstance(number, Real):
        found = _float(number)
        if least <= found <= LARGEST:
            return found
        if np.isfinite(found) and (found > 0 or least < 0):
            sizes = f"{1 / LARGEST:g} to {LARGEST:g}"
            raise InvalidInputError(name, value, f"{allowed}, of a size from {sizes}", "units are SI")
    raise InvalidInputError(name, value, allowed)


def count(name: str, value: object, least: int = 1) -> int:
    """Return `value` as an int, or raise if it is not a whole number >= `least`."""
    value = scalar(name, value)
    if isinstance(value, bool) or not isinstance(value, Integral) or int(value) < least:
        raise InvalidInputError(name, value, f"a whole number not below {least}")
    return int(value)


def instance(name: str, value: object, kind: type | tuple[type, ...], allowed: str) -> None:
    """Raise if `value` is not an instance of `kind`; `allowed` names it for the reader."""
    if not isinstance(value, kind):
        raise InvalidInputError(name, value, f"{allowed}, not {type(value).__name__}")


def known_name(name: str, value: str, known: Iterable[str]) -> str:
    """Return `value` if it is one of `known`, or raise with the nearest known name."""
    names = sorted(known)
    if value in names:
        return value
    near = nearest(value, names, likeness=0.5)
    hint = f"did you mean {near!r}?" if near else ""
    raise InvalidInputError(name, value, f"one of {', '.join(names)}", hint)


@contextmanager
def writing(path: object) -> Iterator[None]:
    """Turn what the system says against writing a file into an error that names the path."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise InvalidInputError("path", str(path), "a file that can be written", reason.lower()) from None


def coordinates(name: str, values: object, unit: str = "m") -> FloatArray:
    """Return `values` as a one-dimensional float array, or raise if it is empty, not numbers, or not finite."""
    try:
        if np.asarray(values).dtype.kind not in REAL:
            raise TypeError
        array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise InvalidInputError(name, values, f"numbers ({unit})") from None
    if array.ndim != 1 or array.size == 0:
        raise InvalidInputError(name, values, f"a non-empty one-dimensional sequence ({unit})")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise InvalidInputError(name, f"{array[bad[0]]} at position {bad[0]}", f"finite everywhere ({unit})")
    large = np.flatnonzero(np.abs(array) > LARGEST)
    if large.size:
        allowed = f"at most {LARGEST:g} everywhere ({unit})"
        raise InvalidInputError(name, f"{array[large[0]]} at position {large[0]}", allowed, "units are SI")
    return array
