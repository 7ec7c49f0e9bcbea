"""A first guess of stick and slip, from coarser cells or from almost the same bound."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.contact.coulomb import Guess
from contactstudy.contact.leading_edge import RollingCells
from contactstudy.contact.tractions import Tractions

STICKING = 0.999
"""Largest part of its bound that a guess gives a cell that sticks. Speed."""


class Coarser(NamedTuple):
    """A solution on coarser cells.

    Attributes
    ----------
    grid : Grid
        Cells; half as many along y, and along x half as many or the same.
    bound : array (x, y)
        Bound on the traction, Pa.
    found : Tractions
        The solution.
    """

    grid: Grid
    bound: FloatArray
    found: Tractions


def guess_from(coarser: Coarser, cells: RollingCells, bound: FloatArray, modes: tuple[str, ...]) -> Guess:
    """Return a guess for finer cells with a given bound (x, y)."""
    row, column = cells.unknown
    factor = bound.shape[0] // coarser.grid.cells_x
    part = coarser.found.traction / np.where(coarser.bound > 0, coarser.bound, 1.0)
    # Cells that slip have all of their bound; inside the stick zone the part is interpolated.
    near = row // factor, column // 2
    own = part[:, near[0], near[1]]
    fine = _between_cells(part, 2)
    if factor == 2:
        fine = _between_cells(fine, 1)
    smooth = fine[:, row, column]
    size = np.hypot(*smooth)
    limited = smooth * np.minimum(1.0, STICKING / np.where(size > 0, size, 1.0))
    traction = np.where(coarser.found.sticks[near], limited, own) * bound[row, column]
    return Guess(traction, np.array([coarser.found.rigid[name] for name in modes]))


def guess_of(last: Tractions, cells: RollingCells, bound: FloatArray, modes: tuple[str, ...]) -> Guess:
    """Return a guess from tractions on the same cells under a bound (x, y) that was almost the same."""
    on_cells = tuple(cells.unknown)
    traction, limit = last.traction[:, *on_cells], bound[on_cells]
    size = np.hypot(*traction)
    held = np.where(last.sticks[on_cells], np.minimum(size, STICKING * limit), limit)
    amplitudes = np.array([last.rigid[name] for name in modes])
    return Guess(traction * (held / np.where(size > 0, size, 1.0)), amplitudes)


def joined(values: FloatArray) -> FloatArray:
    """Means (x, y) over cells of twice the size."""
    rows, columns = values.shape
    return np.asarray(values.reshape(rows // 2, 2, columns // 2, 2).mean(axis=(1, 3)))


def _between_cells(values: FloatArray, axis: int) -> FloatArray:
    """Values (component, x, y) on cells of half the size along an axis, linear between the centres."""
    first, last = np.take(values, [0], axis=axis), np.take(values, [-1], axis=axis)
    padded = np.concatenate([first, values, last], axis=axis)
    count = values.shape[axis]
    middle, low, high = (np.take(padded, np.arange(start, start + count), axis=axis) for start in (1, 0, 2))
    halves = np.stack([0.75 * middle + 0.25 * low, 0.75 * middle + 0.25 * high], axis=axis + 1)
    shape = list(values.shape)
    shape[axis] *= 2
    return halves.reshape(shape)
