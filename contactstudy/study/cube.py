"""How the cases of a study lie along labelled dimensions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Labeller = Callable[[str, Any], Any]

LARGEST_FILL = 4
"""A cube may have this many cells per case; sparser explicit cases are listed along one dimension `case`."""


@dataclass(frozen=True)
class Axis:
    """One factor of a product: a swept parameter, or several zipped ones.

    Parameters
    ----------
    entries : tuple of dict
        The parameters that each step sets; the same names in each.
    """

    entries: tuple[dict[str, Any], ...]


@dataclass(frozen=True)
class Cube:
    """Dimensions of a study's Dataset.

    Parameters
    ----------
    dims : tuple of str
        Names, in order.
    shape : tuple of int
        Sizes.
    labels : dict
        Name of a coordinate to its dimension and its values along that.
    """

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    labels: dict[str, tuple[str, list[Any]]]


def _unique(values: Sequence[Any]) -> list[Any]:
    """Different values in the order in which they first appear."""
    return list(dict.fromkeys(values))


def cube_of_axes(axes: Sequence[Axis], label: Labeller) -> Cube:
    """Cube of a product: one dimension per axis.

    A zipped axis is named after its first parameter whose values all differ, and carries the others as coordinates.
    """
    if not axes:
        return Cube(("case",), (1,), {"case": ("case", [0])})
    dims, shape, labels = [], [], {}
    for axis in axes:
        columns = {name: [label(name, entry[name]) for entry in axis.entries] for name in axis.entries[0]}
        distinct = [name for name, column in columns.items() if len(_unique(column)) == len(column)]
        dim = distinct[0] if distinct else "_and_".join(columns)
        if not distinct:
            labels[dim] = (dim, list(range(len(axis.entries))))
        for name, column in columns.items():
            labels[name] = (dim, column)
        dims.append(dim)
        shape.append(len(axis.entries))
    return Cube(tuple(dims), tuple(shape), labels)


def cube_of_cases(cases: Sequence[Mapping[str, Any]], label: Labeller) -> tuple[Cube, list[tuple[int, ...]]]:
    """Cube of cases that are no product, and each case's place in it.

    The dimensions are the parameters that differ, if that does not leave too much of the cube empty; else one
    dimension `case` with the parameters as coordinates.
    """
    names = list(dict.fromkeys(name for case in cases for name in case))
    rows = [{name: label(name, case.get(name)) if name in case else None for name in names} for case in cases]
    columns = {name: _unique([row[name] for row in rows]) for name in names}
    varying = {name: column for name, column in columns.items() if len(column) > 1}
    cells = 1
    for column in varying.values():
        cells *= len(column)
    complete = all(None not in column for column in varying.values())
    places = {name: {value: place for place, value in enumerate(column)} for name, column in varying.items()}
    positions = [tuple(places[name][row[name]] for name in varying) for row in rows]
    if varying and complete and cells <= LARGEST_FILL * len(cases) and len(set(positions)) == len(positions):
        labels = {name: (name, column) for name, column in varying.items()}
        return Cube(tuple(varying), tuple(len(column) for column in varying.values()), labels), positions
    labels = {"case": ("case", list(range(len(cases))))}
    for name in varying:
        labels[name] = ("case", [row[name] for row in rows])
    return Cube(("case",), (len(cases),), labels), [(index,) for index in range(len(cases))]
