"""Which values of a study's parameters a figure shows, where it cannot show all, and the words that say so."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.named_places import place_of
from contactstudy.plots.labels import folded
from contactstudy.plots.style import as_written


def narrowed(dataset: xr.Dataset, selection: Mapping[str, Any]) -> xr.Dataset:
    """Part of a study with these values of its swept parameters; every dimension stays.

    Examples
    --------
    >>> study = xr.Dataset({"status": ("friction", ["ok", "ok"])}, {"friction": [0.0, 0.1]})
    >>> narrowed(study, {"friction": 0.1}).friction.values.tolist()
    [0.1]
    """
    return dataset.isel({name: [place_of(dataset, name, value)] for name, value in selection.items()})


def said(name: str, value: Any, units: str, count: int = 1) -> str:
    """One value that a figure shows, and out of how many.

    Examples
    --------
    >>> said("max_pressure", 1e9, "Pa", 2), said("profile", "crowned", "")
    ('$p_0$ = 1 GPa (1 of 2)', 'profile = crowned')
    """
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    text = quantity(float(value), units or "1") if number else as_written(value)
    return f"{_readable(name)} = {text}" + (f" (1 of {count})" if count > 1 else "")


def _readable(name: str) -> str:
    """Name of a parameter as it is written in a title."""
    if name == "max_pressure":
        return "$p_0$"
    return name.replace("_over_a", "/a").replace("_", " ")


def in_lines(parts: list[str], width: int, start: str = "") -> str:
    r"""Words of a title, in lines that break between the values.

    Examples
    --------
    >>> in_lines(["friction = 0", "body = finite-length"], 20)
    'friction = 0,\nbody = finite-length'
    """
    lines = [start]
    for number, part in enumerate(parts):
        text = part + ("," if number + 1 < len(parts) else "")
        joined = f"{lines[-1]} {text}".strip()
        if lines[-1] and len(joined) > width:
            lines.append(text)
        else:
            lines[-1] = joined
    return "\n".join(folded(line, width) for line in lines)
