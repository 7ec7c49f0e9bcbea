"""Strain energy of a contact over approach and tilt as one smooth function: load, moment and stiffness derive from it.

Load and moment are the derivatives of the energy with respect to approach and tilt, so the stiffness matrix is its
matrix of second derivatives and symmetric by construction. The energy without tilt follows powers of the approach: its
logarithm is a spline in the logarithm of the approach. What a tilt adds is a tensor product of splines in that
logarithm and in the tilt, fitted to energy, load and moment together by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.ndimage import maximum_filter

from contactstudy.checks import FloatArray

DEGREE = 4
"""Of the splines: the stiffness, a second derivative, then has two continuous derivatives itself. Accuracy."""

LOWER, SAFETY, BETWEEN = 3, 3.0, 4
"""Degree of other splines whose difference tells the error, a factor on that and on what a spline without one approach
misses there, and steps from node to node in which differences are looked for. Accuracy: so the error of springs of
power 3/2, which leave the surface, was covered on 5 to 9 nodes."""

ENERGY_COUNTS = 0.1
"""Weight of the energies themselves, which their derivatives all but determine. Accuracy."""


class Nodes(NamedTuple):
    """What is known of a contact at pairs of approach and tilt.

    Attributes
    ----------
    approaches, tilts : array
        Metres, positive, and radians; increasing.
    energy, load, moment : array (approach, tilt)
        J, N and N m.
    """

    approaches: FloatArray
    tilts: FloatArray
    energy: FloatArray
    load: FloatArray
    moment: FloatArray

    def approached(self, lines: FloatArray) -> Nodes:
        """Return some of the approaches."""
        return Nodes(self.approaches[lines], self.tilts, self.energy[lines], self.load[lines], self.moment[lines])


class Motion(NamedTuple):
    """What an approach and a tilt take, and the stiffness matrix; arrays of one shape.

    Attributes
    ----------
    load, moment : array
        N and N m.
    normal, coupling, tilting : array
        ``dQ/d delta`` (N/m), ``dQ/d theta = dM/d delta`` (N/rad) and ``dM/d theta`` (N m/rad).
    """

    load: FloatArray
    moment: FloatArray
    normal: FloatArray
    coupling: FloatArray
    tilting: FloatArray


@dataclass(frozen=True, eq=False)
class Axis:
    """B-splines along one axis.

    Attributes
    ----------
    knots : array
        Knots, the ends repeated.
    degree : int
        Degree.
    """

    knots: FloatArray
    degree: int

    @classmethod
    def through(cls, places: FloatArray, degree: int) -> Axis:
        """One spline more than places: the integrals of those that pass through values there (de Boor's means)."""
        degree = min(degree, places.size - 1)
        inner = [places[first : first + degree - 1].mean() for first in range(1, places.size - degree + 1)]
        ends = (np.repeat(place, degree + 1) for place in (places[0], places[-1]))
        return cls(np.concatenate([next(ends), inner, next(ends)]), degree)

    def __call__(self, places: FloatArray, derivative: int = 0) -> FloatArray:
        """Every spline at every place: array (place, spline)."""
        count = self.knots.size - self.degree - 1
        return np.asarray(BSpline(self.knots, np.eye(count), self.degree)(places, nu=derivative))


@dataclass(frozen=True, eq=False)
class EnergySpline:
    """Strain energy: the exponential of a spline for no tilt, and a product of splines for what a tilt adds.

    Attributes
    ----------
    along_approach, along_tilt : Axis
        Splines in the logarithm of the approach, and in the tilt over the largest.
    largest_tilt : float
        Radians.
    level : array
        Coefficients of the logarithm of the energy without tilt.
    added : array
        Coefficients of what a tilt adds, one per pair of splines, J.
    """

    along_approach: Axis
    along_tilt: Axis
    largest_tilt: float
    level: FloatArray
    added: FloatArray

    @classmethod
    def fitted(cls, nodes: Nodes, degree: int = DEGREE) -> EnergySpline:
        """Fit energy, load and moment at once."""
        u, scale = np.log(nodes.approaches), float(np.abs(nodes.tilts).max())
        t = nodes.tilts / scale
        first, second = Axis.through(u, degree), Axis.through(t, degree)
        # dU / d ln delta = delta Q, and dU / d(theta / scale) = scale M.
        load, moment = nodes.approaches[:, None] * nodes.load, scale * nodes.moment
        straight = int(np.abs(t).argmin())
        energy, sunk = nodes.energy[:, straight], load[:, straight]
        level = _solved([(first(u), np.log(energy)), (first(u, 1), sunk / energy)])
        along = np.exp(first(u) @ level)
        # The loads, and the moments of each approach, count alike.
        turning = np.abs(moment).max(axis=1, keepdims=True) + np.zeros_like(moment)
        known = (
            ((0, 0), nodes.energy - along[:, None], nodes.energy / ENERGY_COUNTS),
            ((1, 0), load - (along * (first(u, 1) @ level))[:, None], load),
            ((0, 1), moment, np.where(turning > 0, turning, scale * load)),
        )
        rows = [
            (np.kron(first(u, i), second(t, j)) / size.reshape(-1, 1), (value / size).ravel())
            for (i, j), value, size in known
        ]
        return cls(first, second, scale, level, _solved(rows).reshape(first(u).shape[1], -1))

    def __call__(self, approach: FloatArray, tilt: FloatArray) -> Motion:
        """Load, moment and stiffness at pairs of approach and tilt, of one shape."""
        shape = np.shape(approach)
        delta, theta = np.ravel(approach), np.ravel(tilt)
        u, t, scale = np.log(delta), theta / self.largest_tilt, self.largest_tilt
        first = [self.along_approach(u, order) for order in range(3)]
        second = [self.along_tilt(t, order) for order in range(3)]

        def derived(i: int, j: int) -> FloatArray:
            return np.asarray(np.einsum("pi,ij,pj->p", first[i], self.added, second[j]))

        along, slope, bend = np.exp(first[0] @ self.level), first[1] @ self.level, first[2] @ self.level
        by_u = along * slope + derived(1, 0)
        by_uu = along * (bend + slope**2) + derived(2, 0)
        values = (
            by_u / delta,
            derived(0, 1) / scale,
            (by_uu - by_u) / delta**2,
            derived(1, 1) / (delta * scale),
            derived(0, 2) / scale**2,
        )
        return Motion(*(each.reshape(shape) for each in values))


def _solved(rows: list[tuple[FloatArray, FloatArray]]) -> FloatArray:
    """Least squares of several blocks of equations, whose unknowns may differ much in size."""
    matrix, known = (np.concatenate(each) for each in zip(*rows, strict=True))
    size = np.linalg.norm(matrix, axis=0)
    return np.asarray(np.linalg.lstsq(matrix / size, known, rcond=None)[0] / size)


class FitErrors(NamedTuple):
    """Errors of load over the load, and of the moment over load and length; arrays (approach, tilt) or numbers."""

    load: FloatArray | float
    moment: FloatArray | float

    def plus(self, other: FitErrors) -> FitErrors:
        """Return the sum of both."""
        return FitErrors(self.load + other.load, self.moment + other.moment)

    def larger(self, other: FitErrors) -> FitErrors:
        """Return the larger of either error."""
        return FitErrors(np.maximum(self.load, other.load), np.maximum(self.moment, other.moment))

    def times(self, factor: float) -> FitErrors:
        """Return a multiple of both."""
        return FitErrors(factor * self.load, factor * self.moment)


def fit_errors(nodes: Nodes, length: float) -> FitErrors:
    """Errors at and about every node: what is missed there, and what another degree and fewer nodes tell."""
    spline, lower = EnergySpline.fitted(nodes), EnergySpline.fitted(nodes, LOWER)
    missed = _differences(spline(*_pairs(nodes.approaches, nodes.tilts)), nodes.load, nodes.moment, length)
    pairs = _pairs(np.exp(_finer(np.log(nodes.approaches))), _finer(nodes.tilts))
    other = lower(*pairs)
    degree = _differences(spline(*pairs), other.load, other.moment, length)
    told = FitErrors(_about_nodes(degree.load), _about_nodes(degree.moment)).plus(_with_fewer(nodes, length))
    return missed.larger(told.times(SAFETY))


def _with_fewer(nodes: Nodes, length: float) -> FitErrors:
    """Return what splines without one of the approaches miss there; at the first and the last, as beside them."""
    lines, found = np.arange(nodes.approaches.size), []
    for line in lines[1:-1]:
        without, alone = nodes.approached(lines != line), nodes.approached(lines == line)
        there = EnergySpline.fitted(without)(*_pairs(alone.approaches, alone.tilts))
        found.append(_differences(there, alone.load, alone.moment, length))
    load, moment = (np.concatenate([each[0], *each, each[-1]]) for each in zip(*found, strict=True))
    return FitErrors(load, moment)


def _about_nodes(fine: FloatArray | float) -> FloatArray:
    """Largest value from each node to its neighbours, of values on finer steps."""
    return np.asarray(maximum_filter(fine, 2 * BETWEEN + 1, mode="nearest")[::BETWEEN, ::BETWEEN])


def _pairs(approaches: FloatArray, tilts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Every approach with every tilt."""
    delta, theta = np.meshgrid(approaches, tilts, indexing="ij")
    return delta, theta


def _finer(places: FloatArray) -> FloatArray:
    """Return the places and some between them."""
    count = places.size
    return np.asarray(np.interp(np.arange(BETWEEN * (count - 1) + 1) / BETWEEN, np.arange(count), places))


def _differences(found: Motion, load: FloatArray, moment: FloatArray, length: float) -> FitErrors:
    """Differences of load and moment."""
    return FitErrors(np.abs(found.load / load - 1), np.abs(found.moment - moment) / (load * length))
