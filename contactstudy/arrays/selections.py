"""Indices of values along the dimensions of a study, from the values as numbers or texts."""

from __future__ import annotations

import math
from collections.abc import Iterable

import xarray as xr

from contactstudy.errors import InvalidInputError


def index_of(dataset: xr.Dataset | xr.DataArray, name: str, value: object, argument: str = "selection") -> int:
    """Return the index of a value of a swept parameter along its dimension."""
    if name not in dataset.indexes:
        swept = dataset["status"].dims if isinstance(dataset, xr.Dataset) and "status" in dataset else ()
        raise InvalidInputError(argument, name, f"a swept parameter: {', '.join(map(str, swept)) or 'none'}")
    labels = dataset.indexes[name]
    indices = [index for index, label in enumerate(labels) if _equals(value, label)]
    if not indices:
        raise InvalidInputError(f"{argument}[{name!r}]", value, f"one of {', '.join(map(str, labels))}")
    return indices[0]


def _equals(value: object, label: object) -> bool:
    """Whether a value, or the text of a value, equals a label."""
    if isinstance(label, str):
        return str(value) == label
    try:
        return math.isclose(float(str(value)), float(str(label)), rel_tol=1e-9)
    except ValueError:
        return bool(value == label)


def selection_of(texts: Iterable[str]) -> dict[str, str]:
    """Values of swept parameters by name, each given as ``NAME=VALUE``."""
    selection = {}
    for text in texts:
        name, separator, value = text.partition("=")
        if not separator:
            raise InvalidInputError("select", text, "NAME=VALUE with the name and a value of a swept parameter")
        selection[name] = value
    return selection
