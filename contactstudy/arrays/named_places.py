"""Places of values along the dimensions of a study, named by a number or by a text."""

from __future__ import annotations

import math
from collections.abc import Iterable

import xarray as xr

from contactstudy.errors import InvalidInputError


def place_of(dataset: xr.Dataset | xr.DataArray, name: str, value: object, argument: str = "selection") -> int:
    """Return the number of a value of a swept parameter.

    Parameters
    ----------
    dataset : Dataset or DataArray
        Of a study.
    name : str
        Swept parameter.
    value : object
        Its value: as it stands, or as a text that names it; numbers to nine digits.
    argument : str
        Name of the argument that messages speak of.

    Raises
    ------
    InvalidInputError
        If there is no such parameter, or it does not take the value.

    Examples
    --------
    >>> swept = xr.Dataset(coords={"friction": [0.0, 0.1]})
    >>> place_of(swept, "friction", 0.1), place_of(swept, "friction", "0.10")
    (1, 1)
    """
    if name not in dataset.indexes:
        known = dataset["status"].dims if isinstance(dataset, xr.Dataset) and "status" in dataset else ()
        raise InvalidInputError(argument, name, f"a swept parameter: {', '.join(map(str, known)) or 'none'}")
    labels = dataset.indexes[name]
    found = [number for number, label in enumerate(labels) if _same(value, label)]
    if not found:
        raise InvalidInputError(f"{argument}[{name!r}]", value, f"one of {', '.join(map(str, labels))}")
    return found[0]


def _same(value: object, label: object) -> bool:
    """Whether a value, or the text of one, is a label."""
    if isinstance(label, str):
        return str(value) == label
    try:
        return math.isclose(float(str(value)), float(str(label)), rel_tol=1e-9)
    except ValueError:
        return bool(value == label)


def selection_of(texts: Iterable[str]) -> dict[str, str]:
    """Values of swept parameters by name, each given as ``NAME=VALUE``.

    Raises
    ------
    InvalidInputError
        If a text is something else.

    Examples
    --------
    >>> selection_of(["friction=0.1", "profile=crowned"])
    {'friction': '0.1', 'profile': 'crowned'}
    """
    found = {}
    for text in texts:
        name, given, value = text.partition("=")
        if not given:
            raise InvalidInputError("select", text, "NAME=VALUE with the name and a value of a swept parameter")
        found[name] = value
    return found
