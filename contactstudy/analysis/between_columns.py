"""Largest pressure and load of parts of a contact along its axis, from its columns, and what these leave open.

Columns that follow the solution are of very different widths: a peak at an edge lies in columns that are a hundredth
as wide as those in the middle. So the pressure of a part is read between the middles of its columns. Its square is
linear where a contact ends, and is taken as linear from one middle to the next.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray

STEP = 0.5
"""Part of the step of the pressure to the next column that counts as error of a part's largest pressure. Accuracy: at
0.3 it left 1 of 801 tables of crowned, straight, tilted, rounded and sharp rollers uncovered, at 0.4 none."""

MOVED = 0.25
"""Part of the step of the load per length to the next column that may lie on the wrong side of a border. Accuracy: at
0.1 it left 5 of 629 tables uncovered; at 0.25 the worst error is half of what is stated."""


GAUSS_POINTS = 6
"""Points between two middles at which a power of a linear function is integrated. Accuracy: exact for a 12th power."""


class Columns(NamedTuple):
    """Columns of a contact: edges (column, 2) and middles, m, and a quantity of each."""

    edges: FloatArray
    middles: FloatArray
    values: FloatArray

    @property
    def widths(self) -> FloatArray:
        """Width of each column, m."""
        return np.asarray(self.edges[:, 1] - self.edges[:, 0])

    def shares(self, borders: FloatArray) -> FloatArray:
        """Length that each part between two borders has of each column, m: array (part, column)."""
        low, high = self.edges.T
        shared = np.minimum(borders[1:, None], high) - np.maximum(borders[:-1, None], low)
        return np.asarray(np.clip(shared, 0.0, None))


def open_steps(values: FloatArray) -> FloatArray:
    """Part of each step from one value to the next that is open: half of it, and more where a contact ends.

    There it may end anywhere up to the middle of the next column, and a last column that is hardly pressed says nothing
    of its own middle: all of the step counts, and what the step before it leaves open.

    Examples
    --------
    >>> open_steps(np.array([0.0, 1.0, 9.0, 9.0])).tolist()
    [4.0, 4.0, 0.0]
    """
    steps = np.abs(np.diff(values))
    around = beside(STEP * steps)
    ends = (np.minimum(values[1:], values[:-1]) <= 0) & (steps > 0)
    return np.where(ends, np.maximum(steps, np.maximum(around[1:], around[:-1])), STEP * steps)


def beside(steps: FloatArray) -> FloatArray:
    """Larger one of the steps to both neighbours, of each column.

    Examples
    --------
    >>> beside(np.array([1.0, 2.0])).tolist()
    [1.0, 2.0, 2.0]
    """
    return np.asarray(np.maximum(np.append(steps, 0.0), np.insert(steps, 0, 0.0)))


def largest_between(pressure: Columns, borders: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Largest pressure of each part between two borders, and what the distance of the columns leaves open, Pa.

    Examples
    --------
    >>> columns = Columns(np.array([[0.0, 1], [1, 2], [2, 3], [3, 4]]), np.arange(4) + 0.5, np.array([1.0, 1, 2, 2]))
    >>> largest, open_ = largest_between(columns, np.array([0.0, 2.0, 4.0]))
    >>> largest.round(3).tolist(), open_.round(3).tolist()
    ([1.581, 2.0], [0.5, 0.5])
    """
    x, squares = _with_ends(pressure)
    heights = np.sqrt(squares)
    steps = open_steps(heights)
    # Where a border lies, what the two middles around it leave open counts; at a middle, what both sides do.
    places = np.concatenate([borders, x])
    values = np.concatenate([np.sqrt(np.interp(borders, x, squares)), heights])
    around = np.clip(np.searchsorted(x, borders, side="right") - 1, 0, steps.size - 1)
    reached = values + np.concatenate([steps[around], beside(steps)])
    largest, left_open = np.empty(borders.size - 1), np.empty(borders.size - 1)
    for part, (low, high) in enumerate(pairwise(borders)):
        inside = (places >= low) & (places <= high)
        largest[part] = values[inside].max()
        left_open[part] = reached[inside].max() - largest[part]
    return largest, left_open


def power_means(values: Columns, borders: FloatArray, power: float) -> tuple[FloatArray, FloatArray]:
    """Mean of each part between two borders by a power, ``mean(v**power)**(1/power)``, and what the columns leave open.

    The quantity goes with the square of the pressure, so it is linear between the middles of the columns.

    Examples
    --------
    >>> columns = Columns(np.array([[0.0, 1], [1, 2], [2, 3], [3, 4]]), np.arange(4) + 0.5, np.array([1.0, 1, 1, 3]))
    >>> [found.round(3).tolist() for found in power_means(columns, np.array([0.0, 2.0, 4.0]), 1.0)]
    [[1.0, 2.125], [0.0, 0.625]]
    """
    x, heights = _with_straight_ends(values.middles, values.values, values.edges)
    steps = open_steps(heights)
    cuts = np.unique(np.concatenate([borders, x[(x > borders[0]) & (x < borders[-1])]]))
    middles, halves = 0.5 * (cuts[1:] + cuts[:-1]), 0.5 * np.diff(cuts)
    within = np.clip(np.searchsorted(x, middles) - 1, 0, steps.size - 1)
    part = np.searchsorted(borders, middles) - 1
    places, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    found = np.interp(middles[:, None] + halves[:, None] * places, x, heights)

    def mean(at: FloatArray) -> FloatArray:
        scale = max(float(at.max()), np.finfo(float).tiny)
        integral = np.bincount(part, halves * ((at / scale) ** power @ weights), minlength=borders.size - 1)
        return np.asarray(scale * (integral / np.diff(borders)) ** (1 / power))

    usual = mean(found)
    return usual, mean(found + steps[within, None]) - usual


def _with_ends(pressure: Columns) -> tuple[FloatArray, FloatArray]:
    """Middles of columns and both ends, and the square of the pressure there."""
    return _with_straight_ends(pressure.middles, pressure.values**2, pressure.edges)


def _with_straight_ends(x: FloatArray, values: FloatArray, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions and values with those at both ends, to which a straight line goes on, not below 0."""
    ends = (edges[0, 0], edges[-1, 1])
    if x.size == 1:
        return np.array([ends[0], x[0], ends[1]]), np.repeat(values, 3)
    beyond = [
        max(values[one] + (values[one] - values[next_]) * (end - x[one]) / (x[one] - x[next_]), 0.0)
        for end, one, next_ in ((ends[0], 0, 1), (ends[1], -1, -2))
    ]
    return np.concatenate([ends[:1], x, ends[1:]]), np.concatenate([beyond[:1], values, beyond[1:]])


def moved_load(line_load: Columns, borders: FloatArray) -> FloatArray:
    """Load that may lie on the other side of the borders of each part, since it is uniform in each column, N.

    Examples
    --------
    >>> columns = Columns(np.array([[0.0, 1], [1, 2], [2, 3], [3, 4]]), np.arange(4) + 0.5, np.array([1.0, 1, 2, 2]))
    >>> moved_load(columns, np.array([0.0, 2.0, 4.0])).tolist()
    [0.25, 0.25]
    """
    low, high = line_load.edges.T
    moved = beside(np.abs(np.diff(line_load.values))) * np.minimum(line_load.widths, np.diff(borders).min())
    at_borders = np.zeros(borders.size)
    for number, border in enumerate(borders[1:-1], start=1):
        first = int(np.searchsorted(high, border, side="left"))
        last = min(int(np.searchsorted(low, border, side="right")), low.size - 1)
        at_borders[number] = MOVED * moved[max(first - 1, 0) : last + 1].max()
    return np.asarray(at_borders[:-1] + at_borders[1:])
