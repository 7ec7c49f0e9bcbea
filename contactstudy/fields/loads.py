"""Loads on the top of a body, by direction, and the sum of what they do."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from contactstudy.cache import ArrayKey
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load

Result = TypeVar("Result")


class TopLoad(NamedTuple):
    """A load in one direction: a factor times a distribution over the cells.

    Attributes
    ----------
    cells : array (x, y)
        Load per area on each cell, Pa.
    factor : float
        Factor on it. Loads that differ by a factor share the fields that are computed for their distribution.
    """

    cells: FloatArray
    factor: float = 1.0

    @property
    def values(self) -> FloatArray:
        """The load itself, Pa."""
        return self.factor * self.cells


Loads = Mapping[Load, TopLoad]
"""What acts on the top, by direction."""


def sliding(pressure: FloatArray, friction: float | FloatArray) -> Loads:
    """Return the pressure and, in full sliding, the traction ``q = f p`` on the body along +y.

    Examples
    --------
    >>> sorted(load.name for load in sliding(np.ones((2, 2)), 0.1))
    ['ALONG_Y', 'NORMAL']
    """
    loads = {Load.NORMAL: TopLoad(pressure)}
    if isinstance(friction, np.ndarray):
        return loads | {Load.ALONG_Y: TopLoad(friction * pressure)}
    return loads | {Load.ALONG_Y: TopLoad(pressure, friction)} if friction else loads


def grouped(loads: Loads, unit: Callable[[tuple[Load, ...], FloatArray], Mapping[Load, Result]]) -> dict[Load, Result]:
    """Return what `unit` gives for each load; it is asked for loads with the same distribution together.

    Parameters
    ----------
    loads : mapping of Load to TopLoad
        At least one.
    unit : callable
        From some directions and one distribution to what it makes in each of them.
    """
    groups: dict[ArrayKey, list[Load]] = {}
    for load, (cells, _) in loads.items():
        groups.setdefault(ArrayKey(cells), []).append(load)
    found: dict[Load, Result] = {}
    for shared, directions in groups.items():
        found |= unit(tuple(directions), shared.values)
    return found


def superposed(
    loads: Loads, unit_fields: Callable[[tuple[Load, ...], FloatArray], Mapping[Load, Sequence[FloatArray]]]
) -> list[FloatArray]:
    """Sum of the fields under all loads at each of several places, from those under a distribution, see `grouped`."""
    fields = grouped(loads, unit_fields)
    first, *others = loads
    totals = [np.multiply(loads[first].factor, field, order="K") for field in fields[first]]
    for load in others:
        for total, field in zip(totals, fields[load], strict=True):
            total += loads[load].factor * field
    return totals
