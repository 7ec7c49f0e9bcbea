"""Where the pressure jumps from column to column, so that these are split."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.contact.axial_shape import centres_of

POWERS = (2.0, 16.0)
"""Powers of the pressure whose jumps are marked. Accuracy."""

LESSER_HALF = 0.1
"""Least pressure of a half, over the largest, that jumps in this half are measured by. Accuracy."""


def pressure_jumps(edges: FloatArray, pressure: FloatArray) -> FloatArray:
    """Per column: largest step of the pressure's powers to a neighbour, over the peak of its half or its own crest."""
    jumps = [_jumps(edges, pressure, power) for power in POWERS]
    return np.asarray(np.max([*jumps, _at_crests(pressure)], axis=0))


def _at_crests(pressure: FloatArray) -> FloatArray:
    """Per column: where its pressure is above that of both neighbours, the larger step of its square, over this square.

    A narrow crest beside a contact's end may be lower than the peak of its half, by which jumps are measured.
    """
    top = pressure.max(axis=1)
    own, lowest = top[1:-1], np.minimum(top[:-2], top[2:])
    crest = (own > top[:-2]) & (own > top[2:]) & (own > LESSER_HALF * top.max())
    steps = np.zeros_like(top)
    steps[1:-1][crest] = 1 - (lowest[crest] / own[crest]) ** POWERS[0]
    return np.asarray(steps)


def _jumps(edges: FloatArray, pressure: FloatArray, power: float) -> FloatArray:
    """Per column: largest step of a power of the pressure to a neighbour, over its largest in the same half."""
    left = centres_of(edges) < 0.5 * (edges[0] + edges[-1])
    top = np.where(left, pressure[left].max(), pressure[~left].max())
    top = np.maximum(top, LESSER_HALF * pressure.max())
    steps = np.abs(np.diff((pressure / pressure.max()) ** power, axis=0)).max(axis=1)
    return np.asarray(np.maximum(np.append(steps, 0), np.insert(steps, 0, 0)) / (top / pressure.max()) ** power)
