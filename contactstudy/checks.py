"""Checks of single arguments, each raising :class:`~contactstudy.errors.InvalidInputError`."""

from __future__ import annotations

import json
import math
import os
import uuid
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from difflib import get_close_matches
from numbers import Integral, Real
from pathlib import Path
from types import UnionType
from typing import Any

import numpy as np
import numpy.typing as npt

from contactstudy.errors import InvalidInputError, StoreError

UNIT_SIZES: dict[str, dict[str, float]] = {  # input units by their SI unit, and their sizes
    "m": {
        "m": 1.0,
        "mm": 1e-3,
        **dict.fromkeys(("um", "µm", "μm", "micrometer", "micron"), 1e-6),
        "nm": 1e-9,
        "km": 1e3,
        **dict.fromkeys(("metre", "meter", "metres", "meters"), 1.0),
    },
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm2": 1e6, "N/mm^2": 1e6, "N mm-2": 1e6, "bar": 1e5},
    "N": {"N": 1.0, "kN": 1e3},
    "N m": {"N m": 1.0, "Nm": 1.0, "N*m": 1.0, "N.m": 1.0, "N mm": 1e-3, "Nmm": 1e-3},
    "rad": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "degree": math.pi / 180, "degrees": math.pi / 180},
    "Pa s": {"Pa s": 1.0, "mPa s": 1e-3},
    "1/Pa": {"1/Pa": 1.0, "1/GPa": 1e-9, "mm2/N": 1e-6},
    "kg/m3": {"kg/m3": 1.0, "g/cm3": 1e3},
    "J/(kg K)": {"J/(kg K)": 1.0, "J/(g K)": 1e3},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "km/h": 1 / 3.6},
    "rad/m": {"rad/m": 1.0, "1/m": 1.0, "rad/mm": 1e3, "1/mm": 1e3},
    "1": {"1": 1.0, "%": 0.01, "percent": 0.01},
}


def factor_to(unit: str, name: str, input_unit: object) -> float:
    """Return the factor that converts values in `input_unit` to `unit`, an SI unit."""
    sizes = UNIT_SIZES.get(unit, {})
    if not isinstance(input_unit, str) or input_unit.strip() not in sizes:
        allowed = f"one of {', '.join(sizes)}" if sizes else "left out"
        raise InvalidInputError(name, input_unit, allowed, f"without it {unit} is meant" if sizes else "")
    return sizes[input_unit.strip()]


Array = npt.NDArray[Any]
FloatArray = npt.NDArray[np.float64]
SingleArray = npt.NDArray[np.float32]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]
TEMPORARY_SUFFIX = ".part"  # Suffix of an unfinished file
REAL_KINDS = "biufO"  # Kinds of arrays whose values can be real numbers: not complex numbers, dates or texts


def store(target: object, **values: object) -> None:
    """Store checked values in the fields of an instance of a frozen dataclass, from its ``__post_init__``."""
    for name, value in values.items():
        object.__setattr__(target, name, value)


MAX_MAGNITUDE = 1e50
"""Largest accepted number; its inverse is the smallest accepted positive number. It exceeds every quantity in SI units,
but products of a few such numbers remain finite."""


def _float(value: Real) -> float:
    """Return a real number as a float; a number beyond the range of floats becomes infinite."""
    try:
        return float(value)
    except OverflowError:
        return np.inf


SI_UNITS = {"": "1", "metres": "m", "radians": "rad"}  # SI units by the words for them in messages


def scalar(name: str, value: Any, unit: str = "") -> Any:
    """Return the number in an array without dimensions, converted to SI by its `units`; other values unchanged."""
    if isinstance(value, np.generic) or getattr(value, "ndim", None) != 0 or not hasattr(value, "item"):
        return value
    # Convert through numpy, because a lazy array lacks item().
    number, unit_attribute = np.asarray(value).item(), getattr(value, "attrs", {}).get("units")
    symbol = SI_UNITS.get(unit, unit.partition(",")[0])  # the unit of "m/s, of rolling" is m/s
    if unit_attribute is None or unit_attribute == symbol or isinstance(number, bool) or not isinstance(number, Real):
        return number
    return factor_to(symbol, f"{name}.attrs['units']", unit_attribute) * _float(number)


def finite(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float, or raise if it is not a finite real number."""
    return _check_range(name, value, unit, -MAX_MAGNITUDE, "a finite number")


def positive(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float, or raise if it is not a positive finite number."""
    return _check_range(name, value, unit, 1 / MAX_MAGNITUDE, "a positive finite number")


def not_negative(name: str, value: object, unit: str = "") -> float:
    """Return `value` as a float, or raise if it is not a finite number >= 0."""
    return _check_range(name, value, unit, 0.0, "a finite number not below zero")


def _check_range(name: str, value: object, unit: str, minimum: float, allowed: str) -> float:
    """Return a real number from `minimum` to `MAX_MAGNITUDE`, or raise."""
    allowed += f" ({unit})" if unit else ""
    number = scalar(name, value, unit)
    if not isinstance(number, bool) and isinstance(number, Real):
        real_number = _float(number)
        if minimum <= real_number <= MAX_MAGNITUDE:
            return real_number
        if np.isfinite(real_number) and (real_number > 0 or minimum < 0):
            sizes = f"{1 / MAX_MAGNITUDE:g} to {MAX_MAGNITUDE:g}"
            raise InvalidInputError(name, value, f"{allowed}, of a size from {sizes}", "units are SI")
    raise InvalidInputError(name, value, allowed)


def number(check: Callable[[str, object, str], float], unit: str = "") -> dict[str, Any]:
    """Metadata of a field of a dataclass that holds a number: its check and unit."""
    return {"check": check, "unit": unit}


def store_numbers(target: Any) -> None:
    """Check the numbers in the fields of a dataclass and store them as floats; None passes only as the default."""
    for entry in fields(target):
        value, check = getattr(target, entry.name), entry.metadata.get("check")
        if check is not None and not (value is None and entry.default is None):
            store(target, **{entry.name: check(entry.name, value, entry.metadata["unit"])})


def count(name: str, value: object, minimum: int = 1) -> int:
    """Return `value` as an int, or raise if it is not a whole number >= `minimum`."""
    value = scalar(name, value)
    if isinstance(value, bool) or not isinstance(value, Integral) or int(value) < minimum:
        raise InvalidInputError(name, value, f"a whole number not below {minimum}")
    return int(value)


def instance(name: str, value: object, kind: type | UnionType | tuple[type, ...], allowed: str) -> None:
    """Raise if `value` is not an instance of `kind`; `allowed` describes the expected type."""
    if not isinstance(value, kind):
        raise InvalidInputError(name, value, f"{allowed}, not {type(value).__name__}")


def known_name(name: str, value: str, names: Iterable[str]) -> str:
    """Return `value` if it is one of `names`; else raise with the nearest names, or with all names up to twenty."""
    instance(name, value, str, "a name")
    names = sorted(names)
    if value in names:
        return value
    close_matches = get_close_matches(value, names, n=1, cutoff=0.5)
    hint = f"did you mean {close_matches[0]!r}?" if close_matches else ""
    listed_names = names if len(names) <= 20 else get_close_matches(value, names, n=3, cutoff=0.0)
    remainder_text = "" if listed_names is names else f", or one of {len(names) - 3} further names"
    raise InvalidInputError(name, value, f"one of {', '.join(listed_names)}{remainder_text}", hint)


@contextmanager
def name_argument(name: str) -> Iterator[None]:
    """Prefix an argument's name to the parameter of an error in the argument's value."""
    try:
        yield
    except InvalidInputError as error:
        raise InvalidInputError(f"{name}.{error.parameter}", error.value, error.allowed, error.hint) from error


MAX_TEXT = 100_000_000  # Characters of a study's file: some hundred profiles of 50 000 points


def read_tables(source: Path | str, loads: Callable[[str], Any] = json.loads) -> Any:
    """Read JSON or TOML from a file or a text; too many characters or nested tables raise a ValueError."""
    if isinstance(source, Path):
        with open(source, encoding="utf-8-sig") as file:
            source = file.read(MAX_TEXT)
    if len(source) >= MAX_TEXT:
        raise ValueError(f"it has more than {MAX_TEXT:.0e} characters")
    try:
        return loads(source)
    except RecursionError:
        raise ValueError("nested too deeply for a study") from None


@contextmanager
def convert_os_errors(action: str) -> Iterator[None]:
    """Raise an error of the file system as a StoreError of the action that failed."""
    try:
        yield
    except OSError as error:
        raise StoreError(f"cannot {action}: {error.strerror or error}") from error


@contextmanager
def writing(path: Path, name: Callable[[Path], str] | None = None) -> Iterator[Path]:
    """Yield a temporary path; the complete file replaces `path`, or has the name ``name(temporary_path)``.

    After a failed write the previous file remains, and a StoreError is raised. A device or pipe is written to directly.
    """
    if path.is_dir():
        raise StoreError(f"cannot write {path}: it is a folder")
    temporary_path = path.with_name(f"{path.name}.{uuid.uuid4().hex[:12]}{TEMPORARY_SUFFIX}")
    with convert_os_errors(f"write {path}"):
        if path.exists() and not path.is_file():
            with open(os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0)), "wb"):  # raises for an unread pipe
                yield path
            return
        try:
            yield temporary_path
            with open(temporary_path, "rb+") as file:
                os.fsync(file.fileno())
            os.replace(temporary_path, path if name is None else path.with_name(name(temporary_path)))
        finally:
            temporary_path.unlink(missing_ok=True)


def coordinates(name: str, values: object, unit: str = "m") -> FloatArray:
    """Return `values` as a one-dimensional float array; raise if they are empty, not numbers, or not finite."""
    try:
        if np.asarray(values).dtype.kind not in REAL_KINDS:
            raise TypeError
        array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise InvalidInputError(name, values, f"numbers ({unit})") from None
    if array.ndim != 1 or array.size == 0:
        raise InvalidInputError(name, values, f"a non-empty one-dimensional sequence ({unit})")
    invalid_indices = np.flatnonzero(~(np.abs(array) <= MAX_MAGNITUDE))
    if invalid_indices.size:
        allowed = f"finite everywhere, of a size up to {MAX_MAGNITUDE:g} ({unit})"
        value = f"{array[invalid_indices[0]]} at position {invalid_indices[0]}"
        raise InvalidInputError(name, value, allowed, "units are SI")
    return array


def increasing(name: str, values: object, unit: str = "m", minimum: int = 1) -> FloatArray:
    """Return `values` as `coordinates` does; raise unless they increase and are at least `minimum`."""
    array = coordinates(name, values, unit)
    if array.size < minimum or (np.diff(array) <= 0).any():
        raise InvalidInputError(name, array.tolist(), f"{minimum} or more increasing numbers ({unit})")
    return array
