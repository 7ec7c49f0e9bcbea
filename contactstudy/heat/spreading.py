"""How heat spreads along x between insulated ends, and how a moving surface carries it along y.

A point source at rest in a body whose surface moves at V along +y has released its heat at all times t before. In t
that heat has spread by the length ``s = sqrt(4 kappa t)`` and has moved by ``V t``, so the steady temperature is an
integral over s of a product of one factor along each axis (H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids,
1959, sections 10.2 and 10.7):

    T = 1 / (lambda sqrt(pi))  integral of  X(s) Y(s) exp(-z**2 / s**2) ds .

X and Y are those of uniform heat in a cell. Insulated ends act on X alone: they mirror the cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import erf

from contactstudy.checks import FloatArray

NODES = 6
"""Gauss points in each panel of the integral over the length of spreading. Accuracy."""

FIRST_PANEL = 0.125
"""Length of spreading, over the smallest cell, below which a cell's middle has lost nothing. Accuracy."""

GROWTH = 2.0
"""Ratio of neighbouring panels. Accuracy."""

LONGEST = 1e8
"""Length of spreading over the window at which a source at rest is cut off; what is left out is 1e-8. Accuracy."""

TAIL = 6.5
"""Lengths of spreading beyond which nothing is left of a cell's heat: erfc(6.5) = 4e-20. Accuracy."""

SERIES_FROM = 0.6
"""Length of spreading over the distance between two ends from which a cosine series needs fewer terms than images."""

SERIES_TERMS = 8
"""Terms of that series: the next one has lost ``exp(-(9 pi 0.6 / 2)**2)``. Accuracy."""


class Ends(NamedTuple):
    """Where insulated ends stand along x, metres; infinite for none."""

    low: float
    high: float


def spread_lengths(smallest: float, step: float, window: float, drift: float) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of the integral over the length of spreading s.

    Parameters
    ----------
    smallest, step, window : float
        Width of the smallest cell, of a cell along y, and of the whole window along y, metres.
    drift : float
        ``v = V / (2 kappa)`` (1/m): heat that has spread by s has moved by ``v s**2 / 2``.
    """
    speed = abs(drift)
    # Cells of the window drift out of it; after that their heat is gone when it no longer reaches back.
    last = LONGEST * window
    if speed:
        last = min((TAIL + np.sqrt(TAIL**2 + 2 * speed * window)) / speed, last)
    first = FIRST_PANEL * smallest
    count = max(1, int(np.ceil(np.log(last / first) / np.log(GROWTH))))
    edges = [np.zeros(1), np.geomspace(first, last, count + 1)]
    if speed:
        # Where the border of a cell passes the middle of another, as far as the border is still sharp.
        passing = np.sqrt(2 * step * (np.arange(int(np.ceil(window / step)) + 1) + 0.5) / speed)
        edges.append(passing[passing < last])
    borders = np.unique(np.concatenate(edges))
    borders = borders[np.concatenate([[True], np.diff(borders) > 1e-9 * borders[1:]])]
    points, weights = np.polynomial.legendre.leggauss(NODES)
    halves = 0.5 * np.diff(borders)
    middles = 0.5 * (borders[1:] + borders[:-1])
    return (middles[:, None] + halves[:, None] * points).ravel(), (halves[:, None] * weights).ravel()


def along_y(spread: FloatArray, distance: FloatArray, step: float, drift: float) -> FloatArray:
    """Part of a cell's heat density left at distances along y from its middle: array (spread, distance)."""
    s = spread[:, None]
    behind = distance[None, :] - 0.5 * drift * s**2
    return np.asarray(0.5 * (erf((behind + 0.5 * step) / s) - erf((behind - 0.5 * step) / s)))


def along_x(spread: FloatArray, x: FloatArray, edges: FloatArray, ends: Ends) -> FloatArray:
    """Part left at positions `x` of the heat of cells between `edges`: array (spread, x, cell)."""
    length = ends.high - ends.low
    passed = _primitive(spread, x[:, None] - edges[None, :], length)
    mirror = ends.low if np.isfinite(ends.low) else ends.high
    if np.isfinite(mirror):
        passed = passed - _primitive(spread, x[:, None] + edges[None, :] - 2 * mirror, length)
    return np.asarray(passed[..., :-1] - passed[..., 1:])


def between_offsets(spread: FloatArray, offset: FloatArray, width: float, length: float) -> FloatArray:
    """Part left at distances along x from the middle of a cell and of its images in both ends: (spread, offset)."""
    high = _primitive(spread, offset + 0.5 * width, length)
    return high - _primitive(spread, offset - 0.5 * width, length)


def _primitive(spread: FloatArray, distance: FloatArray, length: float) -> FloatArray:
    """Primitive along x of the heat kernel and, for a finite length, of its copies at every second length."""
    distance = np.asarray(distance)
    s = spread.reshape(-1, *[1] * distance.ndim)
    if not np.isfinite(length):
        return np.asarray(0.5 * erf(distance / s))
    turns = np.round(distance / (2 * length))
    reduced = distance - 2 * length * turns
    result = np.empty((spread.size, *distance.shape))
    wide = spread >= SERIES_FROM * length
    # exp(-(m pi / L)**2 kappa t) with 4 kappa t = s**2
    if wide.any():
        number = np.arange(1, SERIES_TERMS + 1) * np.pi / length
        decay = np.exp(-0.25 * np.outer(spread[wide], number) ** 2) / (number * length)
        waves = np.sin(number.reshape(-1, *[1] * distance.ndim) * reduced)
        result[wide] = reduced / (2 * length) + np.tensordot(decay, waves, axes=1)
    if not wide.all():
        near = spread[~wide]
        images = max(0, int(np.ceil((TAIL * near.max() / length - 1) / 2)))
        values = 0.5 * erf(reduced / s[~wide])
        for image in range(1, images + 1):
            for shift in (-2 * length * image, 2 * length * image):
                values += 0.5 * erf((reduced + shift) / s[~wide])
        result[~wide] = values
    return result + turns
